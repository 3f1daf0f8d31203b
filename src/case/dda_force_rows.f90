!> Bars and reactions of a case as rows: of a static one at its end, of a dynamic one in every step
module dda_force_rows
   use dda_bar, only : bar_name, bar_state_t
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t
   use dda_contacts, only : contacts_t
   use dda_growing_text, only : add_line, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_load_stations, only : last_history_time
   use dda_reactions, only : forces_of_blocks, supports_of
   use dda_settings, only : settings_t
   use dda_text, only : to_text
   use dda_verdict, only : verdict
   use dda_write_results, only : reaction_lines
   implicit none
   private

   public :: bar_lines, bars_header, reaction_text

   !> Names of the columns
   character(len=*), parameter :: bars_header = "case,time,bar,force,state"

   interface

      !> Reactions of the points of a block: what its joints and loads leave to them, shared by the
      !> least forces
      pure module subroutine share_among_points(settings, system, contacts, time, support, block, &
         & reaction)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         real(wp), intent(in) :: time               !! The time [s]
         integer, intent(in) :: support(:, :)       !! The supports: (2, n)
         integer, intent(in) :: block               !! The block
         real(wp), intent(inout) :: reaction(:, :)  !! Receives the reactions: (3, n)
      end subroutine share_among_points

   end interface

contains

   !> Bars in the pictures of a case, and at its end
   pure function bar_lines(number, this) result(lines)
      integer, intent(in) :: number           !! Number of the case
      type(case_t), intent(in) :: this
      character(len=:), allocatable :: lines  !! Rows, parted by line ends; empty without bars
      type(growing_text_t) :: rows
      real(wp) :: time
      integer :: i

      lines = ""
      if (allocated(this%error)) return
      time = 0.0_wp
      if (allocated(this%album%frame)) then
         do i = 1, this%album%n
            if (.not. allocated(this%album%frame(i)%bar)) cycle
            call add_rows(number, this%album%frame(i)%time, this%album%frame(i)%bar, rows)
            time = this%album%frame(i)%time
         end do
      end if
      if (this%searches) then
         if (allocated(this%critical%standing)) then
            if (allocated(this%critical%standing%system%bar)) &
               & call add_rows(number, time, this%critical%standing%system%bar, rows)
         end if
      else if (allocated(this%decision%system%bar)) then
         call add_rows(number, end_time(this, time), this%decision%system%bar, rows)
      end if
      lines = lines_of(rows)
   end function bar_lines

   !> Time at the end of a case
   pure real(wp) function end_time(this, last)
      type(case_t), intent(in) :: this
      real(wp), intent(in) :: last  !! Time of its last picture [s]

      end_time = last
      if (this%scene%settings%dynamic) end_time = max(last, this%onward%time)
      if (this%decision%outcome%has_path) end_time = this%decision%outcome%path_time
   end function end_time

   !> Add a row a bar
   pure subroutine add_rows(number, time, bar, rows)
      integer, intent(in) :: number
      real(wp), intent(in) :: time
      type(bar_state_t), intent(in) :: bar(:)  !! The bars
      type(growing_text_t), intent(inout) :: rows
      integer :: i

      do i = 1, size(bar)
         call add_line(rows, to_text(number)//","//to_text(time)//","//to_text(i)//"," &
            & //to_text(bar(i)%force)//","//trim(bar_name(bar(i)%condition)))
      end do
   end subroutine add_rows

   !> Rows of a case in reactions.csv; nothing of a search, and of what does not stand at rest
   pure function reaction_text(number, this) result(lines)
      integer, intent(in) :: number
      type(case_t), intent(in) :: this
      character(len=:), allocatable :: lines
      integer, allocatable :: support(:, :)
      real(wp), allocatable :: reaction(:, :)
      real(wp) :: time

      lines = ""
      if (this%searches .or. this%limerick .or. allocated(this%error)) return
      if (this%scene%settings%dynamic) then
         associate (album => this%album)
            if (allocated(album%reaction)) lines = reaction_lines(number, &
               & album%when(2, 2:album%n_track), album%support, &
               & album%reaction(:, :, 2:album%n_track), this%scene%origin)
         end associate
      else if (this%decision%outcome%verdict == verdict%stable &
         & .and. allocated(this%decision%contacts%joint)) then
         time = last_history_time(this%scene%settings)
         if (this%decision%outcome%has_path) time = this%decision%outcome%path_time
         support = supports_of(this%decision%system, this%scene%settings%boundary)
         call find_reactions(this, time, support, reaction)
         lines = reaction_lines(number, [time], support, &
            & reshape(reaction, [3, size(support, 2), 1]), this%scene%origin)
      end if
   end function reaction_text

   !> Reactions of blocks at rest
   pure subroutine find_reactions(this, time, support, reaction)
      type(case_t), intent(in) :: this
      !> Time of the loads [s]
      real(wp), intent(in) :: time
      integer, intent(in) :: support(:, :)
      !> Force, and moment about the origin of the blocks' coordinates: (3, n) [N/m, N/m, N]
      real(wp), allocatable, intent(out) :: reaction(:, :)
      integer :: first, i

      associate (system => this%decision%system, contacts => this%decision%contacts)
         allocate (reaction(3, size(support, 2)), source=forces_of_blocks(system, contacts, &
            & contacts%force, support))
         first = count(support(2, :) == 0) + 1
         do i = first, size(support, 2)
            ! the points of a block are told together, once
            if (any(support(1, first:i - 1) == support(1, i))) cycle
            call share_among_points(this%scene%settings, system, contacts, time, support, &
               & support(1, i), reaction)
         end do
      end associate
   end subroutine find_reactions
end module dda_force_rows
