!> Where a ring pinches the thrust: the widest gap at one thickness, and the thickness at which that
!> gap closes
!>
!> Symbols as in couplet_heyman_discrete. The gap of a pair of joints (j, k) is the room between the
!> extrados of j and the intrados of k; the gap of the ring is that of its narrowest pair.
submodule (couplet_heyman_discrete) couplet_heyman_pinch
   implicit none

contains

   !> Largest gap over all deficits
   module procedure widest_gap
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
   end procedure widest_gap

   !> The joints that leave the least room for the thrust at one deficit
   pure subroutine narrowest_pair(ring, eta, deficit, pair, gap)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      real(wp), intent(in) :: deficit  !! 1 - H
      integer, intent(out) :: pair(2)  !! Lowest extrados and highest intrados joint: (2)
      real(wp), intent(out) :: gap     !! Room between them
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

   !> Where the gaps of two pairs are equal
   pure subroutine meet(ring, eta, left, right, deficit, gap)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      integer, intent(in) :: left(2)    !! Pair whose gap grows with the deficit: (2)
      integer, intent(in) :: right(2)   !! Pair whose gap shrinks with it: (2)
      real(wp), intent(out) :: deficit  !! 1 - H at the meeting
      real(wp), intent(out) :: gap      !! Both gaps there

      deficit = (pair_gap(ring, eta, 0.0_wp, right) - pair_gap(ring, eta, 0.0_wp, left)) &
              /(gap_slope(ring, eta, left) - gap_slope(ring, eta, right))
      gap = pair_gap(ring, eta, deficit, left)
   end subroutine meet

   !> Thickness ratio at which the pinching joints just let the thrust through
   module procedure solve_pinch
      !> Quadratic convergence takes 3 to 8
      integer, parameter :: most_steps = 60
      !> A relative step this short leaves rounding alone to the next one
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
   end procedure solve_pinch

   !> Step towards the vanishing of both gaps, or of one where friction holds the deficit
   pure subroutine newton_step(ring, eta, pinch, eta_step, deficit_step)
      type(ring_t), intent(in) :: ring
      real(wp), intent(in) :: eta
      type(pinch_t), intent(in) :: pinch
      real(wp), intent(out) :: eta_step      !! Change of eta; huge where there is none
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

end submodule couplet_heyman_pinch
