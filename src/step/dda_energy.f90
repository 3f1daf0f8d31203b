!> Energy balance of a dynamic run
module dda_energy
   use dda_block_inertia, only : damping_rate, kinetic_energy, packed_velocity
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix
   use dda_step_context, only : energy_t, run_t
   implicit none
   private

   public :: audit_t, audit_step, keep_energy

   !> Energies after each step
   type :: audit_t
      logical :: wanted = .false.               !! True if they are kept
      integer :: n = 0                          !! Steps kept
      type(energy_t), allocatable :: energy(:)  !! The energies, the first n of them
   end type audit_t

contains

   !> Energies after a step, and what it took and brought added to what the steps before did; what
   !> is left unexplained is numerical dissipation. A step of no length begins the audit
   pure subroutine audit_step(run)
      type(run_t), intent(inout) :: run  !! The run after the step, except for its energies
      real(wp) :: before

      before = total(run%march%energy)
      call store_energy(run)
      run%march%energy%time = run%march%time
      if (.not. run%step%dt > 0.0_wp) return
      call spend_energy(run)
      associate (energy => run%march%energy)
         energy%numerical = energy%numerical + before - total(energy)
      end associate
   end subroutine audit_step

   !> Energy that is in the blocks, in the springs of the joints, and in bars
   pure subroutine store_energy(run)
      type(run_t), intent(inout) :: run
      real(wp) :: d(3, 3)
      integer :: b, e

      associate (system => run%system, equations => run%equations, contacts => run%contacts, &
         & energy => run%march%energy)
         energy%kinetic = kinetic_energy(equations, &
            & packed_velocity(system, size(equations%weight, 1)))
         energy%gravity = 0.0_wp
         energy%elastic = 0.0_wp
         if (.not. run%settings%current) energy%contact = &
            & sum(sum(contacts%force**2, dim=1)/contacts%springs%stiffness)/2.0_wp
         do b = 1, size(system%equation)
            e = system%equation(b)
            if (e == 0) cycle
            d = elasticity_matrix(system%materials(system%material(b)))
            associate (motion => system%motion(:, b))
               energy%gravity = energy%gravity - dot_product(equations%weight(1:2, e), motion(1:2))
               energy%elastic = energy%elastic + system%area(b)*(dot_product(motion(4:6), &
                  & system%initial_stress(:, b) + matmul(d, motion(4:6))/2.0_wp))
            end associate
         end do
         if (allocated(system%bar)) energy%elastic = energy%elastic &
            & + sum(system%bar%force**2/run%settings%boundary%bar%stiffness)/2.0_wp
      end associate
   end subroutine store_energy

   !> Add what a step brought in and took
   pure subroutine spend_energy(run)
      type(run_t), intent(inout) :: run
      integer :: e

      associate (equations => run%equations, step => run%step, energy => run%march%energy, &
         & motion => run%step%state%motion, fixed => run%equations%fixed)
         energy%work = energy%work + sum((equations%outer - equations%weight)*motion) &
            & + dot_product(fixed%force, fixed%target)
         do e = 1, size(motion, 2)
            energy%damping = energy%damping + damping_rate(run%settings, step%dt)/step%dt &
               & *dot_product(motion(:, e), matmul(equations%mass(:, :, e), motion(:, e)))
         end do
         do e = 1, size(equations%dashpot, 3)
            energy%damping = energy%damping + dot_product(motion(:, e), &
               & matmul(equations%dashpot(:, :, e), motion(:, e)))/step%dt
         end do
         energy%friction = energy%friction - sum(step%state%force(3, :) &
            & *step%state%increment(3, :), &
            & mask=step%state%face%slip /= 0 .or. run%settings%current)
         energy%impact = energy%impact + step%impact
      end associate
   end subroutine spend_energy

   !> Sum that numerical dissipation alone changes
   pure real(wp) function total(energy)
      type(energy_t), intent(in) :: energy

      total = energy%kinetic + energy%elastic + energy%contact + energy%gravity - energy%work &
         & + energy%friction + energy%damping + energy%impact
   end function total

   !> Keep the energies after a step
   pure subroutine keep_energy(energy, audit)
      type(energy_t), intent(in) :: energy
      type(audit_t), intent(inout) :: audit  !! Receives them if they are kept

      if (.not. audit%wanted) return
      if (.not. allocated(audit%energy)) allocate (audit%energy(64))
      ! the second half is room
      if (audit%n == size(audit%energy)) audit%energy = [audit%energy, audit%energy]
      audit%n = audit%n + 1
      audit%energy(audit%n) = energy
   end subroutine keep_energy
end module dda_energy
