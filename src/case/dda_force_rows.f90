!> Bars and reactions of a case as rows: of a static one at its end, of a dynamic one in every step
module dda_force_rows
   use dda_bar, only : bar_name, bar_state_t
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t
   use dda_contact_detection, only : contacts_t
   use dda_deformation, only : moved_point
   use dda_growing_text, only : add_line, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_load_stations, only : last_history_time
   use dda_outer_loads, only : outer_loads
   use dda_reactions, only : force_on, forces_of_blocks, supports_of
   use dda_settings, only : load_direction, settings_t
   use dda_small_systems, only : least_squares
   use dda_submatrices, only : body_load
   use dda_text, only : to_text
   use dda_vector, only : cross
   use dda_verdict, only : verdict
   use dda_write_tables, only : reaction_lines
   implicit none
   private

   public :: bar_lines, bars_header, reaction_text

   !> Names of the columns
   character(len=*), parameter :: bars_header = "case,time,bar,force,state"

   !> Columns of which less than this share of the largest is left say nothing new
   real(wp), parameter :: negligible = 1.0e-10_wp

contains

   !> Bars in the pictures of a case, and at its end
   pure function bar_lines(number, this) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      type(case_t), intent(in) :: this
      !> Rows, parted by line ends; empty without bars
      character(len=:), allocatable :: lines
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
      !> Time of its last picture [s]
      real(wp), intent(in) :: last

      end_time = last
      if (this%scene%settings%dynamic) end_time = max(last, this%onward%time)
      if (this%decision%outcome%has_path) end_time = this%decision%outcome%path_time
   end function end_time

   !> Add a row a bar
   pure subroutine add_rows(number, time, bar, rows)
      integer, intent(in) :: number
      !> The time [s]
      real(wp), intent(in) :: time
      !> The bars
      type(bar_state_t), intent(in) :: bar(:)
      type(growing_text_t), intent(inout) :: rows
      integer :: i

      do i = 1, size(bar)
         call add_line(rows, to_text(number)//","//to_text(time)//","//to_text(i)//"," &
            & //to_text(bar(i)%force)//","//trim(bar_name(bar(i)%condition)))
      end do
   end subroutine add_rows

   !> Rows of a case in reactions.csv; nothing of a search, and of what does not stand at rest
   pure function reaction_text(number, this) result(lines)
      !> Number of the case
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
      !> The supports: (2, n)
      integer, intent(in) :: support(:, :)
      !> Force, and moment about the origin of the blocks' coordinates: (3, n) [N/m, N/m, N]
      real(wp), allocatable, intent(out) :: reaction(:, :)
      integer :: first, i

      associate (system => this%decision%system, contacts => this%decision%contacts)
         allocate (reaction(3, size(support, 2)), source=forces_of_blocks(system, contacts%joint, &
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

   !> Reactions of the points of a block: what its joints and loads leave to them, shared by the
   !> least forces
   pure subroutine share_among_points(settings, system, contacts, time, support, block, reaction)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      real(wp), intent(in) :: time
      integer, intent(in) :: support(:, :)
      !> The block
      integer, intent(in) :: block
      !> Receives the reactions: (3, n)
      real(wp), intent(inout) :: reaction(:, :)
      real(wp) :: wanted(3), place(2), size_of
      real(wp), allocatable :: column(:, :), force(:)
      integer, allocatable :: owner(:)
      integer :: axis, i, n

      wanted = -outer_force(settings, system, time, block)
      do i = 1, size(contacts%joint)
         associate (joint => contacts%joint(i))
            if (joint%block(1) == block) wanted = wanted - force_on(joint, contacts%force(:, i), 1)
            if (joint%block(2) == block) wanted = wanted - force_on(joint, contacts%force(:, i), 2)
         end associate
      end do
      allocate (column(3, 2*size(support, 2)), owner(2*size(support, 2)))
      n = 0
      do i = 1, size(support, 2)
         if (support(1, i) /= block .or. support(2, i) == 0) cycle
         associate (held => settings%boundary%held(support(2, i)))
            place = held%point
            if (settings%current) place = moved_point(held%point, system%centroid(:, block), &
               & system%motion(:, block))
            do axis = 1, 2
               if (.not. held%along(axis)) cycle
               n = n + 1
               owner(n) = i
               column(:, n) = merge([1.0_wp, 0.0_wp, -place(2)], [0.0_wp, 1.0_wp, place(1)], &
                  & axis == 1)
            end do
         end associate
      end do
      ! moments are seen from the block, in its own size: the least forces do not depend on the
      ! origin
      place = system%centroid(:, block)
      size_of = sqrt(system%area(block))
      call move_moments(place, size_of, column(:, :n))
      force = least_forces(column(:, :n), moved(wanted, place, size_of))
      do i = 1, n
         column(3, i) = size_of*column(3, i) + place(1)*column(2, i) - place(2)*column(1, i)
         reaction(:, owner(i)) = reaction(:, owner(i)) + force(i)*column(:, i)
      end do
   end subroutine share_among_points

   !> See the moments of some forces from another point, in a length
   pure subroutine move_moments(place, length, column)
      !> The point: (2) [m]
      real(wp), intent(in) :: place(2)
      !> The length [m]
      real(wp), intent(in) :: length
      !> The forces with their moments: (3, n)
      real(wp), intent(inout) :: column(:, :)
      integer :: i

      do i = 1, size(column, 2)
         column(:, i) = moved(column(:, i), place, length)
      end do
   end subroutine move_moments

   !> A force with its moment seen from another point, in a length
   pure function moved(wrench, place, length) result(seen)
      !> Force, and moment about the origin: (3)
      real(wp), intent(in) :: wrench(3)
      real(wp), intent(in) :: place(2), length
      !> The same with the other moment: (3)
      real(wp) :: seen(3)

      seen = [wrench(1:2), (wrench(3) - cross(place, wrench(1:2)))/length]
   end function moved

   !> The least of the forces that add up to what is wanted: x = A' y with A A' y = b
   pure function least_forces(a, b) result(x)
      !> What each force is to the block: (3, n)
      real(wp), intent(in) :: a(:, :)
      !> What is wanted: (3)
      real(wp), intent(in) :: b(3)
      !> The forces: (n)
      real(wp) :: x(size(a, 2))

      x = matmul(least_squares(matmul(a, transpose(a)), b, negligible), a)
      ! once more, for what rounding has left
      x = x + matmul(least_squares(matmul(a, transpose(a)), b - matmul(a, x), negligible), a)
   end function least_forces

   !> Sum of all loads on a block, and their moment about the origin of coordinates
   pure function outer_force(settings, system, time, block) result(wrench)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: time
      !> The block, which can move
      integer, intent(in) :: block
      !> Force and moment: (3) [N/m, N/m, N]
      real(wp) :: wrench(3)
      real(wp) :: weight(3, maxval(system%equation)), of_block(6)
      real(wp), dimension(3, maxval(system%equation)) :: load, felt
      real(wp) :: place(2)
      integer :: b

      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         of_block = body_load(system%unit_weight(b)*load_direction(settings), system%area(b))
         weight(:, system%equation(b)) = of_block(:3)
      end do
      call outer_loads(system, settings, time, 1.0_wp, weight, load, felt)
      wrench = load(:, system%equation(block))
      place = system%centroid(:, block)
      if (settings%current) place = place + system%motion(1:2, block)
      wrench(3) = wrench(3) + cross(place, wrench(1:2))
   end function outer_force

end module dda_force_rows
