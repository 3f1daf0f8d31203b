!> Load clock of a static run: loads, prescribed displacements and ground motion
!>
!> A history is a path from its beginning to its end, whatever the lengths of the steps. The clock
!> goes on when the blocks are at rest, stands still until they are again, and goes back to the last
!> rest for a shorter stride where they do not come to rest. Prescribed displacements at time 0 are
!> applied in the second before the histories begin.
module dda_load_clock
   use dda_kinds, only : wp
   use dda_load_stations, only : history_times, leads_at_once
   use dda_settings, only : settings_t
   implicit none
   private

   public :: load_clock_t, new_load_clock, has_path, goes_on_at, set_forward, set_back

   !> The clock
   type :: load_clock_t
      !> Times at which the path begins, bends and ends, ascending; one where nothing is live:
      !> (n) [s]
      real(wp), allocatable :: bend(:)
      real(wp) :: now = 0.0_wp           !! Time of the loads in this step [s]
      real(wp) :: rested = 0.0_wp        !! Time at which the blocks were last at rest [s]
      real(wp) :: stride = huge(1.0_wp)  !! Time to go on from there [s]
      !> Earliest time at which they are known not to come to rest [s]
      real(wp) :: fails = huge(1.0_wp)
      !> True if a first step at a new time that does not converge, or moves too far, needs a
      !> shorter stride
      logical :: tries = .false.
   end type load_clock_t

   !> Strides of the whole path, at the least
   real(wp), parameter :: n_strides = 16.0_wp
   !> Shortest increment over a leg of the path
   real(wp), parameter :: shortest = 2.0_wp**(-14)
   !> Factor within which an increment is the shortest
   real(wp), parameter :: barely_longer = 1.001_wp

contains

   !> The clock of a static run at the beginning of its path
   pure type(load_clock_t) function new_load_clock(settings) result(clock)
      type(settings_t), intent(in) :: settings
      real(wp), allocatable :: time(:)
      integer :: first

      allocate (time, source=history_times(settings))
      first = merge(-1, 0, leads_at_once(settings))
      allocate (clock%bend(size(time) + 1 - first), source=0.0_wp)
      clock%bend(1) = real(first, wp)
      clock%bend(2 - first:) = time
      clock%now = clock%bend(1)
      clock%rested = clock%now
   end function new_load_clock

   !> True if anything is live
   pure logical function has_path(clock)
      type(load_clock_t), intent(in) :: clock

      has_path = .false.
      if (allocated(clock%bend)) has_path = size(clock%bend) > 1
   end function has_path

   !> True if the path goes on where the clock is
   pure logical function goes_on_at(clock)
      type(load_clock_t), intent(in) :: clock

      goes_on_at = .false.
      if (has_path(clock)) goes_on_at = clock%now < clock%bend(size(clock%bend))
   end function goes_on_at

   !> Go on from a rest
   pure subroutine set_forward(growth, clock)
      real(wp), intent(in) :: growth  !! By what the stride grows, or shrinks
      type(load_clock_t), intent(inout) :: clock

      if (clock%now >= clock%fails) clock%fails = huge(1.0_wp)
      clock%rested = clock%now
      if (clock%stride < huge(1.0_wp)) clock%stride = growth*clock%stride
      call set_now(clock)
   end subroutine set_forward

   !> Go back to the last rest, for a stride half as long; there is none where the stride is the
   !> shortest already
   pure subroutine set_back(falls, clock, shorter)
      logical, intent(in) :: falls     !! True if the blocks do not come to rest at the present time
      type(load_clock_t), intent(inout) :: clock
      logical, intent(out) :: shorter  !! True if there is a shorter stride

      ! rounding must not take the shortest for a longer one
      shorter = clock%now - clock%rested > barely_longer*shortest*leg_length(clock)
      if (.not. shorter) return
      if (falls) clock%fails = clock%now
      clock%stride = (clock%now - clock%rested)/2.0_wp
      call set_now(clock)
   end subroutine set_back

   !> The time to which the stride leads: no farther than the next bend, and half the way to where
   !> the blocks are known to fall
   pure subroutine set_now(clock)
      type(load_clock_t), intent(inout) :: clock
      real(wp) :: least, leg
      integer :: n_leg

      leg = leg_length(clock)
      least = shortest*leg
      n_leg = size(clock%bend) - 1
      clock%stride = max(least, min(clock%stride, leg*min(1.0_wp, real(n_leg, wp)/n_strides)))
      clock%now = min(clock%rested + clock%stride, clock%bend(leg_of(clock) + 1))
      if (clock%fails - clock%rested > least) then
         clock%now = min(clock%now, clock%rested + (clock%fails - clock%rested)/2.0_wp)
      else
         clock%now = min(clock%now, clock%fails)
      end if
      clock%tries = clock%now - clock%rested > barely_longer*least
   end subroutine set_now

   !> Number of the leg that begins, or goes on, at the last rest
   pure integer function leg_of(clock)
      type(load_clock_t), intent(in) :: clock

      leg_of = min(count(clock%bend <= clock%rested), size(clock%bend) - 1)
   end function leg_of

   !> Length of that leg [s]
   pure real(wp) function leg_length(clock)
      type(load_clock_t), intent(in) :: clock

      leg_length = clock%bend(leg_of(clock) + 1) - clock%bend(leg_of(clock))
   end function leg_length
end module dda_load_clock
