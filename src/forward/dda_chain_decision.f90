!> Does a chain stand: the same march of static steps to the same verdict as for any blocks
module dda_chain_decision
   use dda_chain, only : chain_t
   use dda_chain_state, only : chain_step_t, new_chain_step
   use dda_chain_step, only : find_opening, go_on, lengthen_step, settle_chain
   use dda_chain_thrust, only : find_thrust, thrust_faces, thrust_t
   use dda_decision, only : decision_t
   use dda_kinds, only : wp
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : march_t, step_context_t
   use dda_step_interval, only : longest_static_step, static_growth
   use dda_verdict, only : is_beyond_elastic, is_felt, verdict
   implicit none
   private

   public :: decide_chain

   !> Free fall over elastic motion in the first step. The faces to begin with are nearly right, so
   !> that it may be as long as those that prove a collapse, with a margin
   real(wp), parameter :: first_fall = 2.0e8_wp
   !> Share of the work that is speed where springs take no more than rounding, and what they let
   !> move changes the acceleration by less than 1 %
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
      !> joints stands, for Coulomb's law has the last word there
      logical, intent(out) :: decided
      type(chain_step_t) :: step
      type(march_t) :: march
      type(step_context_t) :: measured
      integer :: answer

      decided = .false.
      call begin_march(settings, chain, march, step)
      answer = verdict%undecided
      do while (march%steps < settings%max_steps)
         call settle_chain(chain, step)
         if (.not. step%settled) return
         call measure(chain, step, measured)
         march%steps = march%steps + 1
         answer = judge(march, measured, settings)
         if (answer /= verdict%undecided) exit
         call lengthen(chain, measured, march, step)
      end do
      decided = answer == verdict%collapsed &
         & .or. answer == verdict%stable .and. .not. slides(chain, step)
      if (decided) call tell(settings, chain, answer, march, measured, step, decision)
   end subroutine decide_chain

   !> Judge a step. It began in balance but for what falls, so that it has no elastic motion to
   !> tell from that, as the first steps of any blocks have: where no spring takes any of its work,
   !> nothing will stop it
   pure integer function judge(march, step, settings)
      !> The march
      type(march_t), intent(in) :: march
      !> The step, measured
      type(step_context_t), intent(in) :: step
      !> Settings of the run
      type(settings_t), intent(in) :: settings

      judge = verdict%undecided
      if (step%acceleration <= settings%rest_tolerance*march%free_acceleration) then
         judge = verdict%stable
      else if (is_beyond_elastic(march, step) .and. step%kinetic > all_speed*step%work) then
         judge = verdict%collapsed
      end if
   end function judge

   !> Whether a joint slides, not counting a plane of symmetry
   pure logical function slides(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(in) :: step

      slides = any(step%face(:size(step%face) - merge(1, 0, chain%halved))%slip /= 0)
   end function slides

   !> Scales, first faces and first length
   pure subroutine begin_march(settings, chain, march, step)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
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
      march%last_acceleration = march%free_acceleration
      march%elastic_motion = thrust%elastic_motion
      march%longest = longest_static_step(chain%mean_mass, chain%stiffest)
      march%dt = march%longest
      if (march%free_acceleration > 0.0_wp) march%dt = min(march%longest, &
         & sqrt(2.0_wp*first_fall*march%elastic_motion/march%free_acceleration))
      if (settings%time_step > 0.0_wp) march%dt = min(march%longest, settings%time_step)
      call lengthen_step(chain, march%dt, step)
   end subroutine begin_march

   !> Go on from the end of a step; one of the same length needs no other equations, and a second
   !> one is free of what the springs took in the first
   pure subroutine lengthen(chain, measured, march, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step's measures
      type(step_context_t), intent(in) :: measured
      !> The march
      type(march_t), intent(inout) :: march
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: factor

      factor = static_growth(measured%acceleration, march%last_acceleration)
      if (march%steps == 1) factor = 1.0_wp
      march%last_acceleration = measured%acceleration
      call go_on(chain, step)
      march%dt = min(march%longest, factor*march%dt)
      if (march%dt > step%dt) call lengthen_step(chain, march%dt, step)
   end subroutine lengthen

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
