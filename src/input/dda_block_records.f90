!> Entries of a file of blocks that name a record in place of rows of their own:
!> WORD ... file 'NAME' [columns T X [Y]] [scale S]
module dda_block_records
   use dda_block_lines, only : entry_t, take_numbers, word_size
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_read_record, only : read_record
   implicit none
   private

   public :: take_record

contains

   !> Put the rows of the record that an entry names below it, and leave its words out; an entry
   !> that names none stays as it is
   subroutine take_record(entry, file, marks, error)
      type(entry_t), intent(inout) :: entry
      !> Name of the file of blocks, beside which the record is
      character(len=*), intent(in) :: file
      !> Receives the length and the check sums of the record
      character(len=:), allocatable, intent(inout) :: marks
      !> Anything wrong with the words, or with the record
      type(error_t), allocatable, intent(out) :: error
      character(len=word_size) :: column(3)
      character(len=:), allocatable :: message, mark, name
      real(wp) :: scale
      integer :: i

      i = findloc(entry%head%word(:entry%head%n) == "file", .true., dim=1)
      if (i == 0) return
      call take_words(entry, i, column, scale, error)
      if (allocated(error)) return
      name = entry%head%quoted
      if (index(name, "/") /= 1) name = file(:index(file, "/", back=.true.))//name
      deallocate (entry%row)
      call read_record(name, column, scale, entry%row, mark, error)
      if (allocated(error)) then
         if (error%line > 0) return
         message = "record '"//shown(entry%head%quoted)//"': "//error%message
         call fatal_error(error, message, line=entry%head%number)
         return
      end if
      entry%n_row = size(entry%row, 2)
      entry%head%n = i - 1
      if (.not. allocated(marks)) marks = ""
      marks = marks//" "//mark
   end subroutine take_record

   !> Take the words from 'file' on
   pure subroutine take_words(entry, first, column, scale, error)
      type(entry_t), intent(in) :: entry
      !> Place of that word
      integer, intent(in) :: first
      !> Columns of time, x and y: (3)
      character(len=word_size), intent(out) :: column(3)
      !> What the components are multiplied by
      real(wp), intent(out) :: scale
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: number(1)
      integer :: i, n
      logical :: has_columns, has_scale

      column = [character(len=word_size) :: "1", "2", "0"]
      scale = 1.0_wp
      has_columns = .false.
      has_scale = .false.
      i = first + 2
      associate (head => entry%head)
         if (entry%n_column /= 3) then
            call fatal_error(error, "unknown word 'file'", line=head%number)
         else if (head%word(min(first + 1, size(head%word))) /= "'") then
            call fatal_error(error, "expected the name of a record in quotes after 'file', got " &
               & //"none; write it as in file 'quake.csv'", line=head%number)
         else if (entry%n_row > 0) then
            call fatal_error(error, "expected a record or rows of time and components, got both; " &
               & //"remove one of them", line=head%number)
         end if
         do while (i <= head%n .and. .not. allocated(error))
            if (head%word(i) == "columns" .and. .not. has_columns) then
               has_columns = .true.
               n = findloc(head%word(i + 1:head%n) == "scale", .true., dim=1) - 1
               if (n < 0) n = head%n - i
               if (n < 2 .or. n > 3) then
                  call fatal_error(error, "expected two or three columns, of time, x and y, " &
                     & //"after 'columns'; 0 stands for none", line=head%number)
                  return
               end if
               column(:n) = head%word(i + 1:i + n)
               i = i + n + 1
            else if (head%word(i) == "scale" .and. .not. has_scale) then
               has_scale = .true.
               call take_numbers(head, i, number, error)
               scale = number(1)
            else
               call fatal_error(error, "expected columns or scale, once each, got '" &
                  & //shown(trim(head%word(i)))//"'", line=head%number)
            end if
         end do
      end associate
   end subroutine take_words
end module dda_block_records
