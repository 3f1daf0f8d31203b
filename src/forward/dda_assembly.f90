!> The equations of one step: blocks first, then the springs of the joints (Shi: df10 to df18)
module dda_assembly
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_block_solve, only : band_factor_t, factorise, substitute
   use dda_block_system, only : block_system_t
   use dda_elasticity, only : elastic_matrix, stress_load
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t
   use dda_inertia, only : mass_matrix
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_loads, only : body_load
   use dda_settings, only : settings_t
   implicit none
   private

   public :: equations_t, new_equations, renew_springs, take_springs, assemble_blocks, solve_faces
   public :: relative_displacement

   !> Matrix, loads and factor; the pattern and the mass are made once, the numbers at each solution
   type :: equations_t
      !> Matrix with the springs of the present faces
      type(block_matrix_t) :: matrix
      !> Its factor
      type(band_factor_t) :: factor
      !> Entry of the matrix that couples the blocks of a joint, 0 if one is fixed: (n_joint)
      integer, allocatable :: entry(:)
      !> Stiffness of the stuck joints, which most are: of the first block, of the second one, and
      !> between the first (rows) and the second: (n_dof, n_dof, 3, n_joint)
      real(wp), allocatable :: stuck(:, :, :, :)
      !> Mass: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: mass(:, :, :)
      !> Elastic stiffness of the blocks: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: elastic(:, :, :)
      !> Matrix of the blocks without springs: elastic + 2*mass/dt**2: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: base(:, :, :)
      !> Loads from outside: (n_dof, n_equation)
      real(wp), allocatable :: weight(:, :)
      !> Loads of this step without springs: (n_dof, n_equation)
      real(wp), allocatable :: load(:, :)
      !> Faces that the factor was made for: (n_joint)
      type(joint_face_t), allocatable :: held(:)
      !> Coefficients of friction that it was made for: (n_joint)
      real(wp), allocatable :: held_friction(:)
      !> Whether base or springs have changed since
      logical :: changed = .true.
      !> Factorisations so far
      integer :: factorisations = 0
   end type equations_t

