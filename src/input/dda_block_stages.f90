!> Stages of a file of blocks: what is built and what is taken away
module dda_block_stages
   use dda_block_input, only : block_plan_t
   use dda_block_lines, only : entry_t, take_numbers
   use dda_boundary, only : stage_change_t
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_polygon, only : contains_point
   use dda_simplex, only : area_moments, area_moments_t
   use dda_sort, only : sorted_order
   use dda_text, only : read_integer, to_text
   implicit none
   private

   public :: take_change, close_changes

contains

   !> Take in remove|add block N ... at T, or remove|add polygon at T with its corners below: the
   !> blocks whose centre of gravity lies inside
   pure subroutine take_change(entry, plan, error)
      type(entry_t), intent(in) :: entry
      !> Receives a change for each of its blocks
      type(block_plan_t), intent(inout) :: plan
      type(error_t), allocatable, intent(out) :: error
      type(stage_change_t), allocatable :: more(:)
      integer, allocatable :: block(:)
      real(wp) :: time(1)
      integer :: at

      at = findloc(entry%head%word(:entry%head%n), "at", dim=1)
      time = 0.0_wp
      if (at == 0 .or. all(entry%head%word(2) /= ["block  ", "polygon"])) then
         call fatal_error(error, "expected 'block' and numbers or 'polygon', then 'at' and a " &
            & //"time after '"//trim(entry%head%word(1))//"'", line=entry%head%number)
      else
         call take_numbers(entry%head, at, time, error)
      end if
      if (allocated(error)) return
      if (at <= entry%head%n) then
         call fatal_error(error, "unknown word '"//shown(trim(entry%head%word(at)))//"'", &
            & line=entry%head%number)
      else if (time(1) < 0.0_wp) then
         call fatal_error(error, "expected a time from 0 [s], got "//to_text(time(1)), &
            & line=entry%head%number)
      else if (entry%head%word(2) == "polygon") then
         call blocks_inside(entry, plan, block, error)
      else
         call blocks_of(entry, size(plan%fixed), block, error)
      end if
      if (allocated(error)) return
      allocate (more(size(block)))
      more%block = block
      more%time = time(1)
      more%adds = entry%head%word(1) == "add"
      more%line = entry%head%number
      if (.not. allocated(plan%boundary%change)) allocate (plan%boundary%change(0))
      plan%boundary%change = [plan%boundary%change, more]
   end subroutine take_change

   !> The blocks that an entry numbers
   pure subroutine blocks_of(entry, n_block, block, error)
      type(entry_t), intent(in) :: entry
      !> Number of blocks
      integer, intent(in) :: n_block
      !> Their numbers: (n)
      integer, allocatable, intent(out) :: block(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      logical :: ok

      if (entry%n_row > 0) then
         call fatal_error(error, "expected corners below 'polygon' only", line=entry%head%number)
         return
      end if
      allocate (block(entry%head%n - 4), source=0)
      ok = size(block) > 0
      do i = 1, size(block)
         call read_integer(trim(entry%head%word(i + 2)), block(i), ok)
         if (ok) ok = block(i) >= 1 .and. block(i) <= n_block
         if (.not. ok) exit
      end do
      if (.not. ok) call fatal_error(error, "expected numbers of blocks from 1 to " &
         & //to_text(n_block)//" between 'block' and 'at', got '" &
         & //shown(trim(entry%head%word(min(i, size(block)) + 2)))//"'", line=entry%head%number)
   end subroutine blocks_of

   !> The blocks whose centre of gravity lies in the polygon of an entry
   pure subroutine blocks_inside(entry, plan, block, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(in) :: plan
      integer, allocatable, intent(out) :: block(:)
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp), allocatable :: corner(:, :)
      logical :: inside(size(plan%fixed))
      integer :: b

      if (entry%n_row < 3) then
         call fatal_error(error, "expected three corners x y or more below 'polygon', got " &
            & //to_text(entry%n_row), line=entry%head%number)
         return
      end if
      corner = entry%row(:2, :entry%n_row) - spread(plan%origin, 2, entry%n_row)
      do b = 1, size(inside)
         moments = area_moments(plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
         inside(b) = contains_point(corner, moments%centroid)
      end do
      block = pack([(b, b=1, size(inside))], inside)
      if (size(block) == 0) call fatal_error(error, "expected a polygon around the centre of a " &
         & //"block, got one around none", line=entry%head%number)
   end subroutine blocks_inside

   !> Put the changes in the order of their times, and check that each is one
   pure subroutine close_changes(plan, error)
      type(block_plan_t), intent(inout) :: plan
      !> A block built or taken away twice, or a bar that would lose its end
      type(error_t), allocatable, intent(out) :: error
      integer :: b, i, last(size(plan%fixed))

      if (.not. allocated(plan%boundary%change)) return
      associate (change => plan%boundary%change)
         change = change(sorted_order(spread(0, 1, size(change)), change%time))
         last = 0
         do i = 1, size(change)
            b = change(i)%block
            if (last(b) > 0) then
               if (change(last(b))%adds .eqv. change(i)%adds) call fatal_error(error, "block " &
                  & //to_text(b)//" is already "//trim(merge("there    ", "not there", &
                  & change(i)%adds))//" at "//to_text(change(i)%time)//" s", line=change(i)%line)
               if (.not. change(last(b))%time < change(i)%time) call fatal_error(error, &
                  & "expected one change of block "//to_text(b)//" at a time", line=change(i)%line)
            end if
            last(b) = i
         end do
      end associate
      if (.not. allocated(error) .and. allocated(plan%boundary%bar)) then
         do i = 1, size(plan%boundary%bar)
            do b = 1, 2
               if (plan%boundary%bar(i)%block(b) == 0) cycle
               if (last(plan%boundary%bar(i)%block(b)) > 0) call fatal_error(error, &
                  & "expected bars between blocks that stay, got one on block " &
                  & //to_text(plan%boundary%bar(i)%block(b))//", which 'remove' or 'add' names", &
                  & line=plan%boundary%bar(i)%line)
            end do
         end do
      end if
      if (.not. allocated(error) .and. size(plan%water) > 0) call fatal_error(error, &
         & "expected a file with either stages or water: pressure on faces that an excavation " &
         & //"lays bare is not known", line=plan%boundary%change(1)%line)
   end subroutine close_changes
end module dda_block_stages
