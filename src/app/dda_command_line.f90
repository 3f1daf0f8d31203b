!> The command line as a value
module dda_command_line
   use dda_error, only : error_t, fatal_error
   use dda_text, only : read_integer
   implicit none
   private

   public :: command_t, read_command, argument_length

   !> Longest argument that is kept
   integer, parameter :: argument_length = 4096

   !> What the user asked for
   type :: command_t
      !> run, check, help or version
      character(len=16) :: verb = "help"
      !> Decks to run or check, or the topic of help: (n)
      character(len=argument_length), allocatable :: name(:)
      !> --set values: (n)
      character(len=argument_length), allocatable :: setting(:)
      !> Output folder; unallocated if none is named
      character(len=:), allocatable :: out
      !> Cases computed at the same time
      integer :: jobs = 1
      !> Print nothing but errors
      logical :: quiet = .false.
   end type command_t

contains

   !> Read the arguments of the program
   subroutine read_command(command, error)
      !> What the user asked for
      type(command_t), intent(out) :: command
      !> Allocated if an argument is not understood
      type(error_t), allocatable, intent(out) :: error
      character(len=argument_length), allocatable :: argument(:)
      integer :: i

      allocate (argument(command_argument_count()))
      do i = 1, size(argument)
         call get_command_argument(i, argument(i))
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
      logical :: takes_decks
      integer :: i

      allocate (command%name(0), command%setting(0))
      if (size(argument) == 0) return
      select case (argument(1))
      case ("--help", "-h", "help")
         command%verb = "help"
      case ("--version")
         command%verb = "version"
      case ("run", "check")
         command%verb = argument(1)(:16)
      case default
         call fatal_error(error, "run, check or help is wanted, '"//trim(argument(1))//"' was found")
         return
      end select
      takes_decks = command%verb == "run" .or. command%verb == "check"
      i = 2
      do while (i <= size(argument) .and. .not. allocated(error))
         if (takes_decks .and. argument(i) (1:1) == "-") then
            call take_option(argument, i, command, error)
         else
            command%name = [command%name, argument(i)]
         end if
         i = i + 1
      end do
      if (allocated(error)) return
      if (takes_decks .and. size(command%name) == 0) &
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
      character(len=argument_length) :: value
      logical :: ok

      if (argument(i) == "--help" .or. argument(i) == "-h") then
         command%name = [command%verb//repeat(" ", argument_length - len(command%verb))]
         command%verb = "help"
         return
      end if
      select case (argument(i))
      case ("--quiet")
         command%quiet = .true.
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
      value = argument(i + 1)
      i = i + 1
      select case (argument(i - 1))
      case ("--out")
         command%out = trim(value)
         if (command%out == "") call fatal_error(error, "--out wants the name of a folder")
      case ("--set")
         command%setting = [command%setting, value]
      case ("--jobs")
         call read_integer(trim(value), command%jobs, ok)
         if (.not. ok .or. command%jobs < 1) call fatal_error(error, &
            & "--jobs wants a number of cases from 1, '"//trim(value)//"' was found")
      end select
   end subroutine take_option
end module dda_command_line
