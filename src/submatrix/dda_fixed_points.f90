!> Fixed points and prescribed displacements: stiff springs (Shi: df12)
!>
!> The springs pull the points to their target positions at the end of the step, with the force of
!> the previous step as initial value. Force corrections are repeated until convergence, so that the
!> result does not depend on the stiffness.
module dda_fixed_points
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t, led_displacement, rate_at
   use dda_deformation, only : displacement_matrix, moved_point, tangent_matrix
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_small_systems, only : least_squares
   implicit none
   private

   public :: fixed_points_t, new_fixed_points, follow_fixed_points, add_fixed_springs
   public :: correct_fixed_forces, turn_fixed_row, hold_rigidly

   !> Smallest stiffness of a restraint over the inertia 2m/dt**2 of its block
   real(wp), parameter :: over_inertia = 1.0e3_wp

   !> Remainder below which a column is dependent, over the largest
   real(wp), parameter :: negligible = 1.0e-10_wp

   !> Relative round-off of the sums of a motion
   real(wp), parameter :: rounded = 16.0_wp*epsilon(1.0_wp)

   !> One spring per restrained direction of a point of a movable block
   type :: fixed_points_t
      integer, allocatable :: point(:)     !! Number of the restrained point: (n)
      integer, allocatable :: axis(:)      !! Direction, 1 or 2 for x or y: (n)
      integer, allocatable :: equation(:)  !! Equation of its block: (n)
      !> Displacement of the point along the axis by the block's unknowns: (n_dof, n)
      real(wp), allocatable :: row(:, :)
      real(wp), allocatable :: stiffness(:)  !! Stiffness: (n) [N/m per metre depth]
      real(wp), allocatable :: target(:)     !! Target displacement in the step: (n) [m]
      real(wp), allocatable :: rate(:)       !! Target velocity at the end of the step: (n) [m/s]
      real(wp), allocatable :: force(:)      !! Force of the spring: (n) [N/m]
   end type fixed_points_t

