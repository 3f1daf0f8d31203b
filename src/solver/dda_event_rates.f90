!> How an assembly goes on under a load that grows: rates of motion and forces at a state
!>
!> Most faces are given: a corner that pushes stays closed, one with a gap stays open, a joint
!> within Coulomb's limit sticks. What is left, the weak faces, must agree with the rates: an
!> open-close loop finds them.
module dda_event_rates
   use dda_coulomb_equations, only : coulomb_equations_t, solve_equations, use_faces
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, shear_role
   use dda_coulomb_law, only : coulomb_state_t, face, imbalance, shear_face, spring_forces
   use dda_kinds, only : wp
   implicit none
   private

   public :: rates_t, new_rates, find_rates

   !> Rates of a state while its joints keep what they do
   type :: rates_t
      !> Motion: (n_dof, n_block)
      real(wp), allocatable :: motion(:, :)
      !> Opening 1, opening 2, slip: (3, n_joint)
      real(wp), allocatable :: opening(:, :)
      !> N1, N2, T: (3, n_joint)
      real(wp), allocatable :: force(:, :)
      !> What corners and joints do: (3, n_joint)
      integer, allocatable :: face(:, :)
      !> Share of the load that goes into damping: near 0 where forces balance the load, near 1
      !> where blocks move
      real(wp) :: unbalanced = 0.0_wp
   end type rates_t

   !> A force below this part of a block's weight is none, a gap that it would close is none
   real(wp), parameter :: weak_force = 1.0e-9_wp
   !> A joint at its limit sticks unless its shear force would grow beyond it by this share
   real(wp), parameter :: slide_margin = 1.0e-12_wp
   !> Passes that change all wrong faces at once
   integer, parameter :: joint_passes = 12
   !> Passes altogether
   integer, parameter :: max_pass = 30

