!> Files that a deck names: lines, analysis, and records of the ground in &ground or in a sweep
module dda_deck_files
   use dda_deck, only : add_file_mark, deck_error, deck_place_t, deck_t, file_beside, &
      & ground_record_t
   use dda_deck_keys, only : key_index
   use dda_deck_token, only : shown
   use dda_error, only : error_t
   use dda_file_mark, only : file_mark
   use dda_kinds, only : wp
   use dda_read_limerick, only : check_materials, read_analysis, read_geometry
   use dda_read_record, only : column_size, read_record
   implicit none
   private

   public :: name_key, read_ground_records, read_lines

contains

   !> Read all of them
   subroutine read_ground_records(deck, error)
      !> The deck, checked; receives the records
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      integer :: i, key, s

      key = key_index("ground", "record")
      if (deck%ground%record%given) call add_record(deck%ground%record%text, &
         & deck%value(key)%place, deck, error)
      do s = 1, size(deck%sweeps)
         if (deck%sweeps(s)%parameter%key /= key) cycle
         do i = 1, size(deck%sweeps(s)%texts)
            if (allocated(error)) return
            call add_record(trim(deck%sweeps(s)%texts(i)), deck%sweeps(s)%place, deck, error)
         end do
      end do
   end subroutine read_ground_records

   !> Read one of them, unless it is there already
   subroutine add_record(name, place, deck, error)
      !> Its name in the deck
      character(len=*), intent(in) :: name
      !> Where the deck names it
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: mark, message
      character(len=column_size) :: column(3)
      real(wp), allocatable :: row(:, :)
      type(ground_record_t), allocatable :: longer(:)
      integer :: i, n

      n = 0
      if (allocated(deck%ground_record)) n = size(deck%ground_record)
      do i = 1, n
         if (deck%ground_record(i)%name == name) return
      end do
      call split_columns(deck, column, error)
      if (allocated(error)) return
      call read_record(file_beside(deck, name), column, 1.0_wp, row, mark, error)
      if (allocated(error)) then
         if (error%line > 0) return
         message = "ground%record = '"//shown(name)//"': "//error%message
         call deck_error(error, message, deck, place)
         return
      end if
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = deck%ground_record
      longer(n + 1)%name = name
      longer(n + 1)%motion%time = row(1, :)
      longer(n + 1)%motion%value = row(2:3, :)
      call move_alloc(longer, deck%ground_record)
      call add_file_mark(mark, deck)
   end subroutine add_record

   !> Part ground%columns into the columns of time, x and y
   pure subroutine split_columns(deck, column, error)
      type(deck_t), intent(in) :: deck
      !> The columns; 0 for none: (3)
      character(len=column_size), intent(out) :: column(3)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      integer :: blank, n

      text = adjustl(deck%ground%columns%text)
      column = "0"
      n = 0
      do while (len_trim(text) > 0)
         n = n + 1
         blank = scan(text//" ", " ,")
         if (n <= 3) column(n) = text(:blank - 1)
         text = adjustl(text(min(blank + 1, len(text) + 1):))
      end do
      if (n == 2 .or. n == 3) return
      call deck_error(error, "ground%columns needs two or three columns, of time, x and y, "// &
         & "got '"//shown(deck%ground%columns%text)//"'; write them as in '1 2'", deck, &
         & deck%value(key_index("ground", "columns"))%place)
   end subroutine split_columns

   !> Read the files of a deck whose kind is 'lines'; any other deck is left as it is
   subroutine read_lines(deck, error)
      !> The deck, checked; receives lines, analysis and warnings
      type(deck_t), intent(inout) :: deck
      !> What is wrong with the files, or with the two together
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: file

      if (deck%scene%kind%word /= "lines") return
      file = file_beside(deck, deck%scene%geometry%text)
      allocate (deck%lines)
      call read_geometry(file, deck%lines, deck%warnings, error)
      if (allocated(error)) then
         call name_key(deck, "geometry", error)
         return
      end if
      call add_file_mark(file_mark(file), deck)
      if (.not. deck%scene%analysis%given) return
      file = file_beside(deck, deck%scene%analysis%text)
      allocate (deck%file_analysis)
      call read_analysis(file, deck%file_analysis, deck%warnings, error)
      if (allocated(error)) then
         call name_key(deck, "analysis", error)
         return
      end if
      call add_file_mark(file_mark(file), deck)
      call check_materials(deck%lines, deck%file_analysis, deck%warnings, error)
   end subroutine read_lines

   !> An error without a line speaks of a file that cannot be read: the line of the deck helps more
   pure subroutine name_key(deck, key, error)
      type(deck_t), intent(in) :: deck
      !> The key of &scene that names the file
      character(len=*), intent(in) :: key
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: message

      if (error%line > 0) return
      message = "scene%"//key//" = '"//deck%value(key_index("scene", key))%text &
         //"': "//error%message
      call deck_error(error, message, deck, deck%value(key_index("scene", key))%place)
   end subroutine name_key
end module dda_deck_files
