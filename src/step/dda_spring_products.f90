!> Products with spring rows: stiffness, load, openings and slips (Shi: df18)
module dda_spring_products
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t
   use dda_joint_matrix, only : add_row_forces, row_openings
   use dda_kinds, only : wp
   implicit none
   private

   public :: projected, add_product, add_forces, add_load, relative_displacement

contains

   !> Rows of one side of a joint, projected on its face: p R P
   pure function projected(springs, cone, face, side, j) result(steep)
      type(joint_springs_t), intent(in) :: springs
      type(cone_t), intent(in) :: cone            !! Bounds of the joint's force
      type(joint_face_t), intent(in) :: face
      integer, intent(in) :: side                 !! Side of the joint, 1 or 2
      integer, intent(in) :: j                    !! Number of the joint
      real(wp) :: steep(size(springs%row, 1), 3)  !! The projected rows: (n_dof, 3)
      real(wp) :: tangent(3, 3), constant(3)

      steep = springs%stiffness(j)*springs%row(:, :, side, j)
      if (is_stuck(face)) return
      call apply_face(cone, face, tangent, constant)
      steep = matmul(steep, tangent)
   end function projected

   !> c = c + a b' of three columns
   pure subroutine add_product(a, b, c)
      real(wp), intent(in) :: a(:, :)     !! First factor: (n, 3)
      real(wp), intent(in) :: b(:, :)     !! Second factor: (n, 3)
      real(wp), intent(inout) :: c(:, :)  !! Matrix that receives the product: (n, n)
      integer :: k

      do k = 1, size(b, 1)
         c(:, k) = c(:, k) + a(:, 1)*b(k, 1) + a(:, 2)*b(k, 2) + a(:, 3)*b(k, 3)
      end do
   end subroutine add_product

   !> Add the load of one joint: R (P z + c)
   pure subroutine add_load(springs, cone, face, trial, j, load)
      type(joint_springs_t), intent(in) :: springs
      type(cone_t), intent(in) :: cone
      type(joint_face_t), intent(in) :: face
      real(wp), intent(in) :: trial(3)       !! Its trial force before the motion: (3) [N/m]
      integer, intent(in) :: j
      real(wp), intent(inout), contiguous :: load(:, :)  !! Receives the load: (n_dof, n_equation)
      real(wp) :: tangent(3, 3), constant(3)

      constant = trial
      if (.not. is_stuck(face)) then
         call apply_face(cone, face, tangent, constant)
         constant = constant + matmul(tangent, trial + springs%shift(:, j)) - springs%shift(:, j)
      end if
      call add_row_forces(size(load, 1), 1, springs%equation(:, j:j), springs%row(:, :, :, j:j), &
         & constant, load)
   end subroutine add_load

   !> Let forces of all joints act on the blocks: add R f
   pure subroutine add_forces(springs, force, load)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in), contiguous :: force(:, :)    !! The forces: (3, n_joint) [N/m]
      real(wp), intent(inout), contiguous :: load(:, :)

      call add_row_forces(size(load, 1), size(force, 2), springs%equation, springs%row, force, &
         & load)
   end subroutine add_forces

   !> Openings and slips of the joints by a motion of the blocks
   pure function relative_displacement(springs, motion) result(increment)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in), contiguous :: motion(:, :)  !! The motion: (n_dof, n_equation)
      !> Opening at the two contacts and slip: (3, n_joint) [m]
      real(wp) :: increment(3, size(springs%equation, 2))

      call row_openings(size(motion, 1), size(increment, 2), springs%equation, springs%row, &
         & motion, increment)
   end function relative_displacement
end module dda_spring_products