contains

   !> Springs of all restrained points, free of force
   pure type(fixed_points_t) function new_fixed_points(system, held, n_dof) result(fixed)
      type(block_system_t), intent(in) :: system
      type(held_point_t), intent(in) :: held(:)  !! The restrained points
      integer, intent(in) :: n_dof               !! Unknowns of a block
      integer :: axis, h, n, number(2*size(held)), direction(2*size(held))

      n = 0
      do h = 1, size(held)
         if (system%equation(held(h)%block) == 0) cycle
         do axis = 1, 2
            if (.not. held(h)%along(axis)) cycle
            n = n + 1
            number(n) = h
            direction(n) = axis
         end do
      end do
      allocate (fixed%point, source=number(:n))
      allocate (fixed%axis, source=direction(:n))
      allocate (fixed%equation(n), fixed%stiffness(n), fixed%row(n_dof, n))
      allocate (fixed%target(n), fixed%rate(n))
      allocate (fixed%force(n), source=0.0_wp)
      fixed%equation = [(system%equation(held(number(h))%block), h=1, n)]
   end function new_fixed_points

   !> Rows and targets of a step from the present position of the blocks
   pure subroutine follow_fixed_points(system, settings, time, dt, fixed)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: time                  !! Time at the end of the step [s]
      real(wp), intent(in) :: dt                    !! Length of the step [s]
      type(fixed_points_t), intent(inout) :: fixed  !! The springs; forces are kept
      real(wp) :: t(2, 6), place(2), centre(2), path(2), rate(2)
      integer :: i

      do i = 1, size(fixed%point)
         associate (held => settings%boundary%held(fixed%point(i)), axis => fixed%axis(i), &
            & b => settings%boundary%held(fixed%point(i))%block)
            t = displacement_matrix(held%point, system%centroid(:, b))
            place = held%point + matmul(t, system%motion(:, b))
            if (settings%current) then
               centre = system%centroid(:, b) + system%motion(1:2, b)
               place = moved_point(held%point, system%centroid(:, b), system%motion(:, b))
               t = tangent_matrix(place, centre, system%motion(:, b))
            end if
            path = led_displacement(held%path, time)
            rate = rate_at(held%path, time)
            fixed%row(:, i) = t(axis, :size(fixed%row, 1))
            fixed%target(i) = held%point(axis) + path(axis) - place(axis)
            fixed%rate(i) = rate(axis)
            fixed%stiffness(i) = max( &
               & settings%penalty_ratio*system%materials(system%material(b))%young, &
               & over_inertia*2.0_wp*system%density(b)*system%area(b)/dt**2)
         end associate
      end do
   end subroutine follow_fixed_points

   !> Add the springs to matrix and load of the blocks
   pure subroutine add_fixed_springs(fixed, target, matrix, load)
      type(fixed_points_t), intent(in) :: fixed
      real(wp), intent(in) :: target(:)  !! Target displacements: (n) [m]
      !> Receives the stiffness: (n_dof, n_dof, n_equation)
      real(wp), intent(inout) :: matrix(:, :, :)
      real(wp), intent(inout) :: load(:, :)  !! Receives the forces: (n_dof, n_equation)
      integer :: c, i

      do i = 1, size(fixed%point)
         associate (row => fixed%row(:, i), e => fixed%equation(i), p => fixed%stiffness(i))
            do c = 1, size(row)
               matrix(:, c, e) = matrix(:, c, e) + p*row(c)*row
            end do
            load(:, e) = load(:, e) + (p*target(i) + fixed%force(i))*row
         end associate
      end do
   end subroutine add_fixed_springs

   !> Remove the second half of the restraint force from the load of a step: it acts at the end
   !> position of the point. With the whole force along the initial row a pendulum would gain energy
   !> (Andersen 1983, J. Comput. Phys. 52:24)
   pure subroutine turn_fixed_row(system, settings, i, motion, fixed, load)
      type(block_system_t), intent(in) :: system  !! The blocks before the step
      type(settings_t), intent(in) :: settings
      integer, intent(in) :: i           !! Number of the spring
      real(wp), intent(in) :: motion(:)  !! Motion of its block in the step: (n_dof)
      !> The springs; row and force of this one are changed
      type(fixed_points_t), intent(inout) :: fixed
      real(wp), intent(inout) :: load(:)  !! Load of its block: (n_dof)
      real(wp) :: end_motion(6), place(2), t(2, 6)

      load = load - fixed%force(i)/2.0_wp*fixed%row(:, i)
      fixed%force(i) = 0.0_wp
      associate (held => settings%boundary%held(fixed%point(i)), &
         & b => settings%boundary%held(fixed%point(i))%block)
         end_motion = system%motion(:, b)
         end_motion(:3) = end_motion(:3) + motion(:3)
         place = moved_point(held%point, system%centroid(:, b), end_motion)
         t = displacement_matrix(place, system%centroid(:, b) + end_motion(1:2))
      end associate
      fixed%row(:3, i) = t(fixed%axis(i), :3)
   end subroutine turn_fixed_row

   !> Reduce the target rates of the points of a block without strain rate to those of a rigid
   !> block, by least squares
   pure subroutine hold_rigidly(equation, fixed)
      integer, intent(in) :: equation  !! Equation of the block
      !> The springs; rows and rates of this block are changed
      type(fixed_points_t), intent(inout) :: fixed
      integer :: mine(count(fixed%equation == equation)), i
      real(wp) :: velocity(3)

      mine = pack([(i, i=1, size(fixed%equation))], fixed%equation == equation)
      fixed%row(4:, mine) = 0.0_wp
      if (size(mine) < 2) return
      velocity = least_squares(transpose(fixed%row(:3, mine)), fixed%rate(mine), negligible)
      fixed%rate(mine) = matmul(velocity, fixed%row(:3, mine))
   end subroutine hold_rigidly

   !> Correct the forces of the springs, and the load, after a motion
   pure subroutine correct_fixed_forces(target, motion, fixed, load, change, miss)
      real(wp), intent(in) :: target(:)
      real(wp), intent(in) :: motion(:, :)          !! Motion of the blocks: (n_dof, n_equation)
      type(fixed_points_t), intent(inout) :: fixed  !! The springs; their forces are corrected
      real(wp), intent(inout) :: load(:, :)         !! The load of the blocks: (n_dof, n_equation)
      !> Largest correction in excess of round-off of the motion times the stiffness [N/m]
      real(wp), intent(out) :: change
      !> Largest distance of a point from its target in excess of round-off [m]
      real(wp), intent(out), optional :: miss
      real(wp) :: more, rounding
      integer :: i

      change = 0.0_wp
      if (present(miss)) miss = 0.0_wp
      do i = 1, size(fixed%point)
         associate (row => fixed%row(:, i), e => fixed%equation(i))
            more = fixed%stiffness(i)*(target(i) - dot_product(row, motion(:, e)))
            fixed%force(i) = fixed%force(i) + more
            load(:, e) = load(:, e) + more*row
            rounding = rounded*fixed%stiffness(i) &
               & *(abs(target(i)) + dot_product(abs(row), abs(motion(:, e))))
            change = max(change, abs(more) - rounding)
            if (present(miss)) miss = max(miss, (abs(more) - rounding)/fixed%stiffness(i))
         end associate
      end do
   end subroutine correct_fixed_forces
end module dda_fixed_points
