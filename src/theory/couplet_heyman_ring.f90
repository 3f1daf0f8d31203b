!> The ring of joints of couplet_heyman_discrete: shape, admissible thrusts, widest gap, and the
!> thickness at which it closes
!>
!> Symbols as there: d = 1 - H the deficit of the thrust, v = 1 - cos t, z = W sin t - M - v, N = n
!> - d cos t with n = cos t + W sin t, and M the moment of the weights over 1 + eta^2/12. Only
!> differences of z and M between joints matter, so both are relative to the first joint. The gap
!> of a pair of joints (j, k) is the distance of the extrados of j from the intrados of k; the gap
!> of the ring is the smallest of all pairs.
module couplet_heyman_ring
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_equations, only : arc_excess, arm_excess, versine
   implicit none
   private

   public :: ring_t, pinch_t, make_ring, limit_thrust, widest_gap, solve_pinch

   !> One half of an arch per joint, independent of eta
   type :: ring_t
      real(wp), allocatable :: cosine(:)   !! Cosine of the joint's angle: (:)
      real(wp), allocatable :: versine(:)  !! 1 - cosine: (:)
      !> z, the height of the weights' funicular over the circle, small of fourth order: (:)
      real(wp), allocatable :: form(:)
      real(wp), allocatable :: moment(:)     !! M, moment of the weights above the joint: (:)
      real(wp), allocatable :: normal(:)     !! n, normal force at the joint for H = 1: (:)
      real(wp), allocatable :: lightness(:)  !! Angle minus weight above the joint, t - W: (:)
      real(wp) :: lowest = -huge(1.0_wp)     !! Lower bound of the deficit by friction
      real(wp) :: highest = huge(1.0_wp)     !! Upper bound of the deficit by friction
      integer :: lowest_joint = 0            !! Joint whose friction gives lowest; 0 if none
      integer :: highest_joint = 0           !! Joint whose friction gives highest; 0 if none
   end type ring_t

   !> Position of the widest gap at one eta, and its active joints
   type :: pinch_t
      real(wp) :: deficit = 0.0_wp  !! Deficit of the thrust there
      real(wp) :: gap = 0.0_wp      !! The gap there
      !> True if the gap grows without bound with the thrust: a straight thrust line fits in the
      !> ring
      logical :: unbounded = .false.
      !> Extrados and intrados joint that limit the gap at smaller deficits: (2)
      integer :: left(2) = 0
      !> Extrados and intrados joint that limit it at greater deficits; equal to left at a sliding
      !> joint: (2)
      integer :: right(2) = 0
      integer :: sliding = 0  !! Joint whose friction limits the deficit; 0 if none
   end type pinch_t

