!> The contact problem of one group of moving blocks
!>
!>    A d = load + R f,   u = gap + R' d + C f,   n = f + tension
!>
!>    n1, n2 >= 0, u1, u2 >= 0, n1 u1 = n2 u2 = 0,   |T| <= limit + friction (n1 + n2), T against u3
!>
!> A is block diagonal: forces alone couple the blocks. d is a motion, or speeds
!> times the length of the step. C is the compliance of bars, and 0 of contacts.
!>
!> Equation (M5) of docs/method.md
module dda_contact_problem
   use dda_contact_types, only : joint_springs_t
   use dda_coulomb_interior, only : coulomb_problem_t
   use dda_friction_cone, only : cone_t, shear_bound
   use dda_joint_matrix, only : add_row_forces, row_openings
   use dda_kinds, only : wp
   use dda_small_systems, only : cholesky, solved
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: contact_problem_t, pose_contacts, openings, move_blocks, residual_of, residual_t
   public :: admissible, find_answers, speed_of

   !> Joints and blocks of a group; the blocks are numbered as they come here. The parent's gaps and
   !> compliance are those of an interior point about given forces
   type, extends(coulomb_problem_t) :: contact_problem_t
      !> Numbers of the joints: (n_joint)
      integer, allocatable :: joint(:)
      !> Equations of the blocks: (n_block)
      integer, allocatable :: equation(:)
      !> Openings without motion and forces: (3, n_joint) [m]
      real(wp), allocatable :: apart(:, :)
      !> Compliance of bars, 0 of contacts: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: bar_give(:, :)
      !> Bounds of the joint forces: (n_joint)
      type(cone_t), allocatable :: cone(:)
      !> Cholesky factor of the matrix of each block: (n_dof, n_dof, n_block)
      real(wp), allocatable :: lower(:, :, :)
      !> Openings and slip by a unit of each of the joint's own forces: (3, 3, n_joint) [m/(N/m)]
      real(wp), allocatable :: give(:, :, :)
      !> Gap that rounding can make: it asks for no force, which could grow without end [m]
      real(wp) :: noise = 0.0_wp
   end type contact_problem_t

   !> Residual of forces against the law of contact
   type :: residual_t
      real(wp) :: opening = 0.0_wp  !! The largest opening, or slip, that is against it [m]
      integer :: joint = 0          !! Its joint, as numbered in the group; 0 if there is none
      !> Energy of all, as springs as soft as the blocks: where many residuals are small, it
      !> separates nearer forces from farther ones [J/m]
      real(wp) :: energy = 0.0_wp
   end type residual_t

   !> Round-off of speeds over that of gaps, times the step
   real(wp), parameter :: of_speeds = 1.0e-2_wp

