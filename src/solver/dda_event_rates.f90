!> Rates of motion and forces of an assembly under a growing load
!>
!> Most faces are given: a corner that pushes stays closed, one with a gap stays open, a joint
!> within Coulomb's limit sticks. The others, the weak faces, must agree with the rates: an
!> open-close loop finds them.
module dda_event_rates
   use dda_coulomb_equations, only : coulomb_equations_t, solve_equations, use_faces
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : add_springs, coulomb_state_t, imbalance, spring_forces
   use dda_joint_graph, only : push_blocks
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: find_rates, pivot_to_load, rates_t, solve_rates, undamp_rates
   public :: rate_law_t, set_rate_law, weak_force

   !> Undetermined faces of a state
   type :: rate_law_t
      !> True if each corner is weak: (2, n_joint)
      logical(small), allocatable :: weak(:, :)
      !> Limits that each joint may slide at, a positive and a negative shear force: (2, n_joint)
      logical(small), allocatable :: limit(:, :)
      !> Faces where they are given: (3, n_joint)
      integer(small), allocatable :: given(:, :)
      !> Joints of which a corner is weak or that are at a limit
      integer, allocatable :: loose(:)
      !> Joints whose cohesion keeps them from sliding until a corner has opened: (n_joint)
      logical(small), allocatable :: holds(:)
   end type rate_law_t

   !> Where the line of a motion meets a bend of the law
   type :: break_t
      !> Its distance
      real(wp) :: distance = 0.0_wp
      !> Joint that changes, 0 if there is none
      integer :: joint = 0
      !> Corner 1 or 2 that opens or closes, 3 or 4 where the joint begins or ends to slide against
      !> a positive or a negative shear force
      integer :: part = 0
      !> True if the deciding quantity rises: the pressure of the corner, or the shear force beyond
      !> the limit
      logical :: rises = .false.
   end type break_t

   !> Rates of a state while its joints keep what they do
   type :: rates_t
      !> Motion: (3, n_block)
      real(wp), allocatable :: motion(:, :)
      !> Opening 1, opening 2, slip: (3, n_joint)
      real(wp), allocatable :: opening(:, :)
      !> N1, N2, T: (3, n_joint)
      real(wp), allocatable :: force(:, :)
      !> Faces of corners and joints: (3, n_joint)
      integer(small), allocatable :: face(:, :)
      !> Rates of opening that may be none
      real(wp) :: still = 0.0_wp
      !> Largest load, or force of a joint that is driven
      real(wp) :: drive = 0.0_wp
      !> Share of it that goes into damping: near 0 where forces balance the load, near 1 where
      !> blocks move
      real(wp) :: unbalanced = 0.0_wp
   end type rates_t

   !> Least force over the weight of a block, and least gap that it closes
   real(wp), parameter :: weak_force = 1.0e-9_wp
   !> Round-off over the largest opening rate, and over the largest motion rate
   real(wp), parameter :: rounding = 1.0e-11_wp, lost = 1.0e-14_wp
   !> Iterations with simultaneous changes, and number of wrong states after which pivots follow
   integer, parameter :: few_passes = 6, few_wrong = 16
   !> Maximum number of iterations
   integer, parameter :: most_passes = 100

   interface

      !> The law of a state
      pure module subroutine set_rate_law(joints, state, law)
         type(coulomb_joints_t), intent(in) :: joints
         type(coulomb_state_t), intent(in) :: state
         type(rate_law_t), intent(out) :: law
      end subroutine set_rate_law

      !> Faces of joints with given rates of opening
      pure module subroutine follow_law(joints, law, opening, still, faces)
         type(coulomb_joints_t), intent(in) :: joints
         type(rate_law_t), intent(in) :: law
         real(wp), intent(in) :: opening(:, :)  !! Rates of opening 1, opening 2, slip: (3, n_joint)
         real(wp), intent(in) :: still          !! Rates of opening that may be none
         integer(small), intent(inout) :: faces(:, :)  !! Their previous and new faces: (3, n_joint)
      end subroutine follow_law

      !> The first bend of the law on a line of rates of opening: without a joint if there is none
      pure type(break_t) module function next_break(joints, law, still, faces, opening, change)
         type(coulomb_joints_t), intent(in) :: joints
         type(rate_law_t), intent(in) :: law
         real(wp), intent(in) :: still          !! Rates of opening that may be none
         integer(small), intent(in) :: faces(:, :)     !! Faces of the joints: (3, n_joint)
         real(wp), intent(in) :: opening(:, :)  !! Where the line begins: (3, n_joint)
         real(wp), intent(in) :: change(:, :)   !! Where it leads: (3, n_joint)
      end function next_break

      !> Rate along a line of the quantity that decides a bend
      pure real(wp) module function break_rate(joints, break, faces, change)
         type(coulomb_joints_t), intent(in) :: joints
         type(break_t), intent(in) :: break
         integer(small), intent(in) :: faces(:, :)
         real(wp), intent(in) :: change(:, :)  !! Where the line leads: (3, n_joint)
      end function break_rate

      !> Faces of a joint beyond a bend
      pure module subroutine cross_break(joints, law, break, opening, faces)
         type(coulomb_joints_t), intent(in) :: joints
         type(rate_law_t), intent(in) :: law
         type(break_t), intent(in) :: break
         real(wp), intent(in) :: opening(:, :)
         integer(small), intent(inout) :: faces(:, :)
      end subroutine cross_break

   end interface

