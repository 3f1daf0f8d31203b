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

   !> Most values of the secant method in its bracket, and most mechanisms
   integer, parameter :: max_values = 60, max_mechanisms = 20
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

   !> Values of the secant method
   type :: secant_t
      real(wp) :: value = 0.0_wp   !! The value looked at
      real(wp) :: next = 0.0_wp    !! The next one
      real(wp) :: before = 0.0_wp  !! The one before that tells of a slope
      real(wp) :: last = 0.0_wp    !! Its deficit [N/m]
      real(wp) :: slope = 0.0_wp   !! Change of the deficit with the value; 0 if unknown [N/m]
      real(wp) :: other = 0.0_wp   !! The value that its chord came from
      !> Nearest values that collapse and that stand, or the ends of the range: (2)
      real(wp) :: bracket(2) = 0.0_wp
      logical :: known(2) = .false.  !! True if they have been looked at: (2)
      integer :: side = 1            !! On which of the two sides the value is
      logical :: steady = .false.    !! True if the slope is that of its mechanism
      !> True if it stands at its limit, as through a range of values: that tells nothing of where
      !> the range begins
      logical :: at_limit = .false.
   end type secant_t

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

   !> Follow the chains in which only some joints part to where they cease to collapse: by secants
   !> of one mechanism, and by halves where these leave the bracket
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
      logical, intent(out) :: found  !! True if they cease to collapse
      type(arch_rays_t) :: joined
      type(chain_t) :: chain
      type(deficit_t) :: collapsed
      type(secant_t) :: secant
      logical :: ended
      integer :: i

      found = .false.
      call join_voussoirs(family%numbers%shape%radius, family%rays, joint, joined)
      do i = 1, 4
         if (deficit%joint(i) > 0) deficit%joint(i) = findloc(joint, deficit%joint(i), 1)
      end do
      secant%bracket = [merge(search%low, search%high, limit > value), limit]
      secant%slope = slope
      secant%steady = abs(slope) > 0.0_wp
      secant%value = value
      secant%before = value
      do i = 1, max_values
         call arch_chain(family%numbers, joined, secant%value, chain)
         call find_deficit(chain, deficit)
         if (.not. deficit%known) return
         call take_deficit(deficit, enough, secant, ended)
         if (ended) exit
         call keep_inside(secant)
         if (.not. abs(secant%next - secant%value) > 0.0_wp) return
         if (secant%at_limit) then
            deficit = collapsed
         else
            if (deficit%least > deficit%noise) collapsed = deficit
            secant%before = secant%value
            secant%last = deficit%least
         end if
         secant%value = secant%next
      end do
      value = secant%next
      slope = secant%slope
      found = ended .and. abs(slope) > 0.0_wp
      do i = 1, 4
         if (deficit%joint(i) > 0) deficit%joint(i) = joint(deficit%joint(i))
      end do
   end subroutine follow

   !> Take the deficit of one value: on its side of the bracket, for the slope and the next value
   pure subroutine take_deficit(deficit, enough, secant, ended)
      type(deficit_t), intent(in) :: deficit
      real(wp), intent(in) :: enough
      type(secant_t), intent(inout) :: secant
      logical, intent(out) :: ended  !! True if the next value is the one sought

      associate (value => secant%value, next => secant%next, least => deficit%least)
         secant%side = merge(1, 2, least > deficit%noise)
         secant%bracket(secant%side) = value
         secant%known(secant%side) = .true.
         secant%steady = secant%steady .and. deficit%exchanges == 0
         secant%at_limit = secant%known(1) .and. .not. secant%steady &
            & .and. abs(least) <= deficit%noise
         ! the chord of nearer values is rounding, that of two mechanisms no slope
         if (abs(value - secant%before) > apart*value .and. .not. secant%at_limit) then
            secant%steady = deficit%exchanges == 0
            if (secant%steady .or. .not. abs(secant%slope) > 0.0_wp) then
               secant%slope = (least - secant%last)/(value - secant%before)
               secant%other = secant%before
            end if
         end if
         next = value*(1.0_wp + sign(first_step, secant%bracket(3 - secant%side) - value))
         if (abs(secant%slope) > 0.0_wp) next = value - least/secant%slope
         ended = abs(secant%bracket(2) - secant%bracket(1)) <= enough*value
         if (secant%steady) ended = ended &
            & .or. abs((next - value)*(next - secant%other)) <= enough*value**2 &
            & .or. abs(next - value) <= max(enough*value, deficit%noise/abs(secant%slope))
      end associate
   end subroutine take_deficit

   !> Keep the next value inside the bracket, and not too far from the last one
   pure subroutine keep_inside(secant)
      type(secant_t), intent(inout) :: secant

      associate (next => secant%next, bracket => secant%bracket, value => secant%value)
         if (secant%at_limit .and. .not. abs(secant%slope) > 0.0_wp) then
            ! a slope is found on the side that collapses
            next = secant%before*(1.0_wp - sign(first_step, value - secant%before))
         else if (secant%at_limit .or. (next - bracket(1))*(bracket(2) - next) <= 0.0_wp) then
            next = bracket(3 - secant%side)
            if (all(secant%known)) next = sqrt(bracket(1)*bracket(2))
         end if
         next = min(max(next, value/largest_ratio), value*largest_ratio)
      end associate
   end subroutine keep_inside

end submodule dda_chain_trace
