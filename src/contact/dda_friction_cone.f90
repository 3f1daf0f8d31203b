!> Contact force of a joint as a projection: open, sliding and locked are faces of its cone
!>
!> A joint carries two normal forces N1, N2 at its corners and one shear force T. Admissible are
!>
!>    N1 >= 0,  N2 >= 0,  |T| <= limit + friction*(N1 + N2)
!>
!> With a penalty, the force is the admissible one nearest to the trial force (N1, N2, T) that the
!> springs would carry if they could not fail.
!>
!> Equation (M2) of docs/method.md
module dda_friction_cone
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_face_t, cone_t, cone_kind_enum, cone_kind, project, apply_face, is_stuck
   public :: shear_bound

   !> Face of the cone on which the force of a joint lies
   type :: joint_face_t
      logical :: open(2) = .false.  !! Corners that are open: (2)
      !> Direction of the shear force at the Coulomb limit: -1 or 1; 0 while the joint is stuck
      integer :: slip = 0
      !> Corners whose force in a motion the velocities did without: (2)
      logical :: idle(2) = .false.
   end type joint_face_t

   !> Kinds of friction cones
   type :: cone_kind_enum
      integer :: frictional = 0  !! Shear force bounded by limit and friction
      integer :: no_slip = 1     !! Shear force without bound; limit and friction are 0
      integer :: mirror = 2      !! A plane of symmetry: any normal forces and no shear force
   end type cone_kind_enum

   !> Names of the kinds of cones
   type(cone_kind_enum), parameter :: cone_kind = cone_kind_enum()

   !> Bounds of the joint force
   type :: cone_t
      !> Coefficient of friction; 0 if the limit alone bounds the shear force
      real(wp) :: friction = 0.0_wp
      real(wp) :: limit = 0.0_wp   !! Shear force that the joint carries without normal force [N/m]
      logical :: single = .false.  !! True if the joint has one corner only: the second stays open
      !> One of `cone_kind`
      integer :: kind = cone_kind%frictional
   end type cone_t

contains

   !> The admissible force nearest to a trial force, and its face
   pure subroutine project(cone, trial, force, face)
      type(cone_t), intent(in) :: cone   !! Bounds of the force
      real(wp), intent(in) :: trial(3)   !! Trial force N1, N2, T: (3) [N/m]
      real(wp), intent(out) :: force(3)  !! Admissible force: (3) [N/m]
      type(joint_face_t), intent(out) :: face
      real(wp) :: excess

      if (cone%kind == cone_kind%mirror) then
         force = [trial(1:2), 0.0_wp]
         face%slip = 1
         return
      end if
      force(1:2) = max(trial(1:2), 0.0_wp)
      force(3) = trial(3)
      face%open = trial(1:2) < 0.0_wp
      if (cone%single) then
         force(2) = 0.0_wp
         face%open(2) = .true.
      end if
      if (cone%kind == cone_kind%no_slip) return
      excess = abs(trial(3)) - cone%limit - cone%friction*(force(1) + force(2))
      if (.not. excess > 0.0_wp) return
      call return_to_limit(cone, trial, force, face)
   end subroutine project

   !> Projection of a trial force beyond the shear limit: find the multiplier of
   !> |T| - multiplier = limit + friction*sum(max(N + friction*multiplier, 0)),
   !> which decreases piecewise linearly. Trials with none, one and both corners open find it
   pure subroutine return_to_limit(cone, trial, force, face)
      type(cone_t), intent(in) :: cone
      real(wp), intent(in) :: trial(3)  !! Trial force beyond the limit: (3) [N/m]
      real(wp), intent(out) :: force(3)
      type(joint_face_t), intent(out) :: face
      real(wp) :: mu, multiplier, excess, high, low

      mu = cone%friction
      high = maxval(trial(1:2))
      low = minval(trial(1:2))
      if (cone%single) high = trial(1)
      excess = abs(trial(3)) - cone%limit
      multiplier = (excess - mu*high)/(1.0_wp + mu**2)
      if (.not. cone%single) then
         multiplier = (excess - mu*(high + low))/(1.0_wp + 2.0_wp*mu**2)
         if (low + mu*multiplier < 0.0_wp) multiplier = (excess - mu*high)/(1.0_wp + mu**2)
      end if
      if (high + mu*multiplier < 0.0_wp) multiplier = excess
      face%slip = merge(1, -1, trial(3) > 0.0_wp)
      face%open = trial(1:2) + mu*multiplier < 0.0_wp
      force(1:2) = max(trial(1:2) + mu*multiplier, 0.0_wp)
      if (cone%single) then
         force(2) = 0.0_wp
         face%open(2) = .true.
      end if
      force(3) = real(face%slip, wp)*(abs(trial(3)) - multiplier)
   end subroutine return_to_limit

   !> Largest shear force of a joint; unlimited for a closed joint that cannot slide
   pure real(wp) function shear_bound(cone, normal)
      type(cone_t), intent(in) :: cone
      !> Normal forces plus the tensile strength of the contacts: (3), the third not used [N/m]
      real(wp), intent(in) :: normal(3)

      shear_bound = cone%limit + cone%friction*(normal(1) + normal(2))
      if (cone%kind == cone_kind%no_slip .and. (normal(1) > 0.0_wp .or. normal(2) > 0.0_wp)) &
         & shear_bound = huge(1.0_wp)
   end function shear_bound

   !> True if a face is the inside of the cone
   elemental logical function is_stuck(face)
      type(joint_face_t), intent(in) :: face

      is_stuck = face%slip == 0 .and. .not. any(face%open)
   end function is_stuck

   !> A face as an affine map: force = tangent*trial + constant on this face. A sliding joint
   !> without slip has separated: it carries no shear force
   pure subroutine apply_face(cone, face, tangent, constant)
      type(cone_t), intent(in) :: cone
      type(joint_face_t), intent(in) :: face
      !> Projector onto the face's directions: symmetric (3, 3)
      real(wp), intent(out) :: tangent(3, 3)
      real(wp), intent(out) :: constant(3)  !! Force of the face's point nearest to zero: (3) [N/m]
      real(wp) :: normal(3), square

      tangent = 0.0_wp
      constant = 0.0_wp
      if (.not. face%open(1)) tangent(1, 1) = 1.0_wp
      if (.not. face%open(2)) tangent(2, 2) = 1.0_wp
      tangent(3, 3) = 1.0_wp
      if (face%slip == 0) return
      normal = [-cone%friction*tangent(1, 1), -cone%friction*tangent(2, 2), real(face%slip, wp)]
      square = dot_product(normal, normal)
      constant = normal*(cone%limit/square)
      normal = normal/sqrt(square)
      tangent = tangent - spread(normal, 2, 3)*spread(normal, 1, 3)
   end subroutine apply_face
end module dda_friction_cone
