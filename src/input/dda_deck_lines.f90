!> The files that a deck of lines names: read and checked with the deck
module dda_deck_lines
   use dda_deck, only : add_file_mark, deck_error, deck_t, file_beside
   use dda_deck_keys, only : key_index
   use dda_error, only : error_t
   use dda_file_mark, only : file_mark
   use dda_read_limerick, only : check_materials, read_analysis, read_geometry
   implicit none
   private

   public :: read_lines, name_key

contains

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
end module dda_deck_lines
