!> Products with spring rows: stiffness, load, openings and slips (Shi: df18)
module dda_spring_products
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t
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
      real(wp), intent(inout) :: c(:, :)  !! What the product is added to: (n, n)
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
      real(wp), intent(inout) :: load(:, :)  !! Receives the load: (n_dof, n_equation)
      real(wp) :: tangent(3, 3), constant(3)

      constant = trial
      if (.not. is_stuck(face)) then
         call apply_face(cone, face, tangent, constant)
         constant = constant + matmul(tangent, trial + springs%shift(:, j)) - springs%shift(:, j)
      end if
      call add_force(springs, constant, j, load)
   end subroutine add_load

   !> Let forces of all joints act on the blocks: add R f
   pure subroutine add_forces(springs, force, load)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: force(:, :)    !! The forces: (3, n_joint) [N/m]
      real(wp), intent(inout) :: load(:, :)
      integer :: j

      do j = 1, size(force, 2)
         call add_force(springs, force(:, j), j, load)
      end do
   end subroutine add_forces

   !> Let the force of one joint act on its blocks
   pure subroutine add_force(springs, force, j, load)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: force(3)       !! The force: (3) [N/m]
      integer, intent(in) :: j
      real(wp), intent(inout) :: load(:, :)
      integer :: c, e, side

      if (.not. any(abs(force) > 0.0_wp)) return
      do side = 1, 2
         e = springs%equation(side, j)
         if (e == 0) cycle
         ! blocks have 3 or 6 unknowns: three at a time, so that the compiler knows the length
         do c = 1, size(load, 1), 3
            load(c:c + 2, e) = load(c:c + 2, e) + springs%row(c:c + 2, 1, side, j)*force(1) &
               & + springs%row(c:c + 2, 2, side, j)*force(2) &
               & + springs%row(c:c + 2, 3, side, j)*force(3)
         end do
      end do
   end subroutine add_force

   !> Openings and slips of the joints by a motion of the blocks
   pure function relative_displacement(springs, motion) result(increment)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: motion(:, :)  !! The motion: (n_dof, n_equation)
      !> Opening at the two contacts and slip: (3, n_joint) [m]
      real(wp) :: increment(3, size(springs%equation, 2))
      real(wp) :: seen(3)
      integer :: c, e, j, k, side

      do j = 1, size(springs%equation, 2)
         seen = 0.0_wp
         do side = 1, 2
            e = springs%equation(side, j)
            if (e == 0) cycle
            do c = 1, size(motion, 1), 3
               do k = 1, 3
                  seen(k) = seen(k) + springs%row(c, k, side, j)*motion(c, e) &
                     & + springs%row(c + 1, k, side, j)*motion(c + 1, e) &
                     & + springs%row(c + 2, k, side, j)*motion(c + 2, e)
               end do
            end do
         end do
         increment(:, j) = seen
      end do
   end function relative_displacement
end module dda_spring_products
