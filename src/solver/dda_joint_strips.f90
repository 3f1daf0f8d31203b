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
!> both by their gradients, and by the curvature (y1 + y2)/S against a change of N. They are
!> eliminated joint by joint:
!>
!>    K = (1/D + curvature + sum of grad z grad z'*y/z)**-1       D: springs of the rays
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

   !> A joint that crushes
   type :: joint_strip_t
      integer :: joint = 0           !! Number of the joint
      integer :: place = 0           !! Number of the column of z1 and z2
      integer :: kind = 0            !! Its kind, one of joint_kind
      real(wp) :: friction = 0.0_wp  !! Its coefficient of friction
      real(wp) :: strength = 0.0_wp  !! Strength over the whole length, in units of force
      real(wp) :: share = 0.0_wp     !! Normal force over the strength, of the last turn
      real(wp) :: bend = 0.0_wp      !! Curvature against a change of the normal force, of that
      real(rk) :: column(3) = 0.0_rk     !! Springs of the rays against normal forces
      real(rk) :: slack = 0.0_rk         !! Curvature, reduced by these springs
      real(rk) :: arm(3, 2) = 0.0_rk     !! Springs with curvature times the edges
      real(rk) :: soft(2, 2) = 0.0_rk    !! Rates of crushing by forces across the edges
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

   !> Put a strip into the spring of its joint. The compliance is a small difference of large
   !> stiffnesses
   pure subroutine soften_spring(stiffness, strip, spring)
      real(wp), intent(in) :: stiffness(:)        !! z/y of either edge: (2)
      type(joint_strip_t), intent(inout) :: strip !! Receives what yielding needs
      real(rk), intent(inout) :: spring(3, 3)     !! Spring of the rays in, with the strip out
      real(rk) :: m(2, 2)

      strip%column = spring(:, 1) + spring(:, 2)
      strip%slack = strip%bend/(1.0_rk + strip%bend*(strip%column(1) + strip%column(2)))
      spring = spring - strip%slack*spread(strip%column, 2, 3)*spread(strip%column, 1, 3)
      strip%arm = matmul(spring, edges(strip%share))
      m = matmul(transpose(edges(strip%share)), strip%arm)
      m(1, 1) = m(1, 1) + stiffness(1)
      m(2, 2) = m(2, 2) + stiffness(2)
      strip%soft = reshape([m(2, 2), -m(2, 1), -m(1, 2), m(1, 1)], [2, 2]) &
         & /(m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1))
      spring = spring - matmul(strip%arm, matmul(strip%soft, transpose(strip%arm)))
   end subroutine soften_spring

   !> Gradients of z1 and z2 by N1, N2, T
   pure function edges(share) result(edge)
      real(wp), intent(in) :: share  !! Normal force over the strength
      real(rk) :: edge(3, 2), n

      n = share
      edge = reshape([1.0_rk - n, -n, 0.0_rk, -n, 1.0_rk - n, 0.0_rk], [3, 2])
   end function edges

   !> Part the opening of a joint into rates of its rays and of crushing
   pure subroutine part_opening(strip, opening, rate)
      type(joint_strip_t), intent(in) :: strip
      real(rk), intent(in) :: opening(3)    !! Opening 1, opening 2, slip
      real(wp), intent(inout) :: rate(:, :) !! Rates; those of the joint are set: (n_side, n_joint)
      real(rk) :: y(2), left(3), edge(3, 2)

      associate (j => strip%joint)
         edge = edges(strip%share)
         y = matmul(strip%soft, matmul(opening, strip%arm))
         left = opening - matmul(edge, y)
         left(1:2) = left(1:2) - strip%slack*dot_product(strip%column, left)
         rate(:, j) = real(matmul(left, joint_rays(strip%kind, strip%friction)), wp)
         rate(:2, strip%place) = real(y, wp)
      end associate
   end subroutine part_opening

   !> Yielding of a strip to forces of its joint: rates of crushing, and what these and the
   !> curvature add to the rates of the rays
   pure subroutine yield_strip(strip, force, aim, y, rate)
      type(joint_strip_t), intent(in) :: strip
      real(wp), intent(in) :: force(3)       !! Forces of the rays without yielding: N1, N2, T
      real(wp), intent(in) :: aim(2)         !! Aimed change of z1 and z2 without rates
      real(wp), intent(out) :: y(2)          !! Rates of crushing
      real(wp), intent(out) :: rate(n_side)  !! Rates that are added to those of the rays
      real(rk) :: left(3), edge(3, 2), crushed(2)

      associate (j => strip%joint)
         edge = edges(strip%share)
         left = force - strip%column*(strip%slack*(real(force(1), rk) + force(2)))
         crushed = matmul(strip%soft, aim - matmul(left, edge))
         y = real(crushed, wp)
         left = left + matmul(strip%arm, crushed)
         left = strip%bend*(left(1) + left(2))*[1.0_rk, 1.0_rk, 0.0_rk] - matmul(edge, crushed)
         rate = real(matmul(left, joint_rays(strip%kind, strip%friction)), wp)
      end associate
   end subroutine yield_strip

end module dda_joint_strips
