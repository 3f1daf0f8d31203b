!> Namelist text to tokens with line numbers
module dda_deck_scan
   use dda_error, only : error_t, fatal_error, place_error
   use dda_text, only : to_text, lower_case, read_integer
   use dda_deck_key, only : max_items
   use dda_deck_token, only : deck_scan_t, token_kind, token_text, shown, &
      start, add_token, skip_blanks, word_end
   implicit none
   private

   public :: scan_deck, scan_values

   !> Maximum length of a quoted text [characters]
   integer, parameter :: max_text = 1000
   !> Characters of a name
   character(len=37), parameter :: name_letters = "abcdefghijklmnopqrstuvwxyz0123456789_"

contains

   !> Split a deck into tokens
   pure subroutine scan_deck(text, scan, error)
      character(len=*), intent(in) :: text  !! Text of the deck, lines ended by line feeds
      type(deck_scan_t), intent(out) :: scan
      !> Allocated for invalid syntax, with the line
      type(error_t), allocatable, intent(out) :: error

      call start(text, scan)
      do
         call skip_blanks(scan)
         if (scan%position > len(scan%text)) exit
         if (scan%open_group == 0) then
            call scan_group(scan, error)
         else
            call scan_item(scan, error)
         end if
         call place_error(error, scan%line)
         if (allocated(error)) return
      end do
      if (scan%open_group > 0) then
         call not_closed(scan, "the end of the file", error)
      else if (scan%n == 0) then
         call fatal_error(error, "expected at least one group, got none; write &arch / for an "// &
            "arch of defaults", line=1)
      end if
   end subroutine scan_deck

   !> Split the value of a --set into tokens: one value, or several separated by commas or blanks
   pure subroutine scan_values(text, scan, error)
      character(len=*), intent(in) :: text  !! Text after the equals sign
      type(deck_scan_t), intent(out) :: scan
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      call start(text, scan)
      do
         call skip_blanks(scan)
         if (scan%position > len(scan%text)) exit
         call scan_item(scan, error)
         if (allocated(error)) return
      end do
      do i = 1, scan%n
         if (scan%token(i)%kind == token_kind%key .or. scan%token(i)%kind == token_kind%close) &
            & call fatal_error(error, "expected values, got '"//shown(text) &
            & //"'; write one value, or several separated by commas")
         if (allocated(error)) return
      end do
   end subroutine scan_values

   !> Scan the beginning of a group: & and a name
   pure subroutine scan_group(scan, error)
      type(deck_scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      integer :: first, last

      first = scan%position
      last = word_end(scan)
      if (scan%text(first:first) /= "&") then
         call fatal_error(error, "expected a group such as &arch, got text between groups: '"// &
            shown(scan%text(first:max(first, last)))//"'; remove it or put '!' before it")
      else if (last == first .or. &
         verify(lower_case(scan%text(first + 1:last)), name_letters) > 0) then
         call fatal_error(error, "expected the name of a group after '&', got '"// &
            shown(scan%text(first + 1:last))//"'; write one like &arch")
      else
         call add_token(scan, token_kind%group, first + 1, last, 1, error)
         scan%open_group = scan%n
         scan%after_comma = .false.
         scan%position = last + 1
      end if
   end subroutine scan_group

   !> Scan one item inside a group
   pure subroutine scan_item(scan, error)
      !> Scanner inside a group, at a character that is not blank
      type(deck_scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error

      select case (scan%text(scan%position:scan%position))
      case ("/")
         call close_group(scan, 1, error)
      case ("&")
         call scan_ampersand(scan, error)
      case (",")
         call scan_comma(scan, error)
      case ("=")
         call fatal_error(error, "expected a key before '=', got none; write key = value")
      case ("'", """")
         call scan_quoted(scan, 1, error)
      case default
         call scan_word(scan, error)
      end select
   end subroutine scan_item

   !> End the open group
   pure subroutine close_group(scan, width, error)
      type(deck_scan_t), intent(inout) :: scan  !! Scanner at the end of a group
      integer, intent(in) :: width              !! Number of characters of the end
      type(error_t), allocatable, intent(out) :: error

      call add_token(scan, token_kind%close, scan%position, scan%position, 1, error)
      scan%position = scan%position + width
      scan%open_group = 0
   end subroutine close_group

   !> Scan an ampersand inside a group: &end, or the next group if a slash is missing
   pure subroutine scan_ampersand(scan, error)
      type(deck_scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      integer :: last

      last = word_end(scan)
      if (lower_case(scan%text(scan%position:last)) == "&end") then
         call close_group(scan, 4, error)
      else
         call not_closed(scan, "'"//shown(scan%text(scan%position:last))//"' in line "// &
            to_text(scan%line), error)
      end if
   end subroutine scan_ampersand

   !> Scan a comma: the second of two adjacent ones makes an empty value
   pure subroutine scan_comma(scan, error)
      type(deck_scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      logical :: has_value

      has_value = scan%n > 0 .and. .not. scan%after_comma
      if (has_value) has_value = scan%token(scan%n)%kind == token_kind%word .or. &
         scan%token(scan%n)%kind == token_kind%quoted
      if (.not. has_value) then
         call add_token(scan, token_kind%nothing, scan%position, scan%position - 1, 1, error)
      end if
      scan%position = scan%position + 1
      scan%after_comma = .true.
   end subroutine scan_comma

   !> Scan a text in quotes
   pure subroutine scan_quoted(scan, count, error)
      type(deck_scan_t), intent(inout) :: scan
      integer, intent(in) :: count  !! Repeat count
      type(error_t), allocatable, intent(out) :: error
      character(len=1) :: quote
      integer :: first, last

      quote = scan%text(scan%position:scan%position)
      first = scan%position + 1
      last = first
      do
         if (last > len(scan%text) .or. last - first > max_text) exit
         if (scan%text(last:last) == achar(10)) exit
         if (scan%text(last:last) /= quote) then
            last = last + 1
         else if (scan%text(last:min(last + 1, len(scan%text))) == quote//quote) then
            last = last + 2
         else
            call add_token(scan, token_kind%quoted, first, last - 1, count, error)
            scan%position = last + 1
            return
         end if
      end do
      last = min(last - 1, len(scan%text))
      call fatal_error(error, "expected a closing quote on the same line after at most "// &
         to_text(max_text)//" characters, got '"//shown(scan%text(first:last))// &
         "'; close the quote")
   end subroutine scan_quoted

   !> Scan a word without quotes: a key before an equals sign, otherwise a value
   pure subroutine scan_word(scan, error)
      type(deck_scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      integer :: first, last, star, count, line

      first = scan%position
      last = word_end(scan)
      line = scan%line
      star = index(scan%text(first:last), "*")
      count = 1
      if (star > 0) call repeat_count(scan, first, star, count, error)
      if (allocated(error)) return
      scan%position = last + 1
      if (star > 0) first = first + star
      if (first > last .and. scan%position <= len(scan%text)) then
         if (scan%text(scan%position:scan%position) == "'" .or. &
            scan%text(scan%position:scan%position) == """") then
            call scan_quoted(scan, count, error)
            return
         end if
      end if
      call skip_blanks(scan)
      if (star == 0 .and. scan%text(scan%position:min(scan%position, len(scan%text))) == "=") then
         call add_token(scan, token_kind%key, first, last, 1, error)
         scan%position = scan%position + 1
      else
         call add_token(scan, token_kind%word, first, last, count, error)
      end if
      scan%token(scan%n)%line = line
   end subroutine scan_word

   !> Read the repeat count r of r*c
   pure subroutine repeat_count(scan, first, star, count, error)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first  !! First character of the word
      integer, intent(in) :: star   !! Position of the asterisk in the word
      integer, intent(out) :: count
      type(error_t), allocatable, intent(out) :: error
      logical :: ok

      call read_integer(scan%text(first:first + star - 2), count, ok)
      if (ok) ok = count >= 1 .and. count <= max_items
      if (ok) return
      call fatal_error(error, "expected a repeat count from 1 to "//to_text(max_items)// &
         " before '*', got '"//shown(scan%text(first:first + star - 2))//"'; write it like 3*1.5")
   end subroutine repeat_count

   !> Set the error for a group without its slash
   pure subroutine not_closed(scan, found, error)
      type(deck_scan_t), intent(in) :: scan  !! Scanner at the missing end
      character(len=*), intent(in) :: found  !! Text in place of the slash
      type(error_t), allocatable, intent(out) :: error

      if (scan%open_group == 0) then
         call fatal_error(error, "expected values, got "//found//"; remove it")
      else
         call fatal_error(error, "expected '/' at the end of &"// &
            token_text(scan, scan%open_group)//", got "//found//"; close the group", &
            line=scan%token(scan%open_group)%line)
      end if
   end subroutine not_closed
end module dda_deck_scan
