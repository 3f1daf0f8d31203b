!> Converged states on the path of a static run, to return to
submodule (dda_forward) dda_rest
   use dda_assembly, only : renew_springs
   use dda_boundary, only : led_displacement
   use dda_load_clock, only : set_back, set_forward
   use dda_step_interval, only : longest_motion
   implicit none

   !> Free fall in a step with prescribed displacements, over these displacements: their inertia
   !> must not throw the blocks about
   real(wp), parameter :: led_fall = 1.0e4_wp
   !> Motions in one stride are smooth below this multiple of what the last stride lets expect
   real(wp), parameter :: smooth = 2.0_wp
   !> And below this share of what a step may move
   real(wp), parameter :: small = 0.2_wp

contains

   !> Whether the blocks have moved in a stride by more than the stride before lets expect
   module procedure leaps
      leaps = settings%current .and. march%moved > max(small*march%allowed_motion, &
         & smooth*march%rate*(march%clock%now - march%clock%rested))
   end procedure leaps

   !> Go on from a rest
   module procedure leave_rest
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
   end procedure leave_rest

   !> Go back to the last rest, from where the blocks do not come to rest, or have moved too far
   module procedure return_to_rest
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
   end procedure return_to_rest

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

end submodule dda_rest
