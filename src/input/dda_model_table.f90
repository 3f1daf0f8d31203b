!> Models, and the parameters that can be searched in them. Decks are checked by it; `dda check`
!> prints what it says of a deck, `dda help models` all of it
module dda_model_table
   use dda_deck_key, only : has_word, key_t, listed_words, word_length
   implicit none
   private

   public :: model_problem, models_of, models_help, search_problem, searches_of

   !> What blocks are made from
   character(len=*), parameter :: all_kinds = "arch shape lines blocks"
   !> Those that the scheme of the original runs
   character(len=*), parameter :: of_original = "arch lines blocks"
   !> What a number of the method is no answer to
   character(len=*), parameter :: of_the_method = "a number of the method, not of the structure"
   !> End of a line
   character(len=1), parameter :: lf = achar(10)

   !> A mode with a geometry
   type :: model_t
      character(len=8) :: mode = ""      !! Word of analysis%mode
      character(len=9) :: geometry = ""  !! Word of analysis%geometry
      character(len=24) :: kinds = ""    !! Kinds of scene%kind that it runs, parted by blanks
      character(len=60) :: why = ""      !! Why it runs no others
   end type model_t

   !> Keys that are searched alike
   type :: search_t
      character(len=16) :: group = ""  !! Their group
      !> Their names, parted by blanks; all others of the group if there are none
      character(len=160) :: names = ""
      !> Kinds of scene%kind with mode = 'static' in which they are searched, parted by blanks
      character(len=24) :: static = ""
      character(len=24) :: dynamic = ""   !! Likewise with mode = 'dynamic'
      character(len=24) :: limerick = ""  !! Likewise with mode = 'limerick'
      character(len=60) :: why = ""       !! Why not in the others
   end type search_t

   !> All modes and geometries
   type(model_t), parameter :: model(6) = [ &
      model_t("static", "reference", all_kinds), &
      model_t("static", "current", all_kinds), &
      model_t("dynamic", "reference", all_kinds), &
      model_t("dynamic", "current", all_kinds), &
      model_t("limerick", "reference", "", "its blocks always move"), &
      model_t("limerick", "current", of_original, "dda export writes such arches as blocks")]

   !> All keys that have real values
   type(search_t), parameter :: search(20) = [ &
      search_t("arch", "abutment_size abutment_overhang", "", "", "arch", &
         "for mode = 'limerick' only"), &
      search_t("arch", "span rise right_rise thickness crown_thickness springing_thickness "// &
         "pier_width pier_height buttress_width buttress_height lune_deg", "shape", "", "", &
         "setting one makes the arch a shape"), &
      search_t("arch", "", "arch shape", "arch", "arch", "needs an arch"), &
      search_t("support", "", "shape", "", "", "needs an arch"), &
      search_t("fill", "", "shape", "", "", "needs an arch"), &
      search_t("tie", "", "shape", "", "", "needs an arch"), &
      search_t("material", "compressive_strength", "shape blocks", "", "", &
         "for limit analysis of arches and blocks only"), &
      search_t("material", "", all_kinds, of_original, of_original), &
      search_t("joint", "cohesion tension", all_kinds, of_original, "", &
         "joints of Shi's scheme start open, without bonds"), &
      search_t("joint", "residual_deg slip_length", "", "", "", &
         "the verdict may change more than once: use &sweep"), &
      search_t("joint", "", all_kinds, of_original, of_original), &
      search_t("load", "displacement_factor", "shape blocks", "blocks", "", &
         "for &support and files of blocks only"), &
      search_t("load", "water_rise", "blocks", "blocks", "", &
         "for files of blocks only"), &
      search_t("load", "", all_kinds, of_original, of_original), &
      search_t("live", "", all_kinds, of_original, "", "Shi's scheme has no &live"), &
      search_t("vehicle", "", all_kinds, of_original, "", &
         "Shi's scheme has no &vehicle"), &
      search_t("ground", "", "", all_kinds, "", "needs mode = 'dynamic'"), &
      search_t("analysis", "restitution damping", "", of_original, "", &
         "needs mode = 'dynamic'"), &
      search_t("analysis", "", "", "", "", of_the_method), &
      search_t("limerick", "", "", "", "", of_the_method)]

