!> Where a model of lines lies, how large it is, and which distances count as none (Shi: dc02)
module dda_cut_scale
   use dda_kinds, only : wp
   use dda_line_model, only : line_model_t
   implicit none
   private

   public :: cut_scale_t, cut_scale

   !> Scales of a cut
   type :: cut_scale_t
      !> What coordinates are counted from, so that none far from zero loses digits: (2) [m]
      real(wp) :: origin(2) = 0.0_wp
      !> Size w0 of the model: 1.02 times the larger of height/2 and width/2.6 [m]
      real(wp) :: size = 0.0_wp
      !> Distance within which things touch [m]
      real(wp) :: reach = 0.0_wp
      !> Distance within which a crossing becomes a node that is there already [m]
      real(wp) :: merge = 0.0_wp
      !> Distance within which an edge disturbs a node of other lines [m]
      real(wp) :: clearance = 0.0_wp
   end type cut_scale_t

contains

   !> The scales of a model with at least one line that has a length
   pure type(cut_scale_t) function cut_scale(model) result(scale)
      type(line_model_t), intent(in) :: model
      real(wp) :: low(2), high(2), largest
      integer :: i

      associate (place => model%line%place(:, :model%line%n))
         do i = 1, 2
            low(i) = min(minval(place(i, :)), minval(place(i + 2, :)))
            high(i) = max(maxval(place(i, :)), maxval(place(i + 2, :)))
         end do
      end associate
      scale%size = 1.02_wp*max((high(2) - low(2))/2.0_wp, (high(1) - low(1))/2.6_wp)
      do i = 1, 2
         scale%origin(i) = far_origin(low(i), high(i), scale%size)
      end do
      largest = maxval(max(abs(low), abs(high)))
      scale%reach = max(1.0e-9_wp*scale%size, 4.0_wp*spacing(largest))
      scale%merge = max(1.25_wp*model%edge_node_ratio*scale%size, scale%reach)
      scale%clearance = max(model%edge_node_ratio*scale%size, scale%reach)
   end function cut_scale

   !> Origin of a coordinate: 0 near zero; far from it a power of two near the model, from which
   !> coordinates are subtracted without rounding
   pure real(wp) function far_origin(low, high, size)
      real(wp), intent(in) :: low   !! Smallest coordinate [m]
      real(wp), intent(in) :: high  !! Largest coordinate [m]
      real(wp), intent(in) :: size  !! Size of the model [m]
      real(wp) :: middle, step

      far_origin = 0.0_wp
      middle = low/2.0_wp + high/2.0_wp
      if (abs(middle) < 8.0_wp*size) return
      step = set_exponent(1.0_wp, exponent(size))
      far_origin = anint(middle/step)*step
   end function far_origin
end module dda_cut_scale
