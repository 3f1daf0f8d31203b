!> Static run along its time histories, from rest to rest
module dda_path_run
   use dda_assembly, only : renew_springs
   use dda_boundary, only : led_displacement
   use dda_error, only : error_t
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_load_clock, only : goes_on_at, has_path, set_back, set_forward
   use dda_settings, only : settings_t, verdict
   use dda_step_context, only : march_t, run_t
   use dda_step_interval, only : aim, longest_motion
   implicit none
   private

   public :: follow_clock

   !> Free fall per step over prescribed displacements
   real(wp), parameter :: led_fall = 1.0e4_wp
   !> Largest motion over the expected one in a smooth increment
   real(wp), parameter :: smooth = 2.0_wp
   !> Motion of a smooth increment over the permitted one
   real(wp), parameter :: small = 0.2_wp

contains

   !> Let the clock of a static run go on where the blocks are at rest before the end of its path,
   !> and back where they do not come to rest, or leap
   pure subroutine follow_clock(run, answer, error, album)
      type(run_t), intent(inout) :: run
      !> One of verdict; becomes undecided where the run goes on
      integer, intent(inout) :: answer
      type(error_t), allocatable, intent(inout) :: error
      type(album_t), intent(inout), optional :: album  !! Pictures of the run
      logical :: falls, has_leapt, returned

      if (.not. has_path(run%march%clock)) return
      has_leapt = .false.
      if (allocated(run%rest)) then
         has_leapt = leaps(run)
         falls = allocated(error) .or. answer == verdict%collapsed .or. has_leapt &
            & .or. run%march%steps - run%march%begun >= run%settings%max_steps
         returned = .false.
         if (falls .or. .not. run%step%accepted) call return_to_rest(run, falls, returned, album)
         if (returned) then
            answer = verdict%undecided
            if (allocated(error)) deallocate (error)
            return
         end if
      end if
      if (answer /= verdict%stable) return
      if (has_leapt) then
         run%march%jumps = run%march%jumps + 1
         run%march%largest_jump = max(run%march%largest_jump, run%march%moved)
      end if
      if (.not. goes_on_at(run%march%clock)) return
      answer = verdict%undecided
      call leave_rest(run, album)
   end subroutine follow_clock

   !> True if the blocks have moved in a stride by more than the stride before lets expect
   pure logical function leaps(run)
      type(run_t), intent(in) :: run

      associate (march => run%march)
         leaps = run%settings%current .and. march%moved > max(small*march%allowed_motion, &
            & smooth*march%rate*(march%clock%now - march%clock%rested))
      end associate
   end function leaps

   !> Go on from a rest: keep it, and let the clock stride as far as the motion of the last stride
   !> lets expect
   pure subroutine leave_rest(run, album)
      type(run_t), intent(inout) :: run
      type(album_t), intent(in), optional :: album
      real(wp) :: growth

      if (.not. allocated(run%rest)) allocate (run%rest)
      associate (march => run%march, rest => run%rest)
         if (march%clock%now > march%clock%rested) &
            & march%rate = march%moved/(march%clock%now - march%clock%rested)
         march%held_force = run%equations%fixed%force
         rest%state = run%run_state_t
         if (present(album)) then
            rest%n_frame = album%n
            rest%n_track = album%n_track
            rest%due = album%due
         end if
         growth = 2.0_wp
         if (run%settings%current .and. march%first_motion > 0.0_wp) growth = min(growth, &
            & aim*longest_motion(march)/march%first_motion)
         call set_forward(growth, march%clock)
      end associate
      call begin_stride(run)
   end subroutine leave_rest

   !> Go back to the last rest, from where the blocks do not come to rest, or have moved too far,
   !> for a shorter stride of the clock
   pure subroutine return_to_rest(run, falls, returned, album)
      type(run_t), intent(inout) :: run  !! The run; its counts are kept
      logical, intent(in) :: falls       !! True if they do not come to rest
      !> True if there is a shorter stride; otherwise nothing is changed
      logical, intent(out) :: returned
      type(album_t), intent(inout), optional :: album
      type(march_t) :: march

      call set_back(falls, run%march%clock, returned)
      if (.not. returned) return
      associate (rest => run%rest)
         march = rest%state%march
         march%clock = run%march%clock
         march%steps = run%march%steps
         march%passes = run%march%passes
         call renew_springs(run%contacts%springs%equation, rest%state%contacts%springs, &
            & run%equations)
         run%run_state_t = rest%state
         run%march = march
         run%equations%fixed%force = march%held_force
         if (present(album)) then
            album%n = rest%n_frame
            album%n_track = rest%n_track
            album%due = rest%due
         end if
      end associate
      call begin_stride(run)
   end subroutine return_to_rest

   !> Begin with the loads of another time
   pure subroutine begin_stride(run)
      type(run_t), intent(inout) :: run

      associate (march => run%march)
         march%begun = march%steps
         march%time = march%clock%now
         march%first_motion = 0.0_wp
         march%last_acceleration = march%free_acceleration
         march%has_fallen = .false.
         march%expected_rest = 0.0_wp
         if (allocated(march%last_motion)) deallocate (march%last_motion)
         if (allocated(run%step%unbalanced)) deallocate (run%step%unbalanced)
         if (allocated(run%onset)) deallocate (run%onset, run%onset_motion)
         call set_interval(run%settings, march)
      end associate
   end subroutine begin_stride

   !> Length of the first static step with the loads of another time: that of the last step at rest,
   !> or longer where displacements are prescribed
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

end module dda_path_run