contains

   !> Why blocks of a kind cannot be run so
   pure function model_problem(kind, mode, geometry) result(why)
      character(len=*), intent(in) :: kind      !! Word of scene%kind
      character(len=*), intent(in) :: mode      !! Word of analysis%mode
      character(len=*), intent(in) :: geometry  !! Word of analysis%geometry
      character(len=:), allocatable :: why      !! The reason; empty if they can
      integer :: i

      why = "there is no such model"
      do i = 1, size(model)
         if (model(i)%mode /= mode .or. model(i)%geometry /= geometry) cycle
         why = trim(model(i)%why)
         if (has_word(model(i)%kinds, kind)) why = ""
      end do
   end function model_problem

   !> Why a key cannot be searched
   pure function search_problem(key, kind, mode) result(why)
      type(key_t), intent(in) :: key        !! The key, which has real values
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: why  !! The reason; empty if it can
      integer :: i

      why = "no rule says what it does"
      do i = size(search), 1, -1
         if (search(i)%group /= key%group) cycle
         if (search(i)%names /= "" .and. .not. has_word(search(i)%names, key%name)) cycle
         why = trim(search(i)%why)
         if (has_word(kinds_of(search(i), mode), kind)) why = ""
      end do
   end function search_problem

   !> Kinds in which keys are searched with a mode
   pure function kinds_of(rule, mode) result(list)
      type(search_t), intent(in) :: rule
      character(len=*), intent(in) :: mode
      character(len=24) :: list  !! The kinds, parted by blanks

      list = ""
      if (mode == "static") list = rule%static
      if (mode == "dynamic") list = rule%dynamic
      if (mode == "limerick") list = rule%limerick
   end function kinds_of

   !> Modes and geometries that blocks of a kind are run with
   pure function models_of(kind) result(text)
      character(len=*), intent(in) :: kind
      character(len=:), allocatable :: text  !! Such as: static reference, static current
      integer :: i

      text = ""
      do i = 1, size(model)
         if (has_word(model(i)%kinds, kind)) text = text//", "//trim(model(i)%mode)//" " &
            & //trim(model(i)%geometry)
      end do
      text = text(3:)
   end function models_of

   !> What is searched in scenes of a kind with a mode
   pure function searches_of(kind, mode) result(text)
      character(len=*), intent(in) :: kind, mode
      character(len=:), allocatable :: text  !! Such as: numbers of &material, numbers of &load
      integer :: i

      text = ""
      do i = 1, size(search)
         if (has_word(kinds_of(search(i), mode), kind)) text = text//", "//name_of(search(i), "")
      end do
      text = text(3:)
   end function searches_of

   !> Names of keys that are searched alike
   pure function name_of(rule, quote) result(text)
      type(search_t), intent(in) :: rule
      character(len=*), intent(in) :: quote  !! What stands before and after a name
      character(len=:), allocatable :: text  !! Such as: tension, or: other numbers of &joint
      character(len=word_length), allocatable :: list(:)
      integer :: i

      if (rule%names == "") then
         text = "numbers of "//quote//"&"//trim(rule%group)//quote
         if (count(search%group == rule%group) > 1) text = "other "//text
         return
      end if
      list = listed_words(rule%names)
      text = ""
      do i = 1, size(list)
         text = text//", "//quote//trim(list(i))//quote
      end do
      text = text(3:)
   end function name_of

   !> Both tables as docs/input.md has them
   pure function models_help() result(text)
      character(len=:), allocatable :: text  !! Lines, each ended by a line feed
      character(len=word_length), allocatable :: kinds(:)
      integer :: i, k

      kinds = listed_words(all_kinds)
      text = "| mode | geometry | arch | shape | lines | blocks | why not |"//lf &
         & //"| --- | --- | --- | --- | --- | --- | --- |"//lf
      do i = 1, size(model)
         text = text//"| `"//trim(model(i)%mode)//"` | `"//trim(model(i)%geometry)//"` |"
         do k = 1, size(kinds)
            text = text//" "//trim(merge("yes", "no ", has_word(model(i)%kinds, kinds(k))))//" |"
         end do
         text = text//ending(model(i)%why)
      end do
      text = text//lf//"| searched | arch | shape | lines | blocks | why not |"//lf &
         & //"| --- | --- | --- | --- | --- | --- |"//lf
      do i = 1, size(search)
         text = text//"| "//name_of(search(i), "`")//" |"
         do k = 1, size(kinds)
            text = text//" "//modes_of(search(i), trim(kinds(k)))//" |"
         end do
         text = text//ending(search(i)%why)
      end do
   end function models_help

   !> Modes in which keys are searched in scenes of a kind
   pure function modes_of(rule, kind) result(text)
      type(search_t), intent(in) :: rule
      character(len=*), intent(in) :: kind
      character(len=:), allocatable :: text  !! Such as: static, limerick

      text = ""
      if (has_word(rule%static, kind)) text = ", static"
      if (has_word(rule%dynamic, kind)) text = text//", dynamic"
      if (has_word(rule%limerick, kind)) text = text//", limerick"
      if (text == "") text = ", no"
      text = text(3:)
   end function modes_of

   !> Last field of a row
   pure function ending(why) result(text)
      character(len=*), intent(in) :: why    !! Why something is not; may be empty
      character(len=:), allocatable :: text  !! The field and the end of the line

      text = trim(" "//why)//" |"//lf
   end function ending
end module dda_model_table
