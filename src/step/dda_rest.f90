!> Converged states on the path of a static run, to return to
module dda_rest
   use dda_assembly, only : equations_t, renew_springs
   use dda_block_system, only : block_system_t
   use dda_boundary, only : led_displacement
   use dda_contact_detection, only : contacts_t
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_load_clock, only : set_back, set_forward
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   use dda_step_interval, only : longest_motion
   implicit none
   private

   public :: rest_t, leaps, leave_rest, return_to_rest

   !> The run at a rest
   type :: rest_t
      !> The blocks
      type(block_system_t) :: system
      !> The contacts
      type(contacts_t) :: contacts
      !> The march
      type(march_t) :: march
      !> Forces of the springs at held points: (n_spring) [N/m]
      real(wp), allocatable :: held_force(:)
      !> Pictures kept so far
      integer :: n_frame = 0
      !> Steps so far of which the measured points are kept
      integer :: n_track = 0
      !> Displacement or time at which the next picture is due [m or s]
      real(wp) :: due = 0.0_wp
   end type rest_t

   !> Free fall in a step with prescribed displacements, over these displacements: their inertia
   !> must not throw the blocks about
   real(wp), parameter :: led_fall = 1.0e4_wp
   !> Motions in one stride are smooth below this multiple of what the last stride lets expect
   real(wp), parameter :: smooth = 2.0_wp
   !> And below this share of what a step may move
   real(wp), parameter :: small = 0.2_wp

contains

   !> Whether the blocks have moved in a stride by more than the stride before lets expect
   pure logical function leaps(settings, march)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march

      leaps = settings%current .and. march%moved > max(small*march%allowed_motion, &
         & smooth*march%rate*(march%clock%now - march%clock%rested))
   end function leaps

   !> Go on from a rest: keep it, and let the clock stride as far as the motion of the last stride
   !> lets expect
   pure subroutine leave_rest(settings, system, contacts, equations, march, rest, album)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(equations_t), intent(in) :: equations
      type(march_t), intent(inout) :: march
      type(rest_t), allocatable, intent(inout) :: rest
      !> Pictures of the run
      type(album_t), intent(in), optional :: album
      real(wp) :: growth

      if (.not. allocated(rest)) allocate (rest)
      if (march%clock%now > march%clock%rested) &
         & march%rate = march%moved/(march%clock%now - march%clock%rested)
      rest%system = system
      rest%contacts = contacts
      rest%march = march
      rest%held_force = equations%fixed%force
      if (present(album)) then
         rest%n_frame = album%n
         rest%n_track = album%n_track
         rest%due = album%due
      end if
      growth = 2.0_wp
      if (settings%current .and. march%first_motion > 0.0_wp) growth = min(growth, &
         & 0.8_wp*longest_motion(march)/march%first_motion)
      call set_forward(growth, march%clock)
      call begin_stride(settings, march)
   end subroutine leave_rest

   !> Go back to the last rest, from where the blocks do not come to rest, or have moved too far,
   !> for a shorter stride of the clock
   pure subroutine return_to_rest(settings, rest, falls, system, contacts, equations, march, &
      & returned, album)
      type(settings_t), intent(in) :: settings
      type(rest_t), intent(in) :: rest
      !> Whether they do not come to rest
      logical, intent(in) :: falls
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march; its counts are kept
      type(march_t), intent(inout) :: march
      !> Whether there is a shorter stride; otherwise nothing is changed
      logical, intent(out) :: returned
      type(album_t), intent(inout), optional :: album
      type(march_t) :: before

      before = march
      call set_back(falls, march%clock, returned)
      if (.not. returned) return
      before%clock = march%clock
      before%steps = march%steps
      before%passes = march%passes
      march = rest%march
      march%clock = before%clock
      march%steps = before%steps
      march%passes = before%passes
      call renew_springs(contacts%springs%equation, rest%contacts%springs, equations)
      system = rest%system
      contacts = rest%contacts
      equations%fixed%force = rest%held_force
      if (present(album)) then
         album%n = rest%n_frame
         album%n_track = rest%n_track
         album%due = rest%due
      end if
      call begin_stride(settings, march)
   end subroutine return_to_rest

   !> Begin with the loads of another time
   pure subroutine begin_stride(settings, march)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(inout) :: march

      march%begun = march%steps
      march%time = march%clock%now
      march%first_motion = 0.0_wp
      march%last_acceleration = march%free_acceleration
      march%has_fallen = .false.
      if (allocated(march%last_motion)) deallocate (march%last_motion)
      call set_interval(settings, march)
   end subroutine begin_stride

   !> Length of the first static step with the loads of another time: that of the last step at rest,
   !> or longer where points are led
   pure subroutine set_interval(settings, march)
      type(settings_t), intent(in) :: settings
      !> The march, its clock gone on; the length of the next step is set
      type(march_t), intent(inout) :: march
      real(wp) :: way
      integer :: i

      way = 0.0_wp
      if (allocated(settings%boundary%held)) then
         do i = 1, size(settings%boundary%held)
            associate (path => settings%boundary%held(i)%path, clock => march%clock)
               way = max(way, norm2(led_displacement(path, clock%now) &
                  & - led_displacement(path, clock%rested)))
            end associate
         end do
      end if
      if (way > 0.0_wp .and. march%free_acceleration > 0.0_wp) &
         & march%dt = max(march%dt, sqrt(2.0_wp*led_fall*way/march%free_acceleration))
      if (.not. march%free_acceleration > 0.0_wp) march%dt = march%longest
      march%dt = min(march%longest, march%dt)
   end subroutine set_interval
end module dda_rest
