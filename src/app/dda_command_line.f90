!> The command line as a value
module dda_command_line
   use dda_error, only : error_t, fatal_error
   use dda_text, only : read_integer, to_text
   implicit none
   private

   public :: command_t, read_command

   !> Longest argument that is taken
   integer, parameter :: longest = 32768

   !> What the user asked for
   type :: command_t
      !> run, check, help or version
      character(len=16) :: verb = "help"
      !> Decks to run or check, or the topic of help: (n)
      character(len=longest), allocatable :: name(:)
      !> --set values: (n)
      character(len=longest), allocatable :: setting(:)
      !> Output folder; unallocated if none is named
      character(len=:), allocatable :: out
      !> Cases computed at the same time
      integer :: jobs = 1
      !> Print nothing but errors
      logical :: quiet = .false.
      !> Skip cases that an earlier run has finished
      logical :: resume = .false.
   end type command_t

contains

   !> Read the arguments of the program
   subroutine read_command(command, error)
      !> What the user asked for
      type(command_t), intent(out) :: command
      !> Allocated if an argument is not understood
      type(error_t), allocatable, intent(out) :: error
      character(len=longest), allocatable :: argument(:)
      integer :: i, length

      allocate (argument(command_argument_count()))
      do i = 1, size(argument)
         call get_command_argument(i, argument(i), length)
         if (length > longest) then
            call fatal_error(error, "an argument of at most "//to_text(longest) &
               & //" characters is wanted, one of "//to_text(length)//" was found")
            return
         end if
      end do
      call parse_command(argument, command, error)
   end subroutine read_command

   !> Understand the arguments
   pure subroutine parse_command(argument, command, error)
      !> The arguments: (n)
      character(len=*), intent(in) :: argument(:)
      !> What the user asked for
      type(command_t), intent(out) :: command
      !> Allocated if an argument is not understood
      type(error_t), allocatable, intent(out) :: error
      character(len=longest), allocatable :: name(:), setting(:)
      logical :: takes_decks
      integer :: i, names, settings

      allocate (name(size(argument) + 1), setting(size(argument)))
      names = 0
      settings = 0
      takes_decks = .false.
      if (size(argument) > 0) then
         select case (argument(1))
         case ("--help", "-h", "help")
            command%verb = "help"
         case ("--version")
            command%verb = "version"
         case ("run", "check")
            command%verb = argument(1)(:16)
            takes_decks = .true.
         case default
            call fatal_error(error, "run, check or help is wanted, '"//trim(argument(1)) &
               & //"' was found")
         end select
      end if
      i = 2
      do while (i <= size(argument) .and. .not. allocated(error))
         if (takes_decks .and. argument(i) == "--set" .and. i < size(argument)) then
            settings = settings + 1
            i = i + 1
            setting(settings) = argument(i)
         else if (takes_decks .and. (argument(i) == "--help" .or. argument(i) == "-h")) then
            names = 1
            name(1) = command%verb
            command%verb = "help"
            exit
         else if (takes_decks .and. argument(i)(1:1) == "-") then
            call take_option(argument, i, command, error)
         else
            names = names + 1
            name(names) = argument(i)
            if (takes_decks .and. name(names) == "") &
               & call fatal_error(error, "the name of a deck is wanted, an empty one was found")
         end if
         i = i + 1
      end do
      allocate (command%name, source=name(:names))
      allocate (command%setting, source=setting(:settings))
      if (takes_decks .and. command%verb /= "help" .and. names == 0 .and. .not. allocated(error)) &
         & call fatal_error(error, "dda "//trim(command%verb)//" wants the name of a deck")
   end subroutine parse_command

   !> Understand one option and its value
   pure subroutine take_option(argument, i, command, error)
      !> The arguments: (n)
      character(len=*), intent(in) :: argument(:)
      !> Place of the option in, of its last part out
      integer, intent(inout) :: i
      !> Receives the option
      type(command_t), intent(inout) :: command
      !> Allocated if the option is not understood
      type(error_t), allocatable, intent(out) :: error
      logical :: ok

      select case (argument(i))
      case ("--quiet")
         command%quiet = .true.
         return
      case ("--resume")
         command%resume = .true.
         return
      case ("--out", "--set", "--jobs")
         if (i == size(argument)) then
            call fatal_error(error, trim(argument(i))//" wants a value")
            return
         end if
      case default
         call fatal_error(error, "unknown option "//trim(argument(i)) &
            & //"; 'dda help "//trim(command%verb)//"' lists those that exist")
         return
      end select
      i = i + 1
      if (argument(i - 1) == "--out") then
         command%out = trim(argument(i))
         if (command%out == "") call fatal_error(error, "--out wants the name of a folder")
      else
         call read_integer(trim(argument(i)), command%jobs, ok)
         if (.not. ok .or. command%jobs < 1) call fatal_error(error, &
            & "--jobs wants a number of cases from 1, '"//trim(argument(i))//"' was found")
      end if
   end subroutine take_option
end module dda_command_line
