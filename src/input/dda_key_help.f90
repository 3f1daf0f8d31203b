!> The registry of groups and keys as help text and as JSON
module dda_key_help
   use dda_deck_key, only : full_name, group_t, is_required, key_kind, key_t, wanted
   use dda_kinds, only : wp
   use dda_text, only : lower_case, to_text
   implicit none
   private

   public :: registry_help, topic_help, registry_json

   !> End of a line
   character(len=1), parameter :: lf = achar(10)
   !> Kinds of values in JSON, in the order of key_kind
   character(len=*), parameter :: kind_name(*) = [character(len=7) :: "number", "whole", "word", &
      & "text", "flag", "numbers", "words"]

contains

   !> Help on all groups and keys of a registry, with unit, range, default and meaning
   pure function registry_help(groups, keys) result(text)
      type(group_t), intent(in) :: groups(:)  !! The groups
      type(key_t), intent(in) :: keys(:)      !! The keys
      character(len=:), allocatable :: text   !! Lines, each ended by a line feed
      integer :: g

      text = ""
      do g = 1, size(groups)
         if (g > 1) text = text//lf
         text = text//group_help(groups(g), keys, keys%group == groups(g)%name)
      end do
   end function registry_help

   !> Help on a group, or on all keys of a name; empty if unknown
   pure function topic_help(name, groups, keys) result(text)
      character(len=*), intent(in) :: name  !! Name of a group, of a key, or of both with %
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: keys(:)
      character(len=:), allocatable :: text
      character(len=len(name)) :: topic
      logical :: is_meant(size(keys))
      integer :: g, i

      topic = lower_case(name)
      if (index(topic, "&") == 1) topic = topic(2:)
      text = ""
      do g = 1, size(groups)
         is_meant = [(keys(i)%name == topic .or. full_name(keys(i)) == topic, i=1, size(keys))]
         is_meant = keys%group == groups(g)%name .and. (is_meant .or. groups(g)%name == topic)
         if (.not. any(is_meant)) cycle
         if (len(text) > 0) text = text//lf
         text = text//group_help(groups(g), keys, is_meant)
      end do
   end function topic_help

   !> Help on a group and selected keys
   pure function group_help(group, keys, is_meant) result(text)
      type(group_t), intent(in) :: group
      type(key_t), intent(in) :: keys(:)
      logical, intent(in) :: is_meant(:)  !! True for selected keys: (n)
      character(len=:), allocatable :: text
      integer :: i

      text = "&"//trim(group%name)//"   "//trim(group%meaning)//lf
      do i = 1, size(keys)
         if (is_meant(i)) text = text//key_help(keys(i))
      end do
   end function group_help

   !> Help on one key
   pure function key_help(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text  !! Three lines
      character(len=*), parameter :: indent = "      "

      text = "   "//trim(key%name)
      if (len_trim(key%default) > 0) text = text//" = "//trim(key%default)
      if (is_required(key)) then
         text = text//"   ("//trim(key%without)//")"
      else if (len_trim(key%without) > 0) then
         text = text//"   (without it: "//trim(key%without)//")"
      end if
      text = text//lf//indent//trim(key%meaning)//lf//indent//wanted(key)
      if (len_trim(key%needs) > 0) text = text//"; needs "//trim(key%needs)
      text = text//lf
   end function key_help

   !> A registry in JSON: groups with their keys
   pure function registry_json(groups, keys) result(text)
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: keys(:)
      character(len=:), allocatable :: text
      character(len=:), allocatable :: rows
      integer :: g, i

      text = ""
      do g = 1, size(groups)
         rows = ""
         do i = 1, size(keys)
            if (keys(i)%group == groups(g)%name) &
               & rows = rows//","//lf//"   {"//key_json(keys(i))//"}"
         end do
         text = text//","//lf//" {"//pair("name", trim(groups(g)%name))//", " &
            & //pair("meaning", trim(groups(g)%meaning))//", ""keys"": ["//rows(2:)//"]}"
      end do
      text = "{""groups"": ["//text(2:)//"]}"//lf
   end function registry_json

   !> Members of the object of a key, without empty ones
   pure function key_json(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text
      real(wp), parameter :: none = huge(1.0_wp)

      text = pair("name", trim(key%name))//", "//pair("kind", trim(kind_name(key%kind)))
      if (key%unit /= "") text = text//", "//pair("unit", trim(key%unit))
      if (key%default /= "") text = text//", "//pair("default", trim(key%default))
      if (key%without /= "") text = text//", "//pair("without", trim(key%without))
      text = text//bound("from", key%within(1))//bound("to", key%within(2)) &
         & //bound("above", key%above)//bound("below", key%below)
      if (key%words /= "") text = text//", ""words"": ["""//joined(trim(key%words))//"""]"
      if (key%needs /= "") text = text//", "//pair("needs", trim(key%needs))
      if (.not. key%bare) text = text//", ""bare"": false"
      text = text//", ""sweep"": "//truth(key%varies)//", ""search"": " &
         & //truth(key%varies .and. key%kind == key_kind%number)//", " &
         & //pair("meaning", trim(key%meaning))

   contains

      !> Member for a bound, empty if unlimited
      pure function bound(name, value) result(member)
         character(len=*), intent(in) :: name  !! Name of the member
         real(wp), intent(in) :: value         !! The bound
         character(len=:), allocatable :: member

         member = ""
         if (abs(value) < none) member = ", """//name//""": "//to_text(value)
      end function bound

      !> JSON text of a flag
      pure function truth(flag) result(word)
         logical, intent(in) :: flag  !! The flag
         character(len=:), allocatable :: word

         word = trim(merge("true ", "false", flag))
      end function truth

      !> JSON list of words
      pure function joined(words) result(list)
         character(len=*), intent(in) :: words  !! Words separated by blanks
         character(len=:), allocatable :: list
         integer :: k

         list = ""
         do k = 1, len(words)
            if (words(k:k) == " ") then
               list = list//""", """
            else
               list = list//words(k:k)
            end if
         end do
      end function joined
   end function key_json

   !> Member with a text value
   pure function pair(name, value) result(member)
      character(len=*), intent(in) :: name   !! Name of the member
      character(len=*), intent(in) :: value  !! Text without control characters
      character(len=:), allocatable :: member
      integer :: k

      member = """"//name//""": """
      do k = 1, len(value)
         if (scan(value(k:k), """\") > 0) member = member//"\"
         member = member//value(k:k)
      end do
      member = member//""""
   end function pair
end module dda_key_help
