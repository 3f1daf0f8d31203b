!> Stages: blocks built or removed while others are stable or move
!>
!> A static run follows the loading path from stage to stage. The forces of a removed block act on
!> its neighbours at first and then go to nothing; a new block fits its place, without force, and
!> then gets its weight. A dynamic run goes on with the velocities of the blocks that stay.
module dda_stages
   use dda_block_system, only : begin_motion, block_system_t
   use dda_boundary, only : present_at, stage_times
   use dda_contacts, only : begin_forces, contacts_t, edge_pairs_t, keep_contacts
   use dda_coulomb_joints, only : coulomb_joints_t, new_coulomb_joints
   use dda_coulomb_law, only : coulomb_state_t, unloaded_state
   use dda_decision, only : decide, record_collapse, record_rest, run_in_time
   use dda_frames, only : album_t
   use dda_graph_decision, only : decide_graph
   use dda_joint_graph, only : add_joint_forces, joint_graph_t
   use dda_kinds, only : wp
   use dda_path_event, only : path_end
   use dda_scene, only : scene_t
   use dda_scene_graph, only : graph_verdict_t, has_limit_analysis, scene_graph
   use dda_search, only : decision_t
   use dda_settings, only : settings_t, verdict
   use dda_step_context, only : march_t
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: decide_in_stages, enter_stage

   !> Least slip over the largest motion, and least force over the largest, of a joint that slid
   real(wp), parameter :: slip_share = 1.0e-9_wp

