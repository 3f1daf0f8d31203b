!> Blocks that stand still in time: what balances and does not move needs no new step
!>
!> With every velocity zero and loads that the contact forces at hand balance, no motion is what the
!> equations of a step ask for, and its end is its beginning.
submodule (dda_step) dda_standstill
   use dda_block_inertia, only : assemble_blocks
   use dda_friction_cone, only : joint_face_t
   use dda_spring_products, only : add_load
   implicit none

   !> Speed that may be noise of contact forces, over what free fall makes in a step
   real(wp), parameter :: slow = 1.0e-3_wp
   !> Speed that finer contact forces leave of it, over the same
   real(wp), parameter :: no_speed = 1.0e-7_wp
   !> Acceleration that a block in balance has left, over that of free fall
   real(wp), parameter :: balanced = 1.0e-9_wp

contains

   !> Whether all blocks move so slowly that this may be what contact forces leave
   module procedure is_slow
      real(wp) :: least
      integer :: e

      is_slow = .false.
      least = merge(no_speed, slow, finer)*run%march%free_acceleration*run%march%dt
      associate (mass => run%equations%mass)
         do e = 1, size(velocity, 2)
            if (dot_product(velocity(:, e), matmul(mass(:, :, e), velocity(:, e))) &
               & > least**2*mass(1, 1, e)) return
         end do
      end associate
      is_slow = .true.
   end procedure is_slow

   !> Length of a step in which rounding of gaps moves blocks less than forces that are not
   module procedure balancing_time
      time = 0.0_wp
      if (run%march%free_acceleration > 0.0_wp) time = sqrt(8.0_wp*run%equations%gap_noise &
         & /(balanced*run%march%free_acceleration))
   end procedure balancing_time

   !> Whether no block moves and the contact forces at hand balance the loads of the coming step
   module procedure stands_still
      real(wp) :: left(size(run%equations%load, 1), size(run%equations%load, 2))
      integer :: b, e, i, j

      still = .false.
      do b = 1, size(run%system%equation)
         if (run%system%equation(b) > 0 .and. any(abs(run%system%velocity(:, b)) > 0.0_wp)) return
      end do
      call assemble_blocks(run%system, run%settings, run%march%dt, run%equations, run%march%time)
      left = run%equations%load
      associate (contacts => run%contacts, mass => run%equations%mass)
         do j = 1, size(contacts%joint)
            call add_load(contacts%springs, contacts%springs%cone(j), joint_face_t(), &
               & contacts%force(:, j), j, left)
         end do
         do e = 1, size(left, 2)
            do i = 1, size(left, 1)
               if (abs(left(i, e)) > balanced*run%march%free_acceleration &
                  & *sqrt(mass(1, 1, e)*mass(i, i, e))) return
            end do
         end do
      end associate
      still = .true.
   end procedure stands_still

   !> A step in which nothing moves
   module procedure stand_still
      associate (step => run%step)
         run%contacts%increment = 0.0_wp
         step%dt = run%march%dt
         step%state%increment = run%contacts%increment
         step%state%force = run%contacts%force
         step%state%settled = .true.
         step%velocity = step%state%motion
         step%has_velocity = .true.
         step%mean_force = run%contacts%force
         step%held_mean_force = run%equations%fixed%force
         step%impact = 0.0_wp
         step%farthest = 0.0_wp
         step%acceleration = 0.0_wp
         step%whole = .true.
      end associate
   end procedure stand_still

end submodule dda_standstill
