!> The ring of joints behind couplet_heyman_discrete: its shape, and the thrusts that friction
!> allows
!>
!> Symbols as there: d = 1 - H the deficit of the thrust, v = 1 - cos t, z = W sin t - M - v, N = n
!> - d cos t with n = cos t + W sin t, and M the moment of the weights over 1 + eta^2/12. Only
!> differences of z and M between joints matter, so both are counted from the first joint.
submodule (couplet_heyman_discrete) couplet_heyman_ring
   use couplet_heyman_kernels, only : arc_excess, arm_excess
   implicit none

contains

   !> Shape of the ring from its joints
   module procedure make_ring
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
   end procedure make_ring

   !> One step of a compensated sum: ten thousand voussoirs lose no digit
   pure subroutine add_exactly(term, before, carry, after)
      real(wp), intent(in) :: term      !! What is added
      real(wp), intent(in) :: before    !! Sum before
      real(wp), intent(inout) :: carry  !! What rounding has left out so far
      real(wp), intent(out) :: after    !! Sum after
      real(wp) :: corrected

      corrected = term + carry
      after = before + corrected
      carry = corrected - (after - before)
   end subroutine add_exactly

   !> Thrusts that friction allows
   module procedure limit_thrust
      !> A quarter of a turn [rad]
      real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp)
      integer :: j, last

      if (friction >= quarter) return
      last = size(joint_angle)
      if (springing_no_slip) last = last - 1
      do j = 1, last
         if (joint_angle(j) <= 0.0_wp) cycle
         call limit_deficit(joint_angle(j) + friction, ring%lightness(j) + friction, +1, j, ring)
         call limit_deficit(joint_angle(j) - friction, ring%lightness(j) - friction, -1, j, ring)
      end do
   end procedure limit_thrust

   !> Keep the deficit where side (H sin x - W cos x) >= 0
   !>
   !> The deficit at equality is 1 - W cot x = (k(x) + (x - W) cos x)/sin x, a sum of small terms
   pure subroutine limit_deficit(x, excess, side, joint, ring)
      !> Angle of the joint, plus or minus that of friction [rad]
      real(wp), intent(in) :: x
      !> x - W
      real(wp), intent(in) :: excess
      !> +1 or -1: the sense of the inequality
      integer, intent(in) :: side
      !> Index of the joint
      integer, intent(in) :: joint
      !> The ring: its limits of the deficit are narrowed
      type(ring_t), intent(inout) :: ring
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

end submodule couplet_heyman_ring
