!> Strain and stress of blocks from the forces that act on them: constant in a block, in balance
!> with all of them
module dda_block_strain
   use dda_block_system, only : block_system_t
   use dda_boundary, only : value_at
   use dda_contact_detection, only : contacts_t
   use dda_deformation, only : displacement_matrix
   use dda_kinds, only : wp
   use dda_loads, only : point_load
   use dda_material, only : elasticity_matrix
   use dda_settings, only : factor_of, settings_t
   implicit none
   private

   public :: strain_blocks

contains

   !> Set strains and stresses of the blocks that can move: area*stress = moment of the forces
   pure subroutine strain_blocks(settings, time, force, pin_force, contacts, system)
      type(settings_t), intent(in) :: settings
      !> Time of the histories [s]
      real(wp), intent(in) :: time
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> Forces of the held points of blocks that can move, in their order: (3, n_pin) [N/m]
      real(wp), intent(in) :: pin_force(:, :)
      !> The contacts, with rows of six unknowns
      type(contacts_t), intent(in) :: contacts
      !> The blocks; their strains and stresses are set
      type(block_system_t), intent(inout) :: system
      real(wp) :: moment(6, size(system%equation)), d(3, 3), stress(3)
      integer :: b, i, j, side

      moment = 0.0_wp
      do j = 1, size(force, 2)
         do side = 1, 2
            b = contacts%joint(j)%block(side)
            moment(:, b) = moment(:, b) + matmul(contacts%springs%row(:, :, side, j), force(:, j))
         end do
      end do
      if (allocated(settings%boundary%loaded)) then
         do i = 1, size(settings%boundary%loaded)
            associate (loaded => settings%boundary%loaded(i))
               b = loaded%block
               moment(:, b) = moment(:, b) + point_load(factor_of(settings, loaded) &
                  & *value_at(loaded%force, time), loaded%point, system%centroid(:, b))
            end associate
         end do
      end if
      call add_pins(settings, pin_force, system, moment)
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         d = elasticity_matrix(system%materials(system%material(b)))
         stress = moment(4:6, b)/system%area(b)
         system%stress(:, b) = stress
         stress = stress - system%initial_stress(:, b)
         system%motion(4:5, b) = [d(2, 2)*stress(1) - d(1, 2)*stress(2), &
            & d(1, 1)*stress(2) - d(2, 1)*stress(1)]/(d(1, 1)*d(2, 2) - d(1, 2)*d(2, 1))
         system%motion(6, b) = stress(3)/d(3, 3)
      end do
   end subroutine strain_blocks

   !> Add what held points do; one that is held along one axis is so by both of its forces
   pure subroutine add_pins(settings, pin_force, system, moment)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: pin_force(:, :)
      type(block_system_t), intent(in) :: system
      !> Forces on the unknowns of all blocks: (6, n_block)
      real(wp), intent(inout) :: moment(:, :)
      real(wp) :: t(2, 6)
      integer :: i, n

      if (.not. allocated(settings%boundary%held)) return
      n = 0
      do i = 1, size(settings%boundary%held)
         associate (held => settings%boundary%held(i), b => settings%boundary%held(i)%block)
            if (system%equation(b) == 0) cycle
            n = n + 1
            t = displacement_matrix(held%point, system%centroid(:, b))
            moment(:, b) = moment(:, b) &
               & + t(merge(1, 2, held%along(1)), :)*pin_force(1, n) &
               & + t(merge(2, 1, held%along(2)), :)*pin_force(3, n)
         end associate
      end do
   end subroutine add_pins
end module dda_block_strain
