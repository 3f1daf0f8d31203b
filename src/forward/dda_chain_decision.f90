!> Does a chain stand: the same march of static steps to the same verdict as for any blocks
module dda_chain_decision
   use dda_balance, only : is_felt
   use dda_chain, only : chain_t
   use dda_chain_state, only : chain_step_t, new_chain_step
   use dda_chain_step, only : find_opening, go_on, lengthen_step, settle_chain
   use dda_chain_thrust, only : find_thrust, thrust_faces, thrust_t
   use dda_decision, only : decision_t
   use dda_kinds, only : wp
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : march_t, step_context_t
   use dda_step_interval, only : longest_static_step
   use dda_verdict, only : verdict
   implicit none
   private

   public :: decide_chain

   !> Free fall over elastic motion in a step, where nothing but rest keeps a chain slow
   real(wp), parameter :: long_fall = 1.0e10_wp
   !> The same once enough joints open for a mechanism, which rounding resists in long steps of a
   !> shallow arch
   real(wp), parameter :: short_fall = 1.0e5_wp
   !> Most steps; the second is free of what the springs took in the first, and a shallow arch of
   !> many voussoirs with three hinges comes to rest in some tens
   integer, parameter :: most_steps = 60
   !> Chains of as many blocks that are undecided are not asked once more as any blocks: in longer
   !> steps rounding of a shallow arch would pass for rest or collapse
   integer, parameter :: many = 100
   !> Share of the work that is speed where springs take none
   real(wp), parameter :: all_speed = 0.999_wp

