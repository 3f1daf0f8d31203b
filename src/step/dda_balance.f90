!> Residual of equilibrium of the blocks in a step, in translation, rotation and strain
module dda_balance
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_springs_t
   use dda_contacts, only : contacts_t
   use dda_kinds, only : wp
   use dda_step_context, only : run_t, step_context_t
   use dda_step_state, only : equations_t
   use dda_vector, only : cross
   implicit none
   private

   public :: free_acceleration, gyration, is_drowned, keep_moment, measure_balance
   public :: measure_way_to_rest, rounding

   !> Load or mass of a light block over the mean
   real(wp), parameter :: light = 1.0e-2_wp
   !> Rounding of sums of joint forces, and of energies, over their terms, with a margin of ten
   real(wp), parameter :: rounding = 1.0e-12_wp
   !> Residual of the whole load over the load of a light block
   real(wp), parameter :: felt_share = 1.0e-3_wp

   !> Round-off force over the load of a block above which motion is noise
   real(wp), parameter :: noise = 10.0_wp

contains

   !> Largest acceleration that the loads would give to free blocks
   pure real(wp) function free_acceleration(system, equations)
      type(block_system_t), intent(in) :: system
      type(equations_t), intent(in) :: equations

      free_acceleration = maxval(own_load(system, equations)/equations%mass(1, 1, :))
   end function free_acceleration

   !> Sizes of the loads from outside on each block: forces, and moments over its radius of gyration
   pure function own_load(system, equations) result(own)
      type(block_system_t), intent(in) :: system
      type(equations_t), intent(in) :: equations
      real(wp) :: own(size(equations%felt, 2))  !! The loads: (n_equation) [N/m]
      integer :: b, e

      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         own(e) = norm2(equations%felt(1:2, e)) + equations%felt(3, e)/gyration(system, b)
      end do
   end function own_load

   !> True if rounded coordinates press a block with far more than its load: its contacts then have
   !> no meaning
   pure logical function is_drowned(system, contacts, equations)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts  !! The joints, placed, and their springs
      type(equations_t), intent(in) :: equations
      real(wp) :: least, own(size(equations%felt, 2)), pressed
      integer :: j, k, side

      is_drowned = .false.
      own = own_load(system, equations)
      do j = 1, size(contacts%joint)
         pressed = 0.0_wp
         do k = 1, contacts%joint(j)%n_contact
            pressed = max(pressed, dot_product(abs(contacts%place(j)%across(:, k)), &
               & abs(contacts%place(j)%point(:, k))))
         end do
         least = huge(least)
         do side = 1, 2
            associate (e => contacts%springs%equation(side, j))
               if (e > 0) least = min(least, own(e))
            end associate
         end do
         is_drowned = is_drowned .or. least > 0.0_wp &
            & .and. epsilon(pressed)*pressed*contacts%springs%stiffness(j) > noise*least
      end do
   end function is_drowned

   !> Radius of gyration of a block
   pure real(wp) function gyration(system, b)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: b  !! Number of the block

      gyration = sqrt((system%second(1, b) + system%second(2, b))/system%area(b))
   end function gyration

   !> Acceleration of a settled step, and how far it is from balance
   pure subroutine measure_balance(system, springs, equations, step)
      type(block_system_t), intent(in) :: system   !! The blocks before the step
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(in) :: equations
      type(step_context_t), intent(inout) :: step  !! The step; acceleration and residues are set
      real(wp) :: around(size(equations%felt, 1), size(equations%felt, 2))
      real(wp) :: own(size(equations%felt, 2)), acceleration, mean, residue, whole
      integer :: b, e

      around = forces_around(springs, equations, step)
      own = own_load(system, equations)
      mean = sum(own)/real(size(own), wp)
      whole = sum(abs(equations%felt(1:2, :))) + sum(abs(equations%fixed%force))
      step%acceleration = 0.0_wp
      step%residue = 0.0_wp
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         associate (motion => step%state%motion(:, e))
            acceleration = (norm2(motion(1:2)) + gyration(system, b)*abs(motion(3))) &
               & *2.0_wp/step%dt**2
         end associate
         residue = equations%mass(1, 1, e)*acceleration
         if (own(e) <= light*mean) then
            if (residue <= max(rounding*sum(around(1:2, e)), min(rounding*whole, &
               & felt_share*own(e)))) cycle
         end if
         step%acceleration = max(step%acceleration, acceleration)
         step%residue = max(step%residue, share_of(residue, own(e)))
      end do
      call measure_strain(system, equations, around, step)
   end subroutine measure_balance

   !> Forces that nothing balances at the end of a static step, and how far blocks would go until
   !> these vanish if they went on to change with the motion as in this step
   pure subroutine measure_way_to_rest(equations, step)
      type(equations_t), intent(in) :: equations
      type(step_context_t), intent(inout) :: step  !! The step; those of the last step in
      real(wp) :: unbalanced(size(equations%felt, 1), size(equations%felt, 2)), finish, start
      integer :: e

      do e = 1, size(unbalanced, 2)
         unbalanced(:, e) = matmul(equations%mass(:, :, e), step%state%motion(:, e)) &
            & *(2.0_wp/step%dt**2)
      end do
      step%way_to_rest = 0.0_wp
      if (allocated(step%unbalanced)) then
         start = sum(step%unbalanced*step%state%motion)
         finish = sum(unbalanced*step%state%motion)
         if (start > 0.0_wp) step%way_to_rest = huge(start)
         if (start > finish) step%way_to_rest = step%farthest*max(0.0_wp, finish/(start - finish))
      end if
      step%unbalanced = unbalanced
      step%is_shorter = step%dt < step%last_dt
      step%last_dt = step%dt
   end subroutine measure_way_to_rest

   !> Share of a whole that may be nothing
   elemental real(wp) function share_of(part, whole)
      real(wp), intent(in) :: part   !! Its part
      real(wp), intent(in) :: whole  !! The whole

      share_of = 0.0_wp
      if (.not. part > 0.0_wp) return
      share_of = huge(part)
      if (whole > part*tiny(part)) share_of = part/whole
   end function share_of

   !> Imbalance of strain: the largest share that the inertia of strains has of all that
   !> strains a block
   pure subroutine measure_strain(system, equations, around, step)
      type(block_system_t), intent(in) :: system
      type(equations_t), intent(in) :: equations
      !> Sizes of the forces around each block: (n_dof, n_equation)
      real(wp), intent(in) :: around(:, :)
      type(step_context_t), intent(inout) :: step  !! The step; the residue of its strains is set
      real(wp) :: own, residue
      integer :: b, e

      step%strain_residue = 0.0_wp
      if (size(around, 1) < 6) return
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         residue = maxval(abs(matmul(equations%mass(4:6, 4:6, e), step%state%motion(4:6, e)))) &
            & *2.0_wp/step%dt**2
         own = maxval(around(4:6, e) + abs(system%stress(:, b))*system%area(b))
         step%strain_residue = max(step%strain_residue, share_of(residue, own))
      end do
   end subroutine measure_strain

   !> Sizes of all forces around the blocks by their unknowns: loads from outside, forces
   !> of joints and of restrained points
   pure function forces_around(springs, equations, step) result(around)
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(in) :: equations
      type(step_context_t), intent(in) :: step
      !> The forces: (n_dof, n_equation)
      real(wp) :: around(size(equations%felt, 1), size(equations%felt, 2))
      integer :: i, j, side

      around = equations%felt
      do j = 1, size(springs%stiffness)
         do side = 1, 2
            associate (e => springs%equation(side, j))
               if (e > 0) around(:, e) = around(:, e) + matmul(abs(springs%row(:, :, side, j)), &
                  & abs(step%state%force(:, j)))
            end associate
         end do
      end do
      associate (fixed => equations%fixed)
         do i = 1, size(fixed%force)
            around(:, fixed%equation(i)) = around(:, fixed%equation(i)) &
               & + abs(fixed%row(:, i)*fixed%force(i))
         end do
      end associate
   end function forces_around

   !> Keep the angular momentum of each pair of blocks: the rows of a joint half way between turned
   !> edges may lie off one line. The two blocks give back what that brings in by one change of spin
   pure subroutine keep_moment(run, velocity)
      type(run_t), intent(in) :: run
      !> Velocities that the forces of the motion have changed: (n_dof, n_equation)
      real(wp), intent(inout) :: velocity(:, :)
      real(wp) :: change(size(velocity, 2)), half_way(6, size(run%system%area))
      integer :: j, pair(2)

      change = 0.0_wp
      half_way = (run%system%motion + run%step%after%motion)/2.0_wp
      do j = 1, size(run%contacts%joint)
         pair = run%contacts%springs%equation(:, j)
         if (any(pair == 0)) cycle
         change(pair) = change(pair) - run%step%dt*excess(run, j, half_way) &
            & /sum(run%equations%mass(3, 3, pair))
      end do
      velocity(3, :) = velocity(3, :) + change
   end subroutine keep_moment

   !> Moment of the force of a joint on both its blocks
   pure real(wp) function excess(run, j, motion)
      type(run_t), intent(in) :: run
      integer, intent(in) :: j              !! Number of the joint
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (6, n_block)
      real(wp) :: turn(3)
      integer :: b, side

      excess = 0.0_wp
      do side = 1, 2
         b = run%contacts%joint(j)%block(side)
         turn = matmul(run%contacts%springs%row(1:3, :, side, j), run%step%state%force(:, j))
         excess = excess + turn(3) + cross(run%system%centroid(:, b) + motion(1:2, b), turn(1:2))
      end do
   end function excess

end module dda_balance
