!> Contact forces of moving blocks within their bounds, and their residual
!>
!> Blocks that no contact joins are independent: each group is a problem of its own. The
!> forces of the last step are checked; faces where these are near, sweeps, and an interior point
!> whose offset moves along follow, each from the best forces so far, until openings are against the
!> law by no more than the tolerance. Where none comes so far, the best forces count; where these
!> bring in energy, those of the convex problem, which exist always. Whatever counts lies within its
!> bounds, and momentum is exact.
!>
!> Equation (M5) of docs/method.md
module dda_contact_solver
   use dda_contact_faces, only : settle_faces
   use dda_contact_interior, only : solve_interior
   use dda_contact_problem, only : admissible, contact_problem_t, move_blocks, openings, &
      & pose_contacts, residual_of, residual_t, speed_of
   use dda_contact_sweeps, only : sweep_joints
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : cone_t, joint_face_t, shear_bound
   use dda_joint_matrix, only : joint_matrix_t
   use dda_kinds, only : wp
   use dda_small_systems, only : cholesky, solved
   use dda_sort, only : list_by_owner
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: gap_tolerance, relative_tolerance, rounding_tolerance
   public :: group_joints, hold_work, max_energy_gain, settle_contacts

   !> Gap tolerance over the free fall of the longest step: what forces leave of speeds, likewise
   real(wp), parameter :: gap_tolerance = 1.0e-7_wp
   !> Tolerance of gaps over the fastest motion of the group, where nothing falls, of accelerations
   !> at rest over that of free fall, and of a shear force that slides over its bound
   real(wp), parameter :: relative_tolerance = 1.0e-9_wp
   !> Tolerance of the interior point over the fastest motion of the group
   real(wp), parameter :: interior_tolerance = 1.0e-5_wp
   !> Joints up to which a group is solved to round-off
   integer, parameter :: small_group_joints = 100
   !> Gap tolerance of small groups over that of large ones, and of a test of rest over the usual
   !> one
   real(wp), parameter :: rounding_tolerance = 1.0e-6_wp
   !> Sweeps before the first factorisation, and after it
   integer, parameter :: first_sweeps = 32, last_sweeps = 64
   !> Energy that contact forces may add, over that of motion and loads, and most by which residual
   !> gaps reduce forces; more is due to depths that are pushed out
   real(wp), parameter :: max_energy_gain = 1.0e-6_wp
   !> Residual at which faces may start, and tolerance of the convex problem, over the fastest
   !> motion of the group
   real(wp), parameter :: near_solution = 1.0e-2_wp, convex_tolerance = 1.0e-3_wp

