!> Springs of contacts whose forces are multipliers: stiff beside the inertia of their blocks
module dda_inertia_springs
   use dda_block_system, only : block_system_t
   use dda_kinds, only : wp
   use dda_step_context, only : run_t
   implicit none
   private

   public :: inertia_stiffness, stiffen_contacts

   !> Stiffness of springs that stand for impulses, over the inertia m/dt**2
   real(wp), parameter :: over_inertia = 1.0e3_wp

contains

   !> Stiffen the springs of contacts in time, however short the step. They have no memory of slip,
   !> which would bring in work
   pure subroutine stiffen_contacts(run)
      type(run_t), intent(inout) :: run
      integer :: j

      associate (contacts => run%contacts)
         do j = 1, size(contacts%joint)
            contacts%springs%stiffness(j) = max(contacts%springs%stiffness(j), &
               & inertia_stiffness(run%system, contacts%joint(j)%block, run%step%dt))
            contacts%trial(:, j) = contacts%force(:, j) &
               & - contacts%springs%stiffness(j)*[contacts%gap(1:2, j), 0.0_wp]
         end do
      end associate
      run%equations%new_numbers = .true.
   end subroutine stiffen_contacts

   !> Stiffness beside the inertia of the lighter of the movable blocks of a pair [N/m per m]
   pure real(wp) function inertia_stiffness(system, pair, dt) result(stiffness)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: pair(2)  !! The two blocks: (2)
      real(wp), intent(in) :: dt      !! Length of the step [s]

      stiffness = over_inertia*minval(system%density(pair)*system%area(pair), &
         & mask=system%equation(pair) > 0)/dt**2
   end function inertia_stiffness

end module dda_inertia_springs
