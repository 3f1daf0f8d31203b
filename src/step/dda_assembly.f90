!> Equations of one step: blocks, then springs of the joints (Shi: df10 to df18)
!>
!> Equation (M3) of docs/method.md
module dda_assembly
   use dda_bar_springs, only : couple_bars, new_bar_springs
   use dda_block_factor, only : factorise, plan_factor, substitute
   use dda_block_matrix, only : set_pattern
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t
   use dda_contact_types, only : joint_springs_t
   use dda_fixed_points, only : new_fixed_points
   use dda_friction_cone, only : cone_t, is_stuck, joint_face_t
   use dda_kinds, only : wp
   use dda_settings, only : load_direction, settings_t
   use dda_sort, only : list_by_owner
   use dda_spring_products, only : add_load, add_product, projected
   use dda_step_state, only : equations_t
   use dda_submatrices, only : body_load, dashpot_matrices, mass_matrix
   implicit none
   private

   public :: new_equations, renew_springs, refresh, solve_faces

contains

   !> Equations of a system at rest: mass and weight. Pattern and factor follow with the
   !> first solution for given faces; dynamic runs with current geometry need none
   pure subroutine new_equations(system, settings, equations)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      type(equations_t), intent(out) :: equations
      type(held_point_t) :: none(0)
      real(wp) :: full(6, 6), load(6)
      integer :: b, e, n, nd

      nd = settings%n_dof
      n = maxval(system%equation)
      allocate (equations%mass(nd, nd, n))
      allocate (equations%base(nd, nd, n), source=0.0_wp)
      allocate (equations%weight(nd, n), equations%outer(nd, n), equations%load(nd, n))
      allocate (equations%felt(nd, n))
      allocate (equations%changed(n), source=.true.)
      equations%new_pattern = .true.
      equations%bars = new_bar_springs(settings%boundary, system%equation, nd)
      equations%dashpot = dashpot_matrices(system, settings%boundary, nd)
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = mass_matrix(system%density(b), system%area(b), system%second(:, b))
         equations%mass(:, :, e) = full(:nd, :nd)
         load = body_load(system%unit_weight(b)*load_direction(settings), system%area(b))
         equations%weight(:, e) = load(:nd)
      end do
      if (allocated(settings%boundary%held)) then
         equations%fixed = new_fixed_points(system, settings%boundary%held, nd)
      else
         equations%fixed = new_fixed_points(system, none, nd)
      end if
   end subroutine new_equations

   !> Add new joints: lists, pattern, plan of the factor, springs
   pure subroutine new_springs(springs, n_dof, n_equation, equations)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_dof       !! Unknowns of one block
      integer, intent(in) :: n_equation  !! Number of movable blocks
      type(equations_t), intent(inout) :: equations

      call list_joints(springs, n_dof, n_equation, equations)
      call plan_factor(equations%matrix, equations%factor)
      if (allocated(equations%held)) deallocate (equations%held, equations%held_friction)
      allocate (equations%held_friction(size(springs%stiffness)), source=0.0_wp)
      allocate (equations%held(size(springs%stiffness)))
      call add_stuck_springs(springs, equations)
   end subroutine new_springs

   !> Note that joints may have changed; the pattern is made again only where other
   !> blocks meet
   pure subroutine renew_springs(before, springs, equations)
      !> Equations of the blocks of each joint so far: (2, n_joint)
      integer, intent(in) :: before(:, :)
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(inout) :: equations
      logical :: same

      same = size(before, 2) == size(springs%equation, 2)
      if (same) same = all(before == springs%equation)
      equations%new_pattern = equations%new_pattern .or. .not. same
      equations%new_numbers = .true.
   end subroutine renew_springs

   !> Bring pattern and numbers up to these springs, if they are not
   pure subroutine refresh(springs, equations)
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(inout) :: equations

      if (equations%new_pattern) then
         call new_springs(springs, size(equations%weight, 1), size(equations%weight, 2), equations)
      else if (equations%new_numbers) then
         call add_stuck_springs(springs, equations)
      end if
      equations%new_pattern = .false.
      equations%new_numbers = .false.
   end subroutine refresh

   !> Lists of the joints that couple blocks, and of the joints of each block
   pure subroutine list_joints(springs, n_dof, n_equation, equations)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_dof, n_equation
      type(equations_t), intent(inout) :: equations
      integer, allocatable :: side(:)
      integer :: e, j
      integer :: pair(2, size(springs%equation, 2) + size(equations%bars%entry))

      if (allocated(equations%entry)) deallocate (equations%entry)
      allocate (equations%entry(size(springs%equation, 2)), source=0)
      e = 0
      do j = 1, size(springs%equation, 2)
         if (any(springs%equation(:, j) == 0)) cycle
         e = e + 1
         equations%entry(j) = e
         pair(:, e) = springs%equation(:, j)
      end do
      do j = 1, size(equations%bars%entry)
         associate (block => equations%bars%equation(:, j))
            if (any(block == 0) .or. block(1) == block(2)) cycle
            e = e + 1
            equations%bars%entry(j) = e
            pair(:, e) = block
         end associate
      end do
      call set_pattern(equations%matrix, n_dof, n_equation, pair(:, :e))
      if (.not. allocated(equations%first_joint)) allocate (equations%first_joint(n_equation + 1), &
         & equations%glued(n_dof, n_dof, n_equation))
      call list_by_owner(reshape(springs%equation, [size(springs%equation)]), &
         & equations%first_joint, side)
      equations%joint = merge((side + 1)/2, -side/2, mod(side, 2) == 1)
   end subroutine list_joints

   !> Stiffness of the springs if all joints are stuck
   pure subroutine add_stuck_springs(springs, equations)
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(inout) :: equations
      integer :: e, j, k

      equations%changed = .true.
      equations%held = joint_face_t()
      do e = 1, size(equations%glued, 3)
         equations%glued(:, :, e) = 0.0_wp
         do k = equations%first_joint(e), equations%first_joint(e + 1) - 1
            j = abs(equations%joint(k))
            associate (row => springs%row(:, :, merge(1, 2, equations%joint(k) > 0), j))
               call add_product(springs%stiffness(j)*row, row, equations%glued(:, :, e))
            end associate
         end do
      end do
      do j = 1, size(equations%entry)
         call couple(springs, cone_t(), j, equations)
      end do
   end subroutine add_stuck_springs

   !> Motion of all blocks if every joint keeps to its face
   pure subroutine solve_faces(equations, springs, cone, face, trial, motion)
      !> Blocks assembled; matrix and factor are made again if they are not those of these faces
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Bounds of the joint forces: (n_joint)
      type(cone_t), intent(in) :: cone(:)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      !> Trial forces before the motion: (3, n_joint) [N/m]
      real(wp), intent(in) :: trial(:, :)
      !> The motion: (n_dof, n_equation); unchanged if the factor is not usable
      real(wp), intent(inout), contiguous :: motion(:, :)
      integer :: j

      call refresh(springs, equations)
      call hold_faces(equations, springs, cone, face)
      if (.not. equations%factor%usable) return
      motion = equations%load
      do j = 1, size(face)
         call add_load(springs, cone(j), face(j), trial(:, j), j, motion)
      end do
      call substitute(equations%factor, motion)
   end subroutine solve_faces

   !> Matrix and factor of these faces: changed parts are made again
   pure subroutine hold_faces(equations, springs, cone, face)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(cone_t), intent(in) :: cone(:)
      type(joint_face_t), intent(in) :: face(:)
      integer :: e, j, side

      do j = 1, size(face)
         if (holds(equations, cone(j), face(j), j)) cycle
         equations%held(j) = face(j)
         equations%held_friction(j) = cone(j)%friction
         call couple(springs, cone(j), j, equations)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e > 0) equations%changed(e) = .true.
         end do
      end do
      if (.not. any(equations%changed)) return
      do e = 1, size(equations%changed)
         if (equations%changed(e)) call add_springs(springs, cone, e, equations)
      end do
      call couple_bars(equations%bars, equations%matrix%pair, equations%matrix%coupling)
      call factorise(equations%matrix, equations%factor, equations%changed)
      equations%factorisations = equations%factorisations + 1
      equations%changed = .not. equations%factor%usable
   end subroutine hold_faces

   !> True if the matrix is that of a joint's face
   pure logical function holds(equations, cone, face, j)
      type(equations_t), intent(in) :: equations
      type(cone_t), intent(in) :: cone  !! Bounds of the joint's force
      type(joint_face_t), intent(in) :: face
      integer, intent(in) :: j          !! Number of the joint

      associate (held => equations%held(j))
         holds = face%slip == held%slip .and. (face%open(1) .eqv. held%open(1)) &
            & .and. (face%open(2) .eqv. held%open(2))
      end associate
      if (face%slip /= 0) holds = holds &
         & .and. .not. abs(cone%friction - equations%held_friction(j)) > 0.0_wp
   end function holds

   !> Stiffness between the two blocks of a joint on the face held: p R P R'
   pure subroutine couple(springs, cone, j, equations)
      type(joint_springs_t), intent(in) :: springs
      type(cone_t), intent(in) :: cone
      integer, intent(in) :: j
      type(equations_t), intent(inout) :: equations
      integer :: e, first, second

      e = equations%entry(j)
      if (e == 0) return
      first = merge(1, 2, equations%matrix%pair(1, e) == springs%equation(1, j))
      second = 3 - first
      equations%matrix%coupling(:, :, e) = 0.0_wp
      call add_product(projected(springs, cone, equations%held(j), first, j), &
         & springs%row(:, :, second, j), equations%matrix%coupling(:, :, e))
   end subroutine couple

   !> Diagonal block of one equation: the block and its springs on the faces held
   pure subroutine add_springs(springs, cone, e, equations)
      type(joint_springs_t), intent(in) :: springs
      type(cone_t), intent(in) :: cone(:)
      integer, intent(in) :: e  !! Number of the equation
      type(equations_t), intent(inout) :: equations
      integer :: first, j, k, last, side

      first = equations%first_joint(e)
      last = equations%first_joint(e + 1) - 1
      associate (joint => equations%joint(first:last))
         if (all(is_stuck(equations%held(abs(joint))))) then
            equations%matrix%diagonal(:, :, e) = equations%base(:, :, e) + equations%glued(:, :, e)
            return
         end if
         equations%matrix%diagonal(:, :, e) = equations%base(:, :, e)
         do k = 1, size(joint)
            j = abs(joint(k))
            side = merge(1, 2, joint(k) > 0)
            call add_product(projected(springs, cone(j), equations%held(j), side, j), &
               & springs%row(:, :, side, j), equations%matrix%diagonal(:, :, e))
         end do
      end associate
   end subroutine add_springs
end module dda_assembly
