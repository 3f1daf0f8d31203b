!> What the joints see of blocks without springs between them: how these answer their forces
module dda_contact_view
   use dda_contact_types, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_small_systems, only : cholesky, solved
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: contact_view_t, see_joints, move_blocks

   !> What the joints see of one step
   type :: contact_view_t
      !> Cholesky factor of each block's equations: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: lower(:, :, :)
      !> Motion of the two blocks by a unit of each force: (n_dof, 3, 2, n_joint) [m/(N/m)]
      real(wp), allocatable :: answer(:, :, :, :)
      !> Openings and slip of the joint and its blocks by a unit of each of its forces:
      !> (3, 3, n_joint) [m/(N/m)]
      real(wp), allocatable :: give(:, :, :)
      !> How much openings and slip follow their forces: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: soft(:, :)
      !> Forces that they follow none of: (3, n_joint) [N/m]
      real(wp), allocatable :: rest(:, :)
      !> Gaps before the motion: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
   end type contact_view_t

contains

   !> How the blocks answer the forces of each joint
   pure subroutine see_joints(equations, springs, state, view)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      type(contact_view_t), intent(out) :: view
      real(wp) :: inverse(size(state%motion, 1), size(state%motion, 1), size(state%motion, 2))
      real(wp) :: unit(size(inverse, 1))
      integer :: e, j, k

      allocate (view%lower, mold=inverse)
      do e = 1, size(inverse, 3)
         view%lower(:, :, e) = cholesky(equations%base(:, :, e))
         do k = 1, size(unit)
            unit = 0.0_wp
            unit(k) = 1.0_wp
            inverse(:, k, e) = solved(view%lower(:, :, e), unit)
         end do
      end do
      allocate (view%answer, mold=springs%row)
      allocate (view%give(3, 3, size(springs%stiffness)), source=0.0_wp)
      allocate (view%gap, mold=state%trial)
      allocate (view%soft(3, size(springs%stiffness)), view%rest(3, size(springs%stiffness)), &
         & source=0.0_wp)
      if (allocated(springs%soft)) view%soft = springs%soft
      if (allocated(springs%rest)) view%rest = springs%rest
      do j = 1, size(springs%stiffness)
         do k = 1, 3
            view%give(k, k, j) = view%soft(k, j)
         end do
         view%gap(:, j) = (state%force(:, j) - state%trial(:, j))/springs%stiffness(j)
         call see_joint(springs, inverse, j, view)
      end do
   end subroutine see_joints

   !> How the blocks of one joint answer its forces
   pure subroutine see_joint(springs, inverse, j, view)
      type(joint_springs_t), intent(in) :: springs
      !> Inverse of each block's equations: (n_dof, n_dof, n_equation)
      real(wp), intent(in) :: inverse(:, :, :)
      integer, intent(in) :: j  !! Number of the joint
      type(contact_view_t), intent(inout) :: view
      real(wp) :: sum_of(3)
      integer :: c, e, k, side

      do side = 1, 2
         e = springs%equation(side, j)
         view%answer(:, :, side, j) = 0.0_wp
         if (e == 0) cycle
         associate (row => springs%row(:, :, side, j), answer => view%answer(:, :, side, j))
            do k = 1, 3
               do c = 1, size(inverse, 1)
                  answer(:, k) = answer(:, k) + inverse(:, c, e)*row(c, k)
               end do
               sum_of = 0.0_wp
               do c = 1, size(inverse, 1)
                  sum_of = sum_of + row(c, :)*answer(c, k)
               end do
               view%give(:, k, j) = view%give(:, k, j) + sum_of
            end do
         end associate
      end do
   end subroutine see_joint

   !> Motion of the blocks under given joint forces
   pure subroutine move_blocks(equations, springs, view, force, motion)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(contact_view_t), intent(in) :: view
      real(wp), intent(in) :: force(:, :)    !! Joint forces: (3, n_joint) [N/m]
      real(wp), intent(out) :: motion(:, :)  !! The motion: (n_dof, n_equation)
      integer :: e, j, side

      motion = equations%load
      do j = 1, size(force, 2)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e > 0) motion(:, e) = motion(:, e) + matmul(springs%row(:, :, side, j), force(:, j))
         end do
      end do
      do e = 1, size(motion, 2)
         motion(:, e) = solved(view%lower(:, :, e), motion(:, e))
      end do
   end subroutine move_blocks
end module dda_contact_view
