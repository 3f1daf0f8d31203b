!> Damped motion of joints without forces under a sudden load, by the interior point
!>
!> From rest without forces Coulomb's law asks for the forces and the speed that balance the load
!> together, with a multiple of the mass as damping.
module dda_damped_motion
   use dda_coulomb_interior, only : absent, coulomb_iterate_t, coulomb_lack_t, coulomb_problem_t, &
      & distances, find_lack, improve, mean_product
   use dda_coulomb_joints, only : coulomb_joints_t, damped_mass, end_role, shear_role
   use dda_joint_matrix, only : joint_matrix_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: enough, interior_motion, sharp

   !> Accepted and best residual over load and motion
   real(wp), parameter :: enough = 1.0e-6_wp, sharp = 1.0e-10_wp

contains

   !> Motion under a load from rest without forces
   pure subroutine interior_motion(joints, matrix, load, damping, tolerance, x, settled)
      type(coulomb_joints_t), intent(in) :: joints
      type(joint_matrix_t), intent(inout) :: matrix
      real(wp), intent(in) :: load(:, :)  !! The load: (3, n_block)
      real(wp), intent(in) :: damping     !! Multiple of the mass
      !> Enough, sharp or between: the faces of joints that carry next to nothing depend on it
      real(wp), intent(in) :: tolerance
      type(coulomb_iterate_t), intent(inout) :: x  !! The iterate; one that is there goes on
      logical, intent(out) :: settled              !! True if the motion was found
      integer, parameter :: max_iteration = 150, patience = 15, few = 3
      real(wp), parameter :: shortfall = 0.995_wp, nothing = 1.0e-30_wp
      type(coulomb_problem_t) :: q
      type(coulomb_lack_t) :: lack
      real(wp) :: best, gap, length, merit
      integer :: i, waited

      q = interior_problem(joints, load, damping)
      if (.not. allocated(x%motion)) call begin(q, x)
      best = huge(best)
      waited = 0
      do i = 1, max_iteration
         call find_lack(q, x, lack)
         gap = mean_product(q, x%slack, x%flow)*real(count(q%bounded), wp) &
            & /max(abs(sum(load*x%motion)), nothing)
         merit = max(gap, max(maxval(abs(lack%balance)), maxval(abs(lack%distance))) &
            & /maxval(abs(load)), maxval(abs(lack%opening))/max(maxval(abs(x%motion)), nothing))
         waited = merge(0, waited + 1, merit < 0.9_wp*best)
         best = min(best, merit)
         if (merit < tolerance .or. waited >= merge(few, patience, best < enough) &
            & .or. .not. merit <= huge(1.0_wp)) exit
         call improve(q, lack, min(max(shortfall, 1.0_wp - gap), 1.0_wp - 1.0e-6_wp), matrix, x, &
            & length)
         if (.not. matrix%factor%usable) exit
      end do
      settled = merit < enough
   end subroutine interior_motion

   !> The problem of joints without forces under a load
   pure type(coulomb_problem_t) function interior_problem(joints, load, damping) result(q)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: load(:, :), damping
      integer :: k, n

      n = size(joints%shear_role)
      allocate (q%base, source=damped_mass(joints, damping))
      allocate (q%load, source=load)
      allocate (q%block, source=joints%graph%block)
      allocate (q%row, source=joints%graph%row)
      allocate (q%friction, source=joints%graph%friction)
      allocate (q%gap(3, n), q%shift(3, n), q%limit(n), source=0.0_wp)
      if (allocated(joints%graph%gap)) q%gap(:2, :) = joints%graph%gap
      allocate (q%soft(3, n), q%unit(3, n), source=1.0_wp)
      allocate (q%bounded(4, n))
      do k = 1, 2
         q%soft(k, :) = merge(absent, joints%graph%compliance, &
            & joints%end_role(k, :) == end_role%absent)
         q%bounded(k, :) = joints%end_role(k, :) == end_role%contact
         q%bounded(k + 2, :) = joints%shear_role == shear_role%frictional
      end do
      q%soft(3, :) = merge(absent, joints%graph%compliance, joints%shear_role == shear_role%absent)
      where (.not. q%soft < absent) q%gap = 0.0_wp
      q%max_corrections = 3
   end function interior_problem

   !> An iterate in the middle of the cones
   pure subroutine begin(q, x)
      type(coulomb_problem_t), intent(in) :: q
      type(coulomb_iterate_t), intent(out) :: x
      real(wp) :: push

      push = max(1.0_wp, sqrt(sum(abs(q%load))))
      allocate (x%motion, mold=q%load)
      x%motion = 0.0_wp
      allocate (x%force, mold=q%gap)
      x%force = 0.0_wp
      where (q%bounded(:2, :)) x%force(:2, :) = push
      allocate (x%slack, source=max(distances(q, x%force), 1.0e-3_wp*push))
      where (.not. q%bounded) x%slack = 1.0_wp
      allocate (x%flow, source=merge(1.0_wp, 0.0_wp, q%bounded))
   end subroutine begin
end module dda_damped_motion
