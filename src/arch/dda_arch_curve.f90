!> Curves of arches: arcs of ellipses, parabolas and catenaries from left to right
module dda_arch_curve
   use dda_kinds, only : wp
   use dda_vector, only : cross
   implicit none
   private

   public :: curve_t, piece_t, piece_form, station_t
   public :: close_curve, station_at, curve_length

   !> Forms of a piece
   type :: piece_form_enum
      integer :: ellipse = 1   !! centre + (a sin u, b cos u), u rising
      integer :: parabola = 2  !! centre + (u, -u**2/(2 a))
      integer :: catenary = 3  !! centre + (u, a (1 - cosh(u/a)))
      integer :: line = 4      !! centre + (u, 0)
   end type piece_form_enum

   !> Names of the forms
   type(piece_form_enum), parameter :: piece_form = piece_form_enum()

   !> One piece
   type :: piece_t
      integer :: form = 1             !! One of piece_form
      real(wp) :: centre(2) = 0.0_wp  !! Centre of an ellipse, or the highest point: (2) [m]
      real(wp) :: a = 1.0_wp          !! Half axis along x, or radius of curvature at the top [m]
      real(wp) :: b = 1.0_wp          !! Half axis along y [m]
      real(wp) :: ends(2) = 0.0_wp    !! Parameter at the left end and at the right end: (2)
   end type piece_t

   !> The line
   type :: curve_t
      type(piece_t), allocatable :: piece(:)  !! Its pieces, from left to right: (n)
      !> Length of the line up to each piece, and the whole: (0:n) [m]
      real(wp), allocatable :: length(:)
      real(wp) :: crown = 0.0_wp    !! Length up to the crown [m]
      logical :: pointed = .false.  !! True if the line has a corner there
   end type curve_t

   !> A place on the line
   type :: station_t
      real(wp) :: point(2) = 0.0_wp    !! The place: (2) [m]
      real(wp) :: along(2) = 0.0_wp    !! Unit vector along the line, to the right: (2)
      real(wp) :: outward(2) = 0.0_wp  !! Unit vector across it, outwards: (2)
      real(wp) :: curvature = 0.0_wp   !! Rate at which the line turns to the right [rad/m]
      integer :: piece = 0             !! Number of the piece
   end type station_t

   !> Gauss points of an interval from -1 to 1, and their weights
   real(wp), parameter :: gauss(5) = [-0.906179845938663992797626878299393_wp, &
      -0.538469310105683091036314420700209_wp, 0.0_wp, &
      0.538469310105683091036314420700209_wp, 0.906179845938663992797626878299393_wp]
   real(wp), parameter :: weight(5) = [0.236926885056189087514264040719917_wp, &
      0.478628670499366468041291514835638_wp, 0.568888888888888888888888888888889_wp, &
      0.478628670499366468041291514835638_wp, 0.236926885056189087514264040719917_wp]
   !> Parts that a piece is integrated in
   integer, parameter :: n_part = 64