contains

   !> Contact forces and motion of one step
   pure subroutine settle_contacts(equations, springs, state)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(inout) :: springs  !! Rows and bounds of the joints
      !> Gaps, and forces to begin with in; motion, forces and faces out
      type(step_state_t), intent(inout) :: state
      type(contact_problem_t) :: p
      integer, allocatable :: joint(:)
      integer :: begun, e, first(size(springs%stiffness) + 1), g, most, n, passes
      type(residual_t) :: residual
      real(wp), allocatable :: force(:, :)
      logical :: acts(size(springs%stiffness))

      acts = has_rows(springs)
      call group_joints(springs, acts, size(state%motion, 2), n, first, joint)
      do e = 1, size(state%motion, 2)
         state%motion(:, e) = solved(cholesky(equations%base(:, :, e)), equations%load(:, e))
      end do
      begun = state%passes
      most = 0
      state%residual = 0.0_wp
      state%worst = 0
      do g = 1, n
         call pose_contacts(equations, springs, state, &
            & pack(joint(first(g):first(g + 1) - 1), acts(joint(first(g):first(g + 1) - 1))), p)
         if (size(p%joint) == 0) cycle
         force = admissible(p, state%force(:, p%joint))
         passes = 0
         call settle_group(p, state%fineness, state%fall, force, residual, passes)
         if (.not. state%rates) call hold_work(p, force, residual)
         ! groups are independent: their passes are side by side
         most = max(most, passes)
         state%force(:, p%joint) = force
         state%motion(:size(p%load, 1), p%equation) = move_blocks(p, force)
         if (.not. allocated(springs%row)) call move_alloc(p%row, springs%row)
         if (residual%opening > state%residual) state%worst = p%joint(residual%joint)
         state%residual = max(residual%opening, state%residual)
      end do
      state%face = face_of(springs%cone, state%force, springs%shift)
      state%passes = begun + most + 1
      state%increment = relative_displacement(springs, state%motion)
      state%settled = .true.
   end subroutine settle_contacts

   !> Solve one group: faces, sweeps, interior point, and the convex problem where these fail
   pure subroutine settle_group(p, fineness, fall, force, residual, passes)
      type(contact_problem_t), intent(inout) :: p
      real(wp), intent(in) :: fineness        !! Over the usual tolerance
      real(wp), intent(in) :: fall            !! Free fall in a step [m]
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(out) :: residual  !! Residual of the forces
      integer, intent(inout) :: passes        !! Factorisations
      type(joint_matrix_t) :: matrix
      real(wp) :: before(3, size(p%joint)), enough, exact, near, speed, tolerance

      before = force
      residual = residual_of(p, force, move_blocks(p, force))
      speed = speed_of(p, move_blocks(p, 0.0_wp*force))
      tolerance = max(p%noise, fineness*max(gap_tolerance*fall, relative_tolerance*speed))
      enough = max(tolerance, interior_tolerance*speed)
      near = near_solution*speed
      exact = merge(rounding_tolerance, 1.0_wp, size(p%joint) <= small_group_joints)*tolerance
      ! sweeps let the first of redundant joints take all
      call settle_faces(p, exact, near, before, matrix, force, residual, passes)
      call sweep_joints(p, exact, first_sweeps, force, residual)
      call settle_faces(p, exact, near, before, matrix, force, residual, passes)
      if (residual%opening > enough) &
         & call solve_interior(p, enough, .false., matrix, force, residual, passes)
      if (residual%opening > near) &
         & call solve_interior(p, convex_tolerance*speed, .true., matrix, force, residual, passes)
      call sweep_joints(p, tolerance, last_sweeps, force, residual)
      call settle_faces(p, exact, near, before, matrix, force, residual, passes)
      if (work_of(p, force) > max_energy_gain*sum(p%load*move_blocks(p, 0.0_wp*force))/2.0_wp) &
         & call solve_interior(p, enough, .true., matrix, force, residual, passes)
   end subroutine settle_group

   !> Work of contact forces on openings and slip: negative under Coulomb's law [J/m]
   pure real(wp) function work_of(p, force)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)  !! The forces: (3, n_joint) [N/m]

      work_of = sum(force*openings(p, force, move_blocks(p, force)))
   end function work_of

   !> Reduce contact forces that bring in energy until they bring in none: the law of contact brings
   !> in none, but where it pushes out a depth that the step begins with. Residual gaps change
   !> forces by little. Bars keep their forces
   pure subroutine hold_work(p, force, residual)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      real(wp), dimension(3, size(p%joint)) :: contact, without
      real(wp) :: by_contacts, by_loads, factor

      without = merge(force, 0.0_wp, p%bar_give > 0.0_wp)
      contact = force - without
      by_loads = sum(contact*(openings(p, without, move_blocks(p, without)) - p%apart))
      by_contacts = sum(contact*(openings(p, force, move_blocks(p, force)) - p%apart)) - by_loads
      if (by_loads + by_contacts <= 0.0_wp) return
      factor = -by_loads/by_contacts
      if (factor < 1.0_wp - max_energy_gain) return
      force = without + factor*contact
      residual = residual_of(p, force, move_blocks(p, force))
   end subroutine hold_work

   !> Joints that have rows: in the search for velocities open ones have none
   pure function has_rows(springs) result(acts)
      type(joint_springs_t), intent(in) :: springs
      logical :: acts(size(springs%stiffness))  !! The answers: (n_joint)
      integer :: j

      do j = 1, size(acts)
         acts(j) = any(abs(springs%row(:, :, :, j)) > 0.0_wp)
      end do
   end function has_rows

   !> The faces that forces lie on
   pure function face_of(cone, force, shift) result(faces)
      type(cone_t), intent(in) :: cone(:)  !! Bounds: (n_joint)
      real(wp), intent(in) :: force(:, :)  !! The forces: (3, n_joint) [N/m]
      !> Tension that the contacts carry, and a zero: (3, n_joint) [N/m]
      real(wp), intent(in) :: shift(:, :)
      type(joint_face_t) :: faces(size(cone))  !! The faces: (n_joint)
      integer :: j

      do j = 1, size(cone)
         associate (face => faces(j), f => force(:, j))
            face%open = .not. f(1:2) + shift(1:2, j) > 0.0_wp
            if (abs(f(3)) >= (1.0_wp - relative_tolerance)*shear_bound(cone(j), f + shift(:, j))) &
               & face%slip = merge(1, -1, f(3) > 0.0_wp)
            if (all(face%open) .and. .not. abs(f(3)) > 0.0_wp) face%slip = 0
         end associate
      end do
   end function face_of

   !> Groups of joints whose blocks hang together: each is a problem of its own
   pure subroutine group_joints(springs, acts, n_equation, n, first, joint)
      type(joint_springs_t), intent(in) :: springs
      logical, intent(in) :: acts(:)  !! Joints that hold their blocks together: (n_joint)
      !> Number of movable blocks
      integer, intent(in) :: n_equation
      !> Number of groups
      integer, intent(out) :: n
      !> First joint of each group in the list, and one beyond the last: (n_joint + 1)
      integer, intent(out) :: first(:)
      !> The joints, group by group, rising in each: (n_joint)
      integer, allocatable, intent(out) :: joint(:)
      integer :: group(size(springs%equation, 2))
      integer :: root(n_equation), number(n_equation), pair(2), i, j

      root = [(i, i=1, n_equation)]
      do j = 1, size(group)
         pair = springs%equation(:, j)
         if (any(pair == 0) .or. .not. acts(j)) cycle
         pair = [root_of(pair(1)), root_of(pair(2))]
         root(maxval(pair)) = minval(pair)
         root(springs%equation(:, j)) = minval(pair)
      end do
      n = 0
      number = 0
      do j = 1, size(group)
         i = root_of(maxval(springs%equation(:, j)))
         if (number(i) == 0) then
            n = n + 1
            number(i) = n
         end if
         group(j) = number(i)
      end do
      first = size(group) + 1
      call list_by_owner(group, first(:n + 1), joint)

   contains

      !> The block that stands for the group of a block
      pure integer function root_of(block)
         integer, intent(in) :: block  !! The block

         root_of = block
         do while (root(root_of) /= root_of)
            root_of = root(root_of)
         end do
      end function root_of
   end subroutine group_joints

end module dda_contact_solver
