!> Sections of an arch: joints, and corners of the chords between them
submodule (dda_arch_assembly) dda_arch_sections
   use dda_arch_curve, only : curve_length, curve_t, station_at, station_t
   use dda_arch_form, only : form_curve
   use dda_kinds, only : degree
   use dda_vector, only : cross
   implicit none

   !> Difference below which lengths are equal, over the total length
   real(wp), parameter :: same = 1.0e-9_wp

contains

   !> The sections of a form
   module procedure arch_sections
      type(curve_t) :: curve
      type(station_t) :: crown
      real(wp), allocatable :: at(:)
      integer :: i

      call form_curve(form, curve, problem)
      if (len_trim(problem%text) > 0) return
      call place_sections(form, curve, at, sections%is_joint)
      allocate (sections%intrados(2, size(at)), sections%extrados(2, size(at)))
      do i = 1, size(at)
         call cut_section(form, curve, at(i), sections%intrados(:, i), sections%extrados(:, i))
      end do
      crown = station_at(curve, curve%crown, .false.)
      sections%crown_x = crown%point(1)
      call check_sections(sections, problem)
   end procedure arch_sections

   !> Lengths at which there are sections: joints of equal voussoirs, a bend, chords in between
   pure subroutine place_sections(form, curve, at, is_joint)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(in) :: curve
      real(wp), allocatable, intent(out) :: at(:)       !! The lengths, rising: (n) [m]
      logical, allocatable, intent(out) :: is_joint(:)  !! True for those at joints: (n)
      real(wp), allocatable :: row(:, :)
      real(wp) :: from, to, whole
      integer :: i, n

      whole = curve_length(curve)
      allocate (row(1, 1), source=0.0_wp)
      allocate (is_joint(1), source=.true.)
      n = 1
      do i = 1, form%voussoirs
         from = row(1, n)
         to = whole*real(i, wp)/real(form%voussoirs, wp)
         if (curve%pointed .and. abs(to - curve%crown) <= same*whole) to = curve%crown
         if (curve%pointed .and. from < curve%crown .and. to > curve%crown) then
            call add_chords(form, curve, from, curve%crown, n, row, is_joint)
            is_joint(n) = .false.
            from = curve%crown
         end if
         call add_chords(form, curve, from, to, n, row, is_joint)
      end do
      at = row(1, :n)
      is_joint = is_joint(:n)
   end subroutine place_sections

   !> Add sections up to a joint, so many that no chord spans too large an angle
   pure subroutine add_chords(form, curve, from, to, n, row, is_joint)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(in) :: curve
      !> Length where they begin, a section already [m]
      real(wp), intent(in) :: from
      real(wp), intent(in) :: to       !! Length of the joint [m]
      integer, intent(inout) :: n      !! Number of sections
      !> Receives their lengths, with room for more: (1, n) [m]
      real(wp), allocatable, intent(inout) :: row(:, :)
      logical, allocatable, intent(inout) :: is_joint(:)  !! Receives that the last is a joint: (n)
      type(station_t) :: first, last
      integer :: i, n_chord

      n_chord = 1
      if (form%facet_deg > 0.0_wp) then
         first = station_at(curve, from, .true.)
         last = station_at(curve, to, .false.)
         n_chord = max(1, ceiling(abs(atan2(cross(first%along, last%along), &
            & dot_product(first%along, last%along)))/(degree*form%facet_deg) - same))
      end if
      call make_room(row, n + n_chord)
      call make_room(is_joint, n + n_chord)
      do i = 1, n_chord
         row(1, n + i) = from + (to - from)*real(i, wp)/real(n_chord, wp)
         is_joint(n + i) = i == n_chord
      end do
      n = n + n_chord
      row(1, n) = to
   end subroutine add_chords

   !> Ends of a section
   pure subroutine cut_section(form, curve, at, intrados, extrados)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: at            !! Length along the line [m]
      real(wp), intent(out) :: intrados(2)  !! Its inner end: (2) [m]
      real(wp), intent(out) :: extrados(2)  !! Its outer end: (2) [m]
      type(station_t) :: station
      real(wp) :: across(2), share, slope, thickness, middle(2)

      station = station_at(curve, at, .false.)
      if (at < curve%crown) then
         share = (curve%crown - at)/curve%crown
         slope = -1.0_wp/curve%crown
      else
         share = (at - curve%crown)/(curve_length(curve) - curve%crown)
         slope = 1.0_wp/(curve_length(curve) - curve%crown)
      end if
      if (abs(at - curve%crown) <= same*curve%crown) slope = 0.0_wp
      thickness = form%thickness(1) + share*(form%thickness(2) - form%thickness(1))
      slope = slope*(form%thickness(2) - form%thickness(1))
      intrados = station%point
      if (curve%pointed .and. .not. abs(at - curve%crown) > 0.0_wp) then
         extrados = outer_apex(curve, thickness)
      else if (form%by_radius) then
         intrados = station%point - 0.5_wp*thickness*station%outward
         extrados = station%point + 0.5_wp*thickness*station%outward
      else if (form%radial) then
         extrados = intrados + thickness*from_centre(form, curve, station)
      else if (abs(slope) > 0.0_wp) then
         ! square to the middle line, whose derivative has the slope of the thickness in it
         middle = station%point + 0.5_wp*thickness*station%outward
         across = (1.0_wp + 0.5_wp*thickness*station%curvature)*station%outward &
            & - 0.5_wp*slope*station%along
         across = across/norm2(across)
         intrados = middle - 0.5_wp*thickness*across
         extrados = middle + 0.5_wp*thickness*across
      else
         extrados = intrados + thickness*station%outward
      end if
   end subroutine cut_section

   !> Direction of a joint that points from a centre: that of the arc; of an ellipse, a parabola or
   !> a catenary, the middle between the springings; of a flat arch, where its skewbacks meet. The
   !> joint of a flat arch reaches to the level extrados
   pure function from_centre(form, curve, station) result(across)
      type(arch_form_t), intent(in) :: form
      type(curve_t), intent(in) :: curve
      type(station_t), intent(in) :: station
      real(wp) :: across(2)  !! Direction; a unit vector except for flat arches: (2)
      type(station_t) :: left, right

      across = station%outward
      select case (form%shape)
      case ("elliptic", "parabolic", "catenary")
         left = station_at(curve, 0.0_wp, .false.)
         right = station_at(curve, curve_length(curve), .false.)
         across = station%point - 0.5_wp*(left%point + right%point)
         across = across/norm2(across)
      case ("flat")
         across = [tan(degree*form%half_angle_deg)*station%point(1)/(0.5_wp*form%span), 1.0_wp]
      end select
   end function from_centre

   !> Where the extrados of the two arcs of a pointed arch meet
   pure function outer_apex(curve, thickness) result(point)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: thickness  !! Thickness at the crown [m]
      real(wp) :: point(2)               !! The point: (2) [m]
      real(wp) :: apart(2), distance, radius(2), foot

      radius = curve%piece%a + thickness
      apart = curve%piece(2)%centre - curve%piece(1)%centre
      distance = norm2(apart)
      foot = 0.5_wp*(distance + (radius(1)**2 - radius(2)**2)/distance)
      apart = apart/distance
      point = curve%piece(1)%centre + foot*apart
      ! the arc on the left has its centre on the right
      point = point + sqrt(max(0.0_wp, radius(1)**2 - foot**2))*[apart(2), -apart(1)]
   end function outer_apex

   !> Check that no two joints cross
   pure subroutine check_sections(sections, problem)
      type(arch_sections_t), intent(in) :: sections
      type(form_problem_t), intent(inout) :: problem
      integer :: i

      do i = 2, size(sections%is_joint)
         associate (a => sections%intrados(:, i - 1), b => sections%intrados(:, i), &
            & c => sections%extrados(:, i), d => sections%extrados(:, i - 1))
            if (min(cross(b - a, c - a), cross(c - a, d - a), cross(b - a, d - a), &
               & cross(c - b, d - b)) > 0.0_wp) cycle
            problem = form_problem_t("expected joints that do not cross, got some that do: "// &
               & "the arch is too thick where it bends, or joints lean too much; make it thinner", &
               & "thickness")
            return
         end associate
      end do
   end subroutine check_sections

end submodule dda_arch_sections
