!> The command line as a value
module dda_command_line
   use dda_error, only : error_t, fatal_error
   use dda_deck_token, only : shown
   use dda_deck_key, only : near_one
   use dda_screen, only : screen_t
   use dda_text, only : read_integer, to_text
   implicit none
   private

   public :: command_t, read_command, name_of

   !> Longest argument that is taken
   integer, parameter :: longest = 32768
   !> What the first argument may be
   character(len=*), parameter :: subcommands(*) = [character(len=9) :: "run", "check", "cut", &
      & "lines", "export", "help", "--help", "--version"]
   !> Options of those that read files
   character(len=*), parameter :: options(*) = [character(len=8) :: "--out", "--jobs", "--set", &
      & "--cases", "--resume", "--tight", "--record", "--quiet", "--help"]

   !> What the user asked for
   type :: command_t
      character(len=16) :: verb = "help"  !! run, check, cut, lines, export, help or version
      !> Decks to run, check or export, files to cut, maps to draw, or the topic of help: (n)
      character(len=longest), allocatable :: name(:)
      !> Lengths of those names, blanks at their ends counted: (n) [characters]
      integer, allocatable :: name_length(:)
      character(len=longest), allocatable :: setting(:)  !! --set values: (n)
      !> Output folder, or the file of cut or lines; unallocated if none is named
      character(len=:), allocatable :: out
      character(len=:), allocatable :: cases  !! Numbers of the cases to compute; empty for all
      integer :: jobs = 1                     !! Cases computed at the same time
      logical :: quiet = .false.              !! Print nothing but errors
      logical :: resume = .false.             !! Skip cases that an earlier run has finished
      logical :: tight = .false.              !! Bounds of searches as near as rounding lets them be
      logical :: record = .false.             !! Print what deck.record would hold
      type(screen_t) :: screen                !! Where lines for the user go
   end type command_t

