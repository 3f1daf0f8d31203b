!> Critical value of a parameter: a bracket of two real decisions, one that falls and one that stands
!>
!> The joints of a collapse, frozen, tell where it would stop; two decisions close around that value
!> prove it. Where the joints tell nothing, the bracket is halved.
module dda_critical
   use dda_decision, only : decide, decision_t
   use dda_error, only : error_t
   use dda_frozen_mechanism, only : frozen_mechanism_t, mechanism_power
   use dda_kinds, only : wp
   use dda_scene, only : family_t, scene_t
   use dda_settings, only : flow_rule
   use dda_verdict, only : verdict
   implicit none
   private

   public :: search_t, critical_t, find_critical

   !> What is searched
   type :: search_t
      !> Least value of the parameter
      real(wp) :: low = 0.0_wp
      !> Largest value of the parameter
      real(wp) :: high = 1.0_wp
      !> Where to begin, from low to high
      real(wp) :: start = 0.0_wp
      !> Width of the bracket over the critical value
      real(wp) :: tolerance = 1.0e-8_wp
      !> Relative change of the critical value that rounded coordinates can make, if it is known
      real(wp) :: resolution = 0.0_wp
      !> Whether the end beyond the critical value is decided too; not needed where it is known to stand
      logical :: check_far_end = .true.
   end type search_t

   !> What was found
   type :: critical_t
      !> found, or the verdict of both ends, or undecided
      integer :: verdict = 0
      !> Why the last undecided value is; unallocated if none was
      character(len=:), allocatable :: reason
      !> The last undecided value
      real(wp) :: undecided_at = 0.0_wp
      !> Value nearest to critical at which the structure falls
      real(wp) :: falls = 0.0_wp
      !> Value nearest to critical at which it stands
      real(wp) :: stands = 0.0_wp
      !> Half the width that rounding and tolerance leave to the bracket
      real(wp) :: half = 0.0_wp
      !> Decision at falls, if there is one
      type(decision_t), allocatable :: fallen
      !> Decision at stands, if there is one
      type(decision_t), allocatable :: standing
      !> Whether the blocks move
      logical :: current = .false.
      !> Number of decisions
      integer :: decisions = 0
      !> Steps of all decisions
      integer :: steps = 0
      !> Passes of the open-close loop of all decisions
      integer :: passes = 0
      !> Factorisations of all decisions and proposals
      integer :: factorisations = 0
   end type critical_t

   !> Where a frozen collapse stops
   type :: proposal_t
      !> Whether it stops anywhere
      logical :: usable = .false.
      !> The value
      real(wp) :: value = 0.0_wp
      !> Half the width of the bracket to close around it: of the tolerance, or of what the rounded
      !> coordinates can tell apart
      real(wp) :: half = 0.0_wp
      !> How far beyond and before it to decide; more than half where the frozen joints, which know
      !> nothing of moving blocks, only come near
      real(wp) :: reach = 0.0_wp
   end type proposal_t

   !> Most decisions of a search
   integer, parameter :: max_decisions = 100
   !> Most values tried on the way from the start to the first collapse
   integer, parameter :: max_descent = 8
   !> Most undecided values in a row on the way to a decided one
   integer, parameter :: max_undecided = 6

   !> Half a bracket is no narrower than this share of its value
   real(wp), parameter :: least_share = 4.0e-12_wp
   !> What each joint adds to that share
   real(wp), parameter :: share_of_joint = 2.0e-14_wp
   !> A bracket wider than this share of its value is no answer
   real(wp), parameter :: widest = 1.0e-4_wp
   !> Share of the value by which moving blocks are first looked for beyond frozen ones
   real(wp), parameter :: first_reach = 1.0e-3_wp
   !> Margin over the noise that three samples show
   real(wp), parameter :: noise_margin = 20.0_wp
   !> Most passes of the secant method
   integer, parameter :: max_passes = 20
   !> Free fall over elastic motion in the step that traces a mechanism
   real(wp), parameter :: free_fall = 1.0e4_wp

