!> Whether blocks have collapsed in a dynamic run: one has turned too far, or moved too far
module dda_collapse_test
   use dda_block_system, only : block_system_t
   use dda_deformation, only : moved_point
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: has_collapsed, still_moves_away, tests_collapse

   !> Share of the duration after which a motion that is larger than before still moves away
   real(wp), parameter :: late = 0.9_wp
   !> By how much larger, over what means collapse
   real(wp), parameter :: growth = 0.01_wp

contains

   !> Whether anything means collapse in a dynamic run
   pure logical function tests_collapse(settings)
      type(settings_t), intent(in) :: settings

      tests_collapse = settings%dynamic .and. settings%current &
         & .and. (settings%collapse_rotation > 0.0_wp .or. settings%collapse_displacement > 0.0_wp)
   end function tests_collapse

   !> Whether the blocks have gone as far as means collapse; keeps how far they have
   pure subroutine has_collapsed(settings, system, march, collapsed)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> The march; receives how far the blocks have gone
      type(march_t), intent(inout) :: march
      !> Whether they have collapsed
      logical, intent(out) :: collapsed
      real(wp) :: displacement

      collapsed = .false.
      if (.not. tests_collapse(settings)) return
      march%progress = 0.0_wp
      if (settings%collapse_rotation > 0.0_wp) &
         & march%progress = maxval(abs(system%motion(3, :)))/settings%collapse_rotation
      if (settings%collapse_displacement > 0.0_wp) then
         displacement = march%displacement
         if (settings%collapse_point > 0) displacement = displacement_of_point(settings, system)
         march%progress = max(march%progress, displacement/settings%collapse_displacement)
      end if
      collapsed = march%progress >= 1.0_wp
      if (march%time <= late*settings%duration) &
         & march%early_progress = max(march%early_progress, march%progress)
   end subroutine has_collapsed

   !> Displacement of the measured point that is asked for [m]
   pure real(wp) function displacement_of_point(settings, system)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system

      associate (measured => settings%boundary%measured(settings%collapse_point))
         displacement_of_point = norm2(moved_point(measured%point, &
            & system%centroid(:, measured%block), system%motion(:, measured%block)) &
            & - measured%point)
      end associate
   end function displacement_of_point

   !> Whether the blocks are farther at the end of a run than before its last part, so that it does
   !> not say whether they come back
   pure logical function still_moves_away(settings, march)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march

      still_moves_away = .false.
      if (tests_collapse(settings)) &
         & still_moves_away = march%progress > march%early_progress + growth
   end function still_moves_away
end module dda_collapse_test
