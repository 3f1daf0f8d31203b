!> Fill on an arch up to a level surface: weight, passive pressure, load spread of axles
module dda_fill_loads
   use dda_arch_assembly, only : arch_assembly_t, top_chord_t
   use dda_arch_scene, only : unit_weight
   use dda_bar, only : bar_state_t, bar_t
   use dda_boundary, only : bounded_force_t, constant_history, loaded_point_t
   use dda_deck, only : deck_t, number_or
   use dda_key_names, only : analysis_collapse_displacement, analysis_geometry, analysis_mode, &
      & fill_backing_height, fill_backing_unit_weight, fill_friction_deg, fill_height, &
      & fill_passive_coefficient, fill_passive_share, fill_passive_stiffness, fill_spread, &
      & fill_unit_weight, joint_cohesion, joint_tension
   use dda_kinds, only : degree, wp
   use dda_scene, only : scene_t
   use dda_shape_scene, only : add_loads
   use dda_sort, only : sorted_order
   implicit none
   private

   public :: fill_t, add_fill_weight, fill_of, fill_yields, live_side, live_total, press_fill
   public :: press_side, side_changes

   !> The fill of a case
   type :: fill_t
      type(top_chord_t), allocatable :: chord(:)  !! Chords below the fill: (n)
      !> Abscissa of the crown of each span's extrados: (n_span) [m]
      real(wp), allocatable :: crown_x(:)
      real(wp) :: surface = 0.0_wp         !! Height of its surface [m]
      real(wp) :: unit_weight(2) = 0.0_wp  !! Weight per volume of fill and of backing: (2) [N/m3]
      !> Height of the surface of the backing; -huge if there is none [m]
      real(wp) :: backing = -huge(1.0_wp)
      real(wp) :: spread = 0.0_wp   !! Load spread of axles: width to either side over depth
      real(wp) :: passive = 0.0_wp  !! Largest horizontal pressure over the weight above
      !> True for passive pressure that follows the displacement, and its stiffness [N/m3]
      logical :: yields = .false.
      real(wp) :: stiffness = 0.0_wp
   end type fill_t

   !> Relative rise of a chord below which it receives no passive pressure
   real(wp), parameter :: level = 1.0e-9_wp
   !> Distance of loads from the crown that belong to neither side, over the width of the fill
   real(wp), parameter :: at_crown = 1.0e-12_wp
   !> Length of the bars of passive pressure over the width of the fill, so that they stay
   !> horizontal
   real(wp), parameter :: far = 1.0e3_wp

