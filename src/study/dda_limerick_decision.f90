!> A run of the original's scheme as a decision of ours: its verdict and the joints at its end
module dda_limerick_decision
   use dda_contact_detection, only : contacts_t
   use dda_contact_types, only : place_joint
   use dda_decision, only : decision_t
   use dda_deck, only : deck_t
   use dda_deck_scene, only : deck_scene
   use dda_kinds, only : wp
   use dda_limerick_contact, only : limerick_contact_t
   use dda_limerick_model, only : limerick_model_t
   use dda_limerick_run, only : limerick_outcome_t, limerick_verdict, run_limerick
   use dda_limerick_scene, only : limerick_scene
   use dda_limerick_state, only : contact_state
   use dda_limerick_step, only : limerick_run_t
   use dda_scene, only : scene_t
   use dda_verdict, only : verdict
   implicit none
   private

   public :: decide_limerick

contains

   !> Run the arch or the blocks of a deck under the original's scheme
   pure subroutine decide_limerick(deck, decision)
      !> The deck of one case, checked
      type(deck_t), intent(in) :: deck
      !> The decision
      type(decision_t), intent(out) :: decision
      type(limerick_model_t) :: model
      type(limerick_run_t) :: run
      type(limerick_outcome_t) :: outcome
      type(scene_t) :: scene

      call limerick_scene(deck, model)
      call run_limerick(model, run, outcome)
      call deck_scene(deck, scene)
      decision%system = scene%system
      decision%contacts = scene%contacts
      call tell_joints(scene, model, run, decision%system%moved, decision%contacts)
      associate (told => decision%outcome)
         told%steps = outcome%steps
         told%passes = outcome%passes
         told%factorisations = outcome%passes
         if (outcome%verdict == limerick_verdict%stable) told%verdict = verdict%stable
         if (outcome%verdict == limerick_verdict%collapsed) told%verdict = verdict%collapsed
         if (outcome%verdict == limerick_verdict%completed) told%verdict = verdict%completed
         if (allocated(outcome%reason)) told%reason = outcome%reason
         if (outcome%still_moving) told%reason = "it still moved when the steps were spent"
      end associate
   end subroutine decide_limerick

   !> Joints at the end of a run: openings and slips from the corners, forces from the contacts. The
   !> increments are those of the whole run, for single steps of this scheme jitter
   pure subroutine tell_joints(scene, model, run, now, contacts)
      !> The scene at the beginning; springings of arches stand for the abutments, which do not move
      type(scene_t), intent(in) :: scene
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run at its end
      type(limerick_run_t), intent(in) :: run
      !> The corners at the end: (2, n_vertex) [m]
      real(wp), intent(inout) :: now(:, :)
      !> The joints: at the beginning in, at the end out
      type(contacts_t), intent(inout) :: contacts
      real(wp) :: elastic_slip
      integer :: j, n

      if (size(model%measured_block) > 0) then
         ! the corners of a scene of lines are the last of the measured points
         n = size(model%measured_block) - size(now, 2)
         now = run%blocks%measured_point(:, n + 1:)
      else
         n = size(now, 2) - 8
         now(:, :n) = run%blocks%vertex(:, :n)
         now(:, n + 1:) = scene%system%vertex(:, n + 1:)
      end if
      elastic_slip = model%constants%stiffness_ratio*model%law(1)%friction &
         & *max(0.0_wp, -minval(run%contacts%item(:run%contacts%n)%gap))
      do j = 1, size(contacts%joint)
         call place_joint(scene%system, now, contacts%joint(j), contacts%gap(:, j))
         call tell_forces(model, run, j, contacts)
         if (any(contacts%face(j)%open)) cycle
         ! shear springs give no more before the joint slides
         if (abs(contacts%gap(3, j)) > elastic_slip) &
            & contacts%face(j)%slip = nint(sign(1.0_wp, contacts%gap(3, j)))
      end do
      contacts%increment = contacts%gap
   end subroutine tell_joints

   !> Forces and open corners of one joint from the contacts between its blocks
   pure subroutine tell_forces(model, run, j, contacts)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run at its end
      type(limerick_run_t), intent(in) :: run
      !> Number of the joint
      integer, intent(in) :: j
      !> The joints; points are set, forces and open corners become so
      type(contacts_t), intent(inout) :: contacts
      real(wp) :: force(2), along
      integer :: c, corner

      contacts%force(:, j) = 0.0_wp
      contacts%face(j)%open = .true.
      contacts%face(j)%slip = 0
      do c = 1, run%contacts%n
         associate (contact => run%contacts%item(c), joint => contacts%joint(j))
            if (contact%state == contact_state%open) cycle
            if (minval(contact%block) /= minval(joint%block)) cycle
            if (maxval(contact%block) /= maxval(joint%block)) cycle
            corner = nearest_corner(contacts, j, run%blocks%vertex(:, contact%vertex(1, 1)))
            force = contact_force(model, run, contact)
            along = dot_product(joint%tangent, run%blocks%vertex(:, contact%vertex(3, 1)) &
               & - run%blocks%vertex(:, contact%vertex(2, 1)))
            ! of the contact's force, what its edge's block does to the other block
            if (contact%block(1) == joint%block(1)) along = -along
            contacts%force(corner, j) = contacts%force(corner, j) + force(1)
            contacts%force(3, j) = contacts%force(3, j) - sign(1.0_wp, along)*force(2)
            contacts%face(j)%open(corner) = .false.
         end associate
      end do
   end subroutine tell_forces

   !> Corner of a joint that lies nearer to a point
   pure integer function nearest_corner(contacts, j, point)
      !> The joints
      type(contacts_t), intent(in) :: contacts
      !> Number of the joint
      integer, intent(in) :: j
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)

      nearest_corner = merge(1, 2, norm2(contacts%joint(j)%contact(1)%point - point) &
         & <= norm2(contacts%joint(j)%contact(2)%point - point))
   end function nearest_corner

   !> Normal force and force along the edge on the edge's block
   pure function contact_force(model, run, contact) result(force)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run at its end
      type(limerick_run_t), intent(in) :: run
      !> A closed contact
      type(limerick_contact_t), intent(in) :: contact
      !> Compression, and force on the edge's block in the direction of slip: (2) [N/m]
      real(wp) :: force(2)

      force(1) = -run%march%used_penalty*contact%gap
      force(2) = 0.0_wp
      if (contact%corner) return
      if (contact%state == contact_state%locked) then
         force(2) = run%march%used_penalty*contact%shear/model%constants%stiffness_ratio
      else
         force(2) = sign(max(0.0_wp, force(1)) &
            & *model%law(model%edge_law(contact%vertex(3, 1)))%friction, contact%shear)
      end if
   end function contact_force
end module dda_limerick_decision
