!> Shi's scheme in a case: verdict of a run, and critical value by bisection
submodule (dda_compute_case) dda_limerick_decision
   use dda_block_system, only : begin_motion, block_system_t
   use dda_contact_types, only : place_joint
   use dda_contacts, only : begin_forces
   use dda_deck, only : deck_t
   use dda_deck_scene, only : deck_family_t, deck_scene, put_value
   use dda_error, only : error_t
   use dda_frames, only : album_t, frame_is_due, keep_frame
   use dda_key_names, only : scene_kind
   use dda_limerick_contact, only : limerick_contact_t
   use dda_limerick_model, only : contact_law, finite_law, limerick_model_t, limerick_state
   use dda_limerick_run, only : begin_outcome, begin_run, limerick_outcome_t, next_step, &
      & run_limerick
   use dda_limerick_scene, only : limerick_scene
   use dda_limerick_step, only : limerick_run_t
   use dda_material, only : joint_law_t
   use dda_search, only : critical_t, keep_decision, search_t
   implicit none

   !> First stride over the start; strides double
   real(wp), parameter :: first_stride = 0.02_wp
   !> Maximum number of runs of a search
   integer, parameter :: max_runs = 100

contains

   !> Decide the scene under Shi's scheme
   module procedure decide_limerick
      if (.not. allocated(this%scene%contacts%joint)) &
         & call deck_scene(this%family%deck, this%scene)
      call run_scheme(this%family%deck, this%scene, this%decision, this%album)
   end procedure decide_limerick

   !> Run what a deck describes under Shi's scheme
   pure subroutine run_scheme(deck, scene, decision, album)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(decision_t), intent(out) :: decision
      !> Receives the ways of its points, if it has some
      type(album_t), intent(inout), optional :: album
      type(limerick_model_t) :: model
      type(limerick_run_t) :: run
      type(limerick_outcome_t) :: outcome
      integer :: frames

      call limerick_scene(deck, scene, model)
      if (present(album)) then
         album%interval = 0.0_wp
         frames = nint(deck%value(output_frames)%number)
         ! evenly in the steps of a dynamic run, in displacement in a static one
         if (frames > 0 .and. model%constants%dynamic) then
            album%every = max(1, model%constants%max_steps/frames)
         else if (frames > 0) then
            album%spacing = model%constants%collapse_displacement/real(frames, wp)
         end if
         call run_with_pictures(deck, scene, model, run, outcome, album)
         if (size(album%point) > 0) then
            album%n_track = outcome%steps + 1
            album%when = outcome%when(:, :album%n_track)
            album%track = outcome%track(:, :, :album%n_track)
         end if
      else
         call run_limerick(model, run, outcome)
      end if
      call report_state(deck, scene, model, run, decision%system, decision%contacts)
      associate (told => decision%outcome)
         told%steps = outcome%steps
         told%passes = outcome%passes
         told%factorisations = outcome%passes
         told%verdict = outcome%verdict
         if (allocated(outcome%reason)) told%reason = outcome%reason
         if (outcome%still_moving) told%reason = "step limit reached while still moving"
      end associate
   end subroutine run_scheme

   !> Run a model and keep its pictures
   pure subroutine run_with_pictures(deck, scene, model, run, outcome, album)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(out) :: run
      type(limerick_outcome_t), intent(out) :: outcome
      type(album_t), intent(inout) :: album
      type(block_system_t) :: system
      type(contacts_t) :: contacts
      real(wp) :: farthest
      logical :: ended

      call begin_run(model, run)
      call begin_outcome(model, run, size(album%point), outcome)
      ended = .false.
      do
         associate (march => run%march)
            if (frame_is_due(march%steps, march%time, outcome%displacement, ended, album)) then
               call report_state(deck, scene, model, run, system, contacts)
               farthest = march%displacement_ratio*march%half_size &
                  & *model%constants%max_displacement_ratio
               call keep_frame(system, contacts, march%steps, march%time, outcome%displacement, &
                  & farthest, ended, album)
            end if
         end associate
         if (ended) exit
         call next_step(model, run, outcome, ended)
      end do
   end subroutine run_with_pictures

   !> The scene's blocks and joints as a run has left them
   pure subroutine report_state(deck, scene, model, run, system, contacts)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      type(block_system_t), intent(out) :: system
      type(contacts_t), intent(out) :: contacts
      integer :: n

      system = scene%system
      call begin_motion(system)
      if (allocated(system%bar)) system%bar%force = run%blocks%bolt_force
      contacts = scene%contacts
      call begin_forces(contacts)
      call place_corners(deck%value(scene_kind)%text, run, system)
      call tell_joints(model, run, system%moved, contacts)
      ! blocks of the scheme are those of the scene, in their order
      n = min(size(system%area), size(run%blocks%area))
      system%stress(:, :n) = run%blocks%stress(:, :n)
      system%motion(1:2, :n) = run%blocks%centroid(:, :n) - scene%system%centroid(:, :n)
      system%motion(3, :n) = run%blocks%rotation(:n)
   end subroutine report_state

   !> Corners of the scene's blocks at the end of a run
   pure subroutine place_corners(kind, run, system)
      character(len=*), intent(in) :: kind  !! Lines of the blocks
      type(limerick_run_t), intent(in) :: run
      !> The blocks; where their corners have moved to is set
      type(block_system_t), intent(inout) :: system
      integer :: n

      n = size(system%moved, 2)
      select case (kind)
      case ("arch")
         ! the last eight are springings, which stand for abutments and do not move
         system%moved(:, :n - 8) = run%blocks%vertex(:, :n - 8)
      case ("lines")
         ! edges are split at the joints: these corners are the last of the monitoring points
         associate (point => run%blocks%measured_point)
            system%moved = point(:, size(point, 2) - n + 1:)
         end associate
      case ("blocks")
         system%moved = run%blocks%vertex
      end select
   end subroutine place_corners

   !> Joints at the end of a run: openings and slips from the corners, forces from the contacts.
   !> The increments are those of the whole run, for single steps of this scheme jitter
   pure subroutine tell_joints(model, run, now, contacts)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      real(wp), intent(in) :: now(:, :)  !! The corners at the end: (2, n_vertex) [m]
      !> The joints: at the beginning in, at the end out
      type(contacts_t), intent(inout) :: contacts
      type(joint_law_t) :: law
      real(wp) :: deepest
      integer :: j

      deepest = max(0.0_wp, -minval(run%contacts%item(:run%contacts%n)%gap))
      allocate (contacts%place(size(contacts%joint)))
      do j = 1, size(contacts%joint)
         call place_joint(now, contacts%joint(j), contacts%place(j), contacts%gap(:, j))
      end do
      call tell_forces(model, run, contacts)
      do j = 1, size(contacts%joint)
         if (any(contacts%face(j)%open(:contacts%joint(j)%n_contact))) cycle
         ! shear springs give no more before the joint slides
         law = finite_law(contacts%law(contacts%joint(j)%law))
         if (abs(contacts%gap(3, j)) > model%constants%stiffness_ratio*law%friction*deepest) &
            & contacts%face(j)%slip = nint(sign(1.0_wp, contacts%gap(3, j)))
      end do
      contacts%increment = contacts%gap
   end subroutine tell_joints

   !> Forces and open corners of the joints from the contacts between their blocks
   pure subroutine tell_forces(model, run, contacts)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      !> The joints; points are set, forces and open corners become so
      type(contacts_t), intent(inout) :: contacts
      real(wp) :: force(2), along
      integer :: c, corner, j

      contacts%force = 0.0_wp
      contacts%face%slip = 0
      do j = 1, size(contacts%joint)
         contacts%face(j)%open = .true.
      end do
      do c = 1, run%contacts%n
         associate (contact => run%contacts%item(c))
            if (contact%state == limerick_state%open) cycle
            call find_corner(contacts, contact%block, &
               & run%blocks%vertex(:, contact%vertex(1, 1)), j, corner)
            if (j == 0) cycle
            force = contact_force(model, run, contact)
            along = dot_product(contacts%place(j)%tangent, &
               & run%blocks%vertex(:, contact%vertex(3, 1)) &
               & - run%blocks%vertex(:, contact%vertex(2, 1)))
            ! of the contact's force, what its edge's block does to the other block
            if (contact%block(1) == contacts%joint(j)%block(1)) along = -along
            contacts%force(corner, j) = contacts%force(corner, j) + force(1)
            contacts%force(3, j) = contacts%force(3, j) - sign(1.0_wp, along)*force(2)
            contacts%face(j)%open(corner) = .false.
         end associate
      end do
   end subroutine tell_forces

   !> The corner of a joint between two blocks that lies nearest to a point
   pure subroutine find_corner(contacts, block, point, joint, corner)
      type(contacts_t), intent(in) :: contacts
      integer, intent(in) :: block(2)   !! Numbers of the blocks: (2)
      real(wp), intent(in) :: point(2)  !! The point: (2) [m]
      integer, intent(out) :: joint     !! Number of the joint; 0 if these blocks have none
      integer, intent(out) :: corner    !! Its corner, 1 or 2
      real(wp) :: nearest, distance
      integer :: j, k

      joint = 0
      corner = 0
      nearest = huge(nearest)
      do j = 1, size(contacts%joint)
         if (minval(block) /= minval(contacts%joint(j)%block)) cycle
         if (maxval(block) /= maxval(contacts%joint(j)%block)) cycle
         do k = 1, contacts%joint(j)%n_contact
            distance = norm2(contacts%place(j)%point(:, k) - point)
            if (.not. distance < nearest) cycle
            nearest = distance
            joint = j
            corner = k
         end do
      end do
   end subroutine find_corner

   !> Normal force and force along the edge on the edge's block
   pure function contact_force(model, run, contact) result(force)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      type(limerick_contact_t), intent(in) :: contact
      !> Compression, and force on the edge's block in the direction of slip: (2) [N/m]
      real(wp) :: force(2)
      type(joint_law_t) :: law

      force(1) = -run%march%used_penalty*contact%gap
      force(2) = 0.0_wp
      if (contact%corner) return
      if (contact%state == limerick_state%locked) then
         force(2) = run%march%used_penalty*contact%shear/model%constants%stiffness_ratio
      else
         law = contact_law(model, contact%block(1), contact%vertex(3, 1))
         force(2) = sign(max(0.0_wp, force(1))*law%friction, contact%shear)
      end if
   end function contact_force

   !> Search the critical value of Shi's scheme
   module procedure search_limerick
      type(decision_t) :: decision
      type(error_t), allocatable :: error

      ! the limit of this scheme lies somewhat above the exact value
      if (this%exact_known .and. .not. this%search%check_far_end) &
         & this%search%start = min(max(this%exact, this%search%low), this%search%high)
      call close_bracket(this%family, this%search, this%critical)
      if (allocated(this%critical%fallen)) &
         & call this%family%build(this%critical%falls, this%scene, error)
      if (nint(this%family%deck%value(output_frames)%number) == 0) return
      if (.not. (allocated(this%critical%fallen) .or. allocated(this%critical%standing))) return
      call run_at(this%family, merge(this%critical%falls, this%critical%stands, &
         & allocated(this%critical%fallen)), decision, error, this%album)
   end procedure search_limerick

   !> Close the bracket around the value
   pure subroutine close_bracket(family, search, critical)
      type(deck_family_t), intent(in) :: family
      !> The search; where the far end needs no check, the search strides out from the start
      type(search_t), intent(in) :: search
      type(critical_t), intent(out) :: critical
      integer :: answer

      if (search%check_far_end) then
         call decide_at(family, search%low, critical, answer)
         if (answer /= verdict%undecided) call decide_at(family, search%high, critical, answer)
      else
         call stride_out(family, search, critical, answer)
      end if
      do while (answer /= verdict%undecided .and. both_sides(critical))
         critical%half = abs(critical%stands - critical%falls)/2.0_wp
         if (critical%decisions >= max_runs) exit
         if (2.0_wp*critical%half <= search%tolerance*abs(critical%stands)) then
            critical%verdict = verdict%found
            return
         end if
         call decide_at(family, (critical%stands + critical%falls)/2.0_wp, critical, answer)
      end do
      if (answer == verdict%undecided .or. both_sides(critical)) return
      critical%verdict = merge(verdict%collapsed, verdict%stable, allocated(critical%fallen))
   end subroutine close_bracket

   !> True if a value stands and another falls
   pure logical function both_sides(critical)
      type(critical_t), intent(in) :: critical

      both_sides = allocated(critical%fallen) .and. allocated(critical%standing)
   end function both_sides

   !> Go up from the start while it falls, or down while it stands, with steps that double
   pure subroutine stride_out(family, search, critical, answer)
      type(deck_family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! The last of them, one of verdict
      real(wp) :: value, stride

      value = search%start
      stride = first_stride*search%start
      do
         call decide_at(family, value, critical, answer)
         if (both_sides(critical) .or. answer == verdict%undecided) return
         if (answer == verdict%collapsed) then
            if (.not. value < search%high) return
            value = min(search%high, value + stride)
         else
            if (.not. value > search%low) return
            value = max(search%low, value - stride)
         end if
         stride = 2.0_wp*stride
      end do
   end subroutine stride_out

   !> Run one value and keep the decision on its side of the bracket
   pure subroutine decide_at(family, value, critical, answer)
      type(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value   !! The value
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! One of verdict
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error

      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      allocate (decision)
      call run_at(family, value, decision, error)
      if (allocated(error)) then
         critical%reason = error%message
         critical%undecided_at = value
         return
      end if
      associate (outcome => decision%outcome)
         if (outcome%verdict == verdict%completed) then
            outcome%verdict = verdict%undecided
            outcome%reason = "a dynamic run ends completed, neither stable nor collapsed"
         end if
         answer = outcome%verdict
      end associate
      call keep_decision(critical, value, decision)
   end subroutine decide_at

   !> Run one value
   pure subroutine run_at(family, value, decision, error, album)
      type(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(decision_t), intent(out) :: decision
      type(error_t), allocatable, intent(out) :: error  !! A value that the deck cannot have
      type(album_t), intent(inout), optional :: album   !! Receives its pictures
      type(deck_t) :: deck
      type(scene_t) :: scene

      deck = family%deck
      call put_value(family, value, deck, error)
      if (allocated(error)) return
      call deck_scene(deck, scene)
      call run_scheme(deck, scene, decision, album)
   end subroutine run_at
end submodule dda_limerick_decision