contains

   !> Decide a chain under the associated flow rule, from rest
   pure subroutine decide_chain(settings, chain, decision, decided)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The decision, without blocks and springs; of the left half alone if the chain is halved
      type(decision_t), intent(out) :: decision
      !> Whether it counts: not where a step did not settle, nor where a structure with sliding
      !> joints stands and Coulomb's law has the last word; undecided if the chain is long
      logical, intent(out) :: decided
      type(chain_step_t) :: step
      type(march_t) :: march
      type(step_context_t) :: measured
      real(wp) :: dt
      integer :: answer

      decided = .false.
      call begin_march(chain, march, step)
      answer = verdict%undecided
      do while (march%steps < min(most_steps, settings%max_steps))
         march%steps = march%steps + 1
         call settle_chain(chain, step)
         if (.not. step%settled) return
         call measure(chain, step, measured)
         answer = judge(march, measured, can_move(step), settings)
         if (answer /= verdict%undecided) exit
         call go_on(chain, step)
         dt = step_length(chain, march, merge(short_fall, long_fall, can_move(step)))
         if (abs(dt - step%dt) > 0.0_wp) call lengthen_step(chain, dt, step)
      end do
      decided = answer == verdict%collapsed &
         & .or. answer == verdict%stable .and. (.not. slides(chain, step) &
         & .or. settings%verdict_flow == flow_rule%associated) &
         & .or. answer == verdict%undecided .and. size(chain%mass) >= many
      if (decided) call tell(settings, chain, answer, march, measured, step, decision)
   end subroutine decide_chain

   !> Judge a step. It began in balance but for what falls, so that it has no elastic motion to
   !> tell from that, as the first steps of any blocks have: what moves so far without a spring that
   !> takes its work, or as a mechanism, will not be stopped
   pure integer function judge(march, step, moves, settings)
      !> The march
      type(march_t), intent(in) :: march
      !> The step, measured
      type(step_context_t), intent(in) :: step
      !> Whether enough joints open or slide for a mechanism
      logical, intent(in) :: moves
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      real(wp) :: rest
      logical :: short

      short = march%free_acceleration*step%dt**2 < 4.0_wp*short_fall*march%elastic_motion
      judge = verdict%undecided
      rest = settings%rest_tolerance*march%free_acceleration
      ! what resists a mechanism is rounding, which must not pass for rest
      if (moves) rest = rest*min(1.0_wp, step%kinetic/max(step%work, tiny(rest)))
      if (step%acceleration <= rest) then
         judge = verdict%stable
      else if (step%kinetic > all_speed*step%work .and. (moves .or. .not. short)) then
         judge = verdict%collapsed
      end if
   end function judge

   !> Whether more corners open and joints slide than the three motions that close the row again
   pure logical function can_move(step)
      !> The step; what slides along a plane of symmetry counts
      type(chain_step_t), intent(in) :: step
      integer :: free, j

      free = 0
      do j = 1, size(step%face)
         if (step%stuck(j)) cycle
         free = free + count(step%face(j)%open) + abs(step%face(j)%slip)
      end do
      can_move = free > 3
   end function can_move

   !> Whether a joint slides, not counting a plane of symmetry
   pure logical function slides(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(in) :: step

      slides = any(step%face(:size(step%face) - merge(1, 0, chain%halved))%slip /= 0)
   end function slides

   !> Scales, first forces, faces and length
   pure subroutine begin_march(chain, march, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The march
      type(march_t), intent(out) :: march
      !> The step
      type(chain_step_t), intent(out) :: step
      type(thrust_t) :: thrust
      real(wp) :: load(3, size(chain%half))

      call new_chain_step(chain, step)
      call find_thrust(chain, thrust, load)
      call thrust_faces(chain, load, thrust, step%face, step%start)
      march%free_acceleration = chain%free_acceleration
      march%elastic_motion = thrust%elastic_motion
      call lengthen_step(chain, step_length(chain, march, long_fall), step)
   end subroutine begin_march

   !> Length of a step [s]
   pure real(wp) function step_length(chain, march, fall)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The march
      type(march_t), intent(in) :: march
      !> Free fall in the step over elastic motion
      real(wp), intent(in) :: fall

      step_length = longest_static_step(chain%mean_mass, chain%stiffest)
      if (march%free_acceleration > 0.0_wp) step_length = min(step_length, &
         & sqrt(2.0_wp*fall*march%elastic_motion/march%free_acceleration))
   end function step_length

   !> Acceleration of a settled step, and energies beyond those of the forces at its beginning: of
   !> a shallow arch these would drown them
   pure subroutine measure(chain, step, measured)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The settled step
      type(chain_step_t), intent(in) :: step
      !> The measures
      type(step_context_t), intent(out) :: measured
      real(wp) :: kinetic, largest, moving, spinning, square, rate
      integer :: b

      measured%dt = step%dt
      rate = 2.0_wp/step%dt**2
      largest = 0.0_wp
      kinetic = 0.0_wp
      associate (d => step%motion, mass => chain%mass)
         do b = 1, size(mass)
            moving = d(1, b)**2 + d(2, b)**2
            spinning = chain%inertia(b)*d(3, b)**2/mass(b)
            kinetic = kinetic + mass(b)*(moving + spinning)
            ! the sum of both motions, squared
            square = moving + spinning + 2.0_wp*sqrt(moving*spinning)
            if (square <= largest) cycle
            if (is_felt(mass(b), chain%mean_mass, chain%whole_load, rate*sqrt(square))) &
               & largest = square
         end do
      end associate
      measured%acceleration = rate*sqrt(largest)
      measured%kinetic = rate*kinetic
      measured%work = step%work
      measured%stored = step%work - measured%kinetic
   end subroutine measure

   !> Tell the end of a march as that of any blocks, without the trial forces, and the openings in
   !> the last step of a collapse alone
   pure subroutine tell(settings, chain, answer, march, measured, step, decision)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The chain
      type(chain_t), intent(in) :: chain
      !> One of verdict
      integer, intent(in) :: answer
      !> The march
      type(march_t), intent(in) :: march
      !> Measures of the last step
      type(step_context_t), intent(in) :: measured
      !> The last step; its motion moves on
      type(chain_step_t), intent(inout) :: step
      !> The decision
      type(decision_t), intent(inout) :: decision
      integer :: j

      decision%flow = flow_rule%associated
      associate (outcome => decision%outcome, contacts => decision%contacts)
         outcome%verdict = answer
         if (answer == verdict%undecided) outcome%reason = &
            & "all steps are spent and neither rest nor collapse is proven"
         outcome%rest_tolerance = settings%rest_tolerance
         outcome%acceleration_ratio = measured%acceleration/march%free_acceleration
         outcome%elastic_time = sqrt(2.0_wp*march%elastic_motion/march%free_acceleration)
         outcome%steps = march%steps
         outcome%passes = step%passes
         outcome%factorisations = step%factorisations
         decision%halved = chain%halved
         decision%keystone = chain%keystone
         call move_alloc(step%face, contacts%face)
         call move_alloc(step%force, contacts%force)
         allocate (contacts%gap(3, size(chain%half)))
         do j = 1, size(chain%half)
            contacts%gap(:, j) = -step%trial(:, j)/chain%stiffness(j)
         end do
         if (answer == verdict%collapsed) call tell_openings(chain, step%motion, contacts%increment)
         call move_alloc(step%motion, outcome%motion)
      end associate
   end subroutine tell

   !> Openings and slips of all joints in a step
   pure subroutine tell_openings(chain, motion, opening)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Motion of the blocks: (3, n) [m, m, 1]
      real(wp), intent(in) :: motion(:, :)
      !> The openings: (3, n + 1) [m]
      real(wp), allocatable, intent(out) :: opening(:, :)
      real(wp) :: before(3), behind(3), normal, turn
      integer :: j, n

      n = size(motion, 2)
      allocate (opening(3, n + 1))
      before = 0.0_wp
      do j = 1, n + 1
         behind = 0.0_wp
         if (j <= n) behind = motion(:, j)
         call find_opening(chain, j, before, behind, normal, turn, opening(3, j))
         opening(1, j) = normal + turn
         opening(2, j) = normal - turn
         before = behind
      end do
   end subroutine tell_openings
end module dda_chain_decision
