!> Tokens of a deck, and the scanner of its text
!>
!> Tokens are positions in the text, not copies: groups, keys, values and group ends in order.
module dda_deck_token
   use dda_error, only : error_t, fatal_error
   use dda_text, only : to_text, lower_case
   implicit none
   private

   public :: deck_scan_t, token_t, token_kind, token_text, shown
   public :: start, add_token, skip_blanks, word_end

   !> Maximum number of tokens in a deck
   integer, parameter :: max_tokens = 2000000
   !> Blank characters of a namelist: blank, tab, line feed
   character(len=3), parameter :: blanks = " "//achar(9)//achar(10)
   !> Characters that end a word without quotes
   character(len=9), parameter :: word_ends = blanks//",/=!'"""

   !> Kinds of tokens
   type :: token_kind_enum
      integer :: group = 1    !! & and the name of a group
      integer :: key = 2      !! Name before an equals sign
      integer :: word = 3     !! Value without quotes
      integer :: quoted = 4   !! Value in quotes
      integer :: nothing = 5  !! Empty value between two commas
      integer :: close = 6    !! Slash that ends a group
   end type token_kind_enum

   !> The kinds of token by name
   type(token_kind_enum), parameter :: token_kind = token_kind_enum()

   !> One token of a deck
   type :: token_t
      integer :: kind = 0   !! One of token_kind
      integer :: first = 1  !! First character in the text, without quotes and repeat count
      integer :: last = 0   !! Last character in the text
      integer :: line = 0   !! Line of the text, counted from 1
      integer :: count = 1  !! Repeat count r of r*c
   end type token_t

   !> A text, its tokens and the state of the scanner
   type :: deck_scan_t
      character(len=:), allocatable :: text   !! The text, its lines ended by line feeds
      type(token_t), allocatable :: token(:)  !! Tokens in their order: (n)
      integer :: n = 0                        !! Number of tokens
      integer :: position = 1                 !! Next character to read
      integer :: line = 1                     !! Line of that character
      logical :: after_comma = .false.  !! True if a comma precedes that character without a value
      integer :: open_group = 0  !! Token of the open group; 0 between groups
   end type deck_scan_t

contains

   !> Text of a token: names in lower case, doubled quotes reduced to one
   pure function token_text(scan, i) result(text)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i  !! Place of the token
      character(len=:), allocatable :: text
      character(len=1) :: quote
      integer :: at, next

      associate (token => scan%token(i))
         text = scan%text(token%first:token%last)
         if (token%kind == token_kind%group .or. token%kind == token_kind%key) then
            text = lower_case(text)
         else if (token%kind == token_kind%quoted) then
            quote = scan%text(token%first - 1:token%first - 1)
            at = 1
            do
               next = index(text(at:), quote)
               if (next == 0) exit
               text = text(:at + next - 1)//text(at + next + 1:)
               at = at + next
            end do
         end if
      end associate
   end function token_text

   !> Text prepared for a message: no control characters, limited length
   pure function shown(text) result(clean)
      character(len=*), intent(in) :: text  !! Any text
      !> One line of at most 60 characters; each character that is not ASCII becomes one '?'
      character(len=:), allocatable :: clean
      character(len=60) :: buffer
      integer :: i, n, code

      n = 0
      do i = 1, len(text)
         code = ichar(text(i:i))
         if (code >= 128 .and. code < 192) cycle
         if (n == len(buffer)) then
            buffer(n - 2:) = "..."
            exit
         end if
         n = n + 1
         buffer(n:n) = text(i:i)
         if (code < 32 .or. code > 126) buffer(n:n) = "?"
      end do
      clean = buffer(:n)
   end function shown

   !> Start the scanner at the beginning of a text
   pure subroutine start(text, scan)
      character(len=*), intent(in) :: text
      type(deck_scan_t), intent(out) :: scan  !! Scanner without tokens

      scan%text = text
      allocate (scan%token(64))
   end subroutine start

   !> Append a token at the scanner's line
   pure subroutine add_token(scan, kind, first, last, count, error)
      type(deck_scan_t), intent(inout) :: scan
      integer, intent(in) :: kind                       !! One of token_kind
      integer, intent(in) :: first                      !! First character
      integer, intent(in) :: last                       !! Last character
      integer, intent(in) :: count                      !! Repeat count
      type(error_t), allocatable, intent(out) :: error  !! Allocated for too many tokens

      if (scan%n == max_tokens) call fatal_error(error, "expected at most "//to_text(max_tokens) &
         & //" groups, keys and values, got more; split the deck")
      if (allocated(error)) return
      ! double the capacity
      if (scan%n == size(scan%token)) scan%token = [scan%token, scan%token]
      scan%n = scan%n + 1
      scan%token(scan%n) = token_t(kind, first, last, scan%line, count)
      scan%after_comma = .false.
   end subroutine add_token

   !> Move to the next character that is neither blank nor in a comment
   pure subroutine skip_blanks(scan)
      type(deck_scan_t), intent(inout) :: scan
      integer :: next

      do while (scan%position <= len(scan%text))
         if (scan%text(scan%position:scan%position) == "!") then
            next = index(scan%text(scan%position:), achar(10))
            if (next == 0) next = len(scan%text) - scan%position + 2
            scan%position = scan%position + next - 1
         else if (verify(scan%text(scan%position:scan%position), blanks) > 0) then
            exit
         else
            if (scan%text(scan%position:scan%position) == achar(10)) scan%line = scan%line + 1
            scan%position = scan%position + 1
         end if
      end do
   end subroutine skip_blanks

   !> Last letter of the word at the scanner's position; one before the position if no word starts
   !> there
   pure integer function word_end(scan)
      type(deck_scan_t), intent(in) :: scan

      word_end = scan%position
      do while (word_end <= len(scan%text))
         if (index(word_ends, scan%text(word_end:word_end)) > 0) exit
         word_end = word_end + 1
      end do
      word_end = word_end - 1
   end function word_end
end module dda_deck_token
