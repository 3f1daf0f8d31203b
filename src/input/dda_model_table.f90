!> Models and their searchable parameters: the tables of docs/input.md. Decks are checked against
!> them; `dda check` prints the rows for a deck, `dda help models` prints both tables
module dda_model_table
   use dda_deck_key, only : key_t
   use dda_model_rows, only : model_row, search_row
   implicit none
   private

   public :: model_problem, models_of, models_help, search_problem, searches_of

   !> Names of the sources of blocks, in the order of the columns
   character(len=6), parameter :: kind_name(4) = [character(len=6) :: "arch", "shape", "lines", &
      & "blocks"]
   !> Number of columns before those of the sources
   integer, parameter :: before_models = 2, before_searches = 1

contains

   !> Reason why a model does not exist for a source of blocks
   pure function model_problem(kind, mode, geometry) result(why)
      character(len=*), intent(in) :: kind      !! One of kind_name
      character(len=*), intent(in) :: mode      !! Word of analysis%mode
      character(len=*), intent(in) :: geometry  !! Word of analysis%geometry
      character(len=:), allocatable :: why      !! The reason; empty if the model exists
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

   !> Reason why a key cannot be searched, from the first row with the key or its group
   pure function search_problem(key, kind, mode) result(why)
      type(key_t), intent(in) :: key        !! A key with real values
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: why  !! The reason; empty if it can be searched
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

   !> True if the keys of a row can be searched
   pure logical function is_searched(i, kind, mode)
      integer, intent(in) :: i  !! Place of the row
      character(len=*), intent(in) :: kind, mode

      is_searched = index(cell(search_row(i), before_searches + place(kind)), mode) > 0
   end function is_searched

   !> Models of a source of blocks: modes and geometries
   pure function models_of(kind) result(text)
      character(len=*), intent(in) :: kind
      character(len=:), allocatable :: text  !! Text such as: static reference, static current
      integer :: i

      text = ""
      do i = 1, size(model_row)
         if (cell(model_row(i), before_models + place(kind)) == "yes") text = text//", " &
            & //trim(cell(model_row(i), 1))//" "//trim(cell(model_row(i), 2))
      end do
      text = text(3:)
   end function models_of

   !> Searchable parameters for a source of blocks and a mode
   pure function searches_of(kind, mode) result(text)
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: text  !! Text such as: numbers of &material, numbers of &load
      integer :: i

      text = ""
      do i = 1, size(search_row)
         if (is_searched(i, kind, mode)) text = text//", "//trim(cell(search_row(i), 1))
      end do
      text = text(3:)
   end function searches_of

   !> Both tables as in docs/input.md
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

   !> Column of a source of blocks, among the sources
   pure integer function place(kind)
      character(len=*), intent(in) :: kind

      place = findloc(kind_name, kind, dim=1)
   end function place

   !> Text of one cell of a row, without Markdown marks
   pure function cell(row, column) result(text)
      character(len=*), intent(in) :: row  !! Row such as: | `static` | `reference` | yes |
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
