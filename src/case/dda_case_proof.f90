!> Certificate of the verdict of a case: forces that carry its load, or a mechanism
!>
!> Both are of limit analysis: forces prove that a load can be carried, a mechanism that it cannot
!> be under any law of friction. A collapse on the loading path below the associated limit has no
!> proof of this kind.
submodule (dda_compute_case) dda_case_proof
   use dda_bar_joints, only : bar_joint
   use dda_deck, only : deck_t
   use dda_error, only : error_t
   use dda_joint_graph, only : joint_graph_t, keep_joints
   use dda_key_names, only : output_thrust_bar, output_thrust_joint
   use dda_limit_certificate, only : check_forces, check_velocities, crushing_power
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_limit_load, only : find_limit, find_thrust_range, limit_load_t, limit_state
   use dda_load_coefficient, only : added_loads, full_loads, with_coefficient
   use dda_load_stations, only : bears_live_load
   use dda_scene, only : family_t
   use dda_scene_graph, only : has_limit_analysis, scene_graph
   use dda_search, only : critical_t, proof_t
   use dda_settings, only : settings_t
   implicit none

   !> Relative gap of the limit of a load factor beside a decision
   real(wp), parameter :: limit_gap = 1.0e-13_wp
   !> Maximum number of joints for a default thrust range
   integer, parameter :: most_thrust_joints = 2001

