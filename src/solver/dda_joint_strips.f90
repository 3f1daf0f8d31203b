!> Joints that crush as constraints of the interior-point method
!>
!> A joint whose strength is S carries a normal force N = N1 + N2 within a strip of the share N/S of
!> its length:
!>
!>    z1 = N1 - N**2/(2 S) >= 0,  z2 = N2 - N**2/(2 S) >= 0
!>
!> Both stand as forces of two more rays beside those of the joint, in a column of their own that
!> acts on no block. Their rates y are those at which the joint is crushed about either edge of its
!> strip: y1*grad z1 + y2*grad z2 is the part of its opening that its rays do not see. A turn sees
!> both by their gradients, and by the curvature (y1 + y2)/S against a change of N. With those of
!> the rays at either corner these are five compliances c of N1 and N2, each along its own v:
!>
!>    K = (sum of c v v')**-1             v = (1, 0), (0, 1), grad z1, grad z2, (1, 1)
!>      = sum of c/det w w'               w: v, turned by a right angle
!>    det = sum over pairs of c(i) c(j) (v(i) x v(j))**2
!>
!> They lie many decades apart, but this form (Cauchy and Binet) has no differences of them. So the
!> joint is five springs along the w and one of the slip, and what opens these parts into rates.
module dda_joint_strips
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_joint_rays, only : sum_of_rays, joint_rays, n_side
   use dda_kinds, only : wp
   use dda_wide_factor, only : rk
   implicit none
   private

   public :: joint_strip_t
   public :: add_strips, bear_strips, beyond_parabola, keep_inside, list_strips, never_crush
   public :: see_strips, part_opening, renew_strips, soften_spring
   public :: strip_hurry, strip_lack, strip_power
   public :: subtract_crushing, yield_strip

   !> Compliances of the normal forces of a joint: both corners, both edges, curvature
   integer, parameter :: n_soft = 5

   !> A joint that crushes
   type :: joint_strip_t
      integer :: joint = 0           !! Number of the joint
      integer :: place = 0           !! Number of the column of z1 and z2
      integer :: kind = 0            !! Its kind, one of joint_kind
      real(wp) :: friction = 0.0_wp  !! Its coefficient of friction
      real(wp) :: strength = 0.0_wp  !! Strength over the whole length, in units of force
      real(wp) :: share = 0.0_wp     !! Normal force over the strength, of the last turn
      real(wp) :: bend = 0.0_wp      !! Curvature against a change of the normal force, of that
      !> Springs of a turn: what they act along, as rays, the same with more digits, which joints
      !> that slide need, and their stiffness
      real(wp) :: row(3, n_soft + 1) = 0.0_wp
      real(rk) :: wide_row(3, n_soft + 1) = 0.0_rk
      real(wp) :: stiffness(n_soft + 1) = 0.0_wp
      !> Rates of the rays and of crushing by openings along these
      real(wp) :: part(n_soft + 1, n_side + 2) = 0.0_wp
      !> Such rates by N1, N2 of the rays alone, and by changes of z1 and z2
      real(wp) :: yield(n_soft - 1, n_side + 2) = 0.0_wp
   end type joint_strip_t

   !> Largest share of the strength at which the interior-point method begins
   real(wp), parameter :: gentle = 0.5_wp

contains

   !> The joints with a column for each that crushes, behind the others; at a corner alone there is
   !> no strip that could bear a force
   pure subroutine add_strips(graph, unit, joints)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: unit  !! Unit of force: [N/m]
      type(joint_graph_t), intent(out) :: joints
      integer, allocatable :: crushed(:)
      integer :: i, m, n

      n = size(graph%kind)
      crushed = pack([(i, i=1, n)], graph%crush > 0.0_wp .and. graph%crush < huge(1.0_wp))
      m = size(crushed)
      joints%n_block = graph%n_block
      allocate (joints%block(2, n + m), source=0)
      joints%block(:, :n) = graph%block
      joints%kind = [graph%kind, spread(joint_kind%strip, 1, m)]
      joints%friction = [graph%friction, spread(0.0_wp, 1, m)]
      joints%length = [graph%length, spread(0.0_wp, 1, m)]
      allocate (joints%row(3, 3, 2, n + m), source=0.0_wp)
      joints%row(:, :, :, :n) = graph%row
      joints%crush = [graph%crush/unit, graph%crush(crushed)/unit]
      where (graph%crush >= huge(1.0_wp)) joints%crush(:n) = huge(1.0_wp)
      do i = 1, n
         if (.not. graph%crush(i) > 0.0_wp) call unload(i, joints)
      end do
   end subroutine add_strips

   !> Let a joint carry nothing but the shear force of one that cannot slide
   pure subroutine unload(joint, joints)
      integer, intent(in) :: joint  !! Its number
      type(joint_graph_t), intent(inout) :: joints

      joints%row(:, 1:2, :, joint) = 0.0_wp
      if (all(joints%kind(joint) /= [joint_kind%no_slip, joint_kind%corner_no_slip])) &
         & joints%row(:, 3, :, joint) = 0.0_wp
      joints%kind(joint) = joint_kind%pin
      joints%crush(joint) = huge(1.0_wp)
   end subroutine unload

   !> The joints with what they carry at any factor: none that crush but the shear force of those
   !> that cannot slide
   pure function never_crush(graph) result(joints)
      type(joint_graph_t), intent(in) :: graph  !! The joints, with columns for those that crush
      type(joint_graph_t) :: joints
      integer :: j

      joints = graph
      if (.not. allocated(graph%crush)) return
      do j = 1, size(graph%kind)
         if (graph%crush(j) < huge(1.0_wp)) call unload(j, joints)
         ! a ray with a bound that acts on nothing stays, by which free rays have their springs
         if (graph%kind(j) == joint_kind%strip) joints%kind(j) = joint_kind%corner
      end do
   end function never_crush

   !> The joints that crush, of a graph with their columns
   pure subroutine list_strips(graph, strip)
      type(joint_graph_t), intent(in) :: graph
      type(joint_strip_t), allocatable, intent(out) :: strip(:)  !! The joints: (n)
      integer :: i, j, n

      n = count(graph%kind == joint_kind%strip)
      allocate (strip(n))
      if (n == 0) return
      i = 0
      do j = 1, size(graph%kind) - n
         if (.not. graph%crush(j) < huge(1.0_wp)) cycle
         i = i + 1
         strip(i) = joint_strip_t(j, size(graph%kind) - n + i, graph%kind(j), &
            & graph%friction(j), graph%crush(j))
      end do
   end subroutine list_strips

   !> Normal force of a joint over its strength
   pure real(wp) function part_of_strip(strip, x) result(share)
      type(joint_strip_t), intent(in) :: strip
      real(wp), intent(in) :: x(:, :)  !! Forces along the rays: (n_side, n_joint)
      real(wp) :: force(3)

      force = sum_of_rays(strip%kind, strip%friction, x(:, strip%joint))
      share = (force(1) + force(2))/strip%strength
   end function part_of_strip

   !> Excess of the forces of a joint over its crushing limit [N/m]
   elemental real(wp) function beyond_parabola(strength, n1, n2) result(beyond)
      !> Strength over the whole length; huge where it does not crush [N/m]
      real(wp), intent(in) :: strength
      !> Normal force at the first corner [N/m]
      real(wp), intent(in) :: n1
      !> Normal force at the second corner [N/m]
      real(wp), intent(in) :: n2

      beyond = 0.0_wp
      if (strength < huge(strength)) &
         & beyond = max(0.0_wp, (n1 + n2)*((n1 + n2)/strength)/2.0_wp - min(n1, n2))
   end function beyond_parabola

   !> Values of z1 and z2 by the forces of the joint
   pure function bear_strips(strip, x) result(z)
      type(joint_strip_t), intent(in) :: strip
      real(wp), intent(in) :: x(:, :)
      real(wp) :: z(2), force(3)

      force = sum_of_rays(strip%kind, strip%friction, x(:, strip%joint))
      z = force(1:2) - 0.5_wp*((force(1) + force(2))/strip%strength)*(force(1) + force(2))
   end function bear_strips

   !> Set z1 and z2 to their values by the forces of their joint where these hold the larger part of
   !> them; elsewhere they approach them from turn to turn
   pure subroutine renew_strips(strip, x)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(inout) :: x(:, :)  !! Forces along the rays: (n_side, n_joint)
      real(wp) :: z(2)
      integer :: i

      do i = 1, size(strip)
         z = bear_strips(strip(i), x)
         where (z > 0.5_wp*x(:2, strip(i)%place)) x(:2, strip(i)%place) = z
      end do
   end subroutine renew_strips

   !> One over the longest step along a direction of the forces on which z1 and z2 bend by no more
   !> than the normal force
   pure real(wp) function strip_hurry(strip, x, dx) result(hurry)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(in) :: x(:, :), dx(:, :)  !! Forces, direction: (n_side, n_joint)
      integer :: i

      hurry = 0.0_wp
      do i = 1, size(strip)
         hurry = max(hurry, abs(part_of_strip(strip(i), dx)) &
            & /sqrt(2.0_wp*max(part_of_strip(strip(i), x), tiny(hurry))))
      end do
   end function strip_hurry

   !> Bring forces of joints well inside their strips
   pure subroutine keep_inside(strip, x)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(inout) :: x(:, :)  !! Forces along the rays, not negative: (n_side, n_joint)
      real(wp) :: force(3), most
      integer :: i

      do i = 1, size(strip)
         associate (j => strip(i)%joint, z => x(:2, strip(i)%place))
            z = bear_strips(strip(i), x)
            force = sum_of_rays(strip(i)%kind, strip(i)%friction, x(:, j))
            most = gentle*min(sum(force(1:2)), strip(i)%strength)
            if (minval(z) < 0.25_wp*most) then
               ! equal forces along all rays
               where (x(:, j) > 0.0_wp) x(:, j) = 1.0_wp
               force = sum_of_rays(strip(i)%kind, strip(i)%friction, x(:, j))
               x(:, j) = most/sum(force(1:2))*x(:, j)
               z = bear_strips(strip(i), x)
            end if
         end associate
      end do
   end subroutine keep_inside

   !> Shares of strength and curvatures at a point
   pure subroutine see_strips(x, s, strip)
      real(wp), intent(in) :: x(:, :), s(:, :)  !! Forces and rates: (n_side, n_joint)
      type(joint_strip_t), intent(inout) :: strip(:)
      integer :: i

      do i = 1, size(strip)
         strip(i)%share = part_of_strip(strip(i), x)
         strip(i)%bend = sum(s(:2, strip(i)%place))/strip(i)%strength
      end do
   end subroutine see_strips

   !> Difference between z1 and z2 of a point and their values by the forces
   pure real(wp) function strip_lack(strip, x) result(lack)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(in) :: x(:, :)
      integer :: i

      lack = 0.0_wp
      do i = 1, size(strip)
         lack = max(lack, maxval(abs(bear_strips(strip(i), x) - x(:2, strip(i)%place))))
      end do
   end function strip_lack

   !> Power that crushed joints take up at most, beyond what their rays do
   pure real(wp) function strip_power(strip, x, s) result(power)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(in) :: x(:, :), s(:, :)  !! Forces and rates: (n_side, n_joint)
      integer :: i

      power = 0.0_wp
      do i = 1, size(strip)
         power = power + 0.5_wp*strip(i)%strength*part_of_strip(strip(i), x)**2 &
            & *sum(s(:2, strip(i)%place))
      end do
   end function strip_power

   !> Take what joints are crushed by from the rates of their rays
   pure subroutine subtract_crushing(strip, x, s, rate)
      type(joint_strip_t), intent(in) :: strip(:)
      real(wp), intent(in) :: x(:, :), s(:, :)  !! Forces and rates of a point: (n_side, n_joint)
      real(wp), intent(inout) :: rate(:, :)     !! Rates of the rays: (n_side, n_joint)
      integer :: i

      do i = 1, size(strip)
         associate (j => strip(i)%joint)
            rate(:, j) = rate(:, j) - matmul(crushing(part_of_strip(strip(i), x), &
               & s(:2, strip(i)%place)), joint_rays(strip(i)%kind, strip(i)%friction))
         end associate
      end do
   end subroutine subtract_crushing

   !> Opening of a joint by rates of crushing
   pure function crushing(share, y) result(opening)
      real(wp), intent(in) :: share  !! Normal force over the strength
      real(wp), intent(in) :: y(2)   !! Rates about either edge
      real(wp) :: opening(3)         !! Opening 1, opening 2, slip

      opening = [y(1) - share*(y(1) + y(2)), y(2) - share*(y(1) + y(2)), 0.0_wp]
   end function crushing

   !> Springs of a joint with its strip, and what parts openings and forces among them
   pure subroutine soften_spring(stiffness, strip)
      !> Stiffness of each ray, z/y in the column of a strip: (n_side, n_joint)
      real(wp), intent(in) :: stiffness(:, :)
      type(joint_strip_t), intent(inout) :: strip
      real(rk) :: lean(2)
      real(wp) :: ray(3, n_side), soft(n_soft), v(2, n_soft), others(n_soft)
      real(wp) :: cross(n_soft, n_soft), det, part(n_soft, n_soft), yield(n_soft, n_soft)
      integer :: c, i

      ray = joint_rays(strip%kind, strip%friction)
      call see_slip(ray, stiffness(:, strip%joint), soft(:2), lean, strip)
      soft(3:) = [1.0_wp/stiffness(:2, strip%place), strip%bend]
      v = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp - strip%share, -strip%share, &
         & -strip%share, 1.0_wp - strip%share, 1.0_wp, 1.0_wp], [2, n_soft])
      do i = 1, n_soft
         cross(:, i) = v(1, :)*v(2, i) - v(2, :)*v(1, i)
         strip%wide_row(:, i) = [-real(v(2, i), rk), real(v(1, i), rk), &
            & v(1, i)*lean(2) - v(2, i)*lean(1)]
      end do
      strip%wide_row(:, n_soft + 1) = [0.0_rk, 0.0_rk, 1.0_rk]
      strip%row = real(strip%wide_row, wp)
      det = sum_of_pairs(soft, cross)
      strip%stiffness(:n_soft) = soft/det
      do i = 1, n_soft
         part(:, i) = soft*cross(:, i)*(soft(i)/det)
      end do
      yield = matmul(cross, part)
      do i = 1, n_soft
         yield(:, i) = soft*yield(:, i)
         others = soft
         others(i) = 0.0_wp
         yield(i, i) = soft(i)*(sum_of_pairs(others, cross)/det)
      end do
      do i = 1, n_side
         c = (i + 1)/2
         strip%part(:n_soft, i) = ray(c, i)*part(:, c)
         strip%yield(:, i) = ray(c, i)*yield(:4, c)
      end do
      strip%part(:n_soft, n_side + 1:) = part(:, 3:4)
      strip%yield(:, n_side + 1:) = yield(:4, 3:4)
   end subroutine soften_spring

   !> Compliance of the rays at either corner of a joint, and what they do against a slip
   pure subroutine see_slip(ray, stiffness, soft, lean, strip)
      real(wp), intent(in) :: ray(3, n_side)     !! The rays: N1, N2, T
      real(wp), intent(in) :: stiffness(n_side)  !! Their stiffness
      real(wp), intent(out) :: soft(2)           !! Compliances of N1 and N2
      real(rk), intent(out) :: lean(2)           !! Openings that change them as a slip does
      type(joint_strip_t), intent(inout) :: strip  !! Receives the spring and the rates of its slip
      integer :: c
      real(wp) :: turned

      strip%stiffness(n_soft + 1) = 0.0_wp
      do c = 1, 2
         associate (p => ray(c, 2*c - 1:2*c), t => ray(3, 2*c - 1:2*c), &
            & k => stiffness(2*c - 1:2*c), firm => strip%stiffness(n_soft + 1))
            soft(c) = 1.0_wp/sum(p**2*k)
            lean(c) = sum(real(p, rk)*t*k)/sum(real(p, rk)**2*k)
            turned = p(1)*t(2) - p(2)*t(1)
            strip%part(n_soft + 1, 2*c - 1:2*c) = [-p(2)*k(2), p(1)*k(1)]*(turned*soft(c))
            firm = firm + k(1)*k(2)*turned**2*soft(c)
         end associate
      end do
   end subroutine see_slip

   !> Determinant of the sum of compliances, each along its v: a sum over their pairs
   pure real(wp) function sum_of_pairs(soft, cross) result(det)
      real(wp), intent(in) :: soft(n_soft)           !! Compliances
      real(wp), intent(in) :: cross(n_soft, n_soft)  !! Cross products of their v

      det = 0.5_wp*dot_product(soft, matmul(cross**2, soft))
   end function sum_of_pairs

   !> Part the opening of a joint into rates of its rays and of crushing
   pure subroutine part_opening(strip, turn, rate)
      type(joint_strip_t), intent(in) :: strip
      real(wp), intent(in) :: turn(:)       !! Openings of its springs: (n_soft + 1)
      real(wp), intent(inout) :: rate(:, :) !! Rates; those of the joint are set: (n_side, n_joint)

      rate(:, strip%joint) = matmul(turn, strip%part(:, :n_side))
      rate(:2, strip%place) = matmul(turn, strip%part(:, n_side + 1:))
   end subroutine part_opening

   !> Yielding of a strip to forces of its joint: rates of crushing, and what these and the
   !> curvature add to the rates of the rays
   pure subroutine yield_strip(strip, force, aim, y, rate)
      type(joint_strip_t), intent(in) :: strip
      real(wp), intent(in) :: force(3)       !! Forces of the rays without yielding: N1, N2, T
      real(wp), intent(in) :: aim(2)         !! Aimed change of z1 and z2 without rates
      real(wp), intent(out) :: y(2)          !! Rates of crushing
      real(wp), intent(out) :: rate(n_side)  !! Rates that are added to those of the rays

      rate = matmul([force(:2), aim], strip%yield(:, :n_side))
      y = matmul([force(:2), aim], strip%yield(:, n_side + 1:))
   end subroutine yield_strip

end module dda_joint_strips
