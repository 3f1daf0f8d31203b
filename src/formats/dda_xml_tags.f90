!> Lines of XML tags (libxml2 counts at most 65535), and checks before parsing
module dda_xml_tags
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_error, only : error_t, fatal_error
   use dda_key_set, only : add_key, has_key, key_set_t, new_key_set
   use dda_text, only : to_text
   use dda_word_list, only : quoted
   implicit none
   private

   public :: xml_tags_t, find_tags, count_of

   !> Tags in the order of the text
   type :: xml_tags_t
      integer :: n = 0                   !! Number of start tags and end tags
      integer, allocatable :: row(:, :)  !! First and last line of each tag: (2, n or more)
      !> True if a tag is both start and end of an element: (n or more)
      logical, allocatable :: is_whole(:)
   end type xml_tags_t

   !> State of the scan
   type :: scan_t
      character(len=:), allocatable :: file  !! Name of the file, for messages
      integer :: next = 1      !! Next character of the text
      integer :: row = 1       !! Line of that character
      real :: pairs = 0.0      !! Sum over all elements of the squared number of attributes
      integer :: n_names = 0   !! Upper limit of the number of different names
      type(key_set_t) :: seen  !! Keys of tags whose names have been counted
   end type scan_t

   !> A tag without its values
   type :: tag_t
      integer :: last = 0        !! Last character
      integer :: n_values = 0    !! Number of values
      integer(int64) :: key = 0  !! Hash of the names in the tag
   end type tag_t

   !> Maximum sum; libxml2 compares each pair of attributes of an element, about one second for this
   real, parameter :: most_pairs = 9.0e8
   !> Maximum number of names; libxml2 takes quadratic time for more
   integer, parameter :: most_names = 100000
   !> Two primes for the hash of names; their product does not overflow
   integer(int64), parameter :: prime = 2147483647_int64, factor = 1000003_int64
   !> References that need no DTD, besides numeric characters
   character(len=*), parameter :: predefined = " lt gt amp quot apos "
   character(len=1), parameter :: lf = achar(10)