contains

   !> Find rates that agree with their faces. Where no faces do, friction lets the forces of the
   !> assembly drop however slowly the load grows: there are none
   pure subroutine find_rates(joints, equations, state, load_rate, viscosity, rates, found, &
      & opening_rate)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      !> Where the assembly is
      type(coulomb_state_t), intent(in) :: state
      !> Rate of the load: (3, n_block)
      real(wp), intent(in), contiguous :: load_rate(:, :)
      !> Damping at the joints, as a multiple of their stiffness
      real(wp), intent(in) :: viscosity
      !> The rates, for which room is made where there is none
      type(rates_t), intent(inout) :: rates
      !> True if they agree with their faces
      logical, intent(out) :: found
      !> Rates of opening that are prescribed, none if absent: (3, n_joint)
      real(wp), intent(in), contiguous, optional :: opening_rate(:, :)
      real(wp), allocatable :: damped(:, :)
      integer :: j

      ! forces come last
      if (allocated(rates%force)) deallocate (rates%force)
      call find_faces(joints, equations, state, load_rate, viscosity, rates, found, opening_rate)
      if (.not. found) return
      allocate (rates%force, mold=rates%opening)
      call spring_forces(joints, rates%face, rates%opening, rates%force)
      damped = equations%damping*joints%graph%mass*rates%motion
      if (viscosity > 0.0_wp) then
         do j = 1, size(rates%opening, 2)
            call push_blocks(1, joints%graph%block(:, j), joints%graph%row(:, :, :, j), &
               & viscosity*rates%opening(:, j)/joints%graph%compliance(j), damped)
         end do
      end if
      rates%unbalanced = maxval(abs(damped))/max(rates%drive, tiny(1.0_wp))
   end subroutine find_rates

   !> Find the faces, with motion and openings
   pure subroutine find_faces(joints, equations, state, load_rate, viscosity, rates, found, &
      & opening_rate)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(in), contiguous :: load_rate(:, :)
      real(wp), intent(in) :: viscosity
      type(rates_t), intent(inout) :: rates
      logical, intent(out) :: found
      real(wp), intent(in), contiguous, optional :: opening_rate(:, :)
      type(rate_law_t) :: law
      integer(small), dimension(3, size(state%face, 2)) :: target, seen
      integer :: n_wrong, pass

      found = .false.
      call set_rate_law(joints, state, law)
      if (.not. allocated(rates%motion)) allocate (rates%motion, mold=state%motion)
      if (.not. allocated(rates%opening)) allocate (rates%opening, mold=state%force)
      rates%face = state%face
      do pass = 1, most_passes
         call solve_rates(joints, equations, load_rate, viscosity, rates, opening_rate)
         if (.not. equations%usable) return
         rates%still = no_rate(rates%motion, rates%opening)
         target = rates%face
         call follow_law(joints, law, rates%opening, rates%still, target)
         n_wrong = count(target /= rates%face)
         found = n_wrong == 0
         if (found) return
         if (pass >= few_passes .and. n_wrong <= few_wrong) exit
         ! faces that occur twice recur without end
         if (pass > 1) then
            if (all(target == seen)) exit
         end if
         if (iand(pass, pass - 1) == 0) seen = rates%face
         rates%face = target
      end do
      call pivot_to_load(joints, equations, law, load_rate, rates%motion, rates%opening, &
         & rates%face, found, opening_rate)
      rates%still = no_rate(rates%motion, rates%opening)
   end subroutine find_faces

   !> Rates of opening that may be none, because rounding makes as much
   pure real(wp) function no_rate(motion, opening)
      real(wp), intent(in) :: motion(:, :)   !! Motion of the blocks: (3, n_block)
      real(wp), intent(in) :: opening(:, :)  !! Openings of the joints by it: (3, n_joint)

      ! what moves freely does so by any multiple of what forces open
      no_rate = max(rounding*min(1.0_wp, maxval(abs(opening))), lost*maxval(abs(motion)))
   end function no_rate

   !> Restore the part that damping has removed from the rates of an assembly that does not move.
   !> Soft parts need many turns. A residual that does not decrease drives a motion, however small a
   !> share of the load it is, and stays unbalanced
   pure subroutine undamp_rates(joints, equations, load_rate, rates)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations  !! Their equations, those of the rates
      real(wp), intent(in), contiguous :: load_rate(:, :)
      type(rates_t), intent(inout) :: rates
      integer, parameter :: max_turn = 40
      real(wp), parameter :: exact = 1.0e-12_wp, less = 0.9_wp
      real(wp), dimension(3, size(load_rate, 2)) :: more, rest
      real(wp) :: before, scale
      integer :: turn

      scale = max(rates%drive, tiny(1.0_wp))
      do turn = 1, max_turn
         if (rates%unbalanced <= exact) exit
         before = rates%unbalanced
         call imbalance(joints, load_rate, rates%force, rest)
         ! openings replace forces in memory, which are computed again from them
         call solve_equations(equations, joints, rest, more, rates%force, once=.true.)
         rates%motion = rates%motion + more
         rates%opening = rates%opening + rates%force
         call spring_forces(joints, rates%face, rates%opening, rates%force)
         rates%unbalanced = equations%damping*maxval(abs(joints%graph%mass*more))/scale
         if (rates%unbalanced > less*before) exit
      end do
   end subroutine undamp_rates

   !> Rates while the faces stay
   pure subroutine solve_rates(joints, equations, load_rate, viscosity, rates, opening_rate)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in), contiguous :: load_rate(:, :)
      real(wp), intent(in) :: viscosity
      type(rates_t), intent(inout) :: rates
      real(wp), intent(in), contiguous, optional :: opening_rate(:, :)
      real(wp) :: load(size(load_rate, 1), size(load_rate, 2))

      call use_faces(equations, joints, rates%face, equations%rest_damping, viscosity)
      if (.not. equations%usable) return
      call add_drive(joints, rates%face, load_rate, load, opening_rate)
      rates%drive = max(maxval(abs(load)), maxval(abs(load_rate)))
      call solve_equations(equations, joints, load, rates%motion, rates%opening)
      if (.not. equations%usable) return
      if (present(opening_rate)) rates%opening = rates%opening + opening_rate
   end subroutine solve_rates

   !> A load with the forces that prescribed openings make
   pure subroutine add_drive(joints, faces, load, driven, opening)
      type(coulomb_joints_t), intent(in) :: joints
      !> Faces of corners and joints: (3, n_joint)
      integer(small), intent(in), contiguous :: faces(:, :)
      !> The load: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Both: (3, n_block)
      real(wp), intent(out), contiguous :: driven(:, :)
      !> The openings: (3, n_joint)
      real(wp), intent(in), contiguous, optional :: opening(:, :)

      driven = load
      if (present(opening)) call add_springs(joints, faces, opening, 0.0_wp, driven)
   end subroutine add_drive

   !> Continue a motion to a load, where an open-close loop recurs. Any motion has faces that agree
   !> with it and a load, so it solves a neighbouring problem. Its load is moved to the given one,
   !> and the motion follows in straight pieces. At a bend of the law one face changes, and the
   !> motion continues as the new face allows: towards the load, or back (Katzenelson 1965; Lemke's
   !> method). It ends at the load, or never returns: then there are no rates
   pure subroutine pivot_to_load(joints, equations, law, load, motion, opening, faces, found, drive)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      type(rate_law_t), intent(in) :: law
      !> The load that is asked for: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Any motion in, the rates out: (3, n_block)
      real(wp), intent(inout) :: motion(:, :)
      !> Openings of the joints by it and by the drive: (3, n_joint)
      real(wp), intent(inout) :: opening(:, :)
      !> Their previous and new faces: (3, n_joint)
      integer(small), intent(inout), contiguous :: faces(:, :)
      !> True if the load was reached
      logical, intent(out) :: found
      !> Rates of opening that are prescribed, none if absent: (3, n_joint)
      real(wp), intent(in), contiguous, optional :: drive(:, :)
      type(break_t) :: break
      real(wp) :: ahead(size(load, 1), size(load, 2)), wide(3, size(opening, 2))
      real(wp) :: rest(size(load, 1), size(load, 2)), sense, still
      integer :: pivot

      found = .false.
      call follow_law(joints, law, opening, no_rate(motion, opening), faces)
      break%joint = 0
      do pivot = 1, equations%most_pivots
         call use_faces(equations, joints, faces, equations%damping, equations%viscosity)
         if (.not. equations%usable) return
         ! the way to the load while the faces stay
         call add_drive(joints, faces, load, rest, drive)
         call solve_equations(equations, joints, rest, ahead, wide)
         if (.not. equations%usable) return
         if (present(drive)) wide = wide + drive
         still = no_rate(ahead, wide)
         ahead = ahead - motion
         wide = wide - opening
         sense = 1.0_wp
         if (break%joint > 0) then
            sense = break_rate(joints, break, faces, wide)
            if (.not. abs(sense) > 0.0_wp) return
            sense = merge(1.0_wp, -1.0_wp, sense > 0.0_wp .eqv. break%rises)
         end if
         wide = sense*wide
         break = next_break(joints, law, still, faces, opening, wide)
         if (sense > 0.0_wp .and. break%distance >= 1.0_wp) then
            motion = motion + ahead
            opening = opening + wide
            found = .true.
            return
         else if (break%joint == 0) then
            return
         end if
         motion = motion + (sense*break%distance)*ahead
         opening = opening + break%distance*wide
         call cross_break(joints, law, break, opening, faces)
      end do
   end subroutine pivot_to_load
end module dda_event_rates
