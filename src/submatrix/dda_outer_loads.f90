!> Loads from outside on all blocks at a time: weight, forces on points, a ground that shakes
!> (Shi: df09, df15, df16)
module dda_outer_loads
   use dda_block_system, only : block_system_t
   use dda_boundary, only : history_t, mean_over, value_at
   use dda_deformation, only : moved_point
   use dda_kinds, only : wp
   use dda_loads, only : body_load, point_load
   use dda_settings, only : settings_t
   implicit none
   private

   public :: outer_loads

contains

   !> Loads that change with time added to those that do not: their mean over a dynamic step, what
   !> they are at the end of a static one
   pure subroutine outer_loads(system, settings, time, dt, weight, load)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Time at the beginning of the step [s]
      real(wp), intent(in) :: time
      !> Length of the step [s]
      real(wp), intent(in) :: dt
      !> Weight of the blocks: (n_dof, n_equation)
      real(wp), intent(in) :: weight(:, :)
      !> Sum of all loads: (n_dof, n_equation)
      real(wp), intent(out) :: load(:, :)
      real(wp) :: of_block(6), centre(2), place(2), force(2), shaking(2)
      integer :: b, e, i, nd

      nd = size(load, 1)
      load = weight
      shaking = -now(settings%boundary%base_acceleration)
      if (any(abs(shaking) > 0.0_wp)) then
         do b = 1, size(system%equation)
            e = system%equation(b)
            if (e == 0) cycle
            of_block = body_load(system%density(b)*shaking, system%area(b))
            load(:, e) = load(:, e) + of_block(:nd)
         end do
      end if
      if (.not. allocated(settings%boundary%loaded)) return
      do i = 1, size(settings%boundary%loaded)
         associate (point => settings%boundary%loaded(i)%point, &
            & b => settings%boundary%loaded(i)%block)
            e = system%equation(b)
            if (e == 0) cycle
            centre = system%centroid(:, b)
            force = now(settings%boundary%loaded(i)%force)
            if (settings%current) then
               place = moved_point(point, centre, system%motion(:, b))
               of_block = point_load(force, place, centre + system%motion(1:2, b), &
                  & system%motion(:, b))
            else
               of_block = point_load(force, point, centre)
            end if
            load(:, e) = load(:, e) + of_block(:nd)
         end associate
      end do

   contains

      !> What a history is in the step
      pure function now(history) result(value)
         !> The history
         type(history_t), intent(in) :: history
         !> Components along x and y: (2)
         real(wp) :: value(2)

         if (settings%dynamic) then
            value = mean_over(history, time, time + dt)
         else
            value = value_at(history, time + dt)
         end if
      end function now
   end subroutine outer_loads
end module dda_outer_loads