contains

   !> Find the tags of an XML text; syntax errors are left to the parser
   pure subroutine find_tags(text, file, tags, error)
      character(len=*), intent(in) :: text  !! The text; its lines end in line feeds
      character(len=*), intent(in) :: file  !! Name of its file, for messages
      type(xml_tags_t), intent(out) :: tags
      !> Allocated for entities, declarations or too many attributes
      type(error_t), allocatable, intent(out) :: error
      type(scan_t) :: scan

      scan%file = file
      call new_key_set(scan%seen, min(most_names, count_of("<", text)))
      allocate (tags%row(2, count_of("<", text)), tags%is_whole(count_of("<", text)))
      do while (scan%next <= len(text) .and. .not. allocated(error))
         if (stands(text, scan%next, "<!--")) then
            call skip(text, mark_end(text, scan%next + 4, "-->"), scan)
         else if (stands(text, scan%next, "<![CDATA[")) then
            call skip(text, mark_end(text, scan%next + 9, "]]>"), scan)
         else if (stands(text, scan%next, "<?")) then
            call skip(text, mark_end(text, scan%next + 2, "?>"), scan)
         else if (stands(text, scan%next, "<!")) then
            call skip_doctype(text, scan, error)
         else if (stands(text, scan%next, "<")) then
            tags%n = tags%n + 1
            tags%row(1, tags%n) = scan%row
            call skip_tag(text, scan, error)
            tags%row(2, tags%n) = scan%row
            tags%is_whole(tags%n) = stands(text, scan%next - 2, "/>")
         else
            call skip_text(text, mark_end(text, scan%next, "<") - 1, scan, error)
         end if
      end do
   end subroutine find_tags

   !> Skip a document type declaration
   pure subroutine skip_doctype(text, scan, error)
      character(len=*), intent(in) :: text
      type(scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      type(tag_t) :: tag

      call find_outside_quotes(text, scan%next, "[>", tag)
      if (stands(text, tag%last, "[")) then
         call fatal_error(error, "expected a DOCTYPE without declarations, got '[': entities and " &
            & //"default values are not read; remove what is between [ and ]", scan%file, scan%row)
      else
         call skip(text, tag%last, scan)
      end if
   end subroutine skip_doctype

   !> Skip a tag
   pure subroutine skip_tag(text, scan, error)
      character(len=*), intent(in) :: text
      type(scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      type(tag_t) :: tag

      call find_outside_quotes(text, scan%next, ">", tag)
      scan%pairs = scan%pairs + real(tag%n_values)**2
      if (.not. has_key(scan%seen, tag%key)) then
         call add_key(scan%seen, tag%key)
         scan%n_names = scan%n_names + 1 + tag%n_values
      end if
      if (scan%pairs > most_pairs) then
         call fatal_error(error, "expected elements of fewer attributes, got one of " &
            & //to_text(tag%n_values)//"; remove some", scan%file, scan%row)
      else if (scan%n_names > most_names) then
         call fatal_error(error, "expected at most "//to_text(most_names)//" different names, " &
            & //"got more; remove elements that mean nothing", scan%file, scan%row)
      else
         call skip_text(text, tag%last, scan, error)
      end if
   end subroutine skip_tag

   !> Skip text; each reference must stand for a single character
   pure subroutine skip_text(text, last, scan, error)
      character(len=*), intent(in) :: text
      integer, intent(in) :: last  !! Place of its last character
      type(scan_t), intent(inout) :: scan
      type(error_t), allocatable, intent(out) :: error
      integer :: first, length

      do
         first = index(text(scan%next:last), "&")
         if (first == 0) exit
         first = scan%next + first - 1
         call skip(text, first, scan)
         length = name_length(text(first + 1:min(last, first + 60)))
         associate (name => text(first + 1:first + length))
            if (stands(name, 1, "#") .or. index(predefined, " "//name//" ") > 0) cycle
            call fatal_error(error, "expected text without entities, got "//quoted("&"//name) &
               & //"; write what it stands for", scan%file, scan%row)
            return
         end associate
      end do
      call skip(text, last, scan)
   end subroutine skip_text

   !> Length of the name that begins a text
   pure integer function name_length(text)
      character(len=*), intent(in) :: text

      name_length = scan(text, " ;<>""'&="//achar(9)//lf) - 1
      if (name_length < 0) name_length = len(text)
   end function name_length

   !> Advance to a character, or to the end of the text, and count lines
   pure subroutine skip(text, last, scan)
      character(len=*), intent(in) :: text
      integer, intent(in) :: last
      type(scan_t), intent(inout) :: scan

      scan%row = scan%row + count_of(lf, text(scan%next:min(last, len(text))))
      scan%next = last + 1
   end subroutine skip

   !> True if a text has a given string at a place
   pure logical function stands(text, first, piece)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first           !! The place
      character(len=*), intent(in) :: piece  !! The string

      stands = .false.
      if (first >= 1 .and. first + len(piece) - 1 <= len(text)) &
         & stands = text(first:first + len(piece) - 1) == piece
   end function stands

   !> End of the next occurrence of a mark; length of the text plus one if there is none
   pure integer function mark_end(text, first, mark)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first          !! Start of the search
      character(len=*), intent(in) :: mark  !! The mark

      mark_end = index(text(first:), mark)
      if (mark_end > 0) then
         mark_end = first + mark_end + len(mark) - 2
      else
         mark_end = len(text) + 1
      end if
   end function mark_end

   !> Find one of several characters outside quotes
   pure subroutine find_outside_quotes(text, first, wanted, tag)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first
      character(len=*), intent(in) :: wanted  !! The characters
      !> The text passed, up to one of the characters or the end of the text
      type(tag_t), intent(out) :: tag
      character(len=1) :: quote
      integer :: i

      quote = " "
      tag%key = 1
      do i = first, len(text)
         tag%last = i
         associate (letter => text(i:i))
            if (quote /= " ") then
               if (letter /= quote) cycle
               quote = " "
               tag%n_values = tag%n_values + 1
            else
               tag%key = 1 + mod(factor*tag%key + ichar(letter), prime)
               if (letter == """" .or. letter == "'") quote = letter
               if (index(wanted, letter) > 0) return
            end if
         end associate
      end do
   end subroutine find_outside_quotes

   !> Number of occurrences of a character in a text
   pure integer function count_of(letter, text)
      character(len=1), intent(in) :: letter  !! The character
      character(len=*), intent(in) :: text
      integer :: i

      count_of = 0
      do i = 1, len(text)
         if (text(i:i) == letter) count_of = count_of + 1
      end do
   end function count_of
end module dda_xml_tags