contains

   !> True if passive pressure or backing needs the displacement: in dynamic runs, in current
   !> geometry or with joint strength. Otherwise limit analysis decides
   pure logical function fill_yields(deck)
      type(deck_t), intent(in) :: deck

      fill_yields = deck%value(fill_passive_coefficient)%number > 0.0_wp &
         & .or. deck%value(fill_passive_share)%number > 0.0_wp &
         & .or. deck%value(fill_backing_height)%given
      fill_yields = fill_yields .and. (deck%value(analysis_mode)%text /= "static" &
         & .or. deck%value(analysis_geometry)%text /= "reference" &
         & .or. deck%value(analysis_collapse_displacement)%given &
         & .or. deck%value(joint_cohesion)%number > 0.0_wp &
         & .or. deck%value(joint_tension)%number > 0.0_wp)
   end function fill_yields

   !> Make the fill of a deck
   pure type(fill_t) function fill_of(deck, assembly) result(fill)
      type(deck_t), intent(in) :: deck  !! The deck of the case, with &fill
      type(arch_assembly_t), intent(in) :: assembly
      integer :: i

      allocate (fill%chord, source=assembly%top)
      allocate (fill%crown_x, source=[(crown_of(pack(assembly%top, assembly%top%span == i)), &
         & i=1, size(assembly%crown_x))])
      fill%surface = -huge(fill%surface)
      do i = 1, size(fill%chord)
         fill%surface = max(fill%surface, fill%chord(i)%left(2), fill%chord(i)%right(2))
      end do
      fill%surface = fill%surface + deck%value(fill_height)%number
      fill%unit_weight = deck%value(fill_unit_weight)%number
      fill%unit_weight(2) = number_or(deck, fill_backing_unit_weight, unit_weight(deck))
      if (deck%value(fill_backing_height)%given) fill%backing = assembly%springing_y &
         & + deck%value(fill_backing_height)%number
      fill%spread = deck%value(fill_spread)%number
      fill%yields = fill_yields(deck)
      fill%stiffness = deck%value(fill_passive_stiffness)%number
      fill%passive = deck%value(fill_passive_coefficient)%number
      if (deck%value(fill_passive_share)%given) fill%passive = &
         & deck%value(fill_passive_share)%number &
         & *tan(degree*(45.0_wp + 0.5_wp*deck%value(fill_friction_deg)%number))**2
   end function fill_of

   !> Abscissa of the crown of a span's extrados: between two chords of opposite slope, by linear
   !> interpolation of the slope; otherwise the highest point [m]
   pure real(wp) function crown_of(chord) result(x)
      type(top_chord_t), intent(in) :: chord(:)  !! Chords from left to right: (n)
      real(wp) :: middle(size(chord)), slope(size(chord)), highest
      integer :: i

      x = 0.0_wp
      highest = -huge(x)
      do i = 1, size(chord)
         middle(i) = 0.5_wp*(chord(i)%left(1) + chord(i)%right(1))
         slope(i) = (chord(i)%right(2) - chord(i)%left(2)) &
            & /(chord(i)%right(1) - chord(i)%left(1))
         if (chord(i)%left(2) > highest) x = chord(i)%left(1)
         if (max(highest, chord(i)%left(2)) < chord(i)%right(2)) x = chord(i)%right(1)
         highest = max(highest, chord(i)%left(2), chord(i)%right(2))
      end do
      do i = 1, size(chord) - 1
         if (slope(i) < 0.0_wp .or. slope(i + 1) > 0.0_wp .or. slope(i + 1) >= slope(i)) cycle
         x = middle(i) + (middle(i + 1) - middle(i))*slope(i)/(slope(i) - slope(i + 1))
         return
      end do
   end function crown_of

   !> Add the weight of the fill to the blocks below it, chord by chord
   pure subroutine add_fill_weight(fill, scene)
      type(fill_t), intent(in) :: fill
      type(scene_t), intent(inout) :: scene  !! The scene; loads are added
      type(loaded_point_t) :: loaded(size(fill%chord))
      real(wp) :: weight, x
      integer :: i

      do i = 1, size(fill%chord)
         call weigh(fill, fill%chord(i), weight, x)
         loaded(i)%block = fill%chord(i)%block
         loaded(i)%point = [x, 0.5_wp*(fill%chord(i)%left(2) + fill%chord(i)%right(2))] &
            & - scene%origin
         loaded(i)%force = constant_history([0.0_wp, -weight])
      end do
      call add_loads(loaded, scene)
   end subroutine add_fill_weight

   !> Weight of the fill and the backing above a chord, and its line of action
   pure subroutine weigh(fill, chord, weight, x)
      type(fill_t), intent(in) :: fill
      type(top_chord_t), intent(in) :: chord
      real(wp), intent(out) :: weight  !! The weight [N/m]
      real(wp), intent(out) :: x       !! Abscissa of its resultant [m]
      real(wp) :: sums(2), part(2), bend

      ! all of it as fill, then the difference of backing and fill
      sums = fill%unit_weight(1)*trapezium(chord%left, chord%right, fill%surface)
      part = 0.0_wp
      associate (low => min(chord%left(2), chord%right(2)), &
         & high => max(chord%left(2), chord%right(2)), &
         & top => min(fill%backing, fill%surface))
         if (top >= high) then
            part = trapezium(chord%left, chord%right, top)
         else if (top > low) then
            bend = chord%left(1) + (top - chord%left(2))*(chord%right(1) - chord%left(1)) &
               & /(chord%right(2) - chord%left(2))
            if (chord%left(2) < chord%right(2)) then
               part = trapezium(chord%left, [bend, top], top)
            else
               part = trapezium([bend, top], chord%right, top)
            end if
         end if
      end associate
      sums = sums + (fill%unit_weight(2) - fill%unit_weight(1))*part
      weight = sums(1)
      x = 0.5_wp*(chord%left(1) + chord%right(1))
      if (weight > 0.0_wp) x = sums(2)/weight
   end subroutine weigh

   !> Area between a horizontal line and a chord, and its first moment along x
   pure function trapezium(left, right, top) result(part)
      real(wp), intent(in) :: left(2)   !! Left end of the chord: (2) [m]
      real(wp), intent(in) :: right(2)  !! Right end of the chord: (2) [m]
      real(wp), intent(in) :: top       !! Height of the line [m]
      real(wp) :: part(2)               !! Area and moment: (2) [m2, m3]
      real(wp) :: depth(2), width

      depth = top - [left(2), right(2)]
      width = right(1) - left(1)
      part(1) = 0.5_wp*width*sum(depth)
      part(2) = left(1)*part(1) + width**2*(depth(1) + 2.0_wp*depth(2))/6.0_wp
   end function trapezium

   !> Add the passive pressure of the fill to a scene
   pure subroutine press_fill(fill, scene)
      type(fill_t), intent(in) :: fill
      !> The scene with its live loads; its forces between zero and a bound are set
      type(scene_t), intent(inout) :: scene
      integer :: side

      side = 0
      if (allocated(scene%settings%boundary%loaded)) &
         & side = live_side(fill, scene%origin, scene%settings%boundary%loaded)
      call press_side(fill, side, scene)
   end subroutine press_fill

   !> Apply unlimited pressure of the backing, and the passive pressure of the fill: on the side
   !> opposite to the live load of a span, or on both sides of a span without live load
   pure subroutine press_side(fill, side, scene)
      type(fill_t), intent(in) :: fill
      integer, intent(in) :: side  !! Side of the live load, see live_side
      type(scene_t), intent(inout) :: scene
      type(bounded_force_t) :: force(size(fill%chord))
      real(wp) :: height(size(fill%chord)), middle(2), rise
      integer :: i, n

      n = 0
      do i = 1, size(fill%chord)
         associate (chord => fill%chord(i))
            if (chord%span == 0) cycle
            middle = 0.5_wp*(chord%left + chord%right)
            rise = chord%right(2) - chord%left(2)
            if (abs(rise) <= level*(chord%right(1) - chord%left(1))) cycle
            force(n + 1)%most = fill%passive*fill%unit_weight(1)*(fill%surface - middle(2)) &
               & *abs(rise)
            if (middle(2) < fill%backing) then
               force(n + 1)%most = huge(rise)
            else if (chord%span == abs(side)) then
               if ((middle(1) - fill%crown_x(chord%span))*real(side, wp) > 0.0_wp) cycle
            end if
            if (.not. force(n + 1)%most > 0.0_wp) cycle
            n = n + 1
            force(n)%block = chord%block
            force(n)%point = middle - scene%origin
            force(n)%direction = [sign(1.0_wp, rise), 0.0_wp]
            height(n) = abs(rise)
         end associate
      end do
      if (allocated(scene%settings%boundary%bounded)) deallocate (scene%settings%boundary%bounded)
      if (n == 0) return
      if (fill%yields) then
         call add_pressure_bars(fill, force(:n), height(:n), scene)
      else
         allocate (scene%settings%boundary%bounded, source=force(:n))
      end if
   end subroutine press_side

   !> Passive pressure that follows the displacement, as long bars without compression: a block that
   !> moves towards the fill elongates its bar
   pure subroutine add_pressure_bars(fill, force, height, scene)
      type(fill_t), intent(in) :: fill
      type(bounded_force_t), intent(in) :: force(:)  !! Largest forces of the fill: (n)
      real(wp), intent(in) :: height(:)              !! Heights of the chords: (n) [m]
      type(scene_t), intent(inout) :: scene          !! The scene; the bars are appended
      type(bar_t), allocatable :: bar(:)
      type(bar_state_t), allocatable :: state(:)
      real(wp) :: away
      integer :: i, n

      n = 0
      if (allocated(scene%settings%boundary%bar)) n = size(scene%settings%boundary%bar)
      allocate (bar(n + size(force)), state(n + size(force)))
      if (n > 0) then
         bar(:n) = scene%settings%boundary%bar
         state(:n) = scene%system%bar
      end if
      away = far*width_of(fill)
      do i = 1, size(force)
         bar(n + i)%block = [force(i)%block, 0]
         bar(n + i)%point(:, 1) = force(i)%point
         bar(n + i)%point(:, 2) = force(i)%point + away*force(i)%direction
         bar(n + i)%pushes = .false.
         bar(n + i)%strength = force(i)%most
         bar(n + i)%stiffness = fill%stiffness*height(i)
      end do
      call move_alloc(bar, scene%settings%boundary%bar)
      call move_alloc(state, scene%system%bar)
   end subroutine add_pressure_bars

   !> Span whose crown is nearest to the resultant of the live loads on points, negative if the
   !> resultant is on its left; 0 at a crown
   pure integer function live_side(fill, origin, loaded, more) result(side)
      type(fill_t), intent(in) :: fill
      real(wp), intent(in) :: origin(2)  !! Origin of the coordinates of the points: (2) [m]
      type(loaded_point_t), intent(in) :: loaded(:)          !! Live and other loads: (n)
      type(loaded_point_t), intent(in), optional :: more(:)  !! Further loads: (m)
      real(wp) :: total(2), x

      total = live_total(loaded)
      if (present(more)) total = total + live_total(more)
      side = 0
      if (.not. total(1) > 0.0_wp) return
      x = total(2)/total(1) + origin(1)
      side = minloc(abs(fill%crown_x - x), dim=1)
      side = merge(0, merge(-side, side, x < fill%crown_x(side)), &
         & abs(x - fill%crown_x(side)) <= at_crown*width_of(fill))
   end function live_side

   !> Positions at which the side of the live loads changes: their resultant is at a crown or midway
   !> between two crowns
   pure function side_changes(fill, origin, total) result(share)
      type(fill_t), intent(in) :: fill
      real(wp), intent(in) :: origin(2)
      !> Totals of the live loads at the start, the middle and the end of the interval, quadratic
      !> between: (2, 3) [N/m, N]
      real(wp), intent(in) :: total(2, 3)
      real(wp), allocatable :: share(:)  !! Positions as shares of the interval, ascending: (n)
      real(wp), allocatable :: line(:)
      real(wp) :: root(2)
      integer :: i, j

      associate (n => size(fill%crown_x))
         allocate (line, source= &
            & [fill%crown_x, 0.5_wp*(fill%crown_x(2:) + fill%crown_x(:n - 1))] - origin(1))
      end associate
      allocate (share(0))
      do i = 1, size(line)
         root = quadratic_roots(total(2, :) - line(i)*total(1, :))
         do j = 1, 2
            if (root(j) > 0.0_wp .and. root(j) < 1.0_wp) share = [share, root(j)]
         end do
      end do
      share = share(sorted_order(spread(0, 1, size(share)), share))
   end function side_changes

   !> Zeros of a parabola from its values at 0, 1/2 and 1; -1 for missing ones
   pure function quadratic_roots(value) result(root)
      real(wp), intent(in) :: value(3)  !! The values: (3)
      real(wp) :: root(2)               !! The zeros: (2)
      real(wp) :: bend, half_slope, part, square

      root = -1.0_wp
      bend = 2.0_wp*(value(1) - 2.0_wp*value(2) + value(3))
      half_slope = 0.5_wp*(4.0_wp*value(2) - 3.0_wp*value(1) - value(3))
      square = half_slope**2 - bend*value(1)
      if (square < 0.0_wp) return
      part = -(half_slope + sign(sqrt(square), half_slope))
      if (abs(part) < huge(part)*abs(bend)) root(1) = part/bend
      if (abs(value(1)) < huge(part)*abs(part)) root(2) = value(1)/part
   end function quadratic_roots

   !> Width of the fill [m]
   pure real(wp) function width_of(fill)
      type(fill_t), intent(in) :: fill

      width_of = maxval(fill%chord%right(1)) - minval(fill%chord%left(1))
   end function width_of

   !> Sums of the absolute values of live loads and of their moments along x
   pure function live_total(loaded) result(total)
      type(loaded_point_t), intent(in) :: loaded(:)
      real(wp) :: total(2)  !! The sums: (2) [N/m, N]
      integer :: i

      total = 0.0_wp
      do i = 1, size(loaded)
         if (loaded(i)%live) total = total + norm2(loaded(i)%force%value(:, 1)) &
            & *[1.0_wp, loaded(i)%point(1)]
      end do
   end function live_total
end module dda_fill_loads
