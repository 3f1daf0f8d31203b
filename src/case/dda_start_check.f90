!> Checks of restart files and of the points of live loads
submodule (dda_scene_check) dda_start_check
   use dda_deck, only : deck_error, file_beside, key_error, place_of, source_of
   use dda_deck_keys, only : deck_key
   use dda_key_names, only : live_group, load_displacement_factor, load_load_factor, &
      & search_parameter, support_left_dx, support_right_rotation_deg, vehicle_group
   use dda_key_value, only : deck_place_t
   use dda_live_loads, only : bears_live, check_live_points
   use dda_restart, only : check_restart, load_restart
   use dda_step_context, only : march_t
   implicit none

contains

   !> Check the file that a run goes on from
   module procedure check_start
      character(len=:), allocatable :: name
      type(scene_t) :: begun
      type(march_t) :: march
      logical :: exists

      name = deck%value(analysis_restart)%text
      inquire (file=file_beside(deck, name), exist=exists)
      if (.not. exists) then
         call key_error(error, "there is no restart file '"//name//"'; check the name", deck, &
            & analysis_restart)
      else if (n_cases(deck) == 1) then
         call deck_scene(deck, scene)
         begun = scene
         call load_restart(file_beside(deck, name), begun%settings, begun%system, &
            & begun%contacts, march, error)
      else
         call check_restart(file_beside(deck, name), error)
      end if
   end procedure check_start

   !> Check that live loads act on blocks that move
   module procedure check_live_cases
      type(deck_place_t) :: place
      type(deck_t) :: work
      logical :: points, reshaped
      integer :: number

      place = factor_place(deck, load_displacement_factor)
      if (place%line > 0 .and. .not. leads_points(deck)) call deck_error(error, &
         & "load%displacement_factor needs a prescribed displacement, got " &
         & //"none; add &support or a displacement line of a file of blocks", deck, place)
      if (allocated(error)) return
      place = factor_place(deck, load_load_factor)
      points = has_group(deck, live_group) .or. has_group(deck, vehicle_group)
      if (place%line == 0 .and. .not. points) return
      reshaped = any(deck_key(deck%sweeps%parameter%key)%group == "arch" &
         & .or. deck_key(deck%sweeps%parameter%key)%group == "fill")
      do number = 1, size(chosen)
         if (.not. chosen(number)) cycle
         call turn_to_case(deck, number, work, error)
         if (allocated(error)) return
         if (place%line > 0 .and. .not. bears_live(work)) then
            call deck_error(error, "load%load_factor needs a live load, got none; add "// &
               & "&live, a live line of a file of blocks, or load%live_horizontal", deck, place)
         else if (points) then
            if (reshaped .or. .not. allocated(scene%contacts%joint)) call deck_scene(work, scene)
            call check_live_points(work, scene, error)
         end if
         if (allocated(error)) return
      end do
   end procedure check_live_cases

   !> True if the deck prescribes displacements
   pure logical function leads_points(deck)
      type(deck_t), intent(in) :: deck
      integer :: i

      leads_points = source_of(deck) == "shape" &
         & .and. any(deck%value(support_left_dx:support_right_rotation_deg)%given)
      if (.not. allocated(deck%plan%boundary%held)) return
      do i = 1, size(deck%plan%boundary%held)
         associate (path => deck%plan%boundary%held(i)%path)
            if (allocated(path%value)) leads_points = leads_points &
               & .or. any(abs(path%value) > 0.0_wp)
         end associate
      end do
   end function leads_points

   !> Where a factor is given, swept or searched
   pure type(deck_place_t) function factor_place(deck, key) result(place)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of its key in the registry
      integer :: s

      if (deck%value(key)%given) place = deck%value(key)%place
      do s = 1, size(deck%sweeps)
         if (deck%sweeps(s)%parameter%key == key) place = deck%sweeps(s)%place
      end do
      if (deck%searched%key == key) place = place_of(deck, search_parameter)
   end function factor_place
end submodule dda_start_check