contains

   !> Search the critical value of a family of scenes
   pure subroutine find_critical(family, search, critical)
      !> The family
      class(family_t), intent(in) :: family
      !> What is searched
      type(search_t), intent(in) :: search
      !> What was found
      type(critical_t), intent(out) :: critical
      type(proposal_t) :: proposal
      real(wp) :: limit
      integer :: answer, undecided

      call find_collapse(family, search, limit, critical)
      if (critical%verdict /= verdict%undecided) return
      if (.not. allocated(critical%fallen)) return
      if (search%check_far_end .and. .not. allocated(critical%standing)) &
         & call decide_at(family, limit, critical, answer)
      answer = verdict%collapsed
      undecided = 0
      do while (critical%decisions < max_decisions .and. undecided < max_undecided)
         if (.not. abs(critical%falls - limit) > 0.0_wp) then
            critical%verdict = verdict%collapsed
            return
         end if
         if (answer == verdict%collapsed) call trace(family, search, limit, critical, proposal)
         if (closed(critical, proposal)) then
            critical%verdict = verdict%found
            critical%half = proposal%half
            return
         end if
         call decide_at(family, candidate(critical, proposal, limit), critical, answer)
         if (answer == verdict%undecided) then
            undecided = undecided + 1
            proposal%half = 4.0_wp*proposal%half
            proposal%reach = 4.0_wp*proposal%reach
         else
            undecided = 0
         end if
      end do
   end subroutine find_critical

   !> Go to the first collapse: from the start towards the low end, or else at the high end
   pure subroutine find_collapse(family, search, limit, critical)
      !> The family
      class(family_t), intent(in) :: family
      !> What is searched
      type(search_t), intent(in) :: search
      !> The end of the range on the side that stands [unit of the parameter]
      real(wp), intent(out) :: limit
      !> Receives the first collapse, or a verdict where both ends agree
      type(critical_t), intent(inout) :: critical
      integer :: answer, attempt
      real(wp) :: value

      limit = search%high
      value = search%start
      do attempt = 1, max_descent
         if (attempt == max_descent) value = search%low
         call decide_at(family, value, critical, answer)
         if (answer == verdict%collapsed) return
         if (.not. value > search%low) exit
         if (answer == verdict%undecided) exit
         value = max(search%low, value/5.0_wp)
      end do
      if (answer == verdict%undecided) then
         call ascend(family, search, value, critical, answer)
         return
      end if
      limit = search%low
      call decide_at(family, search%high, critical, answer)
      if (answer == verdict%stable) critical%verdict = verdict%stable
   end subroutine find_collapse

   !> Go up from an undecided value to the first decided one
   pure subroutine ascend(family, search, value, critical, answer)
      !> The family
      class(family_t), intent(in) :: family
      !> What is searched
      type(search_t), intent(in) :: search
      !> The undecided value
      real(wp), intent(in) :: value
      !> Receives the decisions
      type(critical_t), intent(inout) :: critical
      !> One of verdict
      integer, intent(out) :: answer
      integer :: attempt

      do attempt = 1, max_descent
         call decide_at(family, value + (search%high - value)*2.0_wp**(attempt - max_descent), &
            & critical, answer)
         if (answer /= verdict%undecided) return
      end do
   end subroutine ascend

   !> Decide one value and keep the decision on its side of the bracket
   pure subroutine decide_at(family, value, critical, answer)
      !> The family
      class(family_t), intent(in) :: family
      !> The value
      real(wp), intent(in) :: value
      !> Receives the decision
      type(critical_t), intent(inout) :: critical
      !> One of verdict
      integer, intent(out) :: answer
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error
      type(scene_t) :: scene

      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      call family%build(value, scene, error)
      if (allocated(error)) then
         critical%reason = error%message
         critical%undecided_at = value
         return
      end if
      critical%current = scene%settings%current
      allocate (decision)
      call decide(scene%settings, scene%system, scene%contacts, decision)
      critical%steps = critical%steps + decision%outcome%steps
      critical%passes = critical%passes + decision%outcome%passes
      critical%factorisations = critical%factorisations + decision%outcome%factorisations
      answer = decision%outcome%verdict
      if (answer == verdict%collapsed) then
         critical%falls = value
         call move_alloc(decision, critical%fallen)
      else if (answer == verdict%stable) then
         critical%stands = value
         call move_alloc(decision, critical%standing)
      else
         critical%reason = decision%outcome%reason
         critical%undecided_at = value
      end if
   end subroutine decide_at

   !> Where to decide next: just beyond the proposal, then just before it, then inside the bracket
   pure function candidate(critical, proposal, limit) result(value)
      !> What was found so far
      type(critical_t), intent(in) :: critical
      !> Where the last collapse stops
      type(proposal_t), intent(in) :: proposal
      !> The end of the range on the side that stands
      real(wp), intent(in) :: limit
      !> The value
      real(wp) :: value
      real(wp) :: beyond, before, far, toward

      far = limit
      if (allocated(critical%standing)) far = critical%stands
      toward = sign(1.0_wp, far - critical%falls)
      beyond = proposal%value + toward*proposal%reach
      before = proposal%value - toward*proposal%reach
      if (.not. proposal%usable) then
         value = far
         if (allocated(critical%standing)) value = middle(critical%falls, far)
      else if (inside(beyond)) then
         value = beyond
      else if (.not. allocated(critical%standing)) then
         value = critical%falls + toward*2.0_wp*abs(critical%falls - proposal%value)
         if (.not. critical%current .or. .not. inside(value)) value = far
      else if (inside(before)) then
         value = before
      else if (critical%current .or. abs(far - critical%falls) > 0.3_wp*abs(far)) then
         value = middle(critical%falls, far)
      else
         value = far - 0.1_wp*(far - critical%falls)
      end if

   contains

      !> Whether a value lies strictly between the ends of the bracket
      pure logical function inside(x)
         !> The value
         real(wp), intent(in) :: x

         inside = toward*(x - critical%falls) > 0.0_wp .and. toward*(far - x) > 0.0_wp
      end function inside
   end function candidate

   !> Middle of a bracket; the geometric one where the ends are of different magnitude
   pure real(wp) function middle(a, b)
      !> One end
      real(wp), intent(in) :: a
      !> The other end
      real(wp), intent(in) :: b

      middle = (a + b)/2.0_wp
      if (min(a, b) > 0.0_wp .and. max(a, b) > 4.0_wp*min(a, b)) middle = sqrt(a*b)
   end function middle

   !> Whether the bracket is as narrow as the proposal asks for
   pure logical function closed(critical, proposal)
      !> What was found so far
      type(critical_t), intent(in) :: critical
      !> Where the last collapse stops
      type(proposal_t), intent(in) :: proposal

      closed = allocated(critical%standing) &
         & .and. abs(critical%stands - critical%falls) <= 2.0001_wp*proposal%half &
         & .and. 2.0_wp*proposal%half <= widest*abs(critical%stands)
   end function closed

   !> Trace the last collapse to where it stops, by the secant method on the power of the loads
   pure subroutine trace(family, search, limit, critical, proposal)
      !> The family
      class(family_t), intent(in) :: family
      !> What is searched
      type(search_t), intent(in) :: search
      !> The end of the range on the side that stands
      real(wp), intent(in) :: limit
      !> What was found so far; the factorisations are counted
      type(critical_t), intent(inout) :: critical
      !> Where the collapse stops
      type(proposal_t), intent(out) :: proposal
      type(frozen_mechanism_t) :: mechanism
      real(wp) :: x(2), power(2), first_power, noise, next, slope, coarse_slope, step
      integer :: pass
      logical :: usable, stopped, only_noise

      proposal%half = least_half(search, critical)*max(abs(critical%falls), tiny(1.0_wp))
      if (critical%fallen%flow /= flow_rule%associated) return
      mechanism%face = critical%fallen%contacts%face
      mechanism%motion = critical%fallen%outcome%motion(:3, :)
      mechanism%dt = sqrt(free_fall)*critical%fallen%outcome%elastic_time
      x(1) = critical%falls
      call power_at(family, mechanism, x(1), critical, power(1), noise, usable)
      first_power = power(1)
      step = min(0.3_wp, max(1.0e-3_wp, 1.25_wp*critical%fallen%outcome%acceleration_ratio))
      step = min(step*max(abs(x(1)), 0.01_wp*abs(limit - x(1))), abs(limit - x(1)))
      x(2) = x(1) + sign(step, limit - x(1))
      do pass = 1, max_passes
         if (usable) call power_at(family, mechanism, x(2), critical, power(2), noise, usable)
         if (.not. usable .or. .not. abs(power(2) - power(1)) > 0.0_wp) return
         slope = (power(2) - power(1))/(x(2) - x(1))
         if (pass == 1) coarse_slope = slope
         next = x(2) - power(2)/slope
         if (next < search%low .or. next > search%high) return
         stopped = abs(next - x(2)) < 0.01_wp*search%tolerance*abs(next)
         only_noise = abs(power(2)) < 1.0e-3_wp*abs(first_power) .and. abs(power(2)) > abs(power(1))
         if (stopped .or. only_noise) exit
         x = [x(2), next]
         power(1) = power(2)
      end do
      proposal%usable = .true.
      proposal%value = next
      if (critical%current) then
         proposal%reach = first_reach*abs(next)
         proposal%half = least_half(search, critical)*abs(next)
         return
      end if
      call refine_noise(family, mechanism, next, critical, noise)
      proposal%half = max(least_half(search, critical)*abs(next), abs(noise/coarse_slope), &
         & rest_resolution(critical, next))
      proposal%reach = proposal%half
   end subroutine trace

   !> Half the width of a bracket over its value: of the tolerance, or of what rounding leaves
   pure real(wp) function least_half(search, critical)
      !> What is searched
      type(search_t), intent(in) :: search
      !> What was found so far, a collapse among it
      type(critical_t), intent(in) :: critical

      least_half = max(search%tolerance/2.0_wp, search%resolution, &
         & least_share + share_of_joint*real(size(critical%fallen%contacts%face), wp))
   end function least_half

   !> Rounding in the solution of the equations: what another length of the step makes of the power
   pure subroutine refine_noise(family, mechanism, value, critical, noise)
      !> The family
      class(family_t), intent(in) :: family
      !> The mechanism
      type(frozen_mechanism_t), intent(in) :: mechanism
      !> The value
      real(wp), intent(in) :: value
      !> The factorisations are counted
      type(critical_t), intent(inout) :: critical
      !> Noise of the power; raised where rounding shows
      real(wp), intent(inout) :: noise
      type(frozen_mechanism_t) :: other
      real(wp) :: power(3), ignored
      logical :: usable
      integer :: i

      other = mechanism
      do i = 1, 3
         other%dt = mechanism%dt*0.7_wp**(i - 2)
         call power_at(family, other, value, critical, power(i), ignored, usable)
         if (.not. usable) return
      end do
      noise = max(noise, noise_margin*(maxval(power) - minval(power)))
   end subroutine refine_noise

   !> How near to its stop a mechanism becomes too slow for a decision to tell it from rest
   pure real(wp) function rest_resolution(critical, stop)
      !> What was found so far
      type(critical_t), intent(in) :: critical
      !> Value at which the last collapse stops
      real(wp), intent(in) :: stop

      associate (outcome => critical%fallen%outcome)
         rest_resolution = 2.0_wp*abs(stop - critical%falls)*outcome%rest_tolerance &
            & /outcome%acceleration_ratio
      end associate
   end function rest_resolution

   !> Power of the loads on a frozen mechanism at one value
   pure subroutine power_at(family, mechanism, value, critical, power, noise, usable)
      !> The family
      class(family_t), intent(in) :: family
      !> The mechanism
      type(frozen_mechanism_t), intent(in) :: mechanism
      !> The value
      real(wp), intent(in) :: value
      !> The factorisations are counted
      type(critical_t), intent(inout) :: critical
      !> The power
      real(wp), intent(out) :: power
      !> What the rounding of coordinates alone makes of it
      real(wp), intent(out) :: noise
      !> Whether the power could be found
      logical, intent(out) :: usable
      type(error_t), allocatable :: error
      type(scene_t) :: scene

      power = 0.0_wp
      noise = 0.0_wp
      call family%build(value, scene, error)
      usable = .not. allocated(error)
      if (.not. usable) return
      call mechanism_power(mechanism, scene, power, noise, usable)
      critical%factorisations = critical%factorisations + 1
   end subroutine power_at
end module dda_critical
