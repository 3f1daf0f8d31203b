!> Reactions of fixed blocks and restraints
module dda_reactions
   use dda_block_system, only : block_system_t
   use dda_boundary, only : boundary_t
   use dda_contact_types, only : joint_place_t
   use dda_contacts, only : contacts_t, joint_place
   use dda_deformation, only : moved_point
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_step_context, only : run_t
   use dda_vector, only : cross
   implicit none
   private

   public :: supports_of, forces_of_blocks, force_on, keep_reactions

contains

   !> All supports: fixed blocks first, then points that are held of others
   pure function supports_of(system, boundary) result(support)
      type(block_system_t), intent(in) :: system
      type(boundary_t), intent(in) :: boundary
      integer, allocatable :: support(:, :)  !! Block, and restrained point or 0: (2, n)
      logical :: stands(size(system%equation))
      integer, allocatable :: fixed(:), held(:)
      integer :: i

      stands = system%equation == 0
      if (allocated(system%absent)) stands = stands .and. .not. system%absent
      fixed = pack([(i, i=1, size(stands))], stands)
      allocate (held(0))
      if (allocated(boundary%held)) held = pack([(i, i=1, size(boundary%held))], &
         & system%equation(boundary%held%block) > 0)
      allocate (support(2, size(fixed) + size(held)), source=0)
      support(1, :size(fixed)) = fixed
      support(2, size(fixed) + 1:) = held
      if (size(held) > 0) support(1, size(fixed) + 1:) = boundary%held(held)%block
   end function supports_of

   !> Force of a joint on one of its blocks, and its moment about the origin of coordinates
   pure function force_on(place, force, side) result(wrench)
      type(joint_place_t), intent(in) :: place
      real(wp), intent(in) :: force(3)  !! Its force N1, N2, T: (3) [N/m]
      integer, intent(in) :: side       !! Side of the joint, 1 or 2
      real(wp) :: wrench(3)             !! Components along x and y, and moment: (3) [N/m, N/m, N]
      integer :: k

      wrench(1:2) = force(3)*place%tangent
      wrench(3) = cross(place%middle(:, side), wrench(1:2))
      do k = 1, 2
         wrench(1:2) = wrench(1:2) + force(k)*place%across(:, k)
         wrench(3) = wrench(3) + force(k)*cross(place%point(:, k), place%across(:, k))
      end do
      if (side == 1) wrench = -wrench
   end function force_on

   !> Forces of fixed blocks on those that move
   pure function forces_of_blocks(system, contacts, force, support) result(reaction)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      real(wp), intent(in) :: force(:, :)   !! Their forces N1, N2, T: (3, n_joint) [N/m]
      integer, intent(in) :: support(:, :)  !! The supports; points get nothing: (2, n)
      !> Force, and moment about the origin of coordinates: (3, n) [N/m, N/m, N]
      real(wp) :: reaction(3, size(support, 2))
      integer :: i, j, number(size(system%equation)), side

      reaction = 0.0_wp
      number = 0
      do i = 1, size(support, 2)
         if (support(2, i) == 0) number(support(1, i)) = i
      end do
      do j = 1, size(contacts%joint)
         do side = 1, 2
            i = number(contacts%joint(j)%block(3 - side))
            if (i == 0 .or. system%equation(contacts%joint(j)%block(side)) == 0) cycle
            reaction(:, i) = reaction(:, i) &
               & + force_on(joint_place(system, contacts, j), force(:, j), side)
         end do
      end do
   end function forces_of_blocks

   !> Keep the reactions of a dynamic step: the mean over it of what changes the momentum of the
   !> blocks
   pure subroutine keep_reactions(run, album)
      type(run_t), intent(in) :: run  !! The run after the step
      type(album_t), intent(inout) :: album
      real(wp) :: force(2), place(2)
      integer :: h, i, k

      if (.not. allocated(album%support)) return
      associate (system => run%system, contacts => run%contacts, step => run%step, &
         & fixed => run%equations%fixed)
         if (allocated(step%mean_force)) then
            album%reaction_now = forces_of_blocks(system, contacts, step%mean_force, album%support)
         else
            album%reaction_now = forces_of_blocks(system, contacts, contacts%force, album%support)
         end if
         do k = 1, size(fixed%point)
            h = fixed%point(k)
            i = findloc(album%support(2, :), h, dim=1)
            force = 0.0_wp
            force(fixed%axis(k)) = fixed%force(k)
            if (allocated(step%held_mean_force)) force(fixed%axis(k)) = step%held_mean_force(k)
            associate (held => run%settings%boundary%held(h))
               place = held%point
               if (run%settings%current) place = moved_point(held%point, &
                  & system%centroid(:, held%block), system%motion(:, held%block))
            end associate
            album%reaction_now(:, i) = album%reaction_now(:, i) + [force, cross(place, force)]
         end do
      end associate
   end subroutine keep_reactions
end module dda_reactions
