!> Whether a chain is stable: joint forces within their cones that balance the loads prove that it
!> is, a mechanism on which the loads do work that it is not; and a half model as the whole
module dda_chain_decision
   use dda_chain, only : chain_t
   use dda_chain_balance, only : carry_forces, cone_of, holds, influence, rounding_of_forces
   use dda_chain_lack, only : chain_mechanism_t, chain_power, freeze_mechanism
   use dda_chain_path, only : stick_all_along
   use dda_chain_thrust, only : approach_cones, find_thrust, thrust_t
   use dda_friction_cone, only : joint_face_t, project
   use dda_kinds, only : wp
   use dda_search, only : decision_t
   use dda_settings, only : flow_rule, settings_t, verdict
   implicit none
   private

   public :: decide_chain, doubtful, unfold

   !> Forces beyond the cones by less than so many times their rounding prove nothing
   real(wp), parameter :: doubtful = 4.0_wp
   !> Joints that fail as much as their neighbours except for this share do so by rounding
   real(wp), parameter :: tie = 1.0e-6_wp

contains

   !> Decide a chain
   pure subroutine decide_chain(settings, chain, decision, decided, reaction)
      type(settings_t), intent(in) :: settings
      type(chain_t), intent(in) :: chain
      !> The decision, without blocks and springs; of the left half alone if the chain is halved
      type(decision_t), intent(out) :: decision
      !> Whether it counts: not where joints of what stands may have slid on the way to its loads,
      !> nor where the forces have come neither into the cones nor to a mechanism
      logical, intent(out) :: decided
      !> What its left springing bears, or the plane of symmetry of a half: that of a chain much
      !> like it in, or 0, its own out: (3) [N/m, N/m, N]
      real(wp), intent(inout), optional :: reaction(3)
      type(thrust_t) :: thrust
      real(wp) :: beyond(3, size(chain%joint)), force(3, size(chain%joint)), noise, worst
      real(wp) :: load(3, size(chain%joint))
      integer :: j, n, passes

      if (present(reaction)) thrust%reaction = reaction
      call find_thrust(chain, thrust, load)
      if (present(reaction)) reaction = thrust%reaction
      call carry_forces(chain, load, thrust%reaction, force)
      noise = rounding_of_forces(chain, force)
      call approach_cones(chain, thrust, noise, force, beyond, passes)
      worst = maxval(abs(beyond))
      decided = .true.
      associate (outcome => decision%outcome, contacts => decision%contacts)
         allocate (contacts%face(size(chain%joint)), contacts%gap(3, size(chain%joint)))
         allocate (contacts%force(3, size(chain%joint)))
         do j = 1, size(chain%joint)
            contacts%force(:, j) = force(:, j) - beyond(:, j)
            contacts%gap(:, j) = -force(:, j)*(1.0_wp/chain%joint(j)%stiffness)
         end do
         if (worst > noise .and. .not. closes_row(chain, beyond)) then
            decided = .false.
         else if (worst > doubtful*noise) then
            outcome%verdict = verdict%collapsed
            call show_mechanism(chain, force, beyond, decision)
            ! slower motions drown in rounding
            outcome%rest_tolerance = outcome%acceleration_ratio*doubtful*noise/worst
         else if (worst > noise) then
            outcome%verdict = verdict%undecided
            outcome%reason = "joint forces exceed their limits by no more than round-off"
         else
            outcome%verdict = verdict%stable
            ! the plane of symmetry is smooth
            n = size(chain%joint) - merge(1, 0, chain%halved)
            if (settings%verdict_flow == flow_rule%coulomb &
               & .and. .not. all(chain%joint(:n)%no_slip)) &
               & call stick_all_along(chain, settings%tilt, contacts%face, decided)
         end if
         if (chain%free_acceleration > 0.0_wp) outcome%elastic_time &
            & = sqrt(2.0_wp*thrust%elastic_motion/chain%free_acceleration)
         outcome%steps = 1
         outcome%passes = thrust%passes + passes
      end associate
      decision%flow = flow_rule%associated
      decision%halved = chain%halved
      decision%keystone = chain%keystone
   end subroutine decide_chain

   !> Whether openings close the row again at its end: no forces in balance do work on them
   pure logical function closes_row(chain, beyond)
      type(chain_t), intent(in) :: chain
      !> The part of the forces that the cones do not let pass: (3, n + 1) [N/m]
      real(wp), intent(in) :: beyond(:, :)
      real(wp) :: g(3, 3), left(3), whole(3)
      integer :: j

      left = 0.0_wp
      whole = 0.0_wp
      do j = 1, size(beyond, 2)
         if (.not. any(abs(beyond(:, j)) > 0.0_wp)) cycle
         g = influence(chain, j)/chain%joint(j)%stiffness
         left = left + matmul(beyond(:, j), g)
         whole = whole + matmul(abs(beyond(:, j)), abs(g))
      end do
      if (chain%halved) left(2) = 0.0_wp
      closes_row = all(abs(left) <= tie*whole)
   end function closes_row

   !> Faces, openings and motion of a collapse, and its largest acceleration over that of free fall
   pure subroutine show_mechanism(chain, force, beyond, decision)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(:, :)  !! Forces in balance with the loads: (3, n + 1) [N/m]
      !> The part of each that its cone does not let pass: (3, n + 1) [N/m]
      real(wp), intent(in) :: beyond(:, :)
      type(decision_t), intent(inout) :: decision
      real(wp) :: admissible(3), fastest, inertia, power, spinning, speed
      integer :: b, j, n

      n = size(chain%block)
      allocate (decision%contacts%increment(3, n + 1))
      do j = 1, n + 1
         if (.not. holds(chain, force(:, j), j)) &
            & call project(cone_of(chain, j), force(:, j), admissible, decision%contacts%face(j))
         decision%contacts%increment(:, j) = -beyond(:, j)/chain%joint(j)%stiffness
      end do
      power = -sum(force*decision%contacts%increment)
      call concentrate(chain, beyond, decision%contacts%face, decision%contacts%increment, power)
      call move_blocks(chain, decision%contacts%increment, decision%outcome%motion)
      inertia = 0.0_wp
      fastest = 0.0_wp
      associate (d => decision%outcome%motion)
         do b = 1, n
            speed = norm2(d(1:2, b))
            spinning = sqrt(chain%block(b)%inertia/chain%block(b)%mass)*abs(d(3, b))
            inertia = inertia + chain%block(b)%mass*(speed**2 + spinning**2)
            fastest = max(fastest, speed + spinning)
         end do
      end associate
      decision%outcome%acceleration_ratio = power*fastest/(inertia*chain%free_acceleration)
   end subroutine show_mechanism

   !> Let only those joints open that fail more than their neighbours, where that is a mechanism: a
   !> structure opens joint by joint
   pure subroutine concentrate(chain, beyond, face, opening, power)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: beyond(:, :)
      type(joint_face_t), intent(inout) :: face(:)  !! The faces: (n + 1)
      !> Opening 1, opening 2 and slip of each joint: (3, n + 1) [m]
      real(wp), intent(inout) :: opening(:, :)
      real(wp), intent(inout) :: power  !! Power of the loads on them
      type(chain_mechanism_t) :: mechanism
      type(joint_face_t) :: admissible_face, few(size(face))
      real(wp) :: admissible(3), gap(0:size(face) + 1), all_power, noise
      integer :: i, j
      logical :: usable

      gap = 0.0_wp
      do j = 1, size(face)
         gap(j) = sum(beyond(:, j)**2)
      end do
      do j = 1, size(face)
         if (gap(j) > 0.0_wp .and. gap(j) >= (1.0_wp - tie)*max(gap(j - 1), gap(j + 1))) &
            & few(j) = face(j)
      end do
      call freeze_mechanism(chain, few, mechanism)
      call chain_power(mechanism, chain, all_power, noise, usable)
      if (.not. (usable .and. all_power > noise)) return
      do i = 1, size(mechanism%joint)
         j = mechanism%joint(i)
         call project(cone_of(chain, j), -mechanism%opening(:, i), admissible, admissible_face)
         if (maxval(abs(admissible)) > tie) return
      end do
      face = few
      opening = 0.0_wp
      opening(:, mechanism%joint) = mechanism%opening
      power = all_power*chain%mean_mass*real(size(chain%block), wp)
   end subroutine concentrate

   !> Motion of the blocks from the left springing on, one joint after the other; the last joint
   !> gets the openings that close the row
   pure subroutine move_blocks(chain, opening, motion)
      type(chain_t), intent(in) :: chain
      !> Opening 1, opening 2 and slip of each joint; those of the last are set: (3, n + 1) [m]
      real(wp), intent(inout) :: opening(:, :)
      real(wp), allocatable, intent(out) :: motion(:, :)  !! The motion: (3, n) [m, m, 1]
      real(wp) :: before(3), change(2), t(2), turn
      integer :: b, n

      n = size(chain%block)
      allocate (motion(3, n))
      before = 0.0_wp
      do b = 1, n
         t = chain%joint(b)%tangent
         turn = before(3) + (opening(1, b) - opening(2, b))/(2.0_wp*chain%joint(b)%half)
         ! along the normal (t2, -t1) and along the tangent
         change = [(opening(1, b) + opening(2, b))/2.0_wp, opening(3, b)] &
            & - chain%joint(b)%arm(:, 2)*turn + chain%joint(b)%arm(:, 1)*before(3)
         motion(1, b) = before(1) + t(2)*change(1) + t(1)*change(2)
         motion(2, b) = before(2) - t(1)*change(1) + t(2)*change(2)
         motion(3, b) = turn
         before = motion(:, b)
      end do
      t = chain%joint(n + 1)%tangent
      change(1) = t(1)*before(2) - t(2)*before(1) - chain%joint(n + 1)%arm(1, 1)*before(3)
      change(2) = -dot_product(t, before(1:2)) - chain%joint(n + 1)%arm(2, 1)*before(3)
      turn = -chain%joint(n + 1)%half*before(3)
      opening(:, n + 1) = [change(1) + turn, change(1) - turn, change(2)]
   end subroutine move_blocks

   !> Make the decision of a halved chain that of the whole one; any other stays as it is. A smooth
   !> plane of symmetry is the joint there, which does not slide and opens on both sides
   elemental subroutine unfold(decision)
      type(decision_t), intent(inout) :: decision
      type(joint_face_t), allocatable :: face(:)
      integer :: m, n

      if (.not. decision%halved) return
      decision%halved = .false.
      associate (contacts => decision%contacts, outcome => decision%outcome)
         m = size(contacts%face)
         n = 2*m - merge(2, 1, decision%keystone)
         if (decision%keystone) then
            m = m - 1
         else
            contacts%face(m)%slip = 0
            if (allocated(contacts%increment)) contacts%increment(1:2, m) = &
               & 2.0_wp*contacts%increment(1:2, m)
            contacts%gap(1:2, m) = 2.0_wp*contacts%gap(1:2, m)
            if (allocated(contacts%increment)) contacts%increment(3, m) = 0.0_wp
            contacts%gap(3, m) = 0.0_wp
         end if
         allocate (face(n))
         face(:m) = contacts%face(:m)
         face(n:n - m + 1:-1)%open(1) = contacts%face(:m)%open(1)
         face(n:n - m + 1:-1)%open(2) = contacts%face(:m)%open(2)
         face(n:n - m + 1:-1)%slip = -contacts%face(:m)%slip
         call move_alloc(face, contacts%face)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%gap)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%increment)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%force)
         if (.not. allocated(outcome%motion)) return
         ! a keystone moves up or down alone
         if (decision%keystone) outcome%motion(:, m) = outcome%motion(:, m)*[0.0_wp, 1.0_wp, 0.0_wp]
         call mirror(size(outcome%motion, 2), n - 1, [-1.0_wp, 1.0_wp, -1.0_wp], outcome%motion)
      end associate
   end subroutine unfold

   !> Mirror the columns of the left half
   pure subroutine mirror(m, n, sign, value)
      !> Columns of the left half that count, with that on the plane of symmetry if there is one
      integer, intent(in) :: m
      integer, intent(in) :: n         !! Columns of the whole
      real(wp), intent(in) :: sign(3)  !! Signs of the mirror image: (3)
      !> The columns of the left half in, of the whole out, if there are any:
      !> (3, at least m), (3, n)
      real(wp), allocatable, intent(inout) :: value(:, :)
      real(wp), allocatable :: whole(:, :)
      integer :: j

      if (.not. allocated(value)) return
      allocate (whole(3, n))
      do j = 1, m
         whole(:, n + 1 - j) = sign*value(:, j)
         whole(:, j) = value(:, j)
      end do
      call move_alloc(whole, value)
   end subroutine mirror
end module dda_chain_decision
