!> From blocks as a user gives them to a scene ready to run
module dda_block_scene
   use dda_block_input, only : block_plan_t, unsupported_block
   use dda_block_system, only : new_block_system, set_initial_state
   use dda_contact_search, only : new_joint_search
   use dda_contact_transfer, only : search_contacts
   use dda_kinds, only : wp
   use dda_material, only : friction_coefficient, joint_law_t, material_t
   use dda_scene, only : scene_t
   use dda_water_loads, only : add_water_loads
   implicit none
   private

   public :: base_t, block_scene, floating_block, lacks_friction

   !> What the deck says of all blocks and joints
   type :: base_t
      !> Material of the blocks
      type(material_t) :: material
      !> Weight per volume [N/m3]
      real(wp) :: unit_weight = 0.0_wp
      !> Acceleration of gravity, for materials with a density of their own [m/s2]
      real(wp) :: gravity = 9.81_wp
      !> Friction angle, cohesion, tensile strength of the joints, friction angle of those that have
      !> slid, slip over which strength goes: (5) [deg, Pa, Pa, deg, m]
      real(wp) :: law(5) = [50.0_wp, 0.0_wp, 0.0_wp, 90.0_wp, 0.0_wp]
      !> By how much all lines of heads have risen [m]
      real(wp) :: water_rise = 0.0_wp
   end type base_t

   !> Friction angles count up to this one: a joint that is open must not hold by friction without
   !> bound [deg]
   real(wp), parameter :: most_friction_deg = 89.9_wp

