!> The springs of the joints as rows of a matrix (Shi: df18, df22)
!>
!> A row carries the unknowns of the two blocks to a relative displacement of the joint: the
!> openings at its two contacts and its slip. One row for each, one stiffness for all three.
module dda_joint_springs
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_t
   use dda_deformation, only : tangent_matrix
   use dda_friction_cone, only : cone_t
   use dda_kinds, only : wp
   use dda_material, only : friction_left
   implicit none
   private

   public :: joint_springs_t, new_joint_springs, place_rows, mohr_coulomb, unbounded

   !> Springs of all joints, as the solver wants them
   type :: joint_springs_t
      !> Equations of the two blocks, 0 for a fixed one: (2, n_joint)
      integer, allocatable :: equation(:, :)
      !> Rows (opening 1, opening 2, slip) for the unknowns of the two blocks:
      !> (n_dof, 3, 2, n_joint)
      real(wp), allocatable :: row(:, :, :, :)
      !> Stiffness: (n_joint) [N/m per metre depth]
      real(wp), allocatable :: stiffness(:)
      !> Bounds of the joint force: (n_joint)
      type(cone_t), allocatable :: cone(:)
      !> Tension that the contacts carry, by which the cone is moved, and a zero: (3, n_joint) [N/m]
      real(wp), allocatable :: shift(:, :)
      !> How much openings and slip follow their forces, where they do: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: soft(:, :)
      !> Forces that they follow none of, where they do: (3, n_joint) [N/m]
      real(wp), allocatable :: rest(:, :)
      !> Whether the springs give for good: joints that were found may be more than the blocks can
      !> follow, and forces without give would then not be unique
      logical :: give = .false.
   end type joint_springs_t

   !> A tension, or a force, that nothing bounds [N/m]
   real(wp), parameter :: unbounded = sqrt(huge(1.0_wp))

   !> A block counts as no smaller across a joint than this share of the root of its area
   real(wp), parameter :: least_size = 0.1_wp
   !> Most that the stiffness of two joints may differ by: a joint between two slivers is stiff far
   !> beyond what the blocks around can feel, and would cut the longest step short
   real(wp), parameter :: stiffest = 1.0e2_wp

