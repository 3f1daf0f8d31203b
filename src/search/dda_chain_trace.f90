!> The value at which a chain ceases to collapse, before anything is decided there
!>
!> A chain whose blocks are joined but at the joints of a mechanism lacks no more than the chain
!> itself. Where this one ceases to collapse the whole chain is looked at again, and its mechanism
!> followed, until it is the same.
submodule (dda_collapse_trace) dda_chain_trace
   use dda_arch_chain, only : arch_chain, arch_rays_t, join_voussoirs
   use dda_chain, only : chain_t
   use dda_chain_programme, only : deficit_t, find_deficit
   implicit none

   !> Most values of the secant method, and most mechanisms
   integer, parameter :: max_values = 40, max_mechanisms = 20
   !> About as many joints are looked at first
   integer, parameter :: coarse = 24
   !> Share of the value by which the second one differs from the first
   real(wp), parameter :: first_step = 0.05_wp
   !> Relative step, or product of the last two, at which the next one would be rounding
   real(wp), parameter :: converged = 1.0e-13_wp
   !> The same for a coarse chain, whose zero is an estimate
   real(wp), parameter :: estimated = 1.0e-5_wp
   !> Least relative distance of two values whose chord is a slope
   real(wp), parameter :: apart = 1.0e-7_wp
   !> Largest ratio of two values in a row
   real(wp), parameter :: largest_ratio = 3.0_wp
   !> Relative change of the value after which the mechanism is taken for the last
   real(wp), parameter :: near = 3.0e-3_wp
   !> Half a bracket over the rounding of its middle
   real(wp), parameter :: noise_of_half = 3.0_wp

contains

   !> Trace a chain
   module procedure trace_chain
      integer, allocatable :: joint(:)
      real(wp) :: before, slope, value
      integer :: i, n
      logical :: found

      proposal%half = least_half(search, from, size(family%rays%joint))*abs(from)
      value = from
      slope = 0.0_wp
      if (.not. frozen) then
         if (.not. family%chains) return
         n = size(family%rays%joint)
         allocate (joint, source=[(i, i=1, n - 1, 1 + n/coarse), n])
         call follow(family, search, limit, joint, estimated, critical%deficit, value, slope, &
            & found)
         if (.not. found) return
      end if
      associate (deficit => critical%deficit, link => critical%link)
         do i = 1, max_mechanisms
            call link_once(family, value, link)
            if (.not. link%known) return
            call find_deficit(link%chain, deficit)
            if (.not. deficit%known) return
            if (deficit%exchanges == 0 .and. i > 1) exit
            before = value
            joint = joints_of(deficit, size(link%chain%joint))
            call follow(family, search, limit, joint, converged, deficit, value, slope, found)
            if (.not. found) return
            if (frozen .or. abs(value - before) <= near*value) exit
         end do
         proposal%usable = i <= max_mechanisms
         if (.not. proposal%usable) return
         proposal%value = value
         proposal%half = max(least_half(search, value, size(link%chain%joint))*abs(value), &
            & noise_of_half*deficit%noise/abs(slope))
      end associate
      if (allocated(critical%fallen)) then
         associate (outcome => critical%fallen%outcome)
            proposal%half = max(proposal%half, 2.0_wp*abs(value - critical%falls) &
               & *outcome%rest_tolerance/outcome%acceleration_ratio)
         end associate
      end if
      proposal%reach = proposal%half
      if (critical%current) proposal%reach = first_reach*abs(value)
   end procedure trace_chain

   !> Joints of the bounds, with the first and the last one
   pure function joints_of(deficit, n) result(joint)
      type(deficit_t), intent(in) :: deficit
      integer, intent(in) :: n           !! Number of joints of the chain
      integer, allocatable :: joint(:)   !! The joints, rising
      logical :: takes_part(n)
      integer :: i

      takes_part = .false.
      takes_part([1, n]) = .true.
      do i = 1, size(deficit%joint)
         if (deficit%joint(i) > 0) takes_part(deficit%joint(i)) = .true.
      end do
      joint = pack([(i, i=1, n)], takes_part)
   end function joints_of

   !> Follow the chains in which only some joints part to where they cease to collapse
   pure subroutine follow(family, search, limit, joint, enough, deficit, value, slope, found)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: limit             !! The end of the range on the side that stands
      integer, intent(in) :: joint(:)           !! The joints, rising
      !> Relative step, or product of the last two, at which to end
      real(wp), intent(in) :: enough
      type(deficit_t), intent(inout) :: deficit  !! Bounds of the chain itself
      real(wp), intent(inout) :: value          !! Where to begin in, where they cease out
      !> Change of the deficit with the value; an estimate in, or 0
      real(wp), intent(inout) :: slope
      logical, intent(out) :: found  !! Whether they cease to collapse
      type(arch_rays_t) :: joined
      type(chain_t) :: chain
      real(wp) :: before, last, next
      logical :: tells
      integer :: i

      found = .false.
      call join_voussoirs(family%numbers%shape%radius, family%rays, joint, joined)
      do i = 1, 4
         if (deficit%joint(i) > 0) deficit%joint(i) = findloc(joint, deficit%joint(i), 1)
      end do
      do i = 1, max_values
         call arch_chain(family%numbers, joined, value, chain)
         call find_deficit(chain, deficit)
         if (.not. deficit%known) return
         if (i == 1 .and. .not. abs(slope) > 0.0_wp) then
            next = value*(1.0_wp + sign(first_step, limit - value))
         else
            ! the chord of nearer values is rounding, that of two mechanisms no slope
            tells = .false.
            if (i > 1) tells = abs(value - before) > apart*value .and. deficit%exchanges == 0
            if (tells .or. i == 2 .and. abs(value - before) > apart*value) &
               & slope = (deficit%least - last)/(value - before)
            if (.not. abs(slope) > 0.0_wp) return
            next = value - deficit%least/slope
            if (tells .and. abs((next - value)*(next - before)) <= enough*value**2) exit
            if (abs(next - value) <= max(enough*value, deficit%noise/abs(slope))) exit
            next = min(max(next, value/largest_ratio), value*largest_ratio)
            next = min(max(next, search%low), search%high)
            if (.not. abs(next - value) > 0.0_wp) return
         end if
         before = value
         last = deficit%least
         value = next
      end do
      value = next
      found = i <= max_values
      do i = 1, 4
         if (deficit%joint(i) > 0) deficit%joint(i) = joint(deficit%joint(i))
      end do
   end subroutine follow

end submodule dda_chain_trace