contains

   !> Read the arguments of the program
   subroutine read_command(command, error)
      type(command_t), intent(out) :: command
      !> Allocated if an argument is not understood
      type(error_t), allocatable, intent(out) :: error
      character(len=longest), allocatable :: argument(:)
      integer, allocatable :: length(:)
      integer :: i

      allocate (argument(command_argument_count()), length(command_argument_count()))
      do i = 1, size(argument)
         call get_command_argument(i, argument(i), length(i))
         if (length(i) > longest) call fatal_error(error, "expected an argument of at most " &
            & //to_text(longest)//" characters, got one of "//to_text(length(i))//"; shorten it", &
            & "dda", i)
         if (allocated(error)) return
      end do
      call parse_command(argument, length, command, error)
   end subroutine read_command

   !> Understand the arguments
   pure subroutine parse_command(argument, length, command, error)
      character(len=*), intent(in) :: argument(:)  !! The arguments: (n)
      !> Their lengths, blanks at their ends counted: (n) [characters]
      integer, intent(in) :: length(:)
      type(command_t), intent(out) :: command
      type(error_t), allocatable, intent(out) :: error
      character(len=longest), allocatable :: name(:), setting(:)
      logical :: takes_decks, takes_options
      integer, allocatable :: name_length(:)
      integer :: i, names, settings

      command%cases = ""
      allocate (name(size(argument) + 1), name_length(size(argument) + 1), setting(size(argument)))
      names = 0
      settings = 0
      takes_decks = .false.
      if (size(argument) > 0) call take_subcommand(argument(1), command, takes_decks, error)
      takes_options = takes_decks
      i = 2
      do while (i <= size(argument) .and. .not. allocated(error))
         if (takes_options) call check_option(argument(i), command, error)
         if (allocated(error)) then
            error%line = i
            exit
         end if
         if (takes_options .and. argument(i) == "--") then
            takes_options = .false.
         else if (takes_options .and. argument(i) == "--set" .and. i < size(argument)) then
            settings = settings + 1
            i = i + 1
            setting(settings) = argument(i)
         else if (takes_options .and. (argument(i) == "--help" .or. argument(i) == "-h")) then
            names = 1
            name(1) = command%verb
            name_length(1) = len_trim(command%verb)
            command%verb = "help"
            exit
         else if (takes_options .and. argument(i)(1:1) == "-") then
            call take_option(argument, length, i, command, error)
         else
            names = names + 1
            name(names) = argument(i)
            name_length(names) = length(i)
            if (takes_decks .and. name(names) == "") &
               & call fatal_error(error, "expected the name of a file, got an empty one; "// &
               & "give one")
         end if
         if (allocated(error)) error%line = i
         i = i + 1
      end do
      allocate (command%name, source=name(:names))
      allocate (command%name_length, source=name_length(:names))
      allocate (command%setting, source=setting(:settings))
      if (takes_decks .and. .not. allocated(error)) call check_names(command, error)
      if (.not. allocated(error)) call check_out(command, error)
      if (allocated(error)) error%file = "dda"
   end subroutine parse_command

   !> Whether there is anything to read
   pure subroutine check_names(command, error)
      type(command_t), intent(in) :: command
      type(error_t), allocatable, intent(out) :: error

      if (command%verb == "help" .or. size(command%name) > 0) return
      call fatal_error(error, "dda "//trim(command%verb)//" needs the name of a " &
         & //trim(merge("file of lines", "deck         ", command%verb == "cut"))//", got " &
         & //"none; 'dda help "//trim(command%verb)//"' says more", line=1)
   end subroutine check_names

   !> Whether dda cut or dda lines can do what is asked
   pure subroutine check_out(command, error)
      type(command_t), intent(in) :: command
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      if (allocated(command%out) .and. (command%verb == "cut" .or. command%verb == "lines")) then
         n = len(command%out)
         if (size(command%name) > 1) then
            call fatal_error(error, "--out needs a single file of lines, got " &
               & //to_text(size(command%name))//"; cut them one by one", line=1)
         else if (command%verb == "lines") then
            if (command%out(max(n - 3, 1):) /= ".geo") call fatal_error(error, &
               & "--out expected a file that ends in .geo, got '"//shown(command%out)//"'", line=1)
         else if (all(command%out(max(n - 3, 1):) /= [".vtu", ".csv"])) then
            call fatal_error(error, "--out must be a file that ends in .vtu or .csv, got '" &
               & //shown(command%out)//"'; give it one of these endings", line=1)
         end if
      end if
   end subroutine check_out

   !> Understand the first argument
   pure subroutine take_subcommand(word, command, takes_decks, error)
      character(len=*), intent(in) :: word  !! The argument
      type(command_t), intent(inout) :: command
      logical, intent(out) :: takes_decks   !! Whether decks and options follow
      type(error_t), allocatable, intent(out) :: error

      takes_decks = .false.
      select case (word)
      case ("--help", "-h", "help")
         command%verb = "help"
      case ("--version")
         command%verb = "version"
      case ("run", "check", "cut", "lines", "export")
         command%verb = word(:len(command%verb))
         takes_decks = .true.
      case default
         call fatal_error(error, "expected a subcommand, got '"//shown(trim(word))//"'"// &
            & near_one(trim(word), subcommands)//"; 'dda help' lists all", line=1)
      end select
   end subroutine take_subcommand

   !> Whether a subcommand takes an option that others take
   pure subroutine check_option(option, command, error)
      !> An argument; one that no subcommand takes as an option is not judged here
      character(len=*), intent(in) :: option
      type(command_t), intent(in) :: command
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: own

      select case (command%verb)
      case ("run")
         own = "--out --jobs --set --cases --resume --tight --quiet --help"
      case ("check")
         own = "--set --record --quiet --help"
      case ("cut", "lines")
         own = "--out --quiet --help"
      case default
         own = "--out --set --quiet --help"
      end select
      if (all(options /= option) .or. index(own, trim(option)) > 0) return
      call fatal_error(error, "expected an option of dda "//trim(command%verb)//", got "// &
         & trim(option)//", which dda "//trim(merge("check", "run  ", option == "--record"))// &
         & " takes; remove it")
   end subroutine check_option

   !> Understand one option and its value
   pure subroutine take_option(argument, length, i, command, error)
      character(len=*), intent(in) :: argument(:)
      integer, intent(in) :: length(:)
      integer, intent(inout) :: i  !! Place of the option in, of its last part out
      type(command_t), intent(inout) :: command
      type(error_t), allocatable, intent(out) :: error
      logical :: ok

      select case (argument(i))
      case ("--quiet")
         command%quiet = .true.
         return
      case ("--resume")
         command%resume = .true.
         return
      case ("--tight")
         command%tight = .true.
         return
      case ("--record")
         command%record = .true.
         return
      case ("--out", "--set", "--jobs", "--cases")
         if (i == size(argument)) call fatal_error(error, trim(argument(i)) &
            & //" needs a value, got none; 'dda help "//trim(command%verb)//"' shows it")
         if (allocated(error)) return
      case default
         call fatal_error(error, "unknown option "//shown(trim(argument(i)))// &
            & near_one(trim(argument(i)), options)//"; 'dda help "//trim(command%verb)// &
            & "' lists all")
         return
      end select
      i = i + 1
      if (argument(i - 1) == "--out") then
         command%out = argument(i)(:length(i))
         if (command%out == "") call fatal_error(error, "--out must be the name of a folder, "// &
            & "got an empty one; give one, or remove --out")
      else if (argument(i - 1) == "--cases") then
         command%cases = argument(i)(:length(i))
         if (command%cases == "") call fatal_error(error, "--cases must be numbers of cases, "// &
            & "got none; write them like 1-4,7")
      else
         call read_integer(trim(argument(i)), command%jobs, ok)
         if (.not. ok .or. command%jobs < 1) call fatal_error(error, &
            & "--jobs must be a whole number, 1 or more, got '"//shown(trim(argument(i))) &
            & //"'; correct it, or leave it out for 1")
      end if
   end subroutine take_option

   !> Name of a deck or a topic as it was given, blanks at its end included
   pure function name_of(command, i) result(name)
      type(command_t), intent(in) :: command
      integer, intent(in) :: i  !! Place of the name
      character(len=:), allocatable :: name

      name = command%name(i)(:command%name_length(i))
   end function name_of
end module dda_command_line
