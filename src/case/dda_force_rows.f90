!> Rows of bars and reactions of a case, and of its certificates
module dda_force_rows
   use dda_bar, only : bar_name, bar_state_t
   use dda_bar_joints, only : bar_joint
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t
   use dda_contacts, only : contacts_t, joint_place
   use dda_deformation, only : moved_point
   use dda_kinds, only : wp
   use dda_load_stations, only : last_history_time
   use dda_outer_loads, only : outer_loads
   use dda_reactions, only : force_on, forces_of_blocks, supports_of
   use dda_search, only : proof_t
   use dda_settings, only : load_direction, settings_t, verdict
   use dda_small_systems, only : least_squares
   use dda_submatrices, only : body_load
   use dda_text, only : add_line, fields, growing_text_t, lines_of, to_text
   use dda_vector, only : cross
   use dda_write_results, only : reaction_lines
   implicit none
   private

   public :: bar_lines, bars_header, proof_forces_header, proof_forces_lines, proof_motion_header
   public :: proof_motion_lines, reaction_text

   !> Names of the columns
   character(len=*), parameter :: bars_header = "case,time,bar,force,state"

   !> Names of the columns of proof_forces.csv
   character(len=*), parameter :: proof_forces_header = &
      & "case,value,kind,block_1,block_2,x_1,y_1,x_2,y_2,normal_1,normal_2,shear"
   !> Names of the columns of proof_motion.csv
   character(len=*), parameter :: proof_motion_header = "case,value,block,x,y,u,v,spin"

   !> Remainder below which a column is dependent, over the largest
   real(wp), parameter :: negligible = 1.0e-10_wp

