!> Attributes of elements of DDAML: words, numbers, choices
module dda_ddaml_attributes
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_plain_analysis, only : largest_value
   use dda_text, only : to_text
   use dda_word_list, only : quoted, split_words, take_word_numbers, take_whole, word_list_t
   use dda_xml_tree, only : attribute_of, xml_tree_t
   implicit none
   private

   public :: attribute_words, choose, number_attribute, whole_attribute

   !> Largest whole number
   integer, parameter :: largest_whole = 1000000000

contains

   !> The words of an attribute that must be there
   pure subroutine attribute_words(tree, at, name, words, error)
      type(xml_tree_t), intent(in) :: tree
      !> Place of the element
      integer, intent(in) :: at
      !> Name of the attribute
      character(len=*), intent(in) :: name
      type(word_list_t), intent(out) :: words
      !> It is not there
      type(error_t), allocatable, intent(out) :: error

      associate (element => tree%element(at))
         call split_words(attribute_of(tree, at, name), tree%file, element%row, words)
         words%row = element%row
         if (words%n /= 1) call fatal_error(error, "expected the attribute "//name &
            & //" with one value in "//quoted(element%name)//", got " &
            & //quoted(attribute_of(tree, at, name))//"; write one value", tree%file, element%row)
      end associate
   end subroutine attribute_words

   !> Read an attribute that chooses between two meanings
   pure subroutine choose(tree, at, name, words_for_yes, word_for_no, yes, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name
      !> Words that mean yes, parted by blanks
      character(len=*), intent(in) :: words_for_yes
      !> The word that means no
      character(len=*), intent(in) :: word_for_no
      !> The choice
      logical, intent(out) :: yes
      !> Another word, or none
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: word

      word = attribute_of(tree, at, name)
      yes = len(word) > 0 .and. index(" "//words_for_yes//" ", " "//word//" ") > 0
      if (.not. yes .and. word /= word_for_no) call fatal_error(error, "the attribute "//name &
         & //" of "//quoted(tree%element(at)%name)//" must be one of "//words_for_yes//" " &
         & //word_for_no//", got "//quoted(word)//"; choose one", tree%file, tree%element(at)%row)
   end subroutine choose

   !> Read an attribute that is a number
   pure subroutine number_attribute(tree, at, name, low, value, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name
      !> Smallest value
      real(wp), intent(in) :: low
      !> The number
      real(wp), intent(inout) :: value
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      real(wp) :: number(1)

      call attribute_words(tree, at, name, words, error)
      if (.not. allocated(error)) &
         & call take_word_numbers(words, "the attribute "//name, largest_value, number, error)
      if (allocated(error)) return
      value = number(1)
      if (value < low) call fatal_error(error, "the attribute "//name//" must be "//to_text(low) &
         & //" or more, got "//to_text(value)//"; correct it", tree%file, tree%element(at)%row)
   end subroutine number_attribute

   !> Read an attribute that is a whole number
   pure subroutine whole_attribute(tree, at, name, low, value, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name
      !> Smallest value
      integer, intent(in) :: low
      !> The number
      integer, intent(inout) :: value
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words

      call attribute_words(tree, at, name, words, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the attribute "//name, low, largest_whole, value, error)
   end subroutine whole_attribute
end module dda_ddaml_attributes
