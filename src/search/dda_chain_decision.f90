!> True if a chain is stable: joint forces within their cones that balance the loads prove that it
!> is, a mechanism on which the loads do work that it is not; and a half model as the whole
module dda_chain_decision
   use dda_chain, only : chain_t
   use dda_chain_balance, only : cone_of
   use dda_chain_fall, only : chain_fall_t, find_chain_fall
   use dda_chain_path, only : stick_all_along
   use dda_chain_programme, only : deficit_t, find_deficit, mechanism_of_bounds, &
      & open_bounds
   use dda_friction_cone, only : joint_face_t, project
   use dda_kinds, only : wp
   use dda_limit_decision, only : load_state
   use dda_search, only : decision_t
   use dda_settings, only : flow_rule, settings_t, verdict
   implicit none
   private

   public :: decide_chain, show_first_motion, unfold

contains

   !> Decide a chain
   pure subroutine decide_chain(settings, chain, decision, decided, deficit)
      type(settings_t), intent(in) :: settings
      type(chain_t), intent(in) :: chain
      !> The decision, without blocks and springs; of the left half alone if the chain is halved
      type(decision_t), intent(out) :: decision
      !> True if it counts: not where joints of what stands may have slid on the way to its loads,
      !> nor where the programme has no solution
      logical, intent(out) :: decided
      !> Deficit of a similar chain, or none, in; deficit of this chain out
      type(deficit_t), intent(inout) :: deficit
      integer :: j, n

      n = size(chain%joint)
      decision%flow = flow_rule%associated
      decision%halved = chain%halved
      decision%keystone = chain%keystone
      associate (outcome => decision%outcome, contacts => decision%contacts)
         allocate (contacts%face(n), contacts%gap(3, n), contacts%force(3, n))
         call find_deficit(chain, deficit, contacts%force)
         outcome%steps = 1
         outcome%passes = deficit%exchanges
         decided = deficit%known
         if (.not. decided) return
         do j = 1, n
            contacts%gap(:, j) = contacts%force(:, j)/(-chain%joint(j)%stiffness)
         end do
         allocate (decision%limit)
         if (deficit%least > deficit%noise) then
            outcome%verdict = verdict%collapsed
            decision%limit%state = load_state%falls
            call show_mechanism(chain, deficit, decision)
         else
            outcome%verdict = verdict%stable
            decision%limit%state = load_state%stands
            ! the plane of symmetry is smooth
            n = n - merge(1, 0, chain%halved)
            if (settings%verdict_flow == flow_rule%coulomb &
               & .and. .not. all(chain%joint(:n)%no_slip)) &
               & call stick_all_along(chain, settings%tilt, contacts%face, decided)
         end if
      end associate
   end subroutine decide_chain

   !> Faces, openings and motion of a collapse, and its largest acceleration over that of free fall;
   !> of its forces, what the cones let pass
   pure subroutine show_mechanism(chain, deficit, decision)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(in) :: deficit
      type(decision_t), intent(inout) :: decision
      type(joint_face_t) :: ignored
      real(wp) :: force(3), fastest, free, inertia, power, spinning, speed
      integer :: b, j, n

      n = size(chain%block)
      associate (contacts => decision%contacts, outcome => decision%outcome)
         allocate (contacts%increment(3, n + 1))
         call mechanism_of_bounds(chain, deficit, contacts%face, contacts%increment, power)
         call move_blocks(chain, contacts%increment, outcome%motion)
         do j = 1, n + 1
            force = contacts%force(:, j)
            call project(cone_of(chain, j), force, contacts%force(:, j), ignored)
         end do
         inertia = 0.0_wp
         fastest = 0.0_wp
         free = 0.0_wp
         do b = 1, n
            associate (block => chain%block(b), motion => outcome%motion(:, b))
               speed = motion(1)**2 + motion(2)**2
               spinning = block%inertia*motion(3)**2
               inertia = inertia + block%mass*speed + spinning
               fastest = max(fastest, sqrt(speed) + sqrt(spinning/block%mass))
               free = max(free, (block%weight(1)**2 + block%weight(2)**2)/block%mass**2)
            end associate
         end do
         outcome%acceleration_ratio = power*fastest/(inertia*sqrt(free))
         ! slower motions are rounding errors
         outcome%rest_tolerance = outcome%acceleration_ratio*deficit%noise/deficit%least
      end associate
   end subroutine show_mechanism

   !> Replace the mechanism of a collapse, which stays its certificate, by the first motion and its
   !> forces
   pure subroutine show_first_motion(chain, deficit, decision, found)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(in) :: deficit
      !> Its decision as a chain in; out, that of all blocks
      type(decision_t), intent(inout) :: decision
      !> True if it was found, without slip: sliding changes it under Coulomb friction
      logical, intent(out) :: found
      type(decision_t) :: proof
      type(chain_fall_t) :: fall
      real(wp) :: largest
      integer :: j

      call find_chain_fall(chain, deficit, fall, found)
      if (found) found = all(fall%bound(:fall%n_open) <= 2)
      if (.not. found) return
      proof = decision
      call unfold(proof)
      associate (contacts => decision%contacts, outcome => decision%outcome, n => fall%n_open)
         call open_bounds(chain, fall%joint(:n), fall%bound(:n), fall%share(:n), contacts%face, &
            & contacts%increment)
         call move_blocks(chain, contacts%increment, outcome%motion)
         largest = maxval(abs(outcome%motion(1:2, :)))
         outcome%motion = outcome%motion/largest
         contacts%increment = contacts%increment/largest
         contacts%force = fall%force
         contacts%gap = 0.0_wp
         do j = 1, size(contacts%face)
            where (contacts%face(j)%open)
               contacts%gap(:2, j) = contacts%increment(:2, j)
               contacts%force(:2, j) = 0.0_wp
            end where
            if (all(contacts%face(j)%open)) contacts%force(3, j) = 0.0_wp
         end do
      end associate
      call unfold(decision)
      decision%limit = proof%limit
   end subroutine show_first_motion

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

   !> Extend the decision of a chain to all its blocks, with its forces or its mechanism as
   !> certificate; any other decision is unchanged
   elemental subroutine unfold(decision)
      type(decision_t), intent(inout) :: decision

      if (decision%halved) call mirror_half(decision)
      if (.not. allocated(decision%limit)) return
      associate (limit => decision%limit)
         if (allocated(limit%force) .or. allocated(limit%velocity)) return
         if (limit%state == load_state%stands) limit%force = decision%contacts%force
         if (limit%state == load_state%falls) limit%velocity = decision%outcome%motion
      end associate
   end subroutine unfold

   !> Add the right half of a chain. A smooth plane of symmetry is the joint there, which does not
   !> slide and opens on both sides
   pure subroutine mirror_half(decision)
      type(decision_t), intent(inout) :: decision
      type(joint_face_t), allocatable :: face(:)
      integer :: m, n

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
   end subroutine mirror_half

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

      if (.not. allocated(value)) return
      allocate (whole(3, n))
      call copy_columns(m, n, sign, value, whole)
      call move_alloc(whole, value)
   end subroutine mirror

   !> Copy columns and their mirror images
   pure subroutine copy_columns(m, n, sign, half, whole)
      integer, intent(in) :: m, n
      real(wp), intent(in) :: sign(3)
      real(wp), intent(in) :: half(3, m)    !! Columns of the left half: (3, m)
      real(wp), intent(out) :: whole(3, n)  !! All columns: (3, n)
      integer :: j

      do j = 1, m
         whole(:, j) = half(:, j)
         whole(:, n + 1 - j) = sign*half(:, j)
      end do
   end subroutine copy_columns
end module dda_chain_decision
