!> Displacement of points from the unknowns of a block (Shi: dspl)
module dda_deformation
   use dda_kinds, only : wp
   implicit none
   private

   public :: displacement_matrix, moved_point, tangent_matrix, turned_tensor

contains

   !> Matrix T that maps the six block unknowns to the displacement of a point
   pure function displacement_matrix(point, centroid) result(t)
      real(wp), intent(in) :: point(2)     !! Coordinates of the point: (2) [m]
      real(wp), intent(in) :: centroid(2)  !! Centre of gravity of the block: (2) [m]
      real(wp) :: t(2, 6)                  !! Rows u, v; columns u0, v0, r0, ex, ey, gxy: (2, 6)
      real(wp) :: x, y

      x = point(1) - centroid(1)
      y = point(2) - centroid(2)
      t(1, :) = [1.0_wp, 0.0_wp, -y, x, 0.0_wp, y/2.0_wp]
      t(2, :) = [0.0_wp, 1.0_wp, x, 0.0_wp, y, x/2.0_wp]
   end function displacement_matrix

   !> Matrix T of a block that has moved and strained: the exact derivative of `moved_point`, with
   !> strains in present directions. Strains act on the arm of the point in the unstrained block, so
   !> that the work of dead loads is linear in the strains and Hooke's law is that of small strains
   pure function tangent_matrix(place, centre, motion) result(t)
      real(wp), intent(in) :: place(2)   !! Present coordinates of the point: (2) [m]
      real(wp), intent(in) :: centre(2)  !! Present centre of gravity: (2) [m]
      !> Translation, rotation, strain ex, ey, gxy in the block's own frame: (6)
      real(wp), intent(in) :: motion(6)
      real(wp) :: t(2, 6)  !! Rows u, v; columns u0, v0, r0, ex, ey, gxy: (2, 6)
      real(wp) :: arm(2), strain(3), unstrained(2, 6)

      t = displacement_matrix(place, centre)
      if (.not. any(abs(motion(4:6)) > 0.0_wp)) return
      strain = turned_tensor(motion(4:6), -motion(3), 2.0_wp)
      strain(3) = strain(3)/2.0_wp
      arm = place - centre
      arm = [(1.0_wp + strain(2))*arm(1) - strain(3)*arm(2), &
         & (1.0_wp + strain(1))*arm(2) - strain(3)*arm(1)] &
         & /((1.0_wp + strain(1))*(1.0_wp + strain(2)) - strain(3)**2)
      unstrained = displacement_matrix(arm, [0.0_wp, 0.0_wp])
      t(:, 4:6) = unstrained(:, 4:6)
   end function tangent_matrix

   !> Position of a point of a block after a finite motion: strain in the block's own frame, then
   !> exact rotation, then translation. It starts from the reference shape, so that errors do not
   !> accumulate
   pure function moved_point(point, centroid, motion) result(now)
      real(wp), intent(in) :: point(2)     !! The point in the reference shape: (2) [m]
      real(wp), intent(in) :: centroid(2)  !! Centre of gravity in the reference shape: (2) [m]
      !> Translation, rotation, strain ex, ey, gxy: (6) [m, m, rad, -, -, -]
      real(wp), intent(in) :: motion(6)
      real(wp) :: now(2)  !! Present coordinates of the point: (2) [m]
      real(wp) :: arm(2), c, s

      arm = point - centroid
      arm = [arm(1)*(1.0_wp + motion(4)) + arm(2)*motion(6)/2.0_wp, &
         & arm(2)*(1.0_wp + motion(5)) + arm(1)*motion(6)/2.0_wp]
      c = cos(motion(3))
      s = sin(motion(3))
      now = centroid + motion(1:2) + [c*arm(1) - s*arm(2), s*arm(1) + c*arm(2)]
   end function moved_point

   !> Components of a symmetric tensor in a rotated frame
   pure function turned_tensor(tensor, angle, shear_factor) result(turned)
      real(wp), intent(in) :: tensor(3)  !! Components xx, yy, xy: (3)
      real(wp), intent(in) :: angle      !! Angle of the new frame, anticlockwise [rad]
      !> Ratio of the third component to that of the tensor: 1 for stress, 2 for strain with gxy
      real(wp), intent(in) :: shear_factor
      real(wp) :: turned(3)  !! Components in the new frame: (3)
      real(wp) :: c, s, shear

      c = cos(angle)
      s = sin(angle)
      shear = tensor(3)/shear_factor
      turned(1) = c*c*tensor(1) + s*s*tensor(2) + 2.0_wp*c*s*shear
      turned(2) = s*s*tensor(1) + c*c*tensor(2) - 2.0_wp*c*s*shear
      turned(3) = shear_factor*(c*s*(tensor(2) - tensor(1)) + (c*c - s*s)*shear)
   end function turned_tensor
end module dda_deformation