contains

   !> The problem of some joints. Where these are all, the rows are lent to it
   pure subroutine pose_contacts(equations, springs, state, joint, p)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(inout) :: springs  !! Rows and bounds of all joints
      type(step_state_t), intent(in) :: state
      integer, intent(in) :: joint(:)  !! Numbers of the joints, rising: (n)
      type(contact_problem_t), intent(out) :: p
      integer :: n_dof

      n_dof = size(springs%row, 1)
      ! strain that follows its load has no part in impulses
      if (.not. any(abs(springs%row(4:, :, :, joint)) > 0.0_wp)) n_dof = 3
      allocate (p%joint, source=joint)
      allocate (p%block(2, size(joint)))
      call number_blocks(springs, size(equations%load, 2), p)
      p%base = equations%base(:n_dof, :n_dof, p%equation)
      p%load = equations%load(:n_dof, p%equation)
      if (size(joint) == size(springs%stiffness) .and. n_dof == size(springs%row, 1)) then
         call move_alloc(springs%row, p%row)
      else
         p%row = springs%row(:n_dof, :, :, joint)
      end if
      p%shift = springs%shift(:, joint)
      p%cone = springs%cone(joint)
      p%friction = p%cone%friction
      p%limit = p%cone%limit
      p%noise = state%fineness*equations%gap_noise
      if (state%rates) p%noise = of_speeds*p%noise
      p%apart = state%gap(:, joint)
      allocate (p%bar_give, mold=p%apart)
      p%bar_give = 0.0_wp
      if (allocated(springs%soft)) then
         p%bar_give = springs%soft(:, joint)
         p%apart = p%apart - p%bar_give*springs%rest(:, joint)
      end if
      call see_blocks(p)
   end subroutine pose_contacts

   !> Number the blocks of the joints as these come
   pure subroutine number_blocks(springs, n_equation, p)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_equation            !! Movable blocks in all
      type(contact_problem_t), intent(inout) :: p  !! The problem; equations and blocks are set
      integer :: e, i, side, number(0:n_equation), equation(2*size(p%joint))

      number = 0
      e = 0
      do i = 1, size(p%joint)
         do side = 1, 2
            associate (global => springs%equation(side, p%joint(i)))
               if (global > 0 .and. number(global) == 0) then
                  e = e + 1
                  number(global) = e
                  equation(e) = global
               end if
               p%block(side, i) = number(global)
            end associate
         end do
      end do
      p%equation = equation(:e)
   end subroutine number_blocks

   !> Factors of the blocks' matrices, and compliance of the blocks at the joints
   pure subroutine see_blocks(p)
      type(contact_problem_t), intent(inout) :: p
      real(wp), allocatable :: answer(:, :, :, :)
      integer :: b, i, k, side

      allocate (p%lower, mold=p%base)
      do b = 1, size(p%equation)
         p%lower(:, :, b) = cholesky(p%base(:, :, b))
      end do
      call find_answers(p, answer)
      allocate (p%give(3, 3, size(p%joint)), source=0.0_wp)
      do i = 1, size(p%joint)
         do k = 1, 3
            p%give(k, k, i) = p%bar_give(k, i)
         end do
         do side = 1, 2
            if (p%block(side, i) > 0) call add_give(size(answer, 1), p%row(:, :, side, i), &
               & answer(:, :, side, i), p%give(:, :, i))
         end do
      end do
   end subroutine see_blocks

   !> Motion of the two blocks of each joint by a unit of each force
   pure subroutine find_answers(p, answer)
      type(contact_problem_t), intent(in) :: p
      !> The motion, 0 of what is fixed: (n_dof, 3, 2, n_joint) [m/(N/m)]
      real(wp), allocatable, intent(out) :: answer(:, :, :, :)
      real(wp) :: unit(size(p%base, 1)), inverse(size(unit), size(unit), size(p%equation))
      integer :: b, i, k, side

      do b = 1, size(p%equation)
         do k = 1, size(unit)
            unit = 0.0_wp
            unit(k) = 1.0_wp
            inverse(:, k, b) = solved(p%lower(:, :, b), unit)
         end do
      end do
      allocate (answer(size(unit), 3, 2, size(p%joint)), source=0.0_wp)
      do i = 1, size(p%joint)
         do side = 1, 2
            b = p%block(side, i)
            if (b > 0) call add_answer(size(unit), inverse(:, :, b), p%row(:, :, side, i), &
               & answer(:, :, side, i))
         end do
      end do
   end subroutine find_answers

   !> Motion of one block by a unit of each force
   pure subroutine add_answer(n_dof, inverse, row, answer)
      integer, intent(in) :: n_dof                   !! Unknowns of a block
      real(wp), intent(in) :: inverse(n_dof, n_dof)  !! Inverse of its matrix
      real(wp), intent(in) :: row(n_dof, 3)          !! Rows of the joint for its unknowns
      real(wp), intent(inout) :: answer(n_dof, 3)    !! Receives the motion
      integer :: c, k

      do k = 1, 3
         do c = 1, n_dof
            answer(:, k) = answer(:, k) + inverse(:, c)*row(c, k)
         end do
      end do
   end subroutine add_answer

   !> Compliance of one block at a joint
   pure subroutine add_give(n_dof, row, answer, give)
      integer, intent(in) :: n_dof
      real(wp), intent(in) :: row(n_dof, 3), answer(n_dof, 3)
      real(wp), intent(inout) :: give(3, 3)  !! Receives openings and slip by the block's motion
      integer :: c, i, k

      do k = 1, 3
         do i = 1, 3
            do c = 1, n_dof
               give(i, k) = give(i, k) + row(c, i)*answer(c, k)
            end do
         end do
      end do
   end subroutine add_give

   !> Openings and slips by forces and the motion that they make
   pure function openings(p, force, motion)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)  !! Forces of the joints: (3, n_joint) [N/m]
      !> Motion of the blocks: (n_dof, n_block) [m]
      real(wp), intent(in), contiguous :: motion(:, :)
      real(wp) :: openings(3, size(p%joint))  !! The openings: (3, n_joint) [m]

      call row_openings(size(motion, 1), size(p%joint), p%block, p%row, motion, openings)
      openings = openings + p%apart + p%bar_give*force
   end function openings

   !> Motion of the blocks by forces
   pure function move_blocks(p, force) result(motion)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in), contiguous :: force(:, :)       !! The forces: (3, n_joint) [N/m]
      real(wp) :: motion(size(p%load, 1), size(p%load, 2))  !! The motion: (n_dof, n_block) [m]
      integer :: b

      motion = p%load
      call add_row_forces(size(motion, 1), size(p%joint), p%block, p%row, force, motion)
      do b = 1, size(motion, 2)
         motion(:, b) = solved(p%lower(:, :, b), motion(:, b))
      end do
   end function move_blocks

   !> Openings against the law of contact: each force, pushed by its opening over
   !> what the blocks give to it and taken back into its bounds, would stay the same
   pure type(residual_t) function residual_of(p, force, motion) result(residual)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)   !! Forces within their bounds: (3, n_joint) [N/m]
      real(wp), intent(in) :: motion(:, :)  !! Their motion: (n_dof, n_block) [m]
      real(wp) :: bound, change(3), opening(3, size(p%joint)), normal(3)
      integer :: i, k

      opening = openings(p, force, motion)
      do i = 1, size(p%joint)
         normal = force(:, i) + p%shift(:, i)
         change = 0.0_wp
         do k = 1, 2
            if (p%give(k, k, i) > 0.0_wp) change(k) = max(0.0_wp, abs(min(opening(k, i), &
               & p%give(k, k, i)*normal(k))) - p%noise)
         end do
         if (p%give(3, 3, i) > 0.0_wp) then
            bound = shear_bound(p%cone(i), normal)
            associate (pushed => force(3, i) - opening(3, i)/p%give(3, 3, i))
               change(3) = p%give(3, 3, i)*abs(force(3, i) - max(-bound, min(bound, pushed)))
            end associate
         end if
         do k = 1, 3
            if (change(k) > 0.0_wp) &
               & residual%energy = residual%energy + change(k)**2/(2.0_wp*p%give(k, k, i))
         end do
         if (maxval(change) <= residual%opening) cycle
         residual%opening = maxval(change)
         residual%joint = i
      end do
   end function residual_of

   !> The nearest forces within the bounds, shear last: what it bears follows from the normal forces
   pure function admissible(p, force) result(within)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)
      real(wp) :: within(3, size(p%joint))  !! The forces: (3, n_joint) [N/m]
      real(wp) :: bound
      integer :: i, k

      do i = 1, size(p%joint)
         associate (f => within(:, i), shift => p%shift(:, i))
            f = force(:, i)
            do k = 1, 2
               f(k) = merge(max(-shift(k), f(k)), 0.0_wp, p%give(k, k, i) > 0.0_wp)
            end do
            bound = shear_bound(p%cone(i), f + shift)
            f(3) = merge(max(-bound, min(bound, f(3))), 0.0_wp, p%give(3, 3, i) > 0.0_wp)
         end associate
      end do
   end function admissible

   !> The fastest block of a motion, by its translation, and by rotation at its radius of gyration
   pure real(wp) function speed_of(p, motion)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: motion(:, :)
      integer :: b

      speed_of = 0.0_wp
      do b = 1, size(motion, 2)
         speed_of = max(speed_of, norm2(motion(1:2, b)) &
            & + abs(motion(3, b))*sqrt(p%base(3, 3, b)/p%base(1, 1, b)))
      end do
   end function speed_of

end module dda_contact_problem
