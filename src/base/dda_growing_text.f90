!> A text of many lines, whose room doubles where it must
module dda_growing_text
   use dda_kinds, only : wp
   use dda_text, only : print_number
   implicit none
   private

   public :: growing_text_t, add_line, bytes_of, fields, lines_of

   !> Lines put together so far
   type :: growing_text_t
      private
      character(len=:), allocatable :: text  !! The lines, each with its end, and room behind them
      integer :: length = 0                  !! Length of the lines
   end type growing_text_t

contains

   !> Put a line below the others
   pure subroutine add_line(lines, line)
      type(growing_text_t), intent(inout) :: lines
      character(len=*), intent(in) :: line  !! The line
      character(len=:), allocatable :: longer
      integer :: room

      if (.not. allocated(lines%text)) lines%text = repeat(" ", 4096)
      room = lines%length + len(line) + 1
      if (room > len(lines%text)) then
         allocate (character(len=max(2*len(lines%text), room)) :: longer)
         longer(:lines%length) = lines%text(:lines%length)
         call move_alloc(longer, lines%text)
      end if
      lines%text(lines%length + 1:room) = line//new_line("a")
      lines%length = room
   end subroutine add_line

   !> The lines, parted by line ends, none behind the last
   pure function lines_of(lines) result(text)
      type(growing_text_t), intent(in) :: lines
      character(len=:), allocatable :: text  !! The text; empty if there are none

      text = ""
      if (lines%length > 0) text = lines%text(:lines%length - 1)
   end function lines_of

   !> Bytes of the lines with their ends
   pure integer function bytes_of(lines)
      type(growing_text_t), intent(in) :: lines

      bytes_of = lines%length
   end function bytes_of

   !> Numbers with something between them
   pure function fields(value, between) result(text)
      real(wp), intent(in) :: value(:)            !! The numbers: (n), one or more
      character, intent(in), optional :: between  !! A comma where it is left out
      character(len=:), allocatable :: text
      character(len=33*size(value)) :: buffer
      character :: parting
      integer :: i, k, n

      parting = ","
      if (present(between)) parting = between
      n = 0
      do i = 1, size(value)
         if (i > 1) then
            n = n + 1
            buffer(n:n) = parting
         end if
         call print_number(value(i), buffer(n + 1:n + 32), k)
         n = n + k
      end do
      text = buffer(:n)
   end function fields
end module dda_growing_text
