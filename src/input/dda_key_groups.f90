!> Groups of keys that may be repeated: from the text of a namelist file to values, by a registry
module dda_key_groups
   use dda_deck_key, only : group_t, key_t
   use dda_deck_scan, only : scan_deck
   use dda_deck_token, only : deck_scan_t, shown, token_kind, token_text
   use dda_deck_words, only : near_group
   use dda_error, only : error_t, fatal_error
   use dda_key_entry, only : read_entry
   use dda_key_value, only : deck_value_t, default_value
   implicit none
   private

   public :: group_error, key_group_t, read_groups

   !> One group of the file
   type :: key_group_t
      character(len=16) :: name                    !! Its name
      integer :: row                               !! Line of the file
      type(deck_value_t), allocatable :: value(:)  !! By the places of its keys in the registry
   end type key_group_t

contains

   !> Read all groups of a text
   pure subroutine read_groups(text, file, groups, keys, topic, group, error)
      !> The text, lines ended by line feeds
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Groups that there are
      type(group_t), intent(in) :: groups(:)
      !> Keys that there are, group by group
      type(key_t), intent(in) :: keys(:)
      !> Page of the help that lists them
      character(len=*), intent(in) :: topic
      !> The groups of the text, in their order
      type(key_group_t), allocatable, intent(out) :: group(:)
      type(error_t), allocatable, intent(out) :: error
      type(deck_scan_t) :: scan
      character(len=:), allocatable :: problem
      integer :: i, g, k, first, line

      call scan_deck(text, scan, error)
      allocate (group(count(scan%token(:scan%n)%kind == token_kind%group)))
      i = 1
      do g = 1, size(group)
         if (allocated(error)) exit
         group(g)%name = token_text(scan, i)
         group(g)%row = scan%token(i)%line
         first = findloc(keys%group == group(g)%name, .true., dim=1)
         if (first == 0) then
            call fatal_error(error, "unknown group &"//shown(token_text(scan, i))//": " &
               & //near_group(token_text(scan, i), groups, topic), line=group(g)%row)
            exit
         end if
         allocate (group(g)%value(first:first + count(keys%group == group(g)%name) - 1))
         do k = first, ubound(group(g)%value, 1)
            group(g)%value(k) = default_value(keys(k))
         end do
         i = i + 1
         do while (scan%token(i)%kind /= token_kind%close .and. .not. allocated(error))
            call read_entry(scan, i, trim(group(g)%name), keys, topic, group(g)%value, problem, &
               & line)
            if (len(problem) > 0) call fatal_error(error, problem, line=line)
         end do
         i = i + 1
      end do
      if (allocated(error)) error%file = file
   end subroutine read_groups

   !> An error that speaks of a group
   pure subroutine group_error(group, message, error)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: message  !! What was expected, what was found
      type(error_t), allocatable, intent(out) :: error

      call fatal_error(error, "&"//trim(group%name)//": "//message, line=group%row)
   end subroutine group_error
end module dda_key_groups
