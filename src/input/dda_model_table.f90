!> Models, and the parameters that can be searched in them: the tables of docs/input.md. Decks are
!> checked by them; `dda check` prints what they say of a deck, `dda help models` all of them
module dda_model_table
   use dda_deck_key, only : key_t
   use dda_model_rows, only : model_row, search_row
   implicit none
   private

   public :: model_problem, models_of, models_help, search_problem, searches_of

   !> Kinds of blocks in the order of the columns
   character(len=6), parameter :: kind_name(4) = [character(len=6) :: "arch", "shape", "lines", &
      & "blocks"]
   !> Columns before those of the kinds
   integer, parameter :: before_models = 2, before_searches = 1

contains

   !> Why blocks of a kind cannot be run so
   pure function model_problem(kind, mode, geometry) result(why)
      character(len=*), intent(in) :: kind      !! One of kind_name
      character(len=*), intent(in) :: mode      !! Word of analysis%mode
      character(len=*), intent(in) :: geometry  !! Word of analysis%geometry
      character(len=:), allocatable :: why      !! The reason; empty if they can
      character(len=:), allocatable :: head
      integer :: i

      why = "there is no such model"
      head = "| `"//mode//"` | `"//geometry//"` |"
      do i = 1, size(model_row)
         if (model_row(i)(:len(head)) /= head) cycle
         why = trim(cell(model_row(i), before_models + size(kind_name) + 1))
         if (cell(model_row(i), before_models + place(kind)) == "yes") why = ""
      end do
   end function model_problem

   !> Why a key cannot be searched: the first row of it or of the numbers of its group says so
   pure function search_problem(key, kind, mode) result(why)
      type(key_t), intent(in) :: key        !! The key, which has real values
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: why  !! The reason; empty if it can
      character(len=:), allocatable :: name, group
      integer :: i, last

      why = "no rule says what it does"
      name = "`"//trim(key%name)//"`"
      group = "`&"//trim(key%group)//"`"
      do i = 1, size(search_row)
         last = index(search_row(i)(2:), "|")
         if (index(search_row(i)(:last), name) == 0 &
            & .and. index(search_row(i)(:last), group) == 0) cycle
         why = trim(cell(search_row(i), before_searches + size(kind_name) + 1))
         if (is_searched(i, kind, mode)) why = ""
         return
      end do
   end function search_problem

   !> Whether the keys of a row are searched
   pure logical function is_searched(i, kind, mode)
      integer, intent(in) :: i  !! Place of the row
      character(len=*), intent(in) :: kind, mode

      is_searched = index(cell(search_row(i), before_searches + place(kind)), mode) > 0
   end function is_searched

   !> Modes and geometries that blocks of a kind are run with
   pure function models_of(kind) result(text)
      character(len=*), intent(in) :: kind
      character(len=:), allocatable :: text  !! Such as: static reference, static current
      integer :: i

      text = ""
      do i = 1, size(model_row)
         if (cell(model_row(i), before_models + place(kind)) == "yes") text = text//", " &
            & //trim(cell(model_row(i), 1))//" "//trim(cell(model_row(i), 2))
      end do
      text = text(3:)
   end function models_of

   !> What is searched in scenes of a kind with a mode
   pure function searches_of(kind, mode) result(text)
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: text  !! Such as: numbers of &material, numbers of &load
      integer :: i

      text = ""
      do i = 1, size(search_row)
         if (is_searched(i, kind, mode)) text = text//", "//trim(cell(search_row(i), 1))
      end do
      text = text(3:)
   end function searches_of

   !> Both tables as docs/input.md has them
   pure function models_help() result(text)
      character(len=:), allocatable :: text  !! Lines, each ended by a line feed
      integer :: i

      text = ""
      do i = 1, size(model_row)
         text = text//trim(model_row(i))//achar(10)
      end do
      text = text//achar(10)
      do i = 1, size(search_row)
         text = text//trim(search_row(i))//achar(10)
      end do
   end function models_help

   !> Place of a kind among the columns of kinds
   pure integer function place(kind)
      character(len=*), intent(in) :: kind

      place = findloc(kind_name, kind, dim=1)
   end function place

   !> Text of a row in one of its columns, without marks
   pure function cell(row, column) result(text)
      character(len=*), intent(in) :: row  !! Such as: | `static` | `reference` | yes |
      integer, intent(in) :: column        !! Number of the column, from 1
      character(len=len(row)) :: text
      integer :: first, i, k, n

      first = 2
      do i = 2, column
         first = first + index(row(first:), "|")
      end do
      n = 0
      text = ""
      do k = first + 1, first + index(row(first:), "|") - 2
         if (row(k:k) == "`") cycle
         n = n + 1
         text(n:n) = row(k:k)
      end do
   end function cell
end module dda_model_table
