!> Exact critical thickness of a circular arch of polygon voussoirs, by limit analysis
!>
!> One half of a symmetric arch under its own weight has two unknowns, the thrust H at the crown and
!> the moment Q of that thrust about the centre. At a joint of angle t, with W the weight and S the
!> moment of the part above it,
!>     N = H cos t + W sin t,   (1 - eta/2) N <= Q + S <= (1 + eta/2) N
!>     T = W cos t - H sin t,   |T| <= tan(phi) N
!> (radius 1, forces in gamma r^2 eta, so that W does not depend on eta and S = (1 + eta^2/12) M
!> with M independent). Divided by 1 + eta^2/12 the two bounds widen with eta for all eta < 2: an
!> arch that is stable at eta is stable at every greater one. With H = 1 - d, v = 1 - cos t and the
!> shape z = W sin t - M - v, the ring is thick enough if the gap
!>     min_j (d v + z + eta/2 N - eta^2/12 M)_j - max_k (d v + z - eta/2 N - eta^2/12 M)_k
!> is not negative for some d that friction admits at all joints. All terms are as small as eta
!> itself, so a shallow arch keeps its digits. The gap is concave and piecewise linear in d; its
!> largest value over d is zero at the critical eta. Two or three joints are active there. Their
!> solution for eta is never too large, hence a few iterations suffice.
module couplet_heyman_discrete
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_ring, only : limit_thrust, make_ring, pinch_t, ring_t, solve_pinch, widest_gap
   implicit none
   private

   public :: discrete_critical, discrete_critical_equal, equal_voussoir_joints, chords
   public :: discrete_solution_t, discrete_status, joint_role

   !> Outcome of a critical thickness
   type :: discrete_status_enum
      integer :: found = 0            !! The critical thickness ratio lies in (0, 2)
      integer :: stands_always = 1    !! The arch is stable at every thickness: eta is 0
      integer :: none_admissible = 2  !! No thickness ratio below 2 admits equilibrium: eta is 0
      integer :: bad_input = 3        !! An argument is invalid: nothing was computed, eta is 0
      integer :: unsettled = 4        !! No convergence (never observed): eta is the last estimate
   end type discrete_status_enum

   !> The names of the outcomes
   type(discrete_status_enum), parameter :: discrete_status = discrete_status_enum()

   !> State of a joint at the critical thickness
   type :: joint_role_enum
      integer :: intrados_hinge = 1  !! The thrust passes through its intrados corner
      integer :: extrados_hinge = 2  !! The thrust passes through its extrados corner
      integer :: slides = 3          !! Its friction is fully mobilised
   end type joint_role_enum

   !> The names of the roles
   type(joint_role_enum), parameter :: joint_role = joint_role_enum()

   !> Critical state of a discrete arch
   type :: discrete_solution_t
      integer :: status = 3        !! One of `discrete_status`
      real(wp) :: eta = 0.0_wp     !! Critical thickness ratio t/r [-]
      real(wp) :: thrust = 0.0_wp  !! Horizontal thrust there, over gamma r^2 eta [-]
      integer :: active = 0        !! Number of entries of `joint` and `role` that are used
      integer :: joint(5) = 0      !! Active joints, as indices of joint_angle: (5)
      integer :: role(5) = 0       !! State of each of them, one of `joint_role`: (5)
   end type discrete_solution_t