contains

   !> Make the scene of a plan; its settings are the caller's, with the plan's points
   pure subroutine block_scene(plan, base, scene)
      type(block_plan_t), intent(in) :: plan
      !> What the deck says of all blocks and joints
      type(base_t), intent(in) :: base
      !> The scene; its settings are set
      type(scene_t), intent(inout) :: scene
      type(joint_law_t), allocatable :: law(:, :)
      type(material_t), allocatable :: material(:)
      real(wp), allocatable :: unit_weight(:)
      integer :: b

      call materials_of(plan, base, material, unit_weight)
      allocate (law, source=laws_of(plan, base, size(material)))
      do b = 1, size(material)
         law(:, b)%strength = min(material%strength, material(b)%strength)
      end do
      scene%settings%boundary = plan%boundary
      scene%origin = plan%origin
      call add_water_loads(plan, base%water_rise, scene%settings%boundary)
      associate (system => scene%system)
         system = new_block_system(plan%first_vertex, plan%vertex, plan%fixed, base%material)
         deallocate (system%materials)
         allocate (system%materials, source=material)
         system%material = plan%material
         do b = 1, size(plan%fixed)
            system%density(b) = material(plan%material(b))%density
            system%unit_weight(b) = unit_weight(plan%material(b))
            call set_initial_state(system, b, plan%velocity(:, b), plan%stress(:, b))
         end do
         if (allocated(plan%boundary%bar)) allocate (system%bar(size(plan%boundary%bar)))
         scene%contacts%searched = .true.
         scene%contacts%search = new_joint_search(system, law)
         call search_contacts(system, scene%settings%penalty_ratio, scene%settings%n_dof, &
            & scene%contacts)
      end associate
      allocate (scene%joint_angle_deg(0))
   end subroutine block_scene

   !> The first movable block that no chain of joints ties to a fixed one or to a held point; 0 if
   !> there is none
   pure integer function floating_block(scene)
      type(scene_t), intent(in) :: scene
      logical :: fixed(size(scene%system%area))
      integer, allocatable :: pair(:, :)
      integer :: i, n

      fixed = scene%system%equation == 0
      if (allocated(scene%settings%boundary%held)) then
         do i = 1, size(scene%settings%boundary%held)
            fixed(scene%settings%boundary%held(i)%block) = .true.
         end do
      end if
      n = size(scene%contacts%joint)
      allocate (pair(2, n))
      do i = 1, n
         pair(:, i) = scene%contacts%joint(i)%block
      end do
      if (allocated(scene%settings%boundary%bar)) then
         do i = 1, size(scene%settings%boundary%bar)
            associate (block => scene%settings%boundary%bar(i)%block)
               if (all(block > 0)) pair = reshape([pair, block], [2, size(pair, 2) + 1])
               if (any(block == 0)) fixed(maxval(block)) = .true.
            end associate
         end do
      end if
      floating_block = unsupported_block(fixed, pair)
   end function floating_block

   !> Materials by number; what the plan leaves out is that of the deck
   pure subroutine materials_of(plan, base, material, unit_weight)
      type(block_plan_t), intent(in) :: plan
      type(base_t), intent(in) :: base
      !> The materials: (n_material)
      type(material_t), allocatable, intent(out) :: material(:)
      !> Their weight per volume: (n_material) [N/m3]
      real(wp), allocatable, intent(out) :: unit_weight(:)
      integer :: i, n

      n = max(1, maxval(plan%material))
      if (size(plan%materials) > 0) n = max(n, maxval(plan%materials%number))
      allocate (material(n), source=base%material)
      allocate (unit_weight(n), source=base%unit_weight)
      do i = 1, size(plan%materials)
         associate (own => plan%materials(i), m => plan%materials(i)%number)
            if (own%given(1)) then
               material(m)%density = own%value(1)
               unit_weight(m) = own%value(1)*base%gravity
            end if
            if (own%given(2)) unit_weight(m) = own%value(2)
            if (own%given(3)) material(m)%young = own%value(3)
            if (own%given(4)) material(m)%poisson = own%value(4)
            if (own%given(5)) material(m)%strength = own%value(5)
         end associate
      end do
   end subroutine materials_of

   !> Laws of the joints between any two materials
   pure function laws_of(plan, base, n) result(law)
      type(block_plan_t), intent(in) :: plan
      type(base_t), intent(in) :: base
      !> Number of materials
      integer, intent(in) :: n
      !> The laws: (n, n)
      type(joint_law_t) :: law(n, n)
      real(wp) :: value(5)
      integer :: i

      law = law_of(base%law)
      do i = 1, size(plan%laws)
         associate (pair => plan%laws(i)%material)
            if (any(pair > n)) cycle
            value = merge(plan%laws(i)%value, base%law, plan%laws(i)%given)
            law(pair(1), pair(2)) = law_of(value)
            law(pair(2), pair(1)) = law(pair(1), pair(2))
         end associate
      end do
   end function laws_of

   !> Whether blocks may meet for whose materials the plan gives no friction
   pure logical function lacks_friction(plan)
      type(block_plan_t), intent(in) :: plan
      logical, allocatable :: given(:, :), moves(:)
      integer, allocatable :: blocks(:)
      integer :: b, i, j, n

      n = max(maxval(plan%material), maxval(plan%laws%material(1)), maxval(plan%laws%material(2)))
      allocate (given(n, n), source=.false.)
      do i = 1, size(plan%laws)
         associate (pair => plan%laws(i)%material)
            given(pair(1), pair(2)) = given(pair(1), pair(2)) .or. plan%laws(i)%given(1)
            given(pair(2), pair(1)) = given(pair(1), pair(2))
         end associate
      end do
      allocate (blocks(n), source=0)
      allocate (moves(n), source=.false.)
      do b = 1, size(plan%material)
         blocks(plan%material(b)) = blocks(plan%material(b)) + 1
         moves(plan%material(b)) = moves(plan%material(b)) .or. .not. plan%fixed(b)
      end do
      lacks_friction = .false.
      do j = 1, n
         do i = 1, j
            ! two blocks, not both fixed
            if (merge(blocks(i) < 2, min(blocks(i), blocks(j)) == 0, i == j)) cycle
            if (.not. given(i, j) .and. (moves(i) .or. moves(j))) lacks_friction = .true.
         end do
      end do
   end function lacks_friction

   !> A law of joints that may open
   pure type(joint_law_t) function law_of(value) result(law)
      !> Friction angle, cohesion, tensile strength, friction angle after slip, slip over which
      !> strength goes: (5) [deg, Pa, Pa, deg, m]
      real(wp), intent(in) :: value(5)

      law%friction = friction_coefficient(min(value(1), most_friction_deg))
      law%cohesion = value(2)
      law%tension = value(3)
      if (value(4) < value(1)) law%residual = friction_coefficient(value(4))
      law%slip_length = value(5)
   end function law_of
end module dda_block_scene
