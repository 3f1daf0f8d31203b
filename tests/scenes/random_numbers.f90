!> Numbers that look random and are the same on every machine
module random_numbers
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: random_t, draw, draw_index

   !> A sequence of its own: the multiplicative generator of Park and Miller
   type :: random_t
      integer(int64) :: state = 20080301_int64  !! From 1 to 2**31 - 2
   end type random_t

   !> Fill with numbers between -1 and 1
   interface draw
      module procedure draw_scalar
      module procedure draw_vector
      module procedure draw_matrix
   end interface draw

contains

   !> One number
   pure subroutine draw_scalar(random, x)
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: x  !! Between -1 and 1

      random%state = modulo(48271_int64*random%state, 2147483647_int64)
      x = 2.0_wp*real(random%state, wp)/2147483647.0_wp - 1.0_wp
   end subroutine draw_scalar

   !> Several numbers
   pure subroutine draw_vector(random, x)
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: x(:)  !! Between -1 and 1: (:)
      integer :: i

      do i = 1, size(x)
         call draw_scalar(random, x(i))
      end do
   end subroutine draw_vector

   !> A table of numbers
   pure subroutine draw_matrix(random, x)
      type(random_t), intent(inout) :: random
      real(wp), intent(out) :: x(:, :)  !! Between -1 and 1: (:, :)
      integer :: j

      do j = 1, size(x, 2)
         call draw_vector(random, x(:, j))
      end do
   end subroutine draw_matrix

   !> A whole number
   pure subroutine draw_index(random, n, i)
      type(random_t), intent(inout) :: random
      integer, intent(in) :: n   !! Largest
      integer, intent(out) :: i  !! From 1 to n
      real(wp) :: x

      call draw_scalar(random, x)
      i = min(n, 1 + int(real(n, wp)*(x + 1.0_wp)/2.0_wp))
   end subroutine draw_index
end module random_numbers