contains

   !> Springs of all joints
   pure subroutine new_joint_springs(system, motion, joint, penalty_ratio, n_dof, springs)
      type(block_system_t), intent(in) :: system
      !> How they have moved where the joints are placed: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      !> The joints: (n_joint)
      type(joint_t), intent(in) :: joint(:)
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp), intent(in) :: penalty_ratio
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      type(joint_springs_t), intent(out) :: springs
      real(wp) :: centroid(2, size(system%area))
      integer :: j, n

      centroid = system%centroid + motion(1:2, :)
      n = size(joint)
      allocate (springs%equation(2, n), springs%row(n_dof, 3, 2, n), springs%stiffness(n))
      allocate (springs%cone(n), springs%shift(3, n))
      springs%give = any(joint%found)
      call place_rows(system, motion, joint, springs)
      do j = 1, n
         springs%equation(:, j) = system%equation(joint(j)%block)
         springs%stiffness(j) = penalty_ratio*block_stiffness(system, centroid, joint(j))
         call mohr_coulomb(joint(j), [1.0_wp, 1.0_wp], springs%cone(j), springs%shift(:, j))
      end do
      if (n > 0 .and. .not. springs%give) &
         & springs%stiffness = min(springs%stiffness, stiffest*minval(springs%stiffness))
   end subroutine new_joint_springs

   !> Rows of the springs of joints that have been placed
   pure subroutine place_rows(system, motion, joint, springs)
      type(block_system_t), intent(in) :: system
      !> How the blocks have moved where the joints are placed: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      type(joint_t), intent(in) :: joint(:)
      !> The springs; their rows are set
      type(joint_springs_t), intent(inout) :: springs
      integer :: j, side

      do j = 1, size(joint)
         do side = 1, 2
            associate (b => joint(j)%block(side))
               springs%row(:, :, side, j) = real(2*side - 3, wp)*joint_rows(joint(j), side, &
                  & system%centroid(:, b) + motion(1:2, b), motion(:, b), size(springs%row, 1))
            end associate
         end do
      end do
   end subroutine place_rows

   !> What the joint sees of one block's unknowns
   pure function joint_rows(joint, side, centroid, motion, n_dof) result(row)
      type(joint_t), intent(in) :: joint
      !> 1 or 2, which of the joint's blocks
      integer, intent(in) :: side
      !> Centre of gravity of the block: (2) [m]
      real(wp), intent(in) :: centroid(2)
      !> How the block has moved: (6)
      real(wp), intent(in) :: motion(6)
      integer, intent(in) :: n_dof
      !> Displacement along the normal at both contacts, along the edge halfway: (n_dof, 3)
      real(wp) :: row(n_dof, 3)
      real(wp) :: t(2, 6)
      integer :: k

      row = 0.0_wp
      do k = 1, joint%n_contact
         associate (contact => joint%contact(k))
            t = tangent_matrix(merge(contact%foot, contact%point, side == contact%edge_side), &
               & centroid, motion)
            row(:, k) = contact%normal(1)*t(1, :n_dof) + contact%normal(2)*t(2, :n_dof)
         end associate
      end do
      t = tangent_matrix(joint%middle(:, side), centroid, motion)
      row(:, 3) = joint%tangent(1)*t(1, :n_dof) + joint%tangent(2)*t(2, :n_dof)
   end function joint_rows

   !> Stiffness E t/l = E area/l**2 of the softer of the movable blocks at a joint: l the block's
   !> size across it, t that along it; of given edges t is their length, of found ones l is twice
   !> the way from the centre
   pure function block_stiffness(system, centroid, joint) result(stiffness)
      type(block_system_t), intent(in) :: system
      !> Their centres of gravity: (2, n_block) [m]
      real(wp), intent(in) :: centroid(:, :)
      type(joint_t), intent(in) :: joint
      !> The stiffness [N/m per metre depth]
      real(wp) :: stiffness
      real(wp) :: young, size_across
      integer :: side

      stiffness = huge(stiffness)
      do side = 1, 2
         associate (b => joint%block(side))
            if (system%equation(b) == 0) cycle
            young = system%materials(system%material(b))%young
            if (joint%found) then
               size_across = max(least_size*sqrt(system%area(b)), &
                  & 2.0_wp*abs(dot_product(joint%normal, joint%middle(:, side) - centroid(:, b))))
               stiffness = min(stiffness, young*system%area(b)/size_across**2)
            else
               size_across = system%area(b)/joint%length
               stiffness = min(stiffness, young*joint%length/size_across)
            end if
         end associate
      end do
   end function block_stiffness

   !> Bounds of a joint's force and the tension that its contacts carry. The tension is at most that
   !> at the apex of the Mohr-Coulomb cone; a contact that has slid or parted has neither cohesion
   !> nor tension, and a joint of which none is whole its residual friction
   pure subroutine mohr_coulomb(joint, intact, cone, shift)
      type(joint_t), intent(in) :: joint
      !> Share that is left of each contact's strength: (2)
      real(wp), intent(in) :: intact(2)
      !> Bounds of the force, with the cone moved by the tension
      type(cone_t), intent(out) :: cone
      !> Tension of each contact and a zero for the shear force: (3) [N/m]
      real(wp), intent(out) :: shift(3)
      real(wp) :: whole(2), cohesion

      cone%single = joint%n_contact == 1
      whole = intact*joint%contact%length
      shift = [joint%law%tension*whole, 0.0_wp]
      if (joint%law%no_slip) then
         cone%limit = huge(1.0_wp)
         return
      end if
      cone%friction = friction_left(joint%law, maxval(intact(:joint%n_contact)))
      cohesion = joint%law%cohesion*sum(whole)
      if (cone%friction*sum(shift) > cohesion) shift = shift*(cohesion/(cone%friction*sum(shift)))
      cone%limit = max(0.0_wp, cohesion - cone%friction*sum(shift))
   end subroutine mohr_coulomb
end module dda_joint_springs
