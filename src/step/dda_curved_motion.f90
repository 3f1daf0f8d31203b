!> Contact rows of a step with rotation
!>
!> With normals, corners and centres half way between the beginning and the end of a step, and
!> 2 tan(t/2) for a turn t, a row gives the gap of rigid blocks at the end to rounding. Forces
!> that act by such rows work on gaps and slips alone, so that a step brings in no energy (Simo,
!> Tarnow 1992, ZAMP 43, 757-792).
module dda_curved_motion
   use dda_block_inertia, only : packed_velocity
   use dda_block_update, only : displaced
   use dda_contact_types, only : joint_place_t, place_joint, place_rows
   use dda_kinds, only : wp
   use dda_multipliers, only : settle_in_time
   use dda_spring_products, only : relative_displacement
   use dda_step_context, only : near, near_gap, run_t
   implicit none
   private

   public :: follow_curves, foresee_curves

   !> Maximum number of corrections
   integer, parameter :: max_passes = 8

contains

   !> Begin with the rows of blocks that go on with the acceleration of the last step
   pure subroutine foresee_curves(run)
      type(run_t), intent(inout) :: run
      real(wp), dimension(size(run%step%state%motion, 1), size(run%step%state%motion, 2)) :: motion
      real(wp) :: error
      integer :: b

      motion = packed_velocity(run%system, size(motion, 1))
      do b = 1, size(run%system%equation)
         associate (e => run%system%equation(b), by => run%system%acceleration(:, b))
            if (e > 0) motion(:3, e) = motion(:3, e) + run%step%dt/2.0_wp*by
         end associate
      end do
      motion = run%step%dt*motion
      run%step%curve = 0.0_wp*run%contacts%gap
      run%step%state%increment = 0.0_wp
      call see_curves(run, motion, error)
      call take_turned_rows(run, motion)
   end subroutine foresee_curves

   !> Settle the contacts again with rows of the motion that was found, until closed contacts have
   !> no gap at the end of the step; blocks there are set
   pure subroutine follow_curves(run)
      type(run_t), intent(inout) :: run
      real(wp) :: size_of, error
      integer :: pass

      size_of = sqrt(minval(run%system%area, mask=run%system%equation > 0))
      associate (state => run%step%state)
         do pass = 0, max_passes
            call see_curves(run, state%motion, error)
            if (error <= max(near*size_of, 2.0_wp*state%residual) &
               & .or. pass == max_passes) return
            call take_turned_rows(run, (state%motion))
            run%equations%new_numbers = .true.
            call settle_in_time((run%equations%fixed%target), run%equations, &
               & run%contacts%springs, state)
         end do
      end associate
   end subroutine follow_curves

   !> Blocks after a motion, and the error of the gaps that its rows give there
   pure subroutine see_curves(run, motion, error)
      !> The run; gaps and blocks at the end of its step are set
      type(run_t), intent(inout) :: run
      !> The motion: (n_dof, n_equation)
      real(wp), intent(in) :: motion(:, :)
      !> The largest at closed contacts, and depth that rows of open ones do not give [m]
      real(wp), intent(out) :: error
      type(joint_place_t) :: place
      real(wp) :: by_rows
      integer :: j, k

      associate (step => run%step)
         step%after = displaced(run%settings, run%system, motion)
         step%end_gap = 0.0_wp*run%contacts%gap
         error = 0.0_wp
         do j = 1, size(run%contacts%joint)
            call place_joint(step%after%moved, run%contacts%joint(j), place, step%end_gap(:, j))
            do k = 1, run%contacts%joint(j)%n_contact
               by_rows = run%contacts%gap(k, j) + step%state%increment(k, j) + step%curve(k, j)
               associate (gap => step%end_gap(k, j))
                  error = max(error, merge(min(-gap, by_rows - gap), abs(gap - by_rows), &
                     & step%state%face(j)%open(k)))
               end associate
            end do
         end do
      end associate
   end subroutine see_curves

   !> Rows half way of a motion, and gaps to begin with; what strain lets them lack of the gaps at
   !> the end are curves
   pure subroutine take_turned_rows(run, motion)
      !> The run, with blocks and gaps after the motion; curves and gaps of the step are set
      type(run_t), intent(inout) :: run
      real(wp), intent(in) :: motion(:, :)
      type(joint_place_t) :: place(size(run%contacts%place))
      type(joint_place_t) :: after
      real(wp) :: by_rows(3, size(place)), end_gap(3)
      integer :: e, j, side

      associate (step => run%step, springs => run%contacts%springs, gap => run%contacts%gap)
         do j = 1, size(place)
            call place_joint(step%after%moved, run%contacts%joint(j), after, end_gap)
            place(j) = half_way(run%contacts%place(j), after)
         end do
         call place_rows(run%system, (run%system%motion + step%after%motion)/2.0_wp, &
            & run%contacts%joint, place, springs%row)
         do j = 1, size(place)
            do side = 1, 2
               e = springs%equation(side, j)
               if (e > 0) springs%row(3, :, side, j) = springs%row(3, :, side, j) &
                  & *turn_ratio(motion(3, e))
            end do
         end do
         by_rows = relative_displacement(springs, motion)
         do j = 1, size(place)
            associate (n => run%contacts%joint(j)%n_contact)
               step%curve(:, j) = 0.0_wp
               step%curve(:n, j) = step%end_gap(:n, j) - gap(:n, j) - by_rows(:n, j)
            end associate
            step%state%gap(:, j) = [gap(1:2, j), 0.0_wp]
            ! an impact keeps the forces up to it, and what they close in a short step is a speed
            if (step%ends_at_event) where (abs(gap(1:2, j)) <= near_gap(run%system, &
               & run%contacts%joint(j)%block)) step%state%gap(1:2, j) = gap(1:2, j) &
               & *min(1.0_wp, step%dt/run%march%longest)
            step%state%gap(:, j) = step%state%gap(:, j) + step%curve(:, j)
         end do
      end associate
   end subroutine take_turned_rows

   !> Half way between where a joint is before and after a step
   pure type(joint_place_t) function half_way(before, after) result(place)
      type(joint_place_t), intent(in) :: before  !! The place before the step
      type(joint_place_t), intent(in) :: after   !! The place after it

      place%across = (before%across + after%across)/2.0_wp
      place%point = (before%point + after%point)/2.0_wp
      place%foot = (before%foot + after%foot)/2.0_wp
      place%tangent = (before%tangent + after%tangent)/2.0_wp
      place%middle = (before%middle + after%middle)/2.0_wp
   end function half_way

   !> 2 tan(t/2)/t of a turn t
   pure real(wp) function turn_ratio(turn)
      real(wp), intent(in) :: turn  !! The turn [rad]

      turn_ratio = 1.0_wp + turn**2/12.0_wp
      if (abs(turn) > 1.0e-3_wp) turn_ratio = 2.0_wp*tan(turn/2.0_wp)/turn
   end function turn_ratio

end module dda_curved_motion
