!> Shapes of arches by span and rise, or by radius and angle
module dda_arch_form
   use dda_arch_curve, only : close_curve, curve_t, piece_form, piece_t
   use dda_kinds, only : degree, pi, wp
   implicit none
   private

   public :: arch_form_t, form_curve, form_problem_t

   !> Numbers that make an arch
   type :: arch_form_t
      character(len=16) :: shape = "circular"  !! One of the words of arch%shape
      !> True if made from radius and half angle of its middle line, else from span and rise of its
      !> intrados
      logical :: by_radius = .true.
      real(wp) :: radius = 10.0_wp  !! Radius half way between intrados and extrados [m]
      !> Angle from the crown to a springing; of a flat arch, of its skewbacks from upright [deg]
      real(wp) :: half_angle_deg = 90.0_wp
      real(wp) :: span = 0.0_wp  !! Distance of the springings of the intrados along x [m]
      !> Height of the crown of the intrados above its springings, left and right: (2) [m]
      real(wp) :: rise(2) = 0.0_wp
      real(wp) :: thickness(2) = 0.0_wp  !! Thickness at the crown and at the springings: (2) [m]
      !> True if joints point from a centre; else they are square to the middle line
      logical :: radial = .false.
      integer :: voussoirs = 36       !! Voussoirs of a ring
      real(wp) :: facet_deg = 0.0_wp  !! Largest angle of a chord; 0 for one chord a voussoir [deg]
      integer :: rings = 1            !! Rings
      integer :: spans = 1            !! Spans
      real(wp) :: pier(2) = 0.0_wp    !! Width and height of the piers: (2) [m]
      !> Width and height of the two buttresses; no width for springings that are fixed: (2) [m]
      real(wp) :: buttress(2) = 0.0_wp
      integer :: courses = 1        !! Blocks of a pier, or of a buttress, one on the other
      logical :: no_slip = .false.  !! True if joints at fixed blocks cannot slide
   end type arch_form_t

   !> Error in the form of an arch
   type :: form_problem_t
      !> Message with the expected value, the one that was read and a remedy; empty without error
      character(len=200) :: text = ""
      character(len=24) :: key = "shape"  !! Key of &arch at fault
   end type form_problem_t

