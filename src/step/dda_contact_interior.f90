!> Contact forces of one group by the interior point (`dda_coulomb_interior`)
!>
!> Coulomb's law comes first. Its problem is not convex: with steep friction, or where blocks are
!> confined, the search need not come to an end, and the forces that come nearest to the law count.
!>
!> The convex problem always ends: joints that slide open by friction times their slip, less an
!> offset that is given (De Saxce; Acary and Cadoux). The nearer the offset to that product, the
!> nearer are the forces to Coulomb's law; at any offset they add no energy.
!>
!> Each force has a compliance far below that of the blocks, about the force before: of all forces
!> that stop the blocks those nearest to it count, so that shear is kept.
module dda_contact_interior
   use dda_contact_problem, only : admissible, contact_problem_t, move_blocks, openings, &
      & residual_of, residual_t
   use dda_contact_types, only : unbounded
   use dda_coulomb_interior, only : absent, coulomb_iterate_t, coulomb_lack_t, distances, &
      & find_lack, improve
   use dda_friction_cone, only : cone_kind
   use dda_joint_matrix, only : joint_matrix_t, lay_out_joints
   use dda_kinds, only : wp
   implicit none
   private

   public :: falling, max_convex_iterations, patience, share, solve_interior

   !> Compliance of the regularisation over that of the blocks
   real(wp), parameter :: compliance = 1.0e-6_wp
   !> Maximum number of iterations
   integer, parameter :: max_iterations = 30
   !> Maximum number of iterations of the convex problem
   integer, parameter :: max_convex_iterations = 60
   !> Iterations without progress before termination
   integer, parameter :: patience = 5
   !> Least initial distance from the bounds over a force, for known and unknown solutions
   real(wp), parameter :: near = 1.0e-2_wp, afar = 2.0e-1_wp
   !> Initial distance from the bounds for the convex problem
   real(wp), parameter :: convex_lift = 0.3_wp
   !> Largest initial distance for known solutions
   real(wp), parameter :: highest = 1.0e-1_wp
   !> Least reduction of the residual that counts as progress
   real(wp), parameter :: falling = 0.9_wp
   !> Step below which the iteration is blocked by a bound
   real(wp), parameter :: stuck = 0.2_wp
   !> Step over the distance to the first bound
   real(wp), parameter :: share = 0.995_wp

