!> Rates that agree with their faces, by pivots: the last word where an open-close loop goes round
!> in circles
!>
!> Any motion has faces that agree with it and a load that it takes, so it solves a neighbouring
!> problem. Its load is led over to the one that is asked for, and the motion follows in straight
!> pieces. At a bend of the law one face changes, and the motion goes on as the new face allows:
!> towards the load, or back (Katzenelson 1965; Lemke's method). It ends at the load, or never
!> returns: then there are no rates.
module dda_rate_pivots
   use dda_coulomb_equations, only : coulomb_equations_t, solve_equations, use_faces
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : imbalance, spring_forces
   use dda_kinds, only : wp
   use dda_rate_law, only : break_rate, break_t, cross_break, follow_law, next_break, rate_law_t
   implicit none
   private

   public :: pivot_to_load

contains

   !> Lead a motion over to a load
   pure subroutine pivot_to_load(joints, equations, law, load, drive, motion, opening, faces, found)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      type(rate_law_t), intent(in) :: law
      !> The load that is asked for: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Rates of opening that are prescribed: (3, n_joint)
      real(wp), intent(in) :: drive(:, :)
      !> Any motion in, the rates out: (n_dof, n_block)
      real(wp), intent(inout) :: motion(:, :)
      !> How the joints open with it and with the drive: (3, n_joint)
      real(wp), intent(inout) :: opening(:, :)
      !> What they do: (3, n_joint)
      integer, intent(inout) :: faces(:, :)
      !> Whether the load was reached
      logical, intent(out) :: found
      type(break_t) :: break
      real(wp) :: ahead(size(load, 1), size(load, 2)), wide(3, size(opening, 2))
      real(wp) :: rest(size(load, 1), size(load, 2)), force(3, size(opening, 2)), sense
      integer :: pivot

      found = .false.
      call follow_law(joints, law, opening, faces)
      break%joint = 0
      do pivot = 1, equations%most_pivots
         call use_faces(equations, joints, faces, equations%damping, equations%viscosity)
         if (.not. equations%usable) return
         ! the way to the load while the faces stay
         call spring_forces(joints, faces, drive, force)
         call imbalance(joints, load, force, rest)
         call solve_equations(equations, joints, rest, ahead, wide)
         if (.not. equations%usable) return
         ahead = ahead - motion
         wide = wide + drive - opening
         sense = 1.0_wp
         if (break%joint > 0) then
            sense = break_rate(joints, break, faces, wide)
            if (.not. abs(sense) > 0.0_wp) return
            sense = merge(1.0_wp, -1.0_wp, sense > 0.0_wp .eqv. break%rises)
         end if
         break = next_break(joints, law, faces, opening, sense*wide)
         if (sense > 0.0_wp .and. break%distance >= 1.0_wp) then
            motion = motion + ahead
            opening = opening + wide
            found = .true.
            return
         else if (break%joint == 0) then
            return
         end if
         motion = motion + (sense*break%distance)*ahead
         opening = opening + (sense*break%distance)*wide
         call cross_break(joints, break, opening, faces)
      end do
   end subroutine pivot_to_load
end module dda_rate_pivots
