!> Actions on points of the blocks and their time histories (Shi: df09)
module dda_boundary
   use dda_bar, only : bar_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: absorbing_point_t, boundary_t, bounded_force_t, held_point_t, history_t
   public :: loaded_point_t, measured_point_t, stage_change_t, stage_times, present_at
   public :: constant_history, held_at_start, led_displacement, mean_over, rate_at
   public :: records_before, value_at

   !> A vector as a function of time: linear between the given times, constant before the first and
   !> after the last; zero if unallocated
   type :: history_t
      real(wp), allocatable :: time(:)      !! The times, increasing: (n) [s]
      real(wp), allocatable :: value(:, :)  !! Components along x and y at these times: (2, n)
   end type history_t

   !> A restrained point of a block, with or without a prescribed displacement
   type :: held_point_t
      integer :: block = 0           !! Number of the block
      real(wp) :: point(2) = 0.0_wp  !! Coordinates in the reference shape: (2) [m]
      logical :: along(2) = .true.   !! True if restrained along x and along y: (2)
      type(history_t) :: path        !! Prescribed displacement [m]
      integer :: line = 0            !! Line of the file, 0 if there is none
   end type held_point_t

   !> A force on a point of a block; it follows the point and keeps its direction
   type :: loaded_point_t
      integer :: block = 0           !! Number of the block
      real(wp) :: point(2) = 0.0_wp  !! Coordinates in the reference shape: (2) [m]
      !> The force; for a live load, at a load factor of one [N per metre depth]
      type(history_t) :: force
      logical :: live = .false.  !! True if it is multiplied by the load factor
   end type loaded_point_t

   !> A monitoring point
   type :: measured_point_t
      integer :: block = 0           !! Number of the block
      real(wp) :: point(2) = 0.0_wp  !! Coordinates in the reference shape: (2) [m]
   end type measured_point_t

   !> A force on a point of a block with any value between zero and a bound, for example passive
   !> pressure of fill on an arch
   type :: bounded_force_t
      integer :: block = 0               !! Number of the block
      real(wp) :: point(2) = 0.0_wp      !! Coordinates in the reference shape: (2) [m]
      real(wp) :: direction(2) = 0.0_wp  !! Unit vector along the force: (2)
      real(wp) :: most = huge(1.0_wp)    !! Upper bound; huge if there is none [N per metre depth]
   end type bounded_force_t

   !> A point of an absorbing boundary: dashpots normal and tangential to the face
   type :: absorbing_point_t
      integer :: block = 0             !! Number of the block
      real(wp) :: point(2) = 0.0_wp    !! Coordinates in the reference shape: (2) [m]
      real(wp) :: tangent(2) = 0.0_wp  !! Unit vector along the face: (2)
      real(wp) :: length = 0.0_wp      !! Tributary length of the face [m]
      !> Wave speeds normal and tangential to the face; 0 for those of the block's
      !> material: (2) [m/s]
      real(wp) :: speed(2) = 0.0_wp
      logical :: along(2) = .true.  !! True if it absorbs along x and along y: (2)
      integer :: line = 0           !! Line of the file
   end type absorbing_point_t

   !> A block that is built or removed during the run
   type :: stage_change_t
      real(wp) :: time = 0.0_wp  !! Time of the change [s]
      integer :: block = 0       !! Number of the block
      logical :: adds = .false.  !! True if it is built, otherwise it is removed
      integer :: line = 0        !! Line of the file
   end type stage_change_t

   !> All actions of a scene; unallocated arrays are empty
   type :: boundary_t
      type(held_point_t), allocatable :: held(:)            !! Restrained points
      type(loaded_point_t), allocatable :: loaded(:)        !! Loaded points
      type(measured_point_t), allocatable :: measured(:)    !! Monitoring points
      type(bounded_force_t), allocatable :: bounded(:)      !! Forces between zero and a bound
      type(bar_t), allocatable :: bar(:)                    !! Bars between points
      type(absorbing_point_t), allocatable :: absorbing(:)  !! Points of absorbing boundaries
      !> Blocks that are built or removed, in order of time
      type(stage_change_t), allocatable :: change(:)
      !> Ground acceleration [m/s2]; motions are relative to the ground, so that inertia forces act
      !> on all blocks
      type(history_t) :: base_acceleration
   end type boundary_t

