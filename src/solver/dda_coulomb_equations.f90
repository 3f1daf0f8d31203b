!> Damped equations of a motion with fixed joint states: (A (S + viscosity*K) A' + damping*mass) v
!> = load
!>
!> One factor serves many sets of faces. Where the stiffness of joints differs by D from that in the
!> factor, and U are the answers of the blocks to unit forces at these joints,
!>
!>    v = v0 - U y,   y = D (opening of v at these joints)      (Sherman, Morrison and Woodbury)
!>
!> is a small full system for y. Answers are kept until the matrix is factored again, so that
!> repeated changes of a joint cost nothing. Where rounding may have lost too much of the forces of
!> a solution, its residual is checked: if that is too large, the solution is corrected, then the
!> matrix factored.
module dda_coulomb_equations
   use dda_block_factor, only : substitute
   use dda_coulomb_joints, only : coulomb_joints_t, damped_mass
   use dda_coulomb_law, only : add_springs, coulomb_state_t, joint_stiffness
   use dda_crushed_joint, only : place_strips
   use dda_joint_graph, only : joint_motion
   use dda_joint_matrix, only : factor_joints, joint_matrix_t, lay_out_joints
   use dda_kinds, only : small, wp
   use dda_small_systems, only : eliminate_full, substitute_full
   implicit none
   private

   public :: bend_joints, coulomb_equations_t, new_coulomb_equations, path_damping, &
      & solve_equations, use_faces

   !> Maximum number of stored unit responses; more cost a new factor
   integer, parameter :: max_answer = 32
   !> Maximum number of stored values of unit responses
   integer, parameter :: most_numbers = 160000
   !> Least number of stored unit responses
   integer, parameter :: least_answers = 7

   !> Damping of rates, in unit mass and compliance; results are equal from 1e-12 to 1e-9
   real(wp), parameter :: path_damping = 1.0e-10_wp

   !> A factor, and what has changed since
   type :: coulomb_equations_t
      !> Matrix and factor
      type(joint_matrix_t) :: base
      !> True if the equations can be solved
      logical :: usable = .false.
      !> Pivots that a search for faces may take, and factorisations of the matrix altogether
      integer :: most_pivots = 100, most_factorisations = huge(1)
      !> Multiple of the mass, and of the stiffness of all joints, open ones too
      real(wp) :: damping = -1.0_wp, viscosity = 0.0_wp
      !> The multiple of the mass that rates are asked with; less where the assembly is soft
      real(wp) :: rest_damping = path_damping
      !> Faces in the factor: (3, n_joint)
      integer(small), allocatable :: base_face(:, :)
      !> Faces in the equations: (3, n_joint)
      integer(small), allocatable :: face(:, :)
      !> Number of joints that have changed since
      integer :: n_change = 0
      !> Their numbers in the order of their first change: (max_answer)
      integer, allocatable :: joint(:)
      !> Place of each joint among them, 0 for the others: (n_joint)
      integer(small), allocatable :: place(:)
      !> Their stiffness less that of the factor: (3, 3, max_answer)
      real(wp), allocatable :: difference(:, :, :)
      !> Number of the answer to a unit force along each of their parts, or 0: (3, max_answer)
      integer, allocatable :: answer(:, :)
      !> Number of answers, and the most that are kept
      integer :: n_answer = 0, most_answers = max_answer
      !> Place and part that each belongs to: (2, max_answer)
      integer, allocatable :: origin(:, :)
      !> Motion of all blocks: (3, n_block, most_answers)
      real(wp), allocatable :: response(:, :, :)
      !> The largest of it: (max_answer)
      real(wp) :: reach(max_answer) = 0.0_wp
      !> Openings of the changed joints by it: (3, max_answer, max_answer)
      real(wp), allocatable :: opening(:, :, :)
      !> Answers in use: (n_active)
      integer, allocatable :: active(:)
      !> The small full matrix, factored: (n_active, n_active)
      real(wp), allocatable :: capacity(:, :)
      !> Its exchanges of rows: (n_active)
      integer, allocatable :: exchange(:)
      !> The load that was solved for last with this factor, and the motion by the factor alone:
      !> (3, n_block); without entries if there is none
      real(wp), allocatable :: last_load(:, :), last_motion(:, :)
      !> Largest force on a block by which a joint that sticks answers a unit motion
      real(wp) :: stiffest = 0.0_wp
   end type coulomb_equations_t

   !> Maximum number of new unit responses per update
   integer, parameter :: max_new = 16
contains

   !> Pattern of the equations
   pure subroutine new_coulomb_equations(joints, equations)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(out) :: equations
      integer :: j, n_joint

      n_joint = size(joints%shear_role)
      call lay_out_joints(joints%graph%block, 3, joints%graph%n_block, .false., &
         & equations%base%matrix, equations%base%factor, equations%base%entry)
      equations%most_answers = max(least_answers, min(max_answer, &
         & most_numbers/(3*max(1, joints%graph%n_block))))
      allocate (equations%base_face(3, n_joint), source=0_small)
      allocate (equations%place(n_joint), source=0_small)
      allocate (equations%joint(max_answer), equations%difference(3, 3, max_answer))
      allocate (equations%answer(3, max_answer), equations%origin(2, max_answer))
      allocate (equations%opening(3, max_answer, max_answer), equations%active(0))
      do j = 1, n_joint
         ! what slides answers along itself, too, by its friction
         equations%stiffest = max(equations%stiffest, (1.0_wp + joints%graph%friction(j)) &
            & *maxval(joints%graph%row(:, :, :, j)**2)/joints%graph%compliance(j))
      end do
   end subroutine new_coulomb_equations

   !> Make the equations those of a set of faces: by few changes of the factor, or by a new one
   pure subroutine use_faces(equations, joints, faces, damping, viscosity)
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      !> Faces of corners and joints: (3, n_joint)
      integer(small), intent(in), contiguous :: faces(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> Multiple of the stiffness of all joints, 0 if absent
      real(wp), intent(in), optional :: viscosity
      real(wp) :: viscous
      logical :: few

      viscous = 0.0_wp
      if (present(viscosity)) viscous = viscosity
      few = equations%usable .and. .not. abs(damping - equations%damping) > 0.0_wp &
         & .and. .not. abs(viscous - equations%viscosity) > 0.0_wp
      equations%face = faces
      equations%damping = damping
      equations%viscosity = viscous
      if (few) call note_changes(equations, joints, few)
      if (few) call factor_capacity(equations, few)
      if (.not. few) call factor_faces(equations, joints)
   end subroutine use_faces

   !> Place the strips of a state; a factor that includes one that moves is lost
   pure subroutine bend_joints(equations, joints, state)
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_state_t), intent(in) :: state
      logical :: lost

      call place_strips(joints, state%force, state%gap, equations%base_face, lost)
      if (lost) equations%usable = .false.
   end subroutine bend_joints

   !> Factor the matrix of the faces
   pure subroutine factor_faces(equations, joints)
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      real(wp) :: stiffness(3, 3, size(equations%place))
      integer :: i, j

      equations%usable = equations%base%n_factorisation < equations%most_factorisations
      if (.not. equations%usable) return
      do j = 1, size(equations%place)
         stiffness(:, :, j) = joint_stiffness(joints, j, equations%face(:, j))
         do i = 1, 3
            stiffness(i, i, j) = stiffness(i, i, j) + equations%viscosity/joints%graph%compliance(j)
         end do
      end do
      call factor_joints(damped_mass(joints, equations%damping), joints%graph%block, &
         & joints%graph%row, stiffness, equations%base)
      equations%usable = equations%base%factor%usable
      equations%base_face = equations%face
      equations%place(equations%joint(:equations%n_change)) = 0_small
      equations%n_change = 0
      equations%n_answer = 0
      equations%active = [integer ::]
      if (allocated(equations%last_load)) deallocate (equations%last_load, equations%last_motion)
   end subroutine factor_faces

   !> List what differs from the factor, and find the answers that this takes
   pure subroutine note_changes(equations, joints, few)
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      logical, intent(out) :: few  !! True if there was room for them
      integer :: c, j, k
      logical :: is_new(3, max_answer)

      few = .false.
      do j = 1, size(equations%place)
         if (all(equations%face(:, j) == equations%base_face(:, j))) cycle
         if (equations%place(j) > 0) cycle
         if (equations%n_change == max_answer) return
         equations%n_change = equations%n_change + 1
         equations%joint(equations%n_change) = j
         equations%place(j) = int(equations%n_change, small)
         equations%answer(:, equations%n_change) = 0
         do k = 1, equations%n_answer
            equations%opening(:, equations%n_change, k) = opening_of(joints, j, &
               & equations%response(:, :, k))
         end do
      end do
      do c = 1, equations%n_change
         j = equations%joint(c)
         equations%difference(:, :, c) = joint_stiffness(joints, j, equations%face(:, j)) &
            & - joint_stiffness(joints, j, equations%base_face(:, j))
         is_new(:, c) = any(abs(equations%difference(:, :, c)) > 0.0_wp, 2) &
            & .and. equations%answer(:, c) == 0
      end do
      ! an answer costs as much as a solution: none is computed where a new factor follows
      if (count(is_new(:, :equations%n_change)) > min(max_new, &
         & equations%most_answers - equations%n_answer)) return
      do c = 1, equations%n_change
         do k = 1, 3
            if (is_new(k, c)) call find_answer(equations, joints, c, k)
         end do
      end do
      few = .true.
   end subroutine note_changes

   !> Answer of the blocks to a unit force at a joint
   pure subroutine find_answer(equations, joints, place, part)
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: place  !! Place of the joint among those that have changed
      integer, intent(in) :: part   !! The force: N1, N2 or T
      integer :: a, b, c, side

      ! a load at once that stands asks for none
      if (.not. allocated(equations%response)) allocate (equations%response( &
         & 3, joints%graph%n_block, equations%most_answers))
      equations%n_answer = equations%n_answer + 1
      a = equations%n_answer
      equations%answer(part, place) = a
      equations%origin(:, a) = [place, part]
      associate (response => equations%response(:, :, a), j => equations%joint(place))
         response = 0.0_wp
         do side = 1, 2
            b = joints%graph%block(side, j)
            if (b > 0) response(:, b) = response(:, b) + joints%graph%row(:, part, side, j)
         end do
         call substitute(equations%base%factor, response)
         equations%reach(a) = maxval(abs(response))
         do c = 1, equations%n_change
            equations%opening(:, c, a) = opening_of(joints, equations%joint(c), response)
         end do
      end associate
   end subroutine find_answer

   !> Opening and slip of one joint by a motion
   pure function opening_of(joints, j, motion) result(opening)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j              !! Number of the joint
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (3, n_block)
      real(wp) :: opening(3)                !! Opening 1, opening 2, slip
      integer :: b, k, side

      opening = 0.0_wp
      do side = 1, 2
         b = joints%graph%block(side, j)
         if (b == 0) cycle
         do k = 1, 3
            opening(k) = opening(k) + dot_product(joints%graph%row(:, k, side, j), motion(:, b))
         end do
      end do
   end function opening_of

   !> The small full matrix of the answers in use: unity and differences times openings
   pure subroutine factor_capacity(equations, regular)
      type(coulomb_equations_t), intent(inout) :: equations
      logical, intent(out) :: regular  !! True if it has factors
      integer :: a, i, n
      logical :: is_active(equations%n_answer)

      do a = 1, size(is_active)
         associate (place => equations%origin(1, a), part => equations%origin(2, a))
            is_active(a) = any(abs(equations%difference(part, :, place)) > 0.0_wp)
         end associate
      end do
      n = count(is_active)
      equations%active = pack([(a, a=1, size(is_active))], is_active)
      if (allocated(equations%capacity)) deallocate (equations%capacity, equations%exchange)
      allocate (equations%capacity(n, n), equations%exchange(n))
      do i = 1, n
         associate (place => equations%origin(1, equations%active(i)), &
            & part => equations%origin(2, equations%active(i)))
            do a = 1, n
               equations%capacity(i, a) = dot_product(equations%difference(part, :, place), &
                  & equations%opening(:, place, equations%active(a)))
            end do
            equations%capacity(i, i) = equations%capacity(i, i) + 1.0_wp
         end associate
      end do
      call eliminate_full(equations%capacity, equations%exchange, regular)
   end subroutine factor_capacity

   !> Solve for one load
   pure subroutine solve_equations(equations, joints, load, motion, opening, once)
      !> Usable equations; their matrix is factored again where changes have made them inexact
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      !> The load: (3, n_block)
      real(wp), intent(in), contiguous :: load(:, :)
      !> Motion of the blocks: (3, n_block)
      real(wp), intent(out), contiguous :: motion(:, :)
      !> Openings of the joints by it: (3, n_joint)
      real(wp), intent(out), contiguous :: opening(:, :)
      !> True if other loads follow more often
      logical, intent(in), optional :: once
      !> Permitted residual of the load, and rounding of the openings of blocks that move far
      real(wp), parameter :: exact = 1.0e-11_wp, rounding = 1.0e-14_wp
      real(wp), allocatable :: rest(:, :)
      real(wp) :: bound, lost
      integer :: turn

      call substitute_again(equations, load, motion, once)
      call add_changes(equations, joints, motion, lost)
      do turn = 1, 3
         call joint_motion(joints%graph, motion, opening)
         if (size(equations%active) == 0) exit
         bound = exact*maxval(abs(load)) + rounding*maxval(abs(motion))
         if (turn == 1 .and. lost <= bound) exit
         rest = load - equations%damping*joints%graph%mass*motion
         call add_springs(joints, equations%face, opening, equations%viscosity, rest)
         if (maxval(abs(rest)) <= bound) exit
         if (turn == 1) then
            call substitute(equations%base%factor, rest)
            call add_changes(equations, joints, rest, lost)
            motion = motion + rest
         else
            call factor_faces(equations, joints)
            if (.not. equations%usable) return
            motion = load
            call substitute(equations%base%factor, motion)
         end if
      end do
   end subroutine solve_equations

   !> Substitute with the factor; while the factor stays one load after the other is often the same
   pure subroutine substitute_again(equations, load, motion, once)
      !> Equations; they keep a motion for the next time
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in), contiguous :: load(:, :)
      real(wp), intent(out), contiguous :: motion(:, :)
      logical, intent(in), optional :: once

      if (allocated(equations%last_load)) then
         if (.not. any(abs(load - equations%last_load) > 0.0_wp)) then
            motion = equations%last_motion
            return
         end if
      end if
      motion = load
      call substitute(equations%base%factor, motion)
      if (present(once)) then
         if (once) return
      end if
      if (.not. allocated(equations%last_load)) &
         & allocate (equations%last_load, equations%last_motion, mold=load)
      equations%last_load = load
      equations%last_motion = motion
   end subroutine substitute_again

   !> Add the changes of the factor to a motion that was found with it alone
   pure subroutine add_changes(equations, joints, x, lost)
      type(coulomb_equations_t), intent(in) :: equations
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(inout), contiguous :: x(:, :)  !! The motion: (3, n_block)
      real(wp), intent(out) :: lost                   !! Force that the sum may lose by rounding
      real(wp) :: y(size(equations%active))
      integer :: i

      lost = 0.0_wp
      if (size(y) == 0) return
      do i = 1, size(y)
         associate (place => equations%origin(1, equations%active(i)), &
            & part => equations%origin(2, equations%active(i)))
            y(i) = dot_product(equations%difference(part, :, place), &
               & opening_of(joints, equations%joint(place), x))
         end associate
      end do
      call substitute_full(equations%capacity, equations%exchange, y)
      lost = epsilon(lost)*(1.0_wp + equations%viscosity)*equations%stiffest &
         & *(maxval(abs(x)) + sum(abs(y)*equations%reach(equations%active)))
      call subtract_answers(size(x), equations%response, equations%active, y, x)
   end subroutine add_changes

   !> Take answers from a motion; flat and four at once, so that the motion is read and written less
   pure subroutine subtract_answers(n, response, active, y, x)
      integer, intent(in) :: n                !! Unknowns of all blocks
      real(wp), intent(in) :: response(n, *)  !! Answers
      integer, intent(in) :: active(:)        !! Those in use: (n_active)
      real(wp), intent(in) :: y(:)            !! Share of each: (n_active)
      real(wp), intent(inout) :: x(n)         !! The motion
      integer :: i

      do i = 1, size(y) - 3, 4
         x = x - response(:, active(i))*y(i) - response(:, active(i + 1))*y(i + 1) &
            & - response(:, active(i + 2))*y(i + 2) - response(:, active(i + 3))*y(i + 3)
      end do
      do i = size(y) - modulo(size(y), 4) + 1, size(y)
         x = x - response(:, active(i))*y(i)
      end do
   end subroutine subtract_answers
end module dda_coulomb_equations
