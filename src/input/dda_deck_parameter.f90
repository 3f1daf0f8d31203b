!> Names of what a sweep, a search or a --set may vary
module dda_deck_parameter
   use dda_text, only : to_text, lower_case, read_integer
   use dda_deck_key, only : key_t, key_kind
   use dda_deck_keys, only : deck_key
   use dda_deck_words, only : full_name, near_key
   use dda_deck_token, only : shown
   use dda_deck, only : parameter_t
   implicit none
   private

   public :: split_name, find_parameter, parameter_name

contains

   !> Split a name such as arch%joints_deg(2)
   pure subroutine split_name(name, group, key, item, ok)
      !> The name
      character(len=*), intent(in) :: name
      !> Group, lower case; empty if the name has none
      character(len=:), allocatable, intent(out) :: group
      !> Key, lower case
      character(len=:), allocatable, intent(out) :: key
      !> Item of a list; 0 if the name has none
      integer, intent(out) :: item
      !> Whether what stands in parentheses, if they are there, is a number from 1
      logical, intent(out) :: ok
      integer :: percent, open

      key = trim(adjustl(lower_case(name)))
      percent = index(key, "%")
      group = trim(key(:max(percent - 1, 0)))
      key = trim(adjustl(key(percent + 1:)))
      item = 0
      ok = .true.
      open = index(key, "(")
      if (open == 0) return
      ok = key(len(key):) == ")"
      if (ok) call read_integer(trim(adjustl(key(open + 1:len(key) - 1))), item, ok)
      ok = ok .and. item >= 1
      key = trim(key(:open - 1))
   end subroutine split_name

   !> Find a key that may vary by its name
   pure subroutine find_parameter(name, parameter, problem)
      !> Name of the key, with or without its group: friction_deg, joints_deg(2), arch%radius
      character(len=*), intent(in) :: name
      type(parameter_t), intent(out) :: parameter
      !> Why there is none; empty if there is one
      character(len=:), allocatable, intent(out) :: problem
      character(len=:), allocatable :: group, key
      logical :: ok, fits(size(deck_key))
      integer :: i

      call split_name(name, group, key, parameter%item, ok)
      fits = deck_key%name == key .and. (deck_key%group == group &
         .or. len(group) == 0 .and. deck_key%bare)
      problem = ""
      if (.not. ok) then
         problem = "expected a name such as joints_deg(2), got '"//shown(name)// &
            "'; number the items from 1"
      else if (.not. any(fits)) then
         problem = "'"//shown(name)//"' is no key: "//near_key(key, group, deck_key, "keys")
      else if (.not. any(fits .and. deck_key%varies)) then
         problem = "'"//shown(name)//"' cannot be varied; choose a key of the groups arch to "// &
            "analysis"
      else if (count(fits .and. deck_key%varies) > 1) then
         problem = "'"//shown(name)//"' is a key of several groups; write group%key"
      end if
      if (len(problem) > 0) return
      parameter%key = maxloc(merge(1, 0, fits .and. deck_key%varies), dim=1)
      i = parameter%key
      if (deck_key(i)%kind == key_kind%numbers .eqv. parameter%item > 0) return
      problem = trim(deck_key(i)%name)//" is a list; name one item, such as "// &
         trim(deck_key(i)%name)//"(2)"
      if (parameter%item > 0) problem = trim(deck_key(i)%name)//" has no items; remove the "// &
         "parentheses"
   end subroutine find_parameter

   !> Name of a parameter as a column is headed
   pure function parameter_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter
      !> Key, with its group only if the key alone would be ambiguous, and with its item
      character(len=:), allocatable :: name
      type(key_t) :: key
      integer :: alike, i

      key = deck_key(parameter%key)
      name = trim(key%name)
      alike = 0
      do i = 1, size(deck_key)
         if (.not. (deck_key(i)%varies .and. deck_key(i)%bare)) cycle
         ! the first letter tells most keys apart, and a comparison of texts is a call
         if (deck_key(i)%name(1:1) /= name(1:1)) cycle
         if (deck_key(i)%name == key%name) alike = alike + 1
      end do
      if (.not. key%bare .or. alike > 1) name = full_name(key)
      if (parameter%item > 0) name = name//"("//to_text(parameter%item)//")"
   end function parameter_name
end module dda_deck_parameter