contains

   !> Shape of the ring from its joints; docs/theory.md has the identity for the increments of form
   pure subroutine make_ring(joint_angle, facets, ring)
      real(wp), intent(in) :: joint_angle(:)  !! Joints of one half, from the crown: (n) [rad]
      !> Equal chords of each voussoir: (n - 1), or (n) if the first is at the crown
      integer, intent(in) :: facets(:)
      type(ring_t), intent(out) :: ring
      real(wp) :: span, chord, middle, half_sine, chord_loss
      real(wp) :: lightness_rise, lightness_middle, form_rise, form_carry
      integer :: n, j, above

      n = size(joint_angle)
      above = n - size(facets)
      ring%cosine = cos(joint_angle)
      ring%versine = versine(joint_angle)
      allocate (ring%form(n), ring%moment(n), ring%lightness(n))
      ring%form(1) = 0.0_wp
      ring%moment(1) = 0.0_wp
      ring%lightness(1) = 0.0_wp
      if (above == 0) then
         ring%lightness(1) = 0.5_wp*facets(1)*arc_excess(2.0_wp*joint_angle(1)/facets(1))
      end if
      form_carry = 0.0_wp
      do j = 2, n
         span = joint_angle(j) - joint_angle(j - 1)
         middle = 0.5_wp*(joint_angle(j) + joint_angle(j - 1))
         chord = span/facets(j - above)
         half_sine = sin(0.5_wp*span)
         chord_loss = sin(0.5_wp*chord)**2
         lightness_rise = facets(j - above)*arc_excess(chord)
         lightness_middle = ring%lightness(j - 1) + 0.5_wp*lightness_rise
         form_rise = sin(middle)*(2.0_wp*chord_loss*half_sine - lightness_rise*cos(0.5_wp*span)) &
                   - 2.0_wp*(half_sine*(arm_excess(middle) + cos(middle)*lightness_middle) &
                             + arm_excess(0.5_wp*span)*sin(middle))
         ring%lightness(j) = ring%lightness(j - 1) + lightness_rise
         ring%moment(j) = ring%moment(j - 1) + 2.0_wp*(1.0_wp - chord_loss)*half_sine*sin(middle)
         call add_exactly(form_rise, ring%form(j - 1), form_carry, ring%form(j))
      end do
      ring%normal = ring%cosine + (joint_angle - ring%lightness)*sin(joint_angle)
   end subroutine make_ring

   !> One step of a compensated sum, so that ten thousand voussoirs lose no digit
   pure subroutine add_exactly(term, before, carry, after)
      real(wp), intent(in) :: term      !! Term to add
      real(wp), intent(in) :: before    !! Sum before
      real(wp), intent(inout) :: carry  !! Accumulated round-off
      real(wp), intent(out) :: after    !! Sum after
      real(wp) :: corrected

      corrected = term + carry
      after = before + corrected
      carry = corrected - (after - before)
   end subroutine add_exactly

   !> Set the limits of the thrust by friction: H sin(t + phi) >= W cos(t + phi) and H sin(t - phi)
   !> <= W cos(t - phi) at each joint; a joint at the crown has no shear, by symmetry
   pure subroutine limit_thrust(joint_angle, friction, springing_no_slip, ring)
      real(wp), intent(in) :: joint_angle(:)
      real(wp), intent(in) :: friction          !! Friction angle; from pi/2 on no slip [rad]
      logical, intent(in) :: springing_no_slip  !! True if the last joint cannot slide
      type(ring_t), intent(inout) :: ring       !! The ring; its limits of the deficit are set
      real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp)  !! 90 degrees [rad]
      integer :: j, last

      if (friction >= quarter) return
      last = size(joint_angle)
      if (springing_no_slip) last = last - 1
      do j = 1, last
         if (joint_angle(j) <= 0.0_wp) cycle
         call limit_deficit(joint_angle(j) + friction, ring%lightness(j) + friction, +1, j, ring)
         call limit_deficit(joint_angle(j) - friction, ring%lightness(j) - friction, -1, j, ring)
      end do
   end subroutine limit_thrust

   !> Limit the deficit to side (H sin x - W cos x) >= 0
   !>
   !> The deficit at equality is 1 - W cot x = (k(x) + (x - W) cos x)/sin x, a sum of small terms
   pure subroutine limit_deficit(x, excess, side, joint, ring)
      real(wp), intent(in) :: x       !! Angle of the joint, plus or minus that of friction [rad]
      real(wp), intent(in) :: excess  !! x - W
      integer, intent(in) :: side     !! +1 or -1: the sense of the inequality
      integer, intent(in) :: joint    !! Index of the joint
      type(ring_t), intent(inout) :: ring  !! The ring; its limits of the deficit are narrowed
      real(wp) :: bound
      logical :: caps_deficit

      if (abs(sin(x)) <= tiny(x)) return
      bound = (arm_excess(x) + excess*cos(x))/sin(x)
      caps_deficit = side*sin(x) > 0.0_wp
      if (caps_deficit .and. bound < ring%highest) then
         ring%highest = bound
         ring%highest_joint = joint
      else if (.not. caps_deficit .and. bound > ring%lowest) then
         ring%lowest = bound
         ring%lowest_joint = joint
      end if
   end subroutine limit_deficit

   !> Largest gap over all deficits: the maximum of a concave polygon, by tangents from both sides
   pure subroutine widest_gap(ring, eta, pinch)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta          !! Thickness ratio [-]
      type(pinch_t), intent(out) :: pinch  !! Widest gap and its active joints
      integer :: pair(2), last
      real(wp) :: peak, previous_peak, slope
      logical :: too_low, too_high, rises_for_ever, falls_for_ever

      last = size(ring%form)
      pinch%left = [last, 1]
      pinch%right = [1, last]
      falls_for_ever = gap_slope(ring, eta, pinch%left) <= 0.0_wp
      rises_for_ever = gap_slope(ring, eta, pinch%right) >= 0.0_wp
      pinch%unbounded = (falls_for_ever .and. ring%lowest_joint == 0) &
                   .or. (rises_for_ever .and. ring%highest_joint == 0)
      if (pinch%unbounded) return
      previous_peak = huge(peak)
      do
         call meet(ring, eta, pinch%left, pinch%right, pinch%deficit, peak)
         too_low = pinch%deficit < ring%lowest .or. falls_for_ever
         too_high = pinch%deficit > ring%highest .or. rises_for_ever
         if (too_low) pinch%deficit = ring%lowest
         if (too_high) pinch%deficit = ring%highest
         call narrowest_pair(ring, eta, pinch%deficit, pair, pinch%gap)
         slope = gap_slope(ring, eta, pair)
         if ((too_low .and. slope <= 0.0_wp) .or. (too_high .and. slope >= 0.0_wp)) then
            pinch%left = pair
            pinch%right = pair
            pinch%sliding = merge(ring%lowest_joint, ring%highest_joint, too_low)
            return
         end if
         if (all(pair == pinch%left) .or. all(pair == pinch%right)) return
         if (.not. (too_low .or. too_high)) then
            if (pinch%gap >= peak .or. peak >= previous_peak) return
            previous_peak = peak
         end if
         if (slope > 0.0_wp) pinch%left = pair
         if (slope <= 0.0_wp) pinch%right = pair
      end do
   end subroutine widest_gap

   !> Pair of joints with the smallest gap at one deficit
   pure subroutine narrowest_pair(ring, eta, deficit, pair, gap)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      real(wp), intent(in) :: deficit  !! 1 - H
      integer, intent(out) :: pair(2)  !! Lowest extrados and highest intrados joint: (2)
      real(wp), intent(out) :: gap     !! Gap between them
      real(wp) :: roof, floor, centre, reach
      integer :: j

      roof = huge(roof)
      floor = -huge(floor)
      pair = 1
      do j = 1, size(ring%form)
         centre = deficit*ring%versine(j) + ring%form(j) - eta*eta/12.0_wp*ring%moment(j)
         reach = 0.5_wp*eta*(ring%normal(j) - deficit*ring%cosine(j))
         if (centre + reach < roof) then
            roof = centre + reach
            pair(1) = j
         end if
         if (centre - reach > floor) then
            floor = centre - reach
            pair(2) = j
         end if
      end do
      gap = roof - floor
   end subroutine narrowest_pair

   !> Gap between the extrados of one joint and the intrados of another
   pure real(wp) function pair_gap(ring, eta, deficit, pair)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta, deficit
      integer, intent(in) :: pair(2)
      real(wp) :: reach

      associate (j => pair(1), k => pair(2))
         reach = ring%normal(j) + ring%normal(k) - deficit*(ring%cosine(j) + ring%cosine(k))
         pair_gap = deficit*(ring%versine(j) - ring%versine(k)) + (ring%form(j) - ring%form(k)) &
             + 0.5_wp*eta*reach - eta*eta/12.0_wp*(ring%moment(j) - ring%moment(k))
      end associate
   end function pair_gap

   !> Derivative of a pair's gap by the deficit
   pure real(wp) function gap_slope(ring, eta, pair) result(slope)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      integer, intent(in) :: pair(2)

      associate (j => pair(1), k => pair(2))
         slope = ring%versine(j) - ring%versine(k) - 0.5_wp*eta*(ring%cosine(j) + ring%cosine(k))
      end associate
   end function gap_slope

   !> Derivative of a pair's gap by eta
   pure real(wp) function gap_growth(ring, eta, deficit, pair)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta, deficit
      integer, intent(in) :: pair(2)

      associate (j => pair(1), k => pair(2))
         gap_growth = ring%normal(j) + ring%normal(k) - deficit*(ring%cosine(j) + ring%cosine(k))
         gap_growth = 0.5_wp*gap_growth - eta/6.0_wp*(ring%moment(j) - ring%moment(k))
      end associate
   end function gap_growth

   !> Deficit at which the gaps of two pairs are equal
   pure subroutine meet(ring, eta, left, right, deficit, gap)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      integer, intent(in) :: left(2)    !! Pair with a gap that increases with the deficit: (2)
      integer, intent(in) :: right(2)   !! Pair with a gap that decreases with the deficit: (2)
      real(wp), intent(out) :: deficit  !! 1 - H at equal gaps
      real(wp), intent(out) :: gap      !! Gap of both pairs there

      deficit = (pair_gap(ring, eta, 0.0_wp, right) - pair_gap(ring, eta, 0.0_wp, left)) &
              /(gap_slope(ring, eta, left) - gap_slope(ring, eta, right))
      gap = pair_gap(ring, eta, deficit, left)
   end subroutine meet

   !> Thickness ratio at which the gaps of the active joints vanish: Newton's method in eta and
   !> deficit
   pure subroutine solve_pinch(ring, start, pinch, eta, solved)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: start          !! Thickness ratio of this pinch [-]
      type(pinch_t), intent(inout) :: pinch  !! The active joints; its deficit is updated
      real(wp), intent(out) :: eta           !! Thickness ratio at which the gaps vanish [-]
      logical, intent(out) :: solved         !! True if the iteration has converged
      integer, parameter :: most_steps = 60  !! Quadratic convergence takes 3 to 8
      !> Relative step after which the next one is round-off
      real(wp), parameter :: last_but_one = 1.0e-8_wp
      real(wp) :: eta_step, deficit_step
      integer :: step

      eta = start
      solved = .false.
      do step = 1, most_steps
         call newton_step(ring, eta, pinch, eta_step, deficit_step)
         if (.not. abs(eta + eta_step) < 4.0_wp) return
         eta = eta + eta_step
         pinch%deficit = pinch%deficit + deficit_step
         if (solved) return
         solved = abs(eta_step) <= last_but_one*abs(eta)
      end do
      solved = .false.
   end subroutine solve_pinch

   !> Newton step towards zero gaps, or towards one zero gap at a deficit limited by friction
   pure subroutine newton_step(ring, eta, pinch, eta_step, deficit_step)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      type(pinch_t), intent(in) :: pinch
      real(wp), intent(out) :: eta_step      !! Change of eta; huge if there is none
      real(wp), intent(out) :: deficit_step  !! Change of the deficit
      real(wp) :: gap(2), growth(2), slope(2), determinant, size_of_terms

      gap = [pair_gap(ring, eta, pinch%deficit, pinch%left), &
             pair_gap(ring, eta, pinch%deficit, pinch%right)]
      growth = [gap_growth(ring, eta, pinch%deficit, pinch%left), &
                gap_growth(ring, eta, pinch%deficit, pinch%right)]
      slope = [gap_slope(ring, eta, pinch%left), gap_slope(ring, eta, pinch%right)]
      if (pinch%sliding > 0) then
         gap(1) = 0.0_wp
         growth(1) = 0.0_wp
         slope(1) = 1.0_wp
      end if
      eta_step = huge(eta_step)
      deficit_step = 0.0_wp
      determinant = growth(1)*slope(2) - growth(2)*slope(1)
      size_of_terms = abs(growth(1)*slope(2)) + abs(growth(2)*slope(1))
      if (abs(determinant) <= epsilon(determinant)*size_of_terms) return
      eta_step = (gap(2)*slope(1) - gap(1)*slope(2))/determinant
      deficit_step = (gap(1)*growth(2) - gap(2)*growth(1))/determinant
   end subroutine newton_step

end module couplet_heyman_ring
