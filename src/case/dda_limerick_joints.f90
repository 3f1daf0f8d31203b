!> The contacts of the original's scheme as joints of ours
submodule (dda_compute_case:dda_limerick_decision) dda_limerick_joints
   use dda_contact_types, only : place_joint
   use dda_kinds, only : wp
   use dda_limerick_contact, only : limerick_contact_t
   use dda_limerick_model, only : contact_law, finite_law
   use dda_limerick_state, only : limerick_state
   use dda_material, only : joint_law_t
   implicit none

contains

   !> Joints at the end of a run
   module procedure tell_joints
      type(joint_law_t) :: law
      real(wp) :: deepest
      integer :: j

      deepest = max(0.0_wp, -minval(run%contacts%item(:run%contacts%n)%gap))
      do j = 1, size(contacts%joint)
         call place_joint(scene%system, now, contacts%joint(j), contacts%gap(:, j))
      end do
      call tell_forces(model, run, contacts)
      do j = 1, size(contacts%joint)
         if (any(contacts%face(j)%open(:contacts%joint(j)%n_contact))) cycle
         ! shear springs give no more before the joint slides
         law = finite_law(contacts%joint(j)%law)
         if (abs(contacts%gap(3, j)) > model%constants%stiffness_ratio*law%friction*deepest) &
            & contacts%face(j)%slip = nint(sign(1.0_wp, contacts%gap(3, j)))
      end do
      contacts%increment = contacts%gap
   end procedure tell_joints

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
            along = dot_product(contacts%joint(j)%tangent, &
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
      !> Numbers of the blocks: (2)
      integer, intent(in) :: block(2)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Number of the joint; 0 if these blocks have none
      integer, intent(out) :: joint
      !> Its corner, 1 or 2
      integer, intent(out) :: corner
      real(wp) :: nearest, distance
      integer :: j, k

      joint = 0
      corner = 0
      nearest = huge(nearest)
      do j = 1, size(contacts%joint)
         if (minval(block) /= minval(contacts%joint(j)%block)) cycle
         if (maxval(block) /= maxval(contacts%joint(j)%block)) cycle
         do k = 1, contacts%joint(j)%n_contact
            distance = norm2(contacts%joint(j)%contact(k)%point - point)
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

end submodule dda_limerick_joints