contains

   !> Find forces from those at hand. Of Coulomb's law those of smallest residual count. Those of
   !> the convex problem replace them, however far they are from the law: they add no energy
   pure subroutine solve_interior(p, tolerance, is_convex, matrix, force, residual, passes)
      type(contact_problem_t), intent(inout) :: p
      real(wp), intent(in) :: tolerance       !! Permitted residual, as an opening [m]
      logical, intent(in) :: is_convex        !! True for the convex problem
      type(joint_matrix_t), intent(inout) :: matrix  !! Laid out for the joints, or empty
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      integer, intent(inout) :: passes        !! Factorisations so far
      type(coulomb_lack_t) :: lack
      type(coulomb_iterate_t) :: x
      type(residual_t) :: found
      real(wp) :: least, left, length, trial(3, size(p%joint))
      integer :: turn, waited
      logical :: is_better, may_restart

      call pose_interior(p, is_convex, force)
      if (.not. allocated(matrix%entry)) call lay_out_joints(p%block, size(p%load, 1), &
         & size(p%load, 2), .false., matrix%matrix, matrix%factor, matrix%entry)
      call begin(p, force, merge(convex_lift, near, is_convex), x)
      least = huge(least)
      length = 1.0_wp
      waited = 0
      may_restart = .not. is_convex
      do turn = 1, merge(max_convex_iterations, max_iterations, is_convex)
         call find_lack(p%coulomb_problem_t, x, lack)
         left = most_of(p, x, lack)
         trial = admissible(p, x%force)
         found = residual_of(p, trial, move_blocks(p, trial))
         is_better = merge(left <= tolerance, found%energy < residual%energy, is_convex)
         if (is_better) force = trial
         if (is_better) residual = found
         waited = merge(0, waited + 1, left < falling*least)
         least = min(least, left)
         if (merge(is_better, residual%opening <= tolerance .or. waited == patience, is_convex) &
            & .or. .not. left <= huge(left)) return
         if (may_restart .and. turn <= patience .and. length < stuck) then
            may_restart = .false.
            call begin(p, force, afar, x)
            call find_lack(p%coulomb_problem_t, x, lack)
            least = huge(least)
         end if
         call improve(p%coulomb_problem_t, lack, share, matrix, x, length)
         passes = passes + 1
         if (.not. matrix%factor%usable) return
      end do
   end subroutine solve_interior

   !> Set bounds, units and regularisation about given forces. The offset of the convex problem
   !> follows from their slip
   pure subroutine pose_interior(p, is_convex, force)
      type(contact_problem_t), intent(inout) :: p
      logical, intent(in) :: is_convex
      real(wp), intent(in) :: force(:, :)
      real(wp) :: opening(3, size(p%joint))
      integer :: k, n

      n = size(p%joint)
      if (.not. allocated(p%unit)) allocate (p%bounded(4, n), p%unit(3, n))
      do k = 1, 3
         p%unit(k, :) = merge(p%give(k, k, :), 1.0_wp, p%give(k, k, :) > 0.0_wp)
      end do
      p%soft = p%bar_give
      p%gap = p%apart
      where (.not. p%bar_give > 0.0_wp)
         p%soft = compliance*p%unit
         p%gap = p%gap - p%soft*force
      end where
      do k = 1, 3
         where (.not. p%give(k, k, :) > 0.0_wp) p%soft(k, :) = absent
         if (k < 3) p%bounded(k, :) = p%give(k, k, :) > 0.0_wp .and. p%shift(k, :) < unbounded
      end do
      p%bounded(3, :) = p%give(3, 3, :) > 0.0_wp .and. p%cone%kind /= cone_kind%no_slip
      p%bounded(4, :) = p%bounded(3, :)
      p%dilatancy = merge(1.0_wp, 0.0_wp, is_convex)
      if (.not. is_convex) return
      opening = openings(p, force, move_blocks(p, force))
      do k = 1, 2
         where (p%bounded(3, :)) p%gap(k, :) = p%gap(k, :) + p%friction*abs(opening(3, :))
      end do
   end subroutine pose_interior

   !> Where the search begins: forces and their motion, with distances and flows lifted off zero by
   !> the same product everywhere, but where one is larger
   pure subroutine begin(p, force, lift, x)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)
      real(wp), intent(in) :: lift  !! Least lift over the size of a force
      type(coulomb_iterate_t), intent(out) :: x
      real(wp) :: flow, least, opening(3, size(p%joint)), typical
      integer :: i, k, n_normal

      x%force = force
      x%motion = move_blocks(p, force)
      x%slack = distances(p%coulomb_problem_t, force)
      opening = openings(p, x%force, x%motion)/p%unit
      where (.not. p%soft < absent) opening = 0.0_wp
      ! size of a force, and the part of it by which forces are wrong
      n_normal = max(1, count(p%soft(1:2, :) < absent))
      typical = max(tiny(1.0_wp)/epsilon(1.0_wp), sum(max(x%slack(1:2, :), -opening(1:2, :)), &
         & p%bounded(1:2, :))/real(n_normal, wp))
      least = sum(abs(min(x%slack(1:2, :), opening(1:2, :))), p%bounded(1:2, :)) &
         & /real(n_normal, wp)
      least = max(lift*typical, min(highest*typical, 10.0_wp*least))
      allocate (x%flow(4, size(p%joint)), source=0.0_wp)
      do i = 1, size(p%joint)
         do k = 1, 4
            if (.not. p%bounded(k, i)) cycle
            flow = merge(opening(min(k, 3), i), -opening(3, i), k < 4)
            if (k < 3) x%slack(k, i) = max(x%slack(k, i), -flow)
            x%slack(k, i) = max(x%slack(k, i), least**2/max(flow, least))
            x%flow(k, i) = p%unit(min(k, 3), i)*max(flow, least**2/max(x%slack(k, i), least))
         end do
      end do
      where (.not. p%bounded) x%slack = 1.0_wp
   end subroutine begin

   !> The largest residual and product of distance and flow, as an opening
   pure real(wp) function most_of(p, x, lack)
      type(contact_problem_t), intent(in) :: p
      type(coulomb_iterate_t), intent(in) :: x
      type(coulomb_lack_t), intent(in) :: lack
      integer :: i

      most_of = maxval(abs(lack%opening))
      do i = 1, size(p%friction)
         most_of = max(most_of, maxval(min(x%slack(:, i)*p%unit([1, 2, 3, 3], i), x%flow(:, i)), &
            & p%bounded(:, i)))
      end do
   end function most_of

end module dda_contact_interior
