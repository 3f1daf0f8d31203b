!> External loads on all blocks at a time: self-weight, point forces, ground motion (Shi: df09,
!> df15, df16)
module dda_outer_loads
   use dda_block_system, only : block_system_t
   use dda_boundary, only : history_t, mean_over, value_at
   use dda_deformation, only : moved_point
   use dda_kinds, only : wp
   use dda_settings, only : factor_of, settings_t
   use dda_submatrices, only : body_load, point_load
   implicit none
   private

   public :: outer_loads

contains

   !> Sum of constant and time-dependent loads: mean values over a dynamic step, values at the given
   !> time of a static step
   pure subroutine outer_loads(system, settings, time, dt, weight, load, magnitude)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      !> Time at the beginning of a dynamic step; time of the loads in a static step [s]
      real(wp), intent(in) :: time
      real(wp), intent(in) :: dt                !! Length of the step [s]
      real(wp), intent(in) :: weight(:, :)      !! Weight of the blocks: (n_dof, n_equation)
      real(wp), intent(out) :: load(:, :)       !! Sum of all loads: (n_dof, n_equation)
      real(wp), intent(out) :: magnitude(:, :)  !! Sum of their absolute values: (n_dof, n_equation)
      real(wp) :: force(2), of_block(6), shaking(2)
      integer :: b, e, i, nd

      nd = size(load, 1)
      load = weight
      magnitude = abs(weight)
      shaking = -now(settings%boundary%base_acceleration)
      if (any(abs(shaking) > 0.0_wp)) then
         do b = 1, size(system%equation)
            e = system%equation(b)
            if (e == 0) cycle
            of_block = body_load(system%density(b)*shaking, system%area(b))
            load(:, e) = load(:, e) + of_block(:nd)
            magnitude(:, e) = magnitude(:, e) + abs(of_block(:nd))
         end do
      end if
      if (.not. allocated(settings%boundary%loaded)) return
      do i = 1, size(settings%boundary%loaded)
         associate (loaded => settings%boundary%loaded(i), &
            & centre => system%centroid(:, settings%boundary%loaded(i)%block))
            e = system%equation(loaded%block)
            if (e == 0) cycle
            force = factor_of(settings, loaded)*now(loaded%force)
            if (settings%current) then
               associate (motion => system%motion(:, loaded%block))
                  of_block = point_load(force, moved_point(loaded%point, centre, motion), &
                     & centre + motion(1:2), motion)
               end associate
            else
               of_block = point_load(force, loaded%point, centre)
            end if
            load(:, e) = load(:, e) + of_block(:nd)
            magnitude(:, e) = magnitude(:, e) + abs(of_block(:nd))
         end associate
      end do

   contains

      !> Value of a history in this step
      pure function now(history) result(value)
         type(history_t), intent(in) :: history
         real(wp) :: value(2)  !! Components along x and y: (2)

         if (settings%dynamic) then
            value = mean_over(history, time, time + dt)
         else
            value = value_at(history, max(0.0_wp, time))
         end if
      end function now
   end subroutine outer_loads
end module dda_outer_loads