contains

   !> Measure the pieces of a line
   pure subroutine close_curve(curve)
      type(curve_t), intent(inout) :: curve  !! The line; its lengths are set
      integer :: i, n

      n = size(curve%piece)
      if (allocated(curve%length)) deallocate (curve%length)
      allocate (curve%length(0:n), source=0.0_wp)
      do i = 1, n
         curve%length(i) = curve%length(i - 1) + length_between(curve%piece(i), &
            & curve%piece(i)%ends(1), curve%piece(i)%ends(2))
      end do
   end subroutine close_curve

   !> Length of the line [m]
   pure real(wp) function curve_length(curve)
      type(curve_t), intent(in) :: curve

      curve_length = curve%length(size(curve%piece))
   end function curve_length

   !> The place at a length along the line; at a bend, that of the left or of the right piece
   pure type(station_t) function station_at(curve, length, from_right) result(station)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: length     !! Length from the left end [m]
      logical, intent(in) :: from_right  !! True to use the right piece where two meet
      real(wp) :: u, rate(2), bend(2), speed
      integer :: i

      do i = 1, size(curve%piece) - 1
         if (length < curve%length(i)) exit
         if (.not. (length > curve%length(i) .or. from_right)) exit
      end do
      station%piece = i
      u = parameter_at(curve%piece(i), length - curve%length(i - 1), &
         & curve%length(i) - curve%length(i - 1))
      call see_piece(curve%piece(i), u, station%point, rate, bend)
      speed = norm2(rate)
      station%along = rate/speed
      station%outward = [-station%along(2), station%along(1)]
      station%curvature = -cross(rate, bend)/speed**3
   end function station_at

   !> A point of a piece with its first two derivatives
   pure subroutine see_piece(piece, u, point, rate, bend)
      type(piece_t), intent(in) :: piece
      real(wp), intent(in) :: u          !! Parameter
      real(wp), intent(out) :: point(2)  !! The point: (2) [m]
      real(wp), intent(out) :: rate(2)   !! First derivative: (2)
      real(wp), intent(out) :: bend(2)   !! Second derivative: (2)

      select case (piece%form)
      case (piece_form%ellipse)
         point = piece%centre + [piece%a*sin(u), piece%b*cos(u)]
         rate = [piece%a*cos(u), -piece%b*sin(u)]
         bend = [-piece%a*sin(u), -piece%b*cos(u)]
      case (piece_form%parabola)
         point = piece%centre + [u, -0.5_wp*u**2/piece%a]
         rate = [1.0_wp, -u/piece%a]
         bend = [0.0_wp, -1.0_wp/piece%a]
      case (piece_form%catenary)
         ! 1 - cosh of a small number has no digits
         point = piece%centre + [u, -2.0_wp*piece%a*sinh(0.5_wp*u/piece%a)**2]
         rate = [1.0_wp, -sinh(u/piece%a)]
         bend = [0.0_wp, -cosh(u/piece%a)/piece%a]
      case default
         point = piece%centre + [u, 0.0_wp]
         rate = [1.0_wp, 0.0_wp]
         bend = 0.0_wp
      end select
   end subroutine see_piece

   !> Length of a piece between two parameters [m]
   pure real(wp) function length_between(piece, from, to) result(length)
      type(piece_t), intent(in) :: piece
      real(wp), intent(in) :: from  !! First parameter
      real(wp), intent(in) :: to    !! Second parameter
      real(wp) :: half, middle, point(2), rate(2), bend(2)
      integer :: i, k

      if (piece%form == piece_form%line .or. piece%form == piece_form%ellipse &
         & .and. .not. abs(piece%a - piece%b) > 0.0_wp) then
         length = to - from
         if (piece%form == piece_form%ellipse) length = piece%a*length
         return
      end if
      length = 0.0_wp
      half = 0.5_wp*(to - from)/real(n_part, wp)
      do i = 1, n_part
         middle = from + real(2*i - 1, wp)*half
         do k = 1, size(gauss)
            call see_piece(piece, middle + half*gauss(k), point, rate, bend)
            length = length + half*weight(k)*norm2(rate)
         end do
      end do
   end function length_between

   !> Parameter of a piece at a length from its left end, by Newton's method
   pure real(wp) function parameter_at(piece, length, whole) result(u)
      type(piece_t), intent(in) :: piece
      real(wp), intent(in) :: length
      real(wp), intent(in) :: whole  !! Length of the piece [m]
      real(wp) :: low, high, off, point(2), rate(2), bend(2)
      integer :: i

      low = piece%ends(1)
      high = piece%ends(2)
      u = low + (high - low)*length/whole
      if (piece%form == piece_form%line .or. piece%form == piece_form%ellipse &
         & .and. .not. abs(piece%a - piece%b) > 0.0_wp) return
      do i = 1, 60
         off = length_between(piece, piece%ends(1), u) - length
         if (off > 0.0_wp) high = u
         if (off < 0.0_wp) low = u
         if (abs(off) <= 4.0_wp*epsilon(1.0_wp)*whole) return
         call see_piece(piece, u, point, rate, bend)
         u = u - off/norm2(rate)
         if (u < low .or. u > high) u = 0.5_wp*(low + high)
      end do
   end function parameter_at
end module dda_arch_curve