contains

   !> The line of a form: the intrados, or the middle of what is made by radius and angle
   pure subroutine form_curve(form, curve, problem)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(out) :: curve
      type(form_problem_t), intent(out) :: problem

      allocate (curve%piece(1))
      if (form%by_radius) then
         associate (angle => degree*form%half_angle_deg)
            curve%piece(1) = arc([0.0_wp, 0.0_wp], form%radius, [-angle, angle])
            if (form%shape == "segmental" .and. form%half_angle_deg > 90.0_wp) problem = &
               & form_problem_t("expected at most 90 of a segment, got more; choose shape = "// &
               & "'circular'", "half_angle_deg")
         end associate
      else
         call span_curve(form, curve, problem)
      end if
      if (len_trim(problem%text) > 0) return
      call close_curve(curve)
      call find_crown(form, curve)
   end subroutine form_curve

   !> A circular arc
   pure type(piece_t) function arc(centre, radius, ends)
      real(wp), intent(in) :: centre(2)  !! Its centre: (2) [m]
      real(wp), intent(in) :: radius     !! Its radius [m]
      real(wp), intent(in) :: ends(2)    !! Angles of its ends from upright, to the right: (2) [rad]

      arc = piece_t(piece_form%ellipse, centre, radius, radius, ends)
   end function arc

   !> The line of a form by span and rise; the left springing is half a span left of the origin
   pure subroutine span_curve(form, curve, problem)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(inout) :: curve
      type(form_problem_t), intent(inout) :: problem
      real(wp) :: a, left, crown(2)

      associate (rise => form%rise, span => form%span)
         select case (form%shape)
         case ("circular", "segmental")
            call add_arc(form, curve, problem)
         case ("pointed")
            if (any(rise < 0.5_wp*span)) problem = form_problem_t("expected a pointed arch "// &
               & "with rises of half the span or more, got less; choose shape = 'segmental'", &
               & "rise")
            curve%pointed = any(rise > 0.5_wp*span)
            deallocate (curve%piece)
            allocate (curve%piece(2))
            curve%piece(1) = half_pointed(0.5_wp*span, rise(1), 0.0_wp, .false.)
            curve%piece(2) = half_pointed(0.5_wp*span, rise(2), rise(1) - rise(2), .true.)
         case ("elliptic")
            ! the higher springing cuts the ellipse of the lower one
            a = span/(1.0_wp + sqrt(1.0_wp - (1.0_wp - minval(rise)/maxval(rise))**2))
            left = merge(a, span - a, rise(1) >= rise(2))
            crown = [left - 0.5_wp*span, rise(1)]
            curve%piece(1) = piece_t(piece_form%ellipse, crown - [0.0_wp, maxval(rise)], a, &
               & maxval(rise), [-acos(1.0_wp - rise(1)/maxval(rise)), &
               & acos(1.0_wp - rise(2)/maxval(rise))])
         case ("parabolic")
            left = span/(1.0_wp + sqrt(rise(2)/rise(1)))
            curve%piece(1) = piece_t(piece_form%parabola, [left - 0.5_wp*span, rise(1)], &
               & 0.5_wp*left**2/rise(1), 0.0_wp, [-left, span - left])
         case ("catenary")
            a = catenary_radius(span, rise)
            left = half_catenary(a, rise(1))
            curve%piece(1) = piece_t(piece_form%catenary, [left - 0.5_wp*span, rise(1)], a, &
               & 0.0_wp, [-left, half_catenary(a, rise(2))])
         case ("basket")
            call add_basket(form, curve, problem)
         case default
            curve%piece(1) = piece_t(piece_form%line, [0.0_wp, 0.0_wp], 0.0_wp, 0.0_wp, &
               & 0.5_wp*[-span, span])
         end select
      end associate
   end subroutine span_curve

   !> A circular arc over springings that may lie at different heights
   pure subroutine add_arc(form, curve, problem)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(inout) :: curve
      type(form_problem_t), intent(inout) :: problem  !! A rise that is no segment's
      real(wp) :: left, radius, right, p, q

      associate (l => form%span, h => form%rise)
         ! left**2 = 2 radius h1 - h1**2, right likewise, and both make the span
         p = l*h(1)
         q = h(1)*(l**2 + h(2)**2 - h(1)*h(2))
         left = q/(p + sqrt(p**2 + (h(2) - h(1))*q))
         radius = 0.5_wp*(left**2/h(1) + h(1))
         right = l - left
         if (form%shape == "segmental" .and. any(h > radius*(1.0_wp + 1.0e-12_wp))) problem = &
            & form_problem_t("expected a rise of a segment of at most half the span, got more; "// &
            & "lower it, or choose shape = 'circular'", "rise")
         if (form%shape == "circular" .and. any(h >= 2.0_wp*radius)) problem = &
            & form_problem_t("expected a rise that a circle over the span has, got another; "// &
            & "change it", "rise")
         curve%piece(1) = arc([left - 0.5_wp*l, h(1) - radius], radius, &
            & [-atan2(left, radius - h(1)), atan2(right, radius - h(2))])
      end associate
   end subroutine add_arc

   !> Half of a pointed arch: an arc whose centre is as high as its springing
   pure type(piece_t) function half_pointed(half_span, rise, level, is_right)
      real(wp), intent(in) :: half_span  !! Distance of the crown from the springing along x [m]
      real(wp), intent(in) :: rise       !! Height of the crown above the springing [m]
      real(wp), intent(in) :: level      !! Height of the springing [m]
      logical, intent(in) :: is_right    !! True for the right half
      real(wp) :: radius, apex, way

      radius = 0.5_wp*(half_span**2 + rise**2)/half_span
      apex = atan2(radius - half_span, rise)
      way = merge(-1.0_wp, 1.0_wp, is_right)
      half_pointed = arc([way*(radius - half_span), level], radius, [-0.5_wp*pi, -apex])
      if (is_right) half_pointed%ends = [apex, 0.5_wp*pi]
   end function half_pointed

   !> The three-centred arch whose radii differ by the least factor
   pure subroutine add_basket(form, curve, problem)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(inout) :: curve
      !> Springings of different heights, or a rise above half the span
      type(form_problem_t), intent(inout) :: problem
      real(wp) :: chord, half, inner, outer, turn

      half = 0.5_wp*form%span
      if (abs(form%rise(1) - form%rise(2)) > 0.0_wp) problem = form_problem_t("expected a "// &
         & "basket arch with springings of one height, got two; remove right_rise", "right_rise")
      if (form%rise(1) >= half) problem = form_problem_t("expected a basket arch with a rise "// &
         & "below half the span, got more; lower it, or choose shape = 'circular'", "rise")
      if (len_trim(problem%text) > 0) return
      chord = hypot(half, form%rise(1))
      inner = 0.5_wp*chord*(chord - (half - form%rise(1)))/half
      outer = 0.5_wp*chord*(chord + (half - form%rise(1)))/form%rise(1)
      turn = atan2(half - inner, outer - form%rise(1))
      deallocate (curve%piece)
      allocate (curve%piece(3))
      curve%piece(1) = arc([inner - half, 0.0_wp], inner, [-0.5_wp*pi, -turn])
      curve%piece(2) = arc([0.0_wp, form%rise(1) - outer], outer, [-turn, turn])
      curve%piece(3) = arc([half - inner, 0.0_wp], inner, [turn, 0.5_wp*pi])
   end subroutine add_basket

   !> Radius at the crown of the catenary over a span, by bisection
   pure real(wp) function catenary_radius(span, rise) result(a)
      real(wp), intent(in) :: span     !! The span [m]
      real(wp), intent(in) :: rise(2)  !! Height of the crown above the springings: (2) [m]
      real(wp) :: low, high
      integer :: i

      ! a parabola of the same radius at the crown is wider
      low = 0.5_wp*(span/sum(sqrt(rise)))**2
      high = 2.0_wp*low
      do while (half_catenary(high, rise(1)) + half_catenary(high, rise(2)) < span)
         high = 2.0_wp*high
      end do
      do i = 1, 200
         a = 0.5_wp*(low + high)
         if (.not. (a > low .and. a < high)) exit
         if (half_catenary(a, rise(1)) + half_catenary(a, rise(2)) < span) then
            low = a
         else
            high = a
         end if
      end do
   end function catenary_radius

   !> Distance of a springing of a catenary from its crown along x [m]
   pure real(wp) function half_catenary(a, rise)
      real(wp), intent(in) :: a  !! Radius at the crown [m]
      real(wp), intent(in) :: rise

      half_catenary = 2.0_wp*a*asinh(sqrt(0.5_wp*rise/a))
   end function half_catenary

   !> Where the crown is along the line: its highest point, or the middle of a flat one
   pure subroutine find_crown(form, curve)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(inout) :: curve
      type(curve_t) :: left

      associate (whole => curve%length(size(curve%piece)))
         curve%crown = 0.5_wp*whole
         if (form%by_radius .or. form%shape == "flat") return
         if (.not. abs(form%rise(1) - form%rise(2)) > 0.0_wp) return
      end associate
      if (size(curve%piece) == 2) then
         curve%crown = curve%length(1)
         return
      end if
      left%piece = curve%piece(:1)
      left%piece(1)%ends(2) = 0.0_wp
      call close_curve(left)
      curve%crown = left%length(1)
   end subroutine find_crown
end module dda_arch_form
