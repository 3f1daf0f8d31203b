!> Random lengths end to end along an axis, the same in law wherever one looks
!>
!> The length that covers the origin is drawn with a chance that grows with itself, and the origin
!> lies evenly within it: then no place of the axis is special, and means hold in any window.
module dda_renewal
   use dda_joint_map, only : length_law, length_t
   use dda_kinds, only : wp
   use dda_random, only : draw, draw_normal, random_t
   implicit none
   private

   public :: draw_length, draw_covering_length

contains

   !> A length by its law
   pure subroutine draw_length(length, random, value)
      type(length_t), intent(in) :: length
      !> Random numbers
      type(random_t), intent(inout) :: random
      !> The length [m]
      real(wp), intent(out) :: value
      real(wp) :: number

      value = length%mean
      select case (length%law)
      case (length_law%uniform)
         call draw(random, number)
         value = value*(1.0_wp + length%randomness*(2.0_wp*number - 1.0_wp))
      case (length_law%exponential)
         call draw(random, number)
         value = -value*log(number)
      case (length_law%normal)
         do
            call draw_normal(random, number)
            if (abs(length%randomness*number) < 1.0_wp) exit
         end do
         value = value*(1.0_wp + length%randomness*number)
      end select
   end subroutine draw_length

   !> A length that covers a given point: long ones do so more often
   pure subroutine draw_covering_length(length, random, value)
      type(length_t), intent(in) :: length
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: value
      real(wp) :: more, number

      if (length%law == length_law%exponential) then
         call draw_length(length, random, value)
         call draw_length(length, random, more)
         value = value + more
         return
      end if
      do
         call draw_length(length, random, value)
         call draw(random, number)
         ! no law but the exponential one goes beyond twice the mean
         if (2.0_wp*length%mean*number <= value) exit
      end do
   end subroutine draw_covering_length
end module dda_renewal
