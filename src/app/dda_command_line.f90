!> The command line as a value
module dda_command_line
   use dda_error, only : error_t, fatal_error
   use dda_deck_token, only : shown
   use dda_deck_key, only : near_one
   use dda_screen, only : screen_t
   use dda_text, only : read_integer, to_text
   use dda_utf_8, only : bad_byte, byte_name
   implicit none
   private

   public :: command_t, read_command, is_of_voussoir

   !> Maximum length of an argument
   integer, parameter :: longest = 32768
   !> Verbs that take files
   character(len=*), parameter :: verbs(*) = [character(len=9) :: "run", "check", "cut", "lines", &
      & "export"]
   !> Valid first arguments
   character(len=*), parameter :: subcommands(*) = [character(len=9) :: verbs, "help", "--help", &
      & "--version"]
   !> Commands of voussoir that dda does not have
   character(len=*), parameter :: of_voussoir(*) = [character(len=14) :: "animate", "assess", &
      & "campaign", "examples", "import", "paper", "plot", "stability", "study", "theory", &
      & "traffic", "validation", "verify", "view", "work-precision"]

   !> An option of verbs that take files
   type :: option_t
      character(len=8) :: name    !! Name of the option
      character(len=26) :: verbs  !! Verbs that accept it, separated by blanks
      logical :: has_value        !! True if a value follows
   end type option_t

   character(len=*), parameter :: all_verbs = "run check cut lines export"
   !> All options
   type(option_t), parameter :: option(*) = [option_t("--out", "run cut lines export", .true.), &
      & option_t("--jobs", "run", .true.), option_t("--set", "run check export", .true.), &
      & option_t("--cases", "run", .true.), option_t("--resume", "run", .false.), &
      & option_t("--tight", "run", .false.), option_t("--force", "run", .false.), &
      & option_t("--record", "check", .false.), &
      & option_t("--quiet", all_verbs, .false.), option_t("--help", all_verbs, .false.)]

   !> An argument including trailing blanks
   type :: argument_t
      character(len=:), allocatable :: text  !! The argument
   end type argument_t

   !> The parsed command line
   type :: command_t
      character(len=16) :: verb = "help"  !! One of verbs, help or version
      !> Decks to run, check or export, files to cut, maps to draw, or a help topic: (n)
      type(argument_t), allocatable :: name(:)
      character(len=longest), allocatable :: setting(:)  !! --set values: (n)
      !> Output folder, or output file of cut or lines; unallocated if not given
      character(len=:), allocatable :: out
      character(len=:), allocatable :: cases  !! Numbers of the cases to compute; empty for all
      integer :: jobs = 1                     !! Number of concurrent cases
      logical :: quiet = .false.              !! True to print errors only
      logical :: resume = .false.             !! True to skip cases finished by an earlier run
      logical :: force = .false.              !! True to overwrite tables of other programs
      logical :: tight = .false.              !! True for search bounds at the limit of round-off
      logical :: record = .false.             !! True to print the contents of deck.record
      type(screen_t) :: screen                !! Standard output
   end type command_t