contains

   !> Equations of a system at rest: pattern, mass, stiffness and weight
   pure subroutine new_equations(system, springs, settings, equations)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The equations
      type(equations_t), intent(out) :: equations
      real(wp) :: full(6, 6), load(6)
      integer :: b, e, n, nd

      nd = settings%n_dof
      n = maxval(system%equation)
      call couple_blocks(springs, nd, n, equations)
      allocate (equations%mass(nd, nd, n), equations%elastic(nd, nd, n), equations%base(nd, nd, n))
      allocate (equations%weight(nd, n), equations%load(nd, n))
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = mass_matrix(system%density(b), system%area(b), system%second(:, b))
         equations%mass(:, :, e) = full(:nd, :nd)
         full = elastic_matrix(system%materials(system%material(b)), system%area(b))
         equations%elastic(:, :, e) = full(:nd, :nd)
         load = body_load(system%unit_weight(b)*settings%load_direction, system%area(b))
         equations%weight(:, e) = load(:nd)
      end do
   end subroutine new_equations

   !> Pattern of the matrix and stiffness of the stuck joints
   pure subroutine couple_blocks(springs, n_dof, n_equation, equations)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> Number of movable blocks
      integer, intent(in) :: n_equation
      !> Receives pattern and stiffness
      type(equations_t), intent(inout) :: equations
      logical :: couples(size(springs%equation, 2))
      integer :: e, j, pair(2, size(springs%equation, 2))

      if (allocated(equations%entry)) &
         & deallocate (equations%entry, equations%held, equations%held_friction, equations%stuck)
      couples = all(springs%equation > 0, dim=1)
      allocate (equations%entry(size(couples)), source=0)
      allocate (equations%held(size(couples)), equations%held_friction(size(couples)))
      allocate (equations%stuck(n_dof, n_dof, 3, size(couples)))
      e = 0
      do j = 1, size(couples)
         if (.not. couples(j)) cycle
         e = e + 1
         equations%entry(j) = e
         pair(:, e) = springs%equation(:, j)
      end do
      call set_pattern(equations%matrix, n_dof, n_equation, pair(:, :e))
      call take_springs(springs, equations)
   end subroutine couple_blocks

   !> Take over the springs of new joints; the pattern is made anew only where other blocks meet
   pure subroutine renew_springs(before, springs, equations)
      !> Equations of the blocks of each joint so far: (2, n_joint)
      integer, intent(in) :: before(:, :)
      !> The springs of the joints now
      type(joint_springs_t), intent(in) :: springs
      !> Receives pattern and stiffness
      type(equations_t), intent(inout) :: equations
      logical :: same

      same = size(before, 2) == size(springs%equation, 2)
      if (same) same = all(before == springs%equation)
      if (same) then
         call take_springs(springs, equations)
      else
         call couple_blocks(springs, size(equations%weight, 1), size(equations%weight, 2), &
            & equations)
      end if
   end subroutine renew_springs

   !> Take over springs whose rows have changed while the coupled pairs have not
   pure subroutine take_springs(springs, equations)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Receives the stiffness of the stuck joints
      type(equations_t), intent(inout) :: equations
      real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, &
         & 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      integer :: j

      equations%changed = .true.
      do j = 1, size(equations%entry)
         equations%stuck(:, :, :, j) = joint_stiffness(springs, identity, j)
      end do
   end subroutine take_springs

   !> Block part of matrix and load of one step of length dt
   pure subroutine assemble_blocks(system, settings, dt, equations)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Length of the step [s]
      real(wp), intent(in) :: dt
      !> Receives base and load
      type(equations_t), intent(inout) :: equations
      real(wp) :: stress(6)
      integer :: b, e, nd

      nd = settings%n_dof
      equations%changed = .true.
      equations%base = equations%elastic + (2.0_wp/dt**2)*equations%mass
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         stress = stress_load(system%stress(:, b), system%area(b))
         equations%load(:, e) = equations%weight(:, e) + stress(:nd)
         if (settings%dynamic) equations%load(:, e) = equations%load(:, e) &
            & + (2.0_wp/dt)*matmul(equations%mass(:, :, e), system%velocity(:nd, b))
      end do
   end subroutine assemble_blocks

   !> Motion of all blocks if every joint keeps to its face
   pure subroutine solve_faces(equations, springs, cone, face, trial, motion)
      !> Blocks assembled; matrix and factor are made anew if they are not those of these faces
      type(equations_t), intent(inout) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Bounds of the joint forces: (n_joint)
      type(cone_t), intent(in) :: cone(:)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      !> Trial forces before the motion: (3, n_joint) [N/m]
      real(wp), intent(in) :: trial(:, :)
      !> The motion: (n_dof, n_equation); unchanged if the factor is not usable
      real(wp), intent(inout) :: motion(:, :)
      integer :: j

      call hold_faces(equations, springs, cone, face)
      if (.not. equations%factor%usable) return
      motion = equations%load
      do j = 1, size(face)
         call add_load(springs, cone(j), face(j), trial(:, j), j, motion)
      end do
      call substitute(equations%factor, motion)
   end subroutine solve_faces

   !> Matrix and factor of these faces, made anew if they are those of others
   pure subroutine hold_faces(equations, springs, cone, face)
      !> Blocks assembled
      type(equations_t), intent(inout) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Bounds of the joint forces: (n_joint)
      type(cone_t), intent(in) :: cone(:)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      integer :: j

      if (holds(equations, cone, face)) return
      equations%matrix%diagonal = equations%base
      do j = 1, size(face)
         call add_stiffness(springs, cone(j), face(j), j, equations)
      end do
      call factorise(equations%matrix, equations%factor)
      equations%factorisations = equations%factorisations + 1
      equations%held = face
      equations%held_friction = cone%friction
      equations%changed = .not. equations%factor%usable
   end subroutine hold_faces

   !> Whether the factor is that of these faces
   pure logical function holds(equations, cone, face)
      !> The equations
      type(equations_t), intent(in) :: equations
      !> Bounds of the joint forces: (n_joint)
      type(cone_t), intent(in) :: cone(:)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      integer :: j

      holds = .false.
      if (equations%changed) return
      do j = 1, size(face)
         if (face(j)%slip /= equations%held(j)%slip) return
         if (any(face(j)%open .neqv. equations%held(j)%open)) return
         if (abs(cone(j)%friction - equations%held_friction(j)) > 0.0_wp) return
      end do
      holds = .true.
   end function holds

   !> Add the stiffness of one joint: p R P R'
   pure subroutine add_stiffness(springs, cone, face, j, equations)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Bounds of the joint's force
      type(cone_t), intent(in) :: cone
      !> Its face
      type(joint_face_t), intent(in) :: face
      !> Number of the joint
      integer, intent(in) :: j
      !> Receives the stiffness
      type(equations_t), intent(inout) :: equations
      real(wp) :: tangent(3, 3), constant(3)
      real(wp) :: stiffness(equations%matrix%n_dof, equations%matrix%n_dof, 3)
      integer :: e, side

      if (is_stuck(face)) then
         stiffness = equations%stuck(:, :, :, j)
      else
         call apply_face(cone, face, tangent, constant)
         stiffness = joint_stiffness(springs, tangent, j)
      end if
      do side = 1, 2
         e = springs%equation(side, j)
         if (e > 0) equations%matrix%diagonal(:, :, e) = equations%matrix%diagonal(:, :, e) &
            & + stiffness(:, :, side)
      end do
      e = equations%entry(j)
      if (e == 0) return
      if (equations%matrix%pair(1, e) == springs%equation(1, j)) then
         equations%matrix%coupling(:, :, e) = stiffness(:, :, 3)
      else
         equations%matrix%coupling(:, :, e) = transpose(stiffness(:, :, 3))
      end if
   end subroutine add_stiffness

   !> Add the load of one joint: R (P z + c)
   pure subroutine add_load(springs, cone, face, trial, j, load)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Bounds of the joint's force
      type(cone_t), intent(in) :: cone
      !> Its face
      type(joint_face_t), intent(in) :: face
      !> Its trial force before the motion: (3) [N/m]
      real(wp), intent(in) :: trial(3)
      !> Number of the joint
      integer, intent(in) :: j
      !> Receives the load: (n_dof, n_equation)
      real(wp), intent(inout) :: load(:, :)
      real(wp) :: tangent(3, 3), constant(3)
      integer :: e, side

      constant = trial
      if (.not. is_stuck(face)) then
         call apply_face(cone, face, tangent, constant)
         constant = constant + matmul(tangent, trial + springs%shift(:, j)) - springs%shift(:, j)
      end if
      do side = 1, 2
         e = springs%equation(side, j)
         if (e > 0) load(:, e) = load(:, e) + springs%row(:, 1, side, j)*constant(1) &
            & + springs%row(:, 2, side, j)*constant(2) + springs%row(:, 3, side, j)*constant(3)
      end do
   end subroutine add_load

   !> Whether a face is the inside of the cone
   pure logical function is_stuck(face)
      !> The face
      type(joint_face_t), intent(in) :: face

      is_stuck = face%slip == 0 .and. .not. any(face%open)
   end function is_stuck

   !> Stiffness of one joint: p R P R' of the first block, of the second one, and between them
   pure function joint_stiffness(springs, tangent, j) result(stiffness)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Projector P on the joint's face: (3, 3)
      real(wp), intent(in) :: tangent(3, 3)
      !> Number of the joint
      integer, intent(in) :: j
      !> The three blocks: (n_dof, n_dof, 3)
      real(wp) :: stiffness(size(springs%row, 1), size(springs%row, 1), 3)
      real(wp) :: steep(size(springs%row, 1), 3)
      integer :: c, pair

      do pair = 1, 3
         associate (a => springs%row(:, :, merge(2, 1, pair == 2), j), &
            & b => springs%row(:, :, merge(1, 2, pair == 1), j))
            steep = springs%stiffness(j)*matmul(a, tangent)
            do c = 1, size(b, 1)
               stiffness(:, c, pair) = steep(:, 1)*b(c, 1) + steep(:, 2)*b(c, 2) &
                  & + steep(:, 3)*b(c, 3)
            end do
         end associate
      end do
   end function joint_stiffness

   !> Openings and slips of the joints by a motion of the blocks
   pure function relative_displacement(springs, motion) result(increment)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> The motion: (n_dof, n_equation)
      real(wp), intent(in) :: motion(:, :)
      !> Opening at the two contacts and slip: (3, n_joint) [m]
      real(wp) :: increment(3, size(springs%equation, 2))
      integer :: e, j, k, side

      increment = 0.0_wp
      do j = 1, size(springs%equation, 2)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e == 0) cycle
            do k = 1, 3
               increment(k, j) = increment(k, j) &
                  & + dot_product(motion(:, e), springs%row(:, k, side, j))
            end do
         end do
      end do
   end function relative_displacement
end module dda_assembly