contains

   !> Bars in the pictures of a case, and at its end
   pure function bar_lines(number, this) result(lines)
      integer, intent(in) :: number           !! Number of the case
      type(case_t), intent(in) :: this
      character(len=:), allocatable :: lines  !! Rows, separated by line ends; empty without bars
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
         if (this%scene%settings%dynamic) time = max(time, this%onward%time)
         if (this%decision%outcome%has_path) time = this%decision%outcome%path_time
         call add_rows(number, time, this%decision%system%bar, rows)
      end if
      lines = lines_of(rows)
   end function bar_lines

   !> Add a row a bar
   pure subroutine add_rows(number, time, bar, rows)
      integer, intent(in) :: number
      real(wp), intent(in) :: time             !! Their time [s]
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
      real(wp), intent(in) :: time          !! Time of the loads [s]
      integer, intent(in) :: support(:, :)  !! The supports: (2, n)
      !> Force, and moment about the origin of the blocks' coordinates: (3, n) [N/m, N/m, N]
      real(wp), allocatable, intent(out) :: reaction(:, :)
      integer :: first, i

      associate (system => this%decision%system, contacts => this%decision%contacts)
         allocate (reaction(3, size(support, 2)), source=forces_of_blocks(system, contacts, &
            & contacts%force, support))
         first = count(support(2, :) == 0) + 1
         do i = first, size(support, 2)
            ! the points of a block have their rows together, once
            if (any(support(1, first:i - 1) == support(1, i))) cycle
            call share_among_points(this%scene%settings, system, contacts, time, support, &
               & support(1, i), reaction)
         end do
      end associate
   end subroutine find_reactions

   !> Forces that carry the load: of joints, at their two corners and along them on the second
   !> block; of restrained points, along x and y
   pure function proof_forces_lines(number, value, proof) result(lines)
      integer, intent(in) :: number  !! Number of the case
      !> Value of what is searched as text; empty if nothing is
      character(len=*), intent(in) :: value
      type(proof_t), intent(in) :: proof
      character(len=:), allocatable :: lines  !! Rows, separated by line ends
      type(growing_text_t) :: rows
      character(len=:), allocatable :: start
      integer :: j, n

      lines = ""
      if (.not. allocated(proof%force)) return
      start = to_text(number)//","//value//","
      n = size(proof%scene%contacts%joint)
      do j = 1, n
         associate (joint => proof%scene%contacts%joint(j), &
            & place => joint_place(proof%scene%system, proof%scene%contacts, j))
            call add_line(rows, start//"contact,"//fields([real(joint%block, wp), &
               & place%point(:, 1) + proof%scene%origin, place%point(:, joint%n_contact) &
               & + proof%scene%origin, proof%force(:, j)]))
         end associate
      end do
      call add_held(start, proof, n, rows)
      call add_bounded(start, proof, n, rows)
      call add_bars(start, proof, rows)
      lines = lines_of(rows)
   end function proof_forces_lines

   !> Rows of the forces of restrained points
   pure subroutine add_held(start, proof, n, rows)
      character(len=*), intent(in) :: start  !! First fields of a row
      type(proof_t), intent(in) :: proof
      integer, intent(inout) :: n  !! Number of the last joint before them; theirs are added
      type(growing_text_t), intent(inout) :: rows
      real(wp) :: force(3)
      integer :: i

      if (.not. allocated(proof%scene%settings%boundary%held)) return
      do i = 1, size(proof%scene%settings%boundary%held)
         associate (held => proof%scene%settings%boundary%held(i))
            if (proof%scene%system%equation(held%block) == 0) cycle
            n = n + 1
            force = [proof%force(1, n), proof%force(3, n), 0.0_wp]
            ! one that holds along one axis does so by both of its forces
            if (.not. held%along(1)) force = [0.0_wp, sum(force), 0.0_wp]
            if (.not. held%along(2)) force = [sum(force), 0.0_wp, 0.0_wp]
            call add_line(rows, start//"held,0,"//to_text(held%block)//"," &
               & //fields([held%point + proof%scene%origin, held%point + proof%scene%origin, &
               & force]))
         end associate
      end do
   end subroutine add_held

   !> Rows of bounded forces, along x and y, with the bound as the third; empty without one
   pure subroutine add_bounded(start, proof, n, rows)
      character(len=*), intent(in) :: start
      type(proof_t), intent(in) :: proof
      integer, intent(inout) :: n
      type(growing_text_t), intent(inout) :: rows
      character(len=:), allocatable :: line
      integer :: i

      if (.not. allocated(proof%scene%settings%boundary%bounded)) return
      do i = 1, size(proof%scene%settings%boundary%bounded)
         associate (bounded => proof%scene%settings%boundary%bounded(i))
            n = n + 1
            line = start//"bounded,0,"//to_text(bounded%block)//"," &
               & //fields([bounded%point + proof%scene%origin, bounded%point &
               & + proof%scene%origin, proof%force(1, n)*bounded%direction])//","
            if (bounded%most < huge(bounded%most)) then
               ! then come the stop and the guide of its carrier
               n = n + 2
               line = line//to_text(bounded%most)
            end if
         end associate
         call add_line(rows, line)
      end do
   end subroutine add_bounded

   !> Rows of bars: the force that pulls their ends together
   pure subroutine add_bars(start, proof, rows)
      character(len=*), intent(in) :: start
      type(proof_t), intent(in) :: proof
      type(growing_text_t), intent(inout) :: rows
      integer :: i, j

      associate (scene => proof%scene)
         if (.not. allocated(scene%settings%boundary%bar)) return
         do i = 1, size(scene%settings%boundary%bar)
            j = bar_joint(scene%settings, size(proof%force, 2), i)
            associate (bar => scene%settings%boundary%bar(i))
               call add_line(rows, start//"bar,"//to_text(bar%block(1))//"," &
                  & //to_text(bar%block(2))//","//fields([bar%point(:, 1) + scene%origin, &
                  & bar%point(:, 2) + scene%origin, proof%force(1, j)])//",,")
            end associate
         end do
      end associate
   end subroutine add_bars

   !> Velocities of the mechanism: of the centres of blocks that move, and their spins
   pure function proof_motion_lines(number, value, proof) result(lines)
      integer, intent(in) :: number
      character(len=*), intent(in) :: value
      type(proof_t), intent(in) :: proof
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      integer :: b, e

      lines = ""
      if (.not. (allocated(proof%velocity) .and. proof%same_shape)) return
      do b = 1, size(proof%scene%system%equation)
         e = proof%scene%system%equation(b)
         if (e == 0) cycle
         call add_line(rows, to_text(number)//","//value//","//to_text(b)//"," &
            & //fields([proof%scene%system%centroid(:, b) + proof%scene%origin, &
            & proof%velocity(1:3, e)]))
      end do
      lines = lines_of(rows)
   end function proof_motion_lines

   !> Reactions of the points of a block: what its joints and loads leave to them, shared by the
   !> least forces
   pure subroutine share_among_points(settings, system, contacts, time, support, block, &
      & reaction)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      real(wp), intent(in) :: time               !! The time [s]
      integer, intent(in) :: support(:, :)       !! The supports: (2, n)
      integer, intent(in) :: block               !! The block
      real(wp), intent(inout) :: reaction(:, :)  !! Receives the reactions: (3, n)
      real(wp) :: wanted(3), place(2), size_of
      real(wp), allocatable :: column(:, :), force(:)
      integer, allocatable :: owner(:)
      integer :: axis, i, n, side

      wanted = -outer_force(settings, system, time, block)
      do i = 1, size(contacts%joint)
         associate (joint => contacts%joint(i))
            do side = 1, 2
               if (joint%block(side) == block) wanted = wanted &
                  & - force_on(joint_place(system, contacts, i), contacts%force(:, i), side)
            end do
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
      ! moments are about the block, in units of its size: the least forces do not depend on the
      ! origin
      place = system%centroid(:, block)
      size_of = sqrt(system%area(block))
      do i = 1, n
         column(:, i) = moved(column(:, i), place, size_of)
      end do
      force = least_forces(column(:, :n), moved(wanted, place, size_of))
      do i = 1, n
         column(3, i) = size_of*column(3, i) + place(1)*column(2, i) - place(2)*column(1, i)
         reaction(:, owner(i)) = reaction(:, owner(i)) + force(i)*column(:, i)
      end do
   end subroutine share_among_points

   !> A force with its moment about another point, in units of a length
   pure function moved(wrench, place, length) result(seen)
      real(wp), intent(in) :: wrench(3)  !! Force, and moment about the origin: (3)
      real(wp), intent(in) :: place(2)   !! The point: (2) [m]
      real(wp), intent(in) :: length     !! The length [m]
      real(wp) :: seen(3)                !! The same with the other moment: (3)

      seen = [wrench(1:2), (wrench(3) - cross(place, wrench(1:2)))/length]
   end function moved

   !> The least forces with a given sum: x = A' y with A A' y = b
   pure function least_forces(a, b) result(x)
      real(wp), intent(in) :: a(:, :)  !! Force and moment of each on the block: (3, n)
      real(wp), intent(in) :: b(3)     !! The sum: (3)
      real(wp) :: x(size(a, 2))        !! The forces: (n)

      x = matmul(least_squares(matmul(a, transpose(a)), b, negligible), a)
      ! once more, for what rounding has left
      x = x + matmul(least_squares(matmul(a, transpose(a)), b - matmul(a, x), negligible), a)
   end function least_forces

   !> Sum of all loads on a block, and their moment about the origin of coordinates
   pure function outer_force(settings, system, time, block) result(wrench)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: time
      integer, intent(in) :: block  !! The block, which can move
      real(wp) :: wrench(3)         !! Force and moment: (3) [N/m, N/m, N]
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
