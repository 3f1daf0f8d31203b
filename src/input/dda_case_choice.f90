!> dda run --cases: which cases of a deck are computed
module dda_case_choice
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_text, only : read_integer, to_text
   implicit none
   private

   public :: choose_cases

contains

   !> Choose cases by their numbers
   pure subroutine choose_cases(text, total, chosen, error)
      !> Numbers and ranges parted by commas, such as 1-500,812; empty for all cases
      character(len=*), intent(in) :: text
      !> Number of cases of the deck
      integer, intent(in) :: total
      !> Whether a case is chosen: (total)
      logical, allocatable, intent(out) :: chosen(:)
      !> Not such a list, or a case that the deck does not have
      type(error_t), allocatable, intent(out) :: error
      integer :: first, comma, low, high
      logical :: ok

      allocate (chosen(total), source=text == "")
      if (text == "") return
      first = 1
      do while (first <= len(text) + 1)
         comma = index(text(first:)//",", ",")
         call read_range(text(first:first + comma - 2), low, high, ok)
         if (ok) ok = low >= 1 .and. low <= high .and. high <= total
         if (.not. ok) then
            call fatal_error(error, "expected cases from 1 to "//to_text(total)// &
               & ", got '"//shown(text(first:first + comma - 2))//"'; write them like 1-4,7", &
               & "--cases", 1)
            return
         end if
         chosen(low:high) = .true.
         first = first + comma
      end do
   end subroutine choose_cases

   !> Read a number, or two with a dash between
   pure subroutine read_range(text, low, high, ok)
      character(len=*), intent(in) :: text
      integer, intent(out) :: low   !! First number
      integer, intent(out) :: high  !! Last number
      logical, intent(out) :: ok    !! Whether the text is that
      integer :: dash

      dash = index(text, "-")
      if (dash == 0) then
         call read_integer(text, low, ok)
         high = low
      else
         call read_integer(text(dash + 1:), high, ok)
         if (ok) call read_integer(text(:dash - 1), low, ok)
      end if
   end subroutine read_range
end module dda_case_choice
