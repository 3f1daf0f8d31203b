!> Exact forces of one joint with fixed others: Coulomb's law for two normal forces and one shear
!> force
!>
!>    u = q + W (n, T),   0 <= n, 0 <= u_n, n u_n = 0,   |T| <= limit + friction (n1 + n2)
!>
!> It sticks, with T eliminated, or slides one way or the other, with T = +-(limit + friction n):
!> each is a problem of two unknowns with four cases. Where the joint sticks without a force though
!> a gap closes, eliminating T has deceived, and sliding is tried.
module dda_joint_answer
   use dda_kinds, only : wp
   implicit none
   private

   public :: answer_joint, joint_view_t

   !> Data of a joint while all others stay
   type :: joint_view_t
      !> Openings and slip by a unit of each of its forces; nothing for forces that it has not:
      !> (3, 3) [m/(N/m)]
      real(wp) :: give(3, 3) = 0.0_wp
      real(wp) :: rest(3) = 0.0_wp   !! Openings and slip without its forces: (3) [m]
      real(wp) :: limit = 0.0_wp     !! Shear force that is borne without normal force [N/m]
      real(wp) :: friction = 0.0_wp  !! Coefficient of friction
      !> True if nothing bounds the shear force while it is closed
      logical :: sticks = .false.
   end type joint_view_t

contains

   !> Find the forces of one joint
   pure subroutine answer_joint(joint, slip, force, solved)
      type(joint_view_t), intent(in) :: joint
      integer, intent(inout) :: slip     !! Direction of the shear force that slides, or 0
      real(wp), intent(out) :: force(3)  !! Normal forces and shear force: (3) [N/m]
      logical, intent(out) :: solved     !! True if forces were found

      if (slip /= 0 .and. .not. joint%sticks) then
         call slide(joint, slip, force, solved)
         if (solved) return
      end if
      call stick(joint, force, solved)
      if (.not. solved) then
         slip = 0
         return
      end if
      if (any(force(1:2) > 0.0_wp) .or. joint%limit > 0.0_wp) then
         if (joint%sticks .or. abs(force(3)) <= joint%limit &
            & + joint%friction*(force(1) + force(2))) then
            slip = 0
            return
         end if
      else
         solved = all(joint%rest(1:2) >= 0.0_wp .or. .not. has_normal(joint))
         if (solved .or. joint%sticks) then
            slip = 0
            force = 0.0_wp
            return
         end if
      end if
      slip = merge(1, -1, force(3) > 0.0_wp)
      call slide(joint, slip, force, solved)
      if (solved) return
      slip = -slip
      call slide(joint, slip, force, solved)
      if (.not. solved) slip = 0
   end subroutine answer_joint

   !> Normal forces that a joint has
   pure function has_normal(joint) result(has)
      type(joint_view_t), intent(in) :: joint
      logical :: has(2)  !! The answers

      has = [joint%give(1, 1) > 0.0_wp, joint%give(2, 2) > 0.0_wp]
   end function has_normal

   !> The forces if the joint sticks
   pure subroutine stick(joint, force, solved)
      type(joint_view_t), intent(in) :: joint
      real(wp), intent(out) :: force(3)
      logical, intent(out) :: solved
      real(wp) :: m(2, 2), ratio(2)

      associate (give => joint%give, rest => joint%rest)
         ratio = 0.0_wp
         if (give(3, 3) > 0.0_wp) ratio = give(1:2, 3)/give(3, 3)
         m(:, 1) = give(1:2, 1) - give(1:2, 3)*ratio(1)
         m(:, 2) = give(1:2, 2) - give(1:2, 3)*ratio(2)
         call press(m, rest(1:2) - ratio*rest(3), has_normal(joint), force, solved)
         force(3) = 0.0_wp
         if (give(3, 3) > 0.0_wp) &
            & force(3) = -(rest(3) + give(3, 1)*force(1) + give(3, 2)*force(2))/give(3, 3)
      end associate
   end subroutine stick

   !> The forces if the joint slides one way, and whether it does
   pure subroutine slide(joint, slip, force, solved)
      type(joint_view_t), intent(in) :: joint
      integer, intent(in) :: slip  !! Direction of the shear force
      real(wp), intent(out) :: force(3)
      logical, intent(out) :: solved
      real(wp) :: m(2, 2), least, most, way

      way = real(slip, wp)
      least = way*joint%limit
      most = way*joint%friction
      associate (give => joint%give, rest => joint%rest)
         m(:, 1) = give(1:2, 1) + most*give(1:2, 3)
         m(:, 2) = give(1:2, 2) + most*give(1:2, 3)
         call press(m, rest(1:2) + least*give(1:2, 3), has_normal(joint), force, solved)
         force(3) = least + most*(force(1) + force(2))
         if (solved) solved = way*(rest(3) + give(3, 1)*force(1) + give(3, 2)*force(2) &
            & + give(3, 3)*force(3)) <= 0.0_wp
      end associate
   end subroutine slide

   !> n >= 0, m n + rest >= 0, one of each pair zero; m need not be symmetric
   pure subroutine press(m, rest, has, force, solved)
      real(wp), intent(in) :: m(2, 2)    !! Openings by the forces
      real(wp), intent(in) :: rest(2)    !! Openings without forces [m]
      logical, intent(in) :: has(2)      !! True for each force that exists
      real(wp), intent(out) :: force(3)  !! The forces and a zero [N/m]
      logical, intent(out) :: solved     !! True if there are such forces
      real(wp) :: determinant
      integer :: k

      force = 0.0_wp
      solved = .true.
      if (all(has)) then
         determinant = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
         ! rounding alone may leave as much of a singular joint
         if (determinant > 64.0_wp*epsilon(1.0_wp)*m(1, 1)*m(2, 2)) then
            force(1) = (rest(2)*m(1, 2) - rest(1)*m(2, 2))/determinant
            force(2) = (rest(1)*m(2, 1) - rest(2)*m(1, 1))/determinant
            if (force(1) >= 0.0_wp .and. force(2) >= 0.0_wp) return
         end if
      end if
      force = 0.0_wp
      if (all(rest >= 0.0_wp .or. .not. has)) return
      do k = 1, 2
         if (.not. has(k) .or. rest(k) >= 0.0_wp .or. .not. m(k, k) > 0.0_wp) cycle
         force = 0.0_wp
         force(k) = -rest(k)/m(k, k)
         if (.not. has(3 - k)) return
         if (rest(3 - k) + m(3 - k, k)*force(k) >= 0.0_wp) return
      end do
      solved = .false.
   end subroutine press

end module dda_joint_answer