contains

   !> Room for rates, of a state that does not change
   pure function new_rates(state) result(rates)
      !> The state
      type(coulomb_state_t), intent(in) :: state
      !> Its rates
      type(rates_t) :: rates

      allocate (rates%face, source=state%face)
      allocate (rates%motion, mold=state%motion)
      allocate (rates%force, rates%opening, mold=state%force)
      rates%motion = 0.0_wp
      rates%force = 0.0_wp
      rates%opening = 0.0_wp
   end function new_rates

   !> Find rates that agree with their faces. Where no faces do, friction lets the forces of the
   !> assembly drop however slowly the load grows: there are none
   pure subroutine find_rates(joints, equations, state, load_rate, opening_rate, damping, &
      & rates, found)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> Where the assembly is
      type(coulomb_state_t), intent(in) :: state
      !> Rate of the load: (n_dof, n_block)
      real(wp), intent(in) :: load_rate(:, :)
      !> Rates of opening that are prescribed: (3, n_joint)
      real(wp), intent(in) :: opening_rate(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> The rates
      type(rates_t), intent(inout) :: rates
      !> Whether they agree with their faces
      logical, intent(out) :: found
      integer :: seen(3, size(state%face, 2), max_pass), target(3, size(state%face, 2))
      integer :: change, i, pass
      logical :: one_by_one

      found = .false.
      one_by_one = .false.
      rates%face = state%face
      do pass = 1, max_pass
         call solve_rates(joints, equations, load_rate, opening_rate, damping, rates)
         if (.not. equations%usable) return
         call target_faces(joints, state, rates, target)
         found = all(target == rates%face)
         if (found) return
         do i = 1, pass - 1
            one_by_one = one_by_one .or. all(seen(:, :, i) == target)
         end do
         one_by_one = one_by_one .or. pass > joint_passes
         seen(:, :, pass) = rates%face
         if (one_by_one) then
            change = wrong_face(rates, target, modulo(pass, 2) == 1)
            rates%face(:, change) = target(:, change)
         else
            rates%face = target
         end if
      end do
   end subroutine find_rates

   !> Rates while the faces stay
   pure subroutine solve_rates(joints, equations, load_rate, opening_rate, damping, rates)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> Rate of the load: (n_dof, n_block)
      real(wp), intent(in) :: load_rate(:, :)
      !> Rates of opening that are prescribed: (3, n_joint)
      real(wp), intent(in) :: opening_rate(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> The rates, with their faces
      type(rates_t), intent(inout) :: rates
      real(wp) :: load(size(load_rate, 1), size(load_rate, 2))

      call use_faces(equations, joints, rates%face, damping)
      if (.not. equations%usable) return
      call spring_forces(joints, rates%face, opening_rate, rates%force)
      call imbalance(joints, load_rate, rates%force, load)
      call solve_equations(equations, joints, load, rates%motion, rates%opening)
      if (.not. equations%usable) return
      rates%opening = rates%opening + opening_rate
      call spring_forces(joints, rates%face, rates%opening, rates%force)
      rates%unbalanced = damping*maxval(abs(joints%graph%mass*rates%motion))/maxval(abs(load_rate))
   end subroutine solve_rates

   !> What corners and joints would do with these rates
   pure subroutine target_faces(joints, state, rates, target)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Where the assembly is
      type(coulomb_state_t), intent(in) :: state
      !> The rates
      type(rates_t), intent(in) :: rates
      !> What they would do: (3, n_joint)
      integer, intent(out) :: target(:, :)
      real(wp) :: push(2), trial
      integer :: i, j
      logical :: pushes(2)

      do j = 1, size(target, 2)
         do i = 1, 2
            associate (c => joints%graph%compliance(i, j))
               trial = -rates%opening(i, j)/c
               pushes(i) = joints%end_role(i, j) == end_role%tied &
                  & .or. state%force(i, j) > weak_force
               if (pushes(i)) then
                  target(i, j) = face%closed
               else if (joints%end_role(i, j) == end_role%absent &
                  & .or. state%gap(i, j) > weak_force*c) then
                  target(i, j) = face%open
               else
                  target(i, j) = merge(face%closed, face%open, trial >= 0.0_wp)
               end if
               push(i) = merge(trial, 0.0_wp, target(i, j) == face%closed)
            end associate
         end do
         trial = -rates%opening(3, j)/joints%graph%compliance(3, j)
         target(3, j) = shear_face(joints, j, target(:2, j), face%stuck)
         if (target(3, j) == face%stuck .and. joints%shear_role(j) == shear_role%frictional) then
            target(3, j) = target_shear(state%force(:, j), joints%graph%friction(j), sum(push), &
               & trial, any(pushes))
         end if
      end do
   end subroutine target_faces

   !> What a joint with friction would do along itself
   pure integer function target_shear(force, friction, push, shear, pushes)
      !> N1, N2, T
      real(wp), intent(in) :: force(3)
      !> Coefficient of friction
      real(wp), intent(in) :: friction
      !> Rate of N1 + N2
      real(wp), intent(in) :: push
      !> Rate of T while it sticks
      real(wp), intent(in) :: shear
      !> Whether it pushes now
      logical, intent(in) :: pushes
      real(wp) :: bound
      integer :: side

      target_shear = face%stuck
      if (.not. pushes) then
         if (abs(shear) > friction*push) target_shear = merge(face%slides, face%slides_back, &
            & shear > 0.0_wp)
         return
      end if
      bound = friction*(force(1) + force(2))
      if (bound - force(3) <= weak_force) then
         side = face%slides
      else if (bound + force(3) <= weak_force) then
         side = face%slides_back
      else
         return
      end if
      if (real(side, wp)*shear > friction*push + slide_margin*abs(shear)) target_shear = side
   end function target_shear

   !> A joint with a wrong face: the first one, or the one that moves most
   pure integer function wrong_face(rates, target, most)
      !> The rates
      type(rates_t), intent(in) :: rates
      !> What corners and joints would do: (3, n_joint)
      integer, intent(in) :: target(:, :)
      !> Whether the one that moves most is asked for
      logical, intent(in) :: most
      real(wp) :: largest, moves
      integer :: j

      wrong_face = 0
      largest = -1.0_wp
      do j = 1, size(target, 2)
         if (all(target(:, j) == rates%face(:, j))) cycle
         moves = sum(abs(rates%opening(:, j)))
         if (wrong_face > 0 .and. .not. (most .and. moves > largest)) cycle
         wrong_face = j
         largest = moves
         if (.not. most) return
      end do
   end function wrong_face
end module dda_event_rates