contains

   !> Critical thickness ratio of an arch from the joints of one half
   !>
   !> Above solution%eta the arch has an admissible system of forces, below it none.
   pure subroutine discrete_critical(joint_angle, facets, friction, springing_no_slip, solution)
      !> Joints of one half, from the crown to the springing, strictly increasing, in [0, pi): (n)
      !> [rad]. The first is 0 if there is a joint at the crown; otherwise a voussoir straddles
      !> the crown
      real(wp), intent(in) :: joint_angle(:)
      !> Equal chords of each voussoir, from the crown: (n - 1) with a joint at the crown; (n)
      !> without, and then the first is the number of chords of the whole voussoir that straddles
      !> the crown
      integer, intent(in) :: facets(:)
      !> Friction angle of the joints; pi/2 or more means that no joint slides [rad]
      real(wp), intent(in) :: friction
      logical, intent(in) :: springing_no_slip  !! True if the two springing joints cannot slide
      type(discrete_solution_t), intent(out) :: solution
      type(ring_t) :: ring

      solution%status = discrete_status%bad_input
      if (.not. makes_sense(joint_angle, facets, friction)) return
      call make_ring(joint_angle, facets, ring)
      call limit_thrust(joint_angle, friction, springing_no_slip, ring)
      solution%status = discrete_status%none_admissible
      if (ring%lowest > ring%highest) return
      solution%status = discrete_status%stands_always
      if (size(joint_angle) == 1) return
      if (size(joint_angle) == 2) then
         if (needs_no_thickness(ring)) return
      end if
      call search_eta(ring, solution)
   end subroutine discrete_critical

   !> Critical thickness ratio of an arch of equal voussoirs, one chord each
   pure subroutine discrete_critical_equal(voussoirs, half_angle, friction, springing_no_slip, &
                                           solution)
      !> Number of voussoirs of the whole arch, 1 or more; an odd number has no joint at the crown
      integer, intent(in) :: voussoirs
      real(wp), intent(in) :: half_angle  !! Half angle of embrace, in (0, pi) [rad]
      real(wp), intent(in) :: friction
      logical, intent(in) :: springing_no_slip
      !> Critical state; joints are counted as in equal_voussoir_joints
      type(discrete_solution_t), intent(out) :: solution
      integer :: facets((max(voussoirs, 1) + 1)/2)

      facets = 1
      if (voussoirs < 1) return
      call discrete_critical(equal_voussoir_joints(voussoirs, half_angle), facets, friction, &
                             springing_no_slip, solution)
   end subroutine discrete_critical_equal

   !> Joint angles of one half of an arch of equal voussoirs, from the crown
   pure function equal_voussoir_joints(voussoirs, half_angle) result(joint_angle)
      integer, intent(in) :: voussoirs
      real(wp), intent(in) :: half_angle
      !> 0, 2a/n, 4a/n ... a for an even number n; a/n, 3a/n ... a for an odd one: (n/2 + 1 or (n +
      !> 1)/2) [rad]
      real(wp) :: joint_angle((voussoirs + 2)/2)
      integer :: i, last

      last = size(joint_angle)
      do i = 1, last
         joint_angle(i) = half_angle*real(voussoirs - 2*(last - i), wp)/real(voussoirs, wp)
      end do
   end function equal_voussoir_joints

   !> Number of equal chords of each voussoir, with a limit on the span of a chord
   pure function chords(joint_angle, longest) result(facets)
      real(wp), intent(in) :: joint_angle(:)
      !> Largest span of a chord; 0 or less: one chord per voussoir [rad]
      real(wp), intent(in) :: longest
      !> Argument of discrete_critical: (n - 1) with a joint at the crown, (n) without
      integer :: facets(merge(size(joint_angle), size(joint_angle) - 1, joint_angle(1) > 0.0_wp))
      real(wp) :: span
      integer :: j, above

      above = size(joint_angle) - size(facets)
      do j = 1, size(facets)
         span = 2.0_wp*joint_angle(1)
         if (j + above > 1) span = joint_angle(j + above) - joint_angle(j + above - 1)
         facets(j) = 1
         if (longest > 0.0_wp) facets(j) = max(1, ceiling(span/longest - 1.0e-9_wp))
      end do
   end function chords

   !> True if the arguments describe an arch: finite, in range, increasing, and of matching sizes
   pure logical function makes_sense(joint_angle, facets, friction)
      real(wp), intent(in) :: joint_angle(:)  !! Joints of one half: (:) [rad]
      integer, intent(in) :: facets(:)        !! Chords of each voussoir: (:)
      real(wp), intent(in) :: friction
      real(wp), parameter :: pi = acos(-1.0_wp)  !! 180 degrees [rad]
      integer :: n

      n = size(joint_angle)
      makes_sense = n > 0
      if (.not. makes_sense) return
      makes_sense = joint_angle(1) >= 0.0_wp .and. joint_angle(n) > 0.0_wp .and. joint_angle(n) < pi
      makes_sense = makes_sense .and. all(joint_angle(2:) > joint_angle(:n - 1))
      makes_sense = makes_sense .and. all(facets > 0) .and. friction >= 0.0_wp
      makes_sense = makes_sense .and. size(facets) == merge(n, n - 1, joint_angle(1) > 0.0_wp)
   end function makes_sense

   !> True if a ring of two joints needs no thickness: the straight thrust line between the centres
   !> of the joints causes compression at both and slip at neither
   pure logical function needs_no_thickness(ring)
      type(ring_t), intent(in) :: ring  !! A ring of two joints
      real(wp) :: deficit

      deficit = (ring%form(1) - ring%form(2))/(ring%versine(2) - ring%versine(1))
      needs_no_thickness = deficit >= ring%lowest .and. deficit <= ring%highest
      needs_no_thickness = needs_no_thickness .and. all(ring%normal - deficit*ring%cosine >= 0.0_wp)
   end function needs_no_thickness

   !> Root in eta of the widest gap: the active joints give an estimate, which a bracket safeguards
   pure subroutine search_eta(ring, solution)
      type(ring_t), intent(in) :: ring         !! Ring of two joints or more
      type(discrete_solution_t), intent(out) :: solution
      integer, parameter :: most_rounds = 200  !! More than bisection alone takes (60)
      real(wp) :: eta, low, high, root
      logical :: high_stands, solved, stands, unchanged
      type(pinch_t) :: pinch, proposer
      integer :: round

      low = 0.0_wp
      high = 2.0_wp
      high_stands = .false.
      eta = merge(high, low, size(ring%form) == 2)
      do round = 1, most_rounds
         call widest_gap(ring, eta, pinch)
         stands = pinch%unbounded .or. pinch%gap >= 0.0_wp
         solution%status = discrete_status%none_admissible
         if (eta >= 2.0_wp .and. .not. stands) return
         if (stands) high = eta
         if (.not. stands) low = eta
         high_stands = high_stands .or. stands
         solved = .false.
         if (.not. pinch%unbounded) call solve_pinch(ring, eta, pinch, root, solved)
         if (solved) then
            unchanged = same_joints(pinch, proposer) .or. abs(root - eta) <= 4.0_wp*epsilon(eta)*eta
            solution = critical_state(root, pinch)
            if (unchanged .and. root > 0.0_wp .and. root < 2.0_wp) return
            solved = root > low .and. root < high
         end if
         proposer = pinch_t()
         if (solved) proposer = pinch
         eta = merge(0.5_wp*(low + high), high, high_stands)
         if (solved) eta = root
      end do
      solution%status = discrete_status%unsettled
   end subroutine search_eta

   !> True if two states have the same active joints: equal pairs and the same sliding joint
   pure logical function same_joints(a, b)
      type(pinch_t), intent(in) :: a, b

      same_joints = a%sliding == b%sliding .and. all(a%left == b%left) .and. all(a%right == b%right)
   end function same_joints

   !> Critical state of a ring that has one: status found, with the thrust and the active joints
   pure type(discrete_solution_t) function critical_state(eta, pinch) result(solution)
      real(wp), intent(in) :: eta  !! Critical thickness ratio [-]
      type(pinch_t), intent(in) :: pinch
      integer :: joint(5), role(5)
      logical :: binds(5)

      joint = [pinch%left(1), pinch%right(1), pinch%left(2), pinch%right(2), pinch%sliding]
      role(1:2) = joint_role%extrados_hinge
      role(3:4) = joint_role%intrados_hinge
      role(5) = joint_role%slides
      binds = [.true., joint(2) /= joint(1), .true., joint(4) /= joint(3), joint(5) > 0]
      solution%status = discrete_status%found
      solution%eta = eta
      solution%thrust = 1.0_wp - pinch%deficit
      solution%active = count(binds)
      solution%joint = pack(joint, binds, spread(0, 1, 5))
      solution%role = pack(role, binds, spread(0, 1, 5))
   end function critical_state
end module couplet_heyman_discrete
