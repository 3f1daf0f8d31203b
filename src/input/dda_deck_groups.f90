!> Groups of a deck, and --set GROUP%KEY=VALUE, into values
submodule (dda_read_deck) dda_deck_groups
   use dda_deck, only : deck_error, follow_joints, put_text, split_name
   use dda_deck_key, only : full_name, key_kind, key_t, near_group
   use dda_deck_keys, only : deck_group, deck_key
   use dda_deck_scan, only : scan_values
   use dda_deck_sweep, only : add_sweep
   use dda_deck_token, only : shown, token_kind, token_text
   use dda_key_entry, only : find_key, read_entry, read_value
   use dda_key_names, only : arch_group, sweep_group
   use dda_text, only : to_text
   implicit none

   !> Page of the help that lists groups and keys
   character(len=*), parameter :: topic = "keys"

contains

   !> Read one group
   module procedure read_group
      character(len=:), allocatable :: name, problem
      type(deck_place_t) :: place
      integer :: g, line

      name = token_text(scan, i)
      place%line = scan%token(i)%line
      g = group_index(name)
      if (g == 0) then
         call deck_error(error, "unknown group &"//shown(name)//": " &
            & //near_group(name, deck_group, topic), deck, place)
         return
      else if (deck%group(g)%line > 0 .and. g /= sweep_group) then
         call deck_error(error, "group &"//name//" is repeated: the first is in line "// &
            to_text(deck%group(g)%line)//"; join the two", deck, place)
         return
      end if
      deck%group(g) = place
      i = i + 1
      do while (scan%token(i)%kind /= token_kind%close)
         call read_entry(scan, i, name, deck_key, topic, deck%value, problem, line)
         if (len(problem) > 0) call deck_error(error, problem, deck, deck_place_t(line))
         if (allocated(error)) return
      end do
      i = i + 1
      if (g == arch_group) call follow_joints(deck)
      if (g == sweep_group) call add_sweep(deck, place, error)
   end procedure read_group

   !> Put the value of a --set into the deck
   module procedure apply_setting
      character(len=:), allocatable :: group, name, problem
      type(parameter_t) :: parameter
      integer :: equals
      logical :: ok

      equals = index(setting, "=")
      call split_name(setting(:max(equals - 1, 0)), group, name, parameter%item, ok)
      if (.not. ok .or. equals == 0 .or. len(group) == 0 .or. has_control(setting)) then
         problem = "expected group%key=value, got '"//shown(setting) &
            & //"'; write it like arch%radius=5.0"
      else if (group == "sweep") then
         problem = "&sweep cannot be set; change the deck"
      else if (group_index(group) == 0) then
         problem = "unknown group &"//shown(group)//": "//near_group(group, deck_group, topic)
      else
         call find_key(deck_key, group, name, topic, parameter%key, problem)
      end if
      if (len(problem) > 0) then
         call deck_error(error, problem, deck, place)
      else
         call set_value(setting(equals + 1:), parameter, place, deck, error)
      end if
   end procedure apply_setting

   !> Whether a text holds control characters
   pure logical function has_control(text)
      character(len=*), intent(in) :: text  !! Any text
      integer :: i

      has_control = any([(ichar(text(i:i)) < 32 .or. ichar(text(i:i)) == 127, i=1, len(text))])
   end function has_control

   !> Put the text after the equals sign of a --set into its key
   pure subroutine set_value(text, parameter, place, deck, error)
      !> The value as a namelist would have it; a word or a text may lack its quotes
      character(len=*), intent(in) :: text
      !> The key, with its item if one is set
      type(parameter_t), intent(in) :: parameter
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_scan_t) :: scan
      type(key_t) :: key
      logical :: has_quotes
      integer :: g

      key = deck_key(parameter%key)
      has_quotes = index(adjustl(text), "'") == 1 .or. index(adjustl(text), """") == 1
      if (any(key%kind == [key_kind%text, key_kind%word]) .and. .not. has_quotes) then
         call put_text(deck, parameter, trim(adjustl(text)), place, error)
      else if (parameter%item > 0 .and. key%kind /= key_kind%numbers) then
         call deck_error(error, full_name(key)//" has no items; remove the parentheses", deck, &
            & place)
      else
         call scan_values(text, scan, error)
         if (allocated(error)) then
            error%file = "--set"
            error%line = place%line
            return
         end if
         associate (value => deck%value(parameter%key))
            call read_value(scan, 1, scan%n, deck_key, parameter%key, parameter%item, place, &
               & value, problem)
            if (len(problem) > 0) call deck_error(error, problem, deck, value%place)
         end associate
         call follow_joints(deck)
      end if
      if (allocated(error)) return
      g = group_index(key%group)
      if (deck%group(g)%line == 0) deck%group(g) = place
   end subroutine set_value
end submodule dda_deck_groups