contains

   !> Decide a scene stage by stage, or at once where no block is built or removed
   pure subroutine decide_in_stages(scene, decision, album, onward, last)
      !> The scene at its beginning, or where an earlier run has left it
      type(scene_t), intent(in) :: scene
      !> The decision of the last stage; its counts are those of all
      type(decision_t), intent(out) :: decision
      type(album_t), intent(inout) :: album
      type(march_t), intent(inout) :: onward  !! Where a dynamic run goes on and where it ended
      real(wp), intent(out) :: last           !! Time at which the last stage began [s]
      real(wp), allocatable :: time(:)

      last = 0.0_wp
      associate (settings => scene%settings)
         if (.not. allocated(settings%boundary%change)) then
            call decide(scene, decision, album, onward)
            return
         end if
         time = stage_times(settings%boundary)
         time = [0.0_wp, pack(time, time > 0.0_wp), huge(1.0_wp)]
         decision%system = scene%system
         decision%contacts = scene%contacts
         if (settings%dynamic .and. settings%current) then
            call move_through(settings, time, decision, album, onward, last)
         else if (has_limit_analysis(settings, decision%contacts)) then
            call decide_at_rest(scene, time, decision, last)
         else
            decision%outcome%reason = "stages need friction alone and geometry = 'reference' " &
               & //"in a static run, geometry = 'current' in a dynamic one"
         end if
         call begin_motion(decision%system)
         call begin_forces(decision%contacts)
      end associate
   end subroutine decide_in_stages

   !> Move from stage to stage
   pure subroutine move_through(settings, time, decision, album, onward, last)
      type(settings_t), intent(in) :: settings
      !> Times at which stages begin, and the end: (n_stage + 1) [s]
      real(wp), intent(in) :: time(:)
      !> The decision; blocks and contacts at the beginning in, at the end out
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout) :: album
      type(march_t), intent(inout) :: onward
      real(wp), intent(inout) :: last
      type(outcome_t) :: begun
      type(scene_t) :: stage
      integer :: k

      stage%settings = settings
      do k = 1, size(time) - 1
         if (time(k + 1) <= onward%time) cycle
         if (settings%duration > 0.0_wp .and. time(k) >= settings%duration) exit
         last = time(k)
         stage%settings%duration = settings%duration
         if (time(k + 1) < huge(1.0_wp) .and. .not. (settings%duration > 0.0_wp &
            & .and. settings%duration < time(k + 1))) stage%settings%duration = time(k + 1)
         call enter_stage(settings, last, decision%system, decision%contacts)
         if (allocated(onward%last_motion)) deallocate (onward%last_motion)
         stage%system = decision%system
         stage%contacts = decision%contacts
         ! counts of a run that goes on are those since its beginning
         decision%outcome = begun
         call run_in_time(stage, decision, album, onward)
         if (decision%outcome%verdict /= verdict%completed) exit
      end do
   end subroutine move_through

   !> Follow the loading path through all stages
   pure subroutine decide_at_rest(scene, time, decision, last)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: time(:)
      !> The decision; blocks and contacts at the beginning in, those of the last stage out
      type(decision_t), intent(inout) :: decision
      real(wp), intent(inout) :: last
      type(scene_t) :: next, stage
      type(graph_verdict_t) :: proof
      type(coulomb_state_t), allocatable :: start
      logical :: slid(size(scene%contacts%joint)), there(size(slid)), built
      integer :: factorisations, j, k, steps

      stage = scene
      slid = .false.
      steps = 0
      factorisations = 0
      do k = 1, size(time) - 1
         last = time(k)
         next = stage
         next%settings%from = time(k)
         next%settings%until = time(k + 1)
         next%contacts = scene%contacts
         call enter_stage(next%settings, time(k), next%system, next%contacts)
         if (k > 1) call hand_over(stage, next, scene%contacts, proof, start)
         stage = next
         call decide_graph(stage%settings, stage%system, stage%contacts, .false., proof, start)
         there = [(.not. any(stage%system%absent(scene%contacts%joint(j)%block)), &
            & j=1, size(there))]
         if (allocated(proof%state)) slid = slid .or. unpack(has_slid(proof%state, count(there), &
            & start), there, .false.)
         steps = steps + proof%n_event + 1
         factorisations = factorisations + proof%n_factorisation
         if (proof%end /= path_end%reached) exit
      end do
      associate (change => scene%settings%boundary%change)
         built = any(change%adds .and. change%time > 0.0_wp .and. change%time <= last)
      end associate
      call record_stage(scene%settings, stage, proof, any(slid) .or. built, decision)
      associate (outcome => decision%outcome)
         outcome%has_built = built
         outcome%n_slid = count(slid)
         outcome%slid = pack([(j, j=1, count(there))], pack(slid, there))
         outcome%steps = steps
         outcome%factorisations = factorisations
         outcome%has_path = .true.
         outcome%path_time = last
         if (.not. allocated(outcome%motion)) allocate (outcome%motion(scene%settings%n_dof, &
            & maxval(stage%system%equation)), source=0.0_wp)
      end associate
   end subroutine decide_at_rest

   !> Blocks and contacts of the last stage
   pure subroutine record_stage(settings, stage, proof, in_order, decision)
      type(settings_t), intent(in) :: settings  !! Settings of all stages
      type(scene_t), intent(in) :: stage
      type(graph_verdict_t), intent(in) :: proof
      !> True if joints have slid or blocks were built in any stage; otherwise forces are those of
      !> the last shape built at once
      logical, intent(in) :: in_order
      type(decision_t), intent(inout) :: decision
      type(scene_t) :: at_once
      logical :: slides

      if (proof%end == path_end%collapsed) then
         call record_collapse(stage, proof, decision)
      else if (proof%end == path_end%reached) then
         slides = .false.
         if (.not. in_order) then
            at_once = stage
            at_once%settings = settings
            call decide(at_once, decision)
            ! forces are those of the way without slip, whatever the order of the stages, only where
            ! the last shape stands without any
            slides = decision%outcome%verdict /= verdict%stable
            associate (contacts => decision%contacts)
               if (.not. slides) slides = any(contacts%face%slip /= 0 .and. &
                  & sum(contacts%force(:2, :), dim=1) > slip_share*maxval(abs(contacts%force)))
            end associate
         end if
         if (in_order .or. slides) call record_rest(stage, proof, decision)
         decision%outcome%slides_at_once = slides
      else
         decision%system = stage%system
         decision%contacts = stage%contacts
         decision%outcome%reason = proof%reason
      end if
   end subroutine record_stage

   !> True for joints that have slid against friction since a state
   pure function has_slid(after, n, before) result(slid)
      type(coulomb_state_t), intent(in) :: after
      integer, intent(in) :: n  !! Number of joints that are asked for, the first ones
      !> The state before; not allocated in the first stage
      type(coulomb_state_t), allocatable, intent(in) :: before
      logical :: slid(n)  !! True if they have: (n)
      real(wp) :: slip(n)

      slip = after%slip(:n)
      if (allocated(before)) slip = slip - before%slip(:n)
      slid = abs(slip) > slip_share*maxval(abs(after%motion)) &
         & .and. sum(after%force(:2, :n), dim=1) > slip_share*maxval(abs(after%force))
   end function has_slid

   !> Set the blocks and contacts that exist from a time on
   pure subroutine enter_stage(settings, time, system, contacts)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: time  !! The time [s]
      type(block_system_t), intent(inout) :: system
      !> Their contacts, those of the stage before or of all blocks
      type(contacts_t), intent(inout) :: contacts
      logical :: present(size(system%area)), kept(size(contacts%joint))
      integer :: b, j, n

      present = present_at(settings%boundary, size(present), time)
      n = 0
      do b = 1, size(present)
         if (present(b) .and. .not. system%fixed(b)) n = n + 1
         system%equation(b) = merge(n, 0, present(b) .and. .not. system%fixed(b))
         if (allocated(system%velocity) .and. .not. present(b)) system%velocity(:, b) = 0.0_wp
      end do
      system%absent = .not. present
      contacts%search%absent = .not. present
      contacts%search%near = edge_pairs_t()
      do j = 1, size(kept)
         kept(j) = all(present(contacts%joint(j)%block))
      end do
      call keep_contacts(kept, contacts)
   end subroutine enter_stage

   !> The state that the next stage begins with: joints of blocks that stay keep what they carry;
   !> what the others carried is a load on those that stay
   pure subroutine hand_over(stage, next, all, proof, start)
      type(scene_t), intent(in) :: stage   !! The stage that has ended
      type(scene_t), intent(in) :: next    !! The stage that begins
      type(contacts_t), intent(in) :: all  !! Contacts between all blocks
      type(graph_verdict_t), intent(in) :: proof
      type(coulomb_state_t), allocatable, intent(out) :: start
      type(joint_graph_t) :: before, after
      type(coulomb_joints_t) :: joints
      real(wp), allocatable :: force(:, :), load(:, :)
      integer, allocatable :: joint_of(:), label_before(:), label_after(:)
      integer :: b, e, i, j

      if (.not. allocated(proof%state)) return
      call scene_graph(stage%settings, stage%system, stage%contacts, before)
      call scene_graph(next%settings, next%system, next%contacts, after)
      allocate (load(3, after%n_block), source=1.0_wp)
      call new_coulomb_joints(after, load, joints)
      start = unloaded_state(joints)
      label_before = labels(stage, all, before)
      label_after = labels(next, all, after)
      allocate (joint_of(max(maxval([0, label_before]), maxval([0, label_after]))), source=0)
      joint_of(label_before) = [(j, j=1, size(label_before))]
      force = proof%state%force
      do i = 1, size(label_after)
         j = joint_of(label_after(i))
         if (j == 0) cycle
         start%force(:, i) = proof%state%force(:, j)
         start%gap(:, i) = proof%state%gap(:, j)
         start%slip(i) = proof%state%slip(j)
         start%face(:, i) = proof%state%face(:, j)
         force(:, j) = 0.0_wp
      end do
      load = proof%state%load
      call add_joint_forces(before, force, load)
      do b = 1, size(stage%system%equation)
         e = next%system%equation(b)
         if (e == 0 .or. stage%system%equation(b) == 0) cycle
         start%motion(:, e) = proof%state%motion(:, stage%system%equation(b))
         start%load(:, e) = load(:, stage%system%equation(b))
      end do
      ! nodes of bars come last in both
      i = after%n_block - maxval(next%system%equation)
      start%motion(:, after%n_block - i + 1:) = proof%state%motion(:, before%n_block - i + 1:)
      start%load(:, after%n_block - i + 1:) = load(:, before%n_block - i + 1:)
   end subroutine hand_over

   !> A number for each joint of a stage that is the same in all stages: that of the joint between
   !> all blocks, then of the restrained point, then of the bar
   pure function labels(stage, all, graph) result(label)
      type(scene_t), intent(in) :: stage
      type(contacts_t), intent(in) :: all
      type(joint_graph_t), intent(in) :: graph
      integer, allocatable :: label(:)  !! The numbers: (n_joint)
      logical :: there(size(all%joint))
      integer :: i, j, n

      do j = 1, size(there)
         there(j) = .not. any(stage%system%absent(all%joint(j)%block))
      end do
      label = pack([(j, j=1, size(there))], there)
      n = size(there)
      if (allocated(stage%settings%boundary%held)) then
         associate (held => stage%settings%boundary%held)
            label = [label, pack([(n + i, i=1, size(held))], &
               & stage%system%equation(held%block) > 0)]
            n = n + size(held)
         end associate
      end if
      label = [label, [(n + i, i=1, size(graph%kind) - size(label))]]
   end function labels
end module dda_stages
