!> Checks of a deck that need its scene: whether its modes can run the blocks
module dda_scene_check
   use dda_deck, only : deck_t, keeps_velocities
   use dda_deck_check_case, only : check_model
   use dda_deck_scene, only : deck_scene
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_key_names, only : analysis_mode, analysis_restart, limerick_dynamic, scene_kind
   use dda_kinds, only : wp
   use dda_limerick_scene, only : check_limerick_blocks
   use dda_line_scene, only : check_line_scene, cut_lines
   use dda_read_deck, only : geometry_file
   use dda_scene, only : scene_t
   use dda_scene_doubts, only : check_live_cases, check_stages, check_start, check_support, &
      & check_widths, doubt_scene
   use dda_shape_check, only : check_shapes
   use dda_watch, only : watch_t
   implicit none
   private

   public :: check_lines, check_scene

contains

   !> Check that the modes of a deck can run the blocks of its file, and that a run that goes on has
   !> a file; warn of blocks that will fall, and of units that are no metres
   subroutine check_scene(deck, scene, error, watch)
      type(deck_t), intent(inout) :: deck
      !> The scene of the first case, if its blocks are from a file
      type(scene_t), intent(out) :: scene
      !> What cannot be run, or a file that is not there
      type(error_t), allocatable, intent(out) :: error
      !> Is told what is done
      class(watch_t), intent(inout), optional :: watch

      if (present(watch)) call watch%tell("looking for joints", -1.0_wp)
      call cut_lines(deck, error)
      if (.not. allocated(error) .and. deck%value(analysis_restart)%given) &
         & call check_start(deck, error)
      if (.not. allocated(error)) call check_shapes(deck, error)
      if (.not. allocated(error)) call check_live_cases(deck, error)
      if (allocated(error) .or. deck%value(scene_kind)%text /= "blocks") return
      call check_modes(deck, scene, error)
   end subroutine check_scene

   !> Check that the modes of a deck can run the blocks that were cut from its lines
   pure subroutine check_lines(deck, error)
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene

      if (deck%value(scene_kind)%text == "lines") call check_modes(deck, scene, error)
   end subroutine check_lines

   !> Check the first case of each mode
   pure subroutine check_modes(deck, scene, error)
      type(deck_t), intent(inout) :: deck
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: work
      integer :: number, mode
      logical :: seen(4)

      seen = .false.
      do number = 1, n_cases(deck)
         call turn_to_case(deck, number, work, error)
         if (allocated(error)) return
         mode = findloc(["static  ", "dynamic ", "limerick"] == &
            & work%value(analysis_mode)%text, .true., dim=1)
         if (mode == 3 .and. keeps_velocities(work)) mode = 4
         if (number == 1 .and. work%value(scene_kind)%text == "blocks") &
            & call deck_scene(work, scene)
         if (.not. seen(mode)) call check_mode(work, number == 1, scene, deck%warnings, error)
         seen(mode) = .true.
         if (allocated(error) .or. all(seen) .or. .not. any( &
            & deck%sweeps%parameter%key == analysis_mode &
            & .or. deck%sweeps%parameter%key == limerick_dynamic)) return
      end do
   end subroutine check_modes

   !> Check that the mode of one case can run its scene
   pure subroutine check_mode(deck, warns, scene, warnings, error)
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: warns  !! Whether doubts are told
      !> A scene of these blocks and joints, if they are from a file
      type(scene_t), intent(in) :: scene
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error

      select case (deck%value(scene_kind)%text)
      case ("lines")
         ! the analysis file may ask for velocities
         call check_model(deck, error)
         if (allocated(error)) return
         if (deck%value(analysis_mode)%text /= "limerick") call check_line_scene(deck, error)
      case ("blocks")
         if (deck%value(analysis_mode)%text == "limerick") call check_limerick_blocks( &
            & deck%plan, geometry_file(deck), keeps_velocities(deck), error)
         if (allocated(error)) return
         if (allocated(deck%plan%boundary%change)) call check_stages(deck, error)
         if (allocated(error)) return
         if (deck%value(analysis_mode)%text == "static") call check_support(deck, scene, error)
         if (.not. allocated(error)) call check_widths(deck, scene, error)
         if (deck%value(analysis_mode)%text == "static" .and. .not. allocated(error)) &
            & call check_loads(deck, scene, error)
         if (warns .and. .not. allocated(error)) call doubt_scene(deck, scene, warnings)
         if (allocated(deck%plan%boundary%absorbing) .and. .not. allocated(error) &
            & .and. deck%value(analysis_mode)%text == "static") call add_warning(warnings, &
            & "absorb has no effect: mode = 'static' has no time", geometry_file(deck), &
            & deck%plan%boundary%absorbing(1)%line)
      end select
   end subroutine check_mode

   !> Whether anything bears on the blocks of a static scene
   pure subroutine check_loads(deck, scene, error)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (any(scene%system%unit_weight > 0.0_wp)) return
      if (allocated(scene%system%initial_stress)) then
         if (any(abs(scene%system%initial_stress) > 0.0_wp)) return
      end if
      associate (boundary => scene%settings%boundary)
         if (allocated(boundary%base_acceleration%time)) return
         if (allocated(boundary%loaded)) then
            if (size(boundary%loaded) > 0) return
         end if
         if (allocated(boundary%held)) then
            do i = 1, size(boundary%held)
               if (.not. allocated(boundary%held(i)%path%value)) cycle
               if (any(abs(boundary%held(i)%path%value) > 0.0_wp)) return
            end do
         end if
      end associate
      call fatal_error(error, "expected a load, got none: load%gravity is 0, no material has a "// &
         & "unit_weight, and no point has a load or a prescribed displacement; add one", &
         & geometry_file(deck), 1)
   end subroutine check_loads
end module dda_scene_check