contains

   !> Make a constant history
   pure type(history_t) function constant_history(value)
      real(wp), intent(in) :: value(2)  !! Components along x and y: (2)

      allocate (constant_history%time(1), source=0.0_wp)
      allocate (constant_history%value(2, 1))
      constant_history%value(:, 1) = value
   end function constant_history

   !> The actions at time 0 as constants, without ground motion
   pure type(boundary_t) function held_at_start(boundary) result(held)
      type(boundary_t), intent(in) :: boundary
      integer :: i

      held = boundary
      held%base_acceleration = history_t()
      if (allocated(held%loaded)) then
         do i = 1, size(held%loaded)
            held%loaded(i)%force = constant_history(value_at(boundary%loaded(i)%force, 0.0_wp))
         end do
      end if
      if (.not. allocated(held%held)) return
      do i = 1, size(held%held)
         if (allocated(boundary%held(i)%path%time)) held%held(i)%path = &
            & constant_history(value_at(boundary%held(i)%path, 0.0_wp))
      end do
   end function held_at_start

   !> Times at which blocks are built or removed
   pure function stage_times(boundary) result(time)
      type(boundary_t), intent(in) :: boundary
      real(wp), allocatable :: time(:)  !! The times, ascending, each once: (n) [s]
      integer :: i, n

      allocate (time(0))
      if (.not. allocated(boundary%change)) return
      n = size(boundary%change)
      time = pack(boundary%change%time, [(i == 1 .or. boundary%change(i)%time &
         & > boundary%change(max(1, i - 1))%time, i=1, n)])
   end function stage_times

   !> Blocks present after the changes up to a given time
   pure function present_at(boundary, n_block, time) result(present)
      type(boundary_t), intent(in) :: boundary
      integer, intent(in) :: n_block  !! Number of blocks
      real(wp), intent(in) :: time    !! The time [s]
      logical :: present(n_block)     !! True for present blocks: (n_block)
      integer :: i

      present = .true.
      if (.not. allocated(boundary%change)) return
      do i = size(boundary%change), 1, -1
         ! the first change implies the state before it
         present(boundary%change(i)%block) = .not. boundary%change(i)%adds
      end do
      do i = 1, size(boundary%change)
         if (boundary%change(i)%time <= time) &
            & present(boundary%change(i)%block) = boundary%change(i)%adds
      end do
   end function present_at

   !> Value of a history at a time
   pure function value_at(history, time) result(value)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: time
      real(wp) :: value(2)  !! Components along x and y: (2)
      real(wp) :: share
      integer :: i

      value = 0.0_wp
      if (.not. allocated(history%time)) return
      i = records_before(history%time, time)
      if (i == 0) then
         value = history%value(:, 1)
      else if (i == size(history%time)) then
         value = history%value(:, i)
      else
         share = (time - history%time(i))/(history%time(i + 1) - history%time(i))
         value = (1.0_wp - share)*history%value(:, i) + share*history%value(:, i + 1)
      end if
   end function value_at

   !> Prescribed displacement of a point. Its initial value is applied during the second before time
   !> zero
   pure function led_displacement(path, time) result(displacement)
      type(history_t), intent(in) :: path
      real(wp), intent(in) :: time  !! The time, at least -1 [s]
      real(wp) :: displacement(2)   !! Components along x and y: (2) [m]

      displacement = min(1.0_wp, 1.0_wp + time)*value_at(path, max(0.0_wp, time))
   end function led_displacement

   !> Mean of a history over an interval, so that short pulses contribute their full impulse
   pure function mean_over(history, start, finish) result(mean)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: start   !! Start of the interval [s]
      real(wp), intent(in) :: finish  !! End of the interval, after its start [s]
      real(wp) :: mean(2)             !! Components along x and y: (2)
      real(wp) :: before(2), after(2), left, right
      integer :: i

      mean = value_at(history, (start + finish)/2.0_wp)
      if (.not. allocated(history%time)) return
      i = records_before(history%time, start) + 1
      if (i > size(history%time)) return
      if (.not. history%time(i) < finish) return
      mean = 0.0_wp
      left = start
      before = value_at(history, left)
      do
         right = finish
         if (i <= size(history%time)) right = min(right, history%time(i))
         after = value_at(history, right)
         mean = mean + (right - left)/(finish - start)*(before + after)/2.0_wp
         if (.not. right < finish) exit
         left = right
         before = after
         i = i + 1
      end do
   end function mean_over

   !> Rate of a history just before a time
   pure function rate_at(history, time) result(rate)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: time
      real(wp) :: rate(2)  !! Components along x and y, per second: (2)
      integer :: i

      rate = 0.0_wp
      if (.not. allocated(history%time)) return
      i = records_before(history%time, time)
      if (i == 0 .or. i == size(history%time)) return
      rate = (history%value(:, i + 1) - history%value(:, i)) &
         & /(history%time(i + 1) - history%time(i))
   end function rate_at

   !> Number of increasing times before a given time
   pure integer function records_before(times, time)
      real(wp), intent(in) :: times(:)  !! The times: (n) [s]
      real(wp), intent(in) :: time
      integer :: high, middle

      records_before = 0
      high = size(times) + 1
      do while (high - records_before > 1)
         middle = (records_before + high)/2
         if (times(middle) < time) then
            records_before = middle
         else
            high = middle
         end if
      end do
   end function records_before
end module dda_boundary