contains

   !> Read the arguments of the program
   subroutine read_command(command, error)
      type(command_t), intent(out) :: command
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid argument
      type(argument_t), allocatable :: argument(:)
      integer :: bad, i, length

      allocate (argument(command_argument_count()))
      do i = 1, size(argument)
         call get_command_argument(i, length=length)
         if (length > longest) call fatal_error(error, "expected an argument of at most " &
            & //to_text(longest)//" characters, got one of "//to_text(length)//"; shorten it", &
            & "dda", i)
         if (allocated(error)) return
         allocate (character(len=length) :: argument(i)%text)
         call get_command_argument(i, argument(i)%text)
         bad = bad_byte(argument(i)%text)
         if (bad > 0) call fatal_error(error, "expected text in UTF-8, got the byte " &
            & //byte_name(argument(i)%text(bad:bad))//"; rename the file or folder", "dda", i)
         if (allocated(error)) return
      end do
      call parse_command(argument, command, error)
      if (allocated(error)) error%file = "dda"
   end subroutine read_command

   !> Parse the arguments
   pure subroutine parse_command(argument, command, error)
      type(argument_t), intent(in) :: argument(:)  !! The arguments: (n)
      type(command_t), intent(out) :: command
      type(error_t), allocatable, intent(out) :: error
      logical :: takes_files, takes_options
      integer :: i, n

      command%cases = ""
      allocate (command%name(size(argument)), command%setting(0))
      n = 0
      takes_files = .false.
      if (size(argument) > 0) call take_subcommand(argument(1)%text, command, takes_files, error)
      takes_options = takes_files
      i = 2
      do while (i <= size(argument) .and. .not. allocated(error))
         associate (word => argument(i)%text)
            if (.not. takes_options .or. index(word, "-") /= 1) then
               n = n + 1
               command%name(n)%text = word
               if (takes_files .and. word == "") call fatal_error(error, &
                  & "expected the name of a file, got an empty one; give one")
            else if (word == "--") then
               takes_options = .false.
            else if (word == "--help" .or. word == "-h") then
               n = 1
               command%name(1)%text = trim(command%verb)
               command%verb = "help"
               exit
            else
               call take_option(argument, i, command, error)
            end if
         end associate
         if (allocated(error)) error%line = i
         i = i + 1
      end do
      command%name = command%name(:n)
      if (.not. allocated(error)) call check_command(command, takes_files, error)
   end subroutine parse_command

   !> Check that there is an input file, and at most one output file of cut or lines
   pure subroutine check_command(command, takes_files, error)
      type(command_t), intent(in) :: command
      logical, intent(in) :: takes_files  !! True if the command reads files
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: ending

      if (takes_files .and. command%verb /= "help" .and. size(command%name) == 0) then
         call fatal_error(error, "dda "//trim(command%verb)//" needs the name of a " &
            & //trim(merge("file of lines", "deck         ", command%verb == "cut"))//", got " &
            & //"none; 'dda help "//trim(command%verb)//"' lists its options", line=1)
      else if (allocated(command%out) .and. any(command%verb == ["cut  ", "lines"])) then
         ending = command%out(max(len(command%out) - 3, 1):)
         if (size(command%name) > 1) then
            call fatal_error(error, "--out needs a single file of lines, got " &
               & //to_text(size(command%name))//"; cut them one by one", line=1)
         else if (command%verb == "lines" .and. ending /= ".geo") then
            call fatal_error(error, "--out must be a file that ends in .geo, got '" &
               & //shown(command%out)//"'; give it that ending", line=1)
         else if (command%verb == "cut" .and. all(ending /= [".vtu", ".csv"])) then
            call fatal_error(error, "--out must be a file that ends in .vtu or .csv, got '" &
               & //shown(command%out)//"'; give it one of these endings", line=1)
         end if
      end if
   end subroutine check_command

   !> Parse the first argument
   pure subroutine take_subcommand(word, command, takes_files, error)
      character(len=*), intent(in) :: word  !! The argument
      type(command_t), intent(inout) :: command
      logical, intent(out) :: takes_files   !! True if files and options follow
      type(error_t), allocatable, intent(out) :: error

      takes_files = any(verbs == word)
      if (takes_files) then
         command%verb = word
      else if (word == "--version") then
         command%verb = "version"
      else if (is_of_voussoir(word)) then
         call fatal_error(error, "expected a subcommand of dda, got '"//word//"', which "// &
            & "voussoir has; write 'voussoir "//word//"'", line=1)
      else if (all(word /= [character(len=6) :: "--help", "-h", "help"])) then
         call fatal_error(error, "expected a subcommand, got '"//shown(trim(word))//"'"// &
            & near_one(trim(word), subcommands)//"; 'dda help' lists all", line=1)
      end if
   end subroutine take_subcommand

   !> True for a command of voussoir that dda does not have
   pure logical function is_of_voussoir(word)
      character(len=*), intent(in) :: word

      is_of_voussoir = any(of_voussoir == word)
   end function is_of_voussoir

   !> Parse one option and its value
   pure subroutine take_option(argument, i, command, error)
      type(argument_t), intent(in) :: argument(:)
      integer, intent(inout) :: i  !! Index of the option on entry, of its last part on return
      type(command_t), intent(inout) :: command
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, value
      integer :: k
      logical :: ok

      name = trim(argument(i)%text)
      value = ""
      k = findloc(option%name == name, .true., dim=1)
      if (k == 0) then
         call fatal_error(error, "unknown option "//shown(name)//near_one(name, option%name) &
            & //"; 'dda help "//trim(command%verb)//"' lists all")
      else if (index(option(k)%verbs, trim(command%verb)) == 0) then
         call fatal_error(error, "expected an option of dda "//trim(command%verb)//", got "// &
            & name//", which dda "//trim(merge("check", "run  ", name == "--record"))// &
            & " takes; remove it")
      else if (option(k)%has_value .and. i == size(argument)) then
         call fatal_error(error, name//" needs a value, got none; 'dda help " &
            & //trim(command%verb)//"' shows it")
      end if
      if (allocated(error)) return
      if (option(k)%has_value) then
         i = i + 1
         value = argument(i)%text
      end if
      select case (name)
      case ("--quiet")
         command%quiet = .true.
      case ("--resume")
         command%resume = .true.
      case ("--force")
         command%force = .true.
      case ("--tight")
         command%tight = .true.
      case ("--record")
         command%record = .true.
      case ("--set")
         command%setting = [character(len=longest) :: command%setting, value]
      case ("--out")
         command%out = value
         if (value == "") call fatal_error(error, "--out must be the name of a folder, "// &
            & "got an empty one; give one, or remove --out")
      case ("--cases")
         command%cases = value
         if (value == "") call fatal_error(error, "--cases must be numbers of cases, "// &
            & "got none; write them like 1-4,7")
      case ("--jobs")
         call read_integer(trim(value), command%jobs, ok)
         if (.not. ok .or. command%jobs < 1) call fatal_error(error, &
            & "--jobs must be a whole number, 1 or more, got '"//shown(trim(value)) &
            & //"'; correct it, or leave it out for 1")
      end select
   end subroutine take_option
end module dda_command_line
