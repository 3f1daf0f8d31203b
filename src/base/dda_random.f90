!> Reproducible random numbers, equal on every machine
!>
!> L'Ecuyer's MRG32k3a (1999): two recurrences of order three, whose products fit into 64 bits.
module dda_random
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: random_t, new_random, draw, draw_normal

   !> Moduli of the two recurrences: (2)
   integer(int64), parameter :: modulus(2) = [4294967087_int64, 4294944443_int64]
   !> Factors that mix a seed, one per round, and their modulus
   integer(int64), parameter :: mix_factor(4) = [1103515245_int64, 48271_int64, 69621_int64, &
      & 630360016_int64]
   integer(int64), parameter :: mix_modulus = 2147483647_int64

   !> A generator with its state
   type :: random_t
      private
      integer(int64) :: state(3, 2) = 1_int64  !! The last three numbers of both recurrences: (3, 2)
   end type random_t

contains

   !> Make a generator from a seed
   pure subroutine new_random(seed, stream, random)
      integer, intent(in) :: seed    !! Any number
      integer, intent(in) :: stream  !! Number of the sequence for this seed
      type(random_t), intent(out) :: random
      integer(int64) :: x
      integer :: i, k

      x = mixed(mixed(int(seed, int64)) + int(stream, int64))
      do k = 1, 2
         do i = 1, 3
            x = mixed(x + 3*k + i)
            random%state(i, k) = x + 1_int64
         end do
      end do
   end subroutine new_random

   !> Hash of a number: 31 bits without visible correlation to it
   pure integer(int64) function mixed(number)
      integer(int64), intent(in) :: number  !! Any number
      integer :: i

      mixed = modulo(number, mix_modulus)
      do i = 1, size(mix_factor)
         mixed = modulo(ieor(mixed, ishft(mixed, -15))*mix_factor(i) + 12345_int64, mix_modulus)
      end do
   end function mixed

   !> Return the next uniform number between 0 and 1, both excluded
   pure subroutine draw(random, number)
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: number  !! The number
      integer(int64) :: next(2)

      associate (s => random%state)
         next(1) = modulo(1403580_int64*s(2, 1) - 810728_int64*s(1, 1), modulus(1))
         next(2) = modulo(527612_int64*s(3, 2) - 1370589_int64*s(1, 2), modulus(2))
         s(:, 1) = [s(2, 1), s(3, 1), next(1)]
         s(:, 2) = [s(2, 2), s(3, 2), next(2)]
      end associate
      number = (real(modulo(next(1) - next(2), modulus(1)), wp) + 0.5_wp)/real(modulus(1), wp)
   end subroutine draw

   !> Return the next number of the standard normal distribution (Box and Muller)
   pure subroutine draw_normal(random, number)
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: number
      real(wp), parameter :: two_pi = 8.0_wp*atan(1.0_wp)
      real(wp) :: u, v

      call draw(random, u)
      call draw(random, v)
      number = sqrt(-2.0_wp*log(u))*cos(two_pi*v)
   end subroutine draw_normal
end module dda_random