contains

   !> Prove the verdict of a case by limit analysis
   module procedure prove_case
      if (this%searches) then
         call prove_search(this%family, this%critical, this%standing, this%scene, this%proof)
         return
      end if
      associate (mine => this%decision%contacts, others => this%scene%contacts)
         if (.not. allocated(others%joint)) return
         ! joints that are those of the scene are forgotten: the proof needs room
         if (allocated(mine%joint) .and. .not. this%scene%settings%current) then
            if (size(mine%joint) == size(others%joint)) deallocate (mine%joint)
         end if
      end associate
      call prove_decision(this%family%deck, this%scene, this%decision, this%proof)
   end procedure prove_case

   !> Prove a decision
   pure subroutine prove_decision(deck, scene, decision, proof)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene  !! Its scene at the beginning
      type(decision_t), intent(in) :: decision
      type(proof_t), intent(inout) :: proof
      type(joint_graph_t) :: graph
      type(limit_load_t) :: limit
      real(wp), allocatable :: dead(:, :)
      integer :: thrust_bar, thrust_joint

      if (.not. has_limit_analysis(scene%settings, scene%contacts)) return
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      call prove_state(scene, graph, decision, proof)
      if (decision%outcome%verdict /= verdict%stable) return
      thrust_bar = nint(deck%value(output_thrust_bar)%number)
      thrust_joint = nint(deck%value(output_thrust_joint)%number)
      associate (angle => scene%joint_angle_deg)
         if (thrust_joint == 0 .and. size(angle) > 0 .and. size(angle) <= most_thrust_joints) &
            & thrust_joint = minloc(abs(angle), dim=1)
      end associate
      if (thrust_joint <= 0) thrust_joint = scene%crown_joint
      if (thrust_bar > 0 .and. allocated(scene%settings%boundary%bar)) then
         if (thrust_bar <= size(scene%settings%boundary%bar)) &
            & call find_bar_range(scene, thrust_bar, proof)
      else if (thrust_joint > 0 .and. allocated(proof%force)) then
         if (thrust_joint <= size(scene%contacts%joint)) call find_thrust_range(graph, &
            & full_loads(scene%settings, scene, graph), proof%force, thrust_joint, proof%thrust, &
            & proof%has_thrust)
      end if
      if (.not. bears_live_load(with_coefficient(scene%settings, searched_load%factor, 1.0_wp))) &
         & return
      allocate (dead, source=full_loads(with_coefficient(scene%settings, searched_load%factor, &
         & 0.0_wp), scene, graph))
      call find_limit(graph, dead, added_loads(searched_load%factor, scene%settings, scene, &
         & graph), limit_gap, limit)
      proof%has_limit = limit%state == limit_state%found
      proof%limit = [limit%lower, limit%upper]
   end subroutine prove_decision

   !> Prove both sides of what a search has found
   pure subroutine prove_search(family, critical, stands, falls, proof)
      class(family_t), intent(in) :: family
      type(critical_t), intent(in) :: critical
      !> The scenes of its two sides; made here if they are not there yet
      type(scene_t), intent(inout) :: stands
      type(scene_t), intent(inout) :: falls
      type(proof_t), intent(inout) :: proof
      type(proof_t) :: other

      if (critical%limit%known .and. critical%verdict == verdict%found) then
         call prove_limit(family, critical, falls, proof)
         return
      end if
      if (allocated(critical%standing)) then
         call prove_side(family, critical%stands, critical%standing, stands, proof)
         if (.not. allocated(proof%scene%contacts%joint)) return
         proof%force_at = critical%stands
      end if
      if (.not. allocated(critical%fallen)) return
      call prove_side(family, critical%falls, critical%fallen, falls, other)
      if (.not. allocated(other%velocity)) return
      proof%law_violation = max(proof%law_violation, other%law_violation)
      proof%power = other%power
      proof%motion_at = critical%falls
      call move_alloc(other%velocity, proof%velocity)
      if (.not. allocated(proof%force)) proof%scene = falls
      proof%same_shape = .not. any(abs(proof%scene%system%vertex - falls%system%vertex) > 0.0_wp)
   end subroutine prove_search

   !> Prove the decision of one value, if limit analysis applies to its scene
   pure subroutine prove_side(family, value, decision, scene, proof)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! The value
      type(decision_t), intent(in) :: decision
      type(scene_t), intent(inout) :: scene
      type(proof_t), intent(inout) :: proof
      type(joint_graph_t) :: graph

      call build_once(family, value, scene)
      if (.not. allocated(scene%contacts%joint)) return
      if (.not. has_limit_analysis(scene%settings, scene%contacts)) return
      call place_all_joints(scene%system, scene%contacts)
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      call prove_state(scene, graph, decision, proof)
   end subroutine prove_side

   !> Least and greatest force of a bar with which the blocks stand: a pair of forces in its place
   pure subroutine find_bar_range(scene, bar, proof)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: bar  !! Number of the bar
      type(proof_t), intent(inout) :: proof
      type(settings_t) :: settings
      type(joint_graph_t) :: graph
      type(load_decision_t) :: decision
      type(limit_load_t) :: limit
      real(wp), allocatable :: dead(:, :), live(:, :)
      logical, allocatable :: kept(:)
      integer :: j, k, side

      settings = scene%settings
      settings%boundary%bar(bar)%strength = huge(1.0_wp)
      call scene_graph(settings, scene%system, scene%contacts, graph)
      allocate (dead, source=full_loads(settings, scene, graph))
      allocate (live, source=0.0_wp*dead)
      j = bar_joint(settings, size(graph%kind), bar)
      do side = 1, 2
         if (graph%block(side, j) > 0) live(1:3, graph%block(side, j)) = graph%row(:, 1, side, j)
      end do
      call decide_load(graph, dead, decision)
      if (decision%state /= load_state%stands) return
      dead = dead + decision%force(1, j)*live
      allocate (kept(size(graph%kind)), source=.true.)
      kept(j) = .false.
      call keep_joints(kept, graph)
      do k = 1, 2
         call find_limit(graph, dead, merge(-1.0_wp, 1.0_wp, k == 1)*live, limit_gap, limit)
         proof%has_thrust(k) = limit%state == limit_state%found
         if (proof%has_thrust(k)) proof%thrust(k) = decision%force(1, j) &
            & + merge(-0.5_wp, 0.5_wp, k == 1)*(limit%lower + limit%upper)
      end do
      ! a bar pulls with no less than nothing and no more than its strength
      proof%thrust(1) = max(0.0_wp, proof%thrust(1))
      if (scene%settings%boundary%bar(bar)%strength < huge(1.0_wp)) then
         if (.not. proof%has_thrust(2)) proof%thrust(2) = huge(1.0_wp)
         proof%thrust(2) = min(proof%thrust(2), scene%settings%boundary%bar(bar)%strength)
         proof%has_thrust(2) = .true.
      end if
   end subroutine find_bar_range

   !> Forces that carry the load of a scene, or a mechanism that it drives
   pure subroutine prove_state(scene, graph, decision, proof)
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      !> Decision to prove, with that of limit analysis if there is one
      type(decision_t), intent(in) :: decision
      type(proof_t), intent(inout) :: proof
      type(load_decision_t) :: answer
      real(wp) :: load(3, graph%n_block), power
      integer :: b

      load = full_loads(scene%settings, scene, graph)
      if (allocated(decision%limit)) then
         answer = decision%limit
      else
         call decide_load(graph, load, answer)
      end if
      proof%scene = scene
      ! beside what acts on blocks, without nodes of bars and carriers of bounded forces
      b = maxval(scene%system%equation)
      if (answer%state == load_state%stands .and. decision%outcome%verdict == verdict%stable) then
         call check_forces(graph, load, answer%force, proof%imbalance, proof%law_violation)
         call move_alloc(answer%force, proof%force)
      else if (answer%state == load_state%falls &
         & .and. decision%outcome%verdict == verdict%collapsed) then
         call check_velocities(graph, load, answer%velocity, proof%law_violation, power)
         proof%power = (power - crushing_power(graph, answer%velocity)) &
            & /most_power(load(:, :b), answer%velocity(:, :b))
         call move_alloc(answer%velocity, proof%velocity)
      end if
   end subroutine prove_state

   !> The two proofs of the limit of a load coefficient
   pure subroutine prove_limit(family, critical, falls, proof)
      class(family_t), intent(in) :: family
      type(critical_t), intent(in) :: critical
      type(scene_t), intent(in) :: falls  !! The scene of another value, if there is one
      type(proof_t), intent(inout) :: proof
      type(joint_graph_t) :: graph
      type(error_t), allocatable :: error
      real(wp), allocatable :: load(:, :)
      real(wp) :: violation, power

      proof%scene = falls
      associate (limit => critical%limit)
         call family%turn(limit%value(1), proof%scene, error)
         if (allocated(error)) return
         call scene_graph(proof%scene%settings, proof%scene%system, proof%scene%contacts, graph)
         allocate (load, source=full_loads(proof%scene%settings, proof%scene, graph))
         proof%force = limit%force
         proof%velocity = limit%velocity
         proof%force_at = limit%value(1)
         proof%motion_at = limit%value(2)
         call check_forces(graph, load, proof%force, proof%imbalance, proof%law_violation, &
            & limit%value(1)*limit%live)
         call check_velocities(graph, limit%live, proof%velocity, violation, power)
         proof%law_violation = max(proof%law_violation, violation)
         proof%power = power/most_power(limit%live, proof%velocity)
      end associate
   end subroutine prove_limit

   !> Power of loads if each went along with the motion of its block
   pure real(wp) function most_power(load, velocity)
      real(wp), intent(in) :: load(:, :)      !! Loads: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: velocity(:, :)  !! Velocities: (3, n_block) [m/s, m/s, 1/s]

      most_power = sum(norm2(load(1:2, :), dim=1)*norm2(velocity(1:2, :), dim=1) &
         & + abs(load(3, :)*velocity(3, :)))
      most_power = max(most_power, tiny(most_power))
   end function most_power

end submodule dda_case_proof
