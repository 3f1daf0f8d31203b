!> Scene from cut blocks; common edges are joints
module dda_line_scene
   use dda_arch_scene, only : joint_law, material_of, settings_of, unit_weight
   use dda_bar, only : bar_t
   use dda_block_system, only : block_system_t, new_block_system
   use dda_boundary, only : boundary_t, constant_history, history_t
   use dda_contact_search, only : new_joint_search
   use dda_contact_transfer, only : search_contacts
   use dda_contacts, only : find_contacts
   use dda_cut_model, only : bond_joint, cut_model_t, split_edges
   use dda_cutting, only : cut_blocks
   use dda_deck, only : deck_error, deck_t
   use dda_error, only : error_t
   use dda_key_names, only : analysis_geometry, analysis_mode, joint_cohesion, &
      & joint_friction_deg, joint_tension, load_gravity, material_density, material_plane, &
      & material_poisson, material_unit_weight, material_young, scene_geometry
   use dda_kinds, only : pi, wp
   use dda_limerick_analysis, only : limerick_joint_t
   use dda_line_model, only : entity_role
   use dda_material, only : joint_law_t, set_friction
   use dda_outline, only : outline_t
   use dda_scene, only : scene_t
   implicit none
   private

   public :: line_scene, check_line_scene, cut_lines, held_blocks, law_of_joint, line_system
   public :: points_of_lines

   !> Cohesion and tensile strength of bonds between pieces of a block [Pa]
   real(wp), parameter :: bond_strength = 1.0e15_wp

   !> Smallest stiffness of a bolt without properties
   real(wp), parameter :: least_stiffness = 1.0e-12_wp

contains

   !> Cut the lines of a deck into blocks, once, with their points; a deck without lines is
   !> unchanged
   pure subroutine cut_lines(deck, error)
      type(deck_t), intent(inout) :: deck  !! The deck; the lines are replaced by blocks and points
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the lines cannot be cut

      if (.not. allocated(deck%lines)) return
      allocate (deck%cut)
      call cut_blocks(deck%lines, deck%cut, error)
      if (allocated(error)) return
      deallocate (deck%lines)
      call points_of_lines(deck, held_blocks(deck%cut), deck%plan%boundary)
   end subroutine cut_lines

   !> Make the scene of the blocks from a deck's files
   pure subroutine line_scene(deck, scene)
      type(deck_t), intent(in) :: deck  !! The deck of a case, with its blocks; checked
      type(scene_t), intent(out) :: scene
      logical :: held(size(deck%cut%area))

      scene%origin = deck%cut%scale%origin
      held = held_blocks(deck%cut)
      scene%settings = settings_of(deck, pi/2.0_wp, count(.not. (held(deck%cut%pair%side(1)) &
         & .and. held(deck%cut%pair%side(3)))))
      allocate (scene%joint_angle_deg(0))
      if (scene%settings%current .and. scene%settings%dynamic) then
         call search_line_contacts(deck, scene)
      else
         call join_common_edges(deck, scene)
      end if
      scene%settings%boundary = deck%plan%boundary
      if (size(deck%cut%bolt) == 0) return
      scene%settings%boundary%bar = bars_of(deck)
      allocate (scene%system%bar(size(deck%cut%bolt)))
      scene%system%bar%force = scene%settings%boundary%bar%prestress
   end subroutine line_scene

   !> Joints of blocks that stay where they are drawn: edges that coincide, split where others end
   pure subroutine join_common_edges(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(inout) :: scene  !! The scene; its blocks and contacts are set
      type(cut_model_t) :: split
      type(joint_law_t), allocatable :: law(:)
      integer, allocatable :: edge_pair(:, :)
      integer :: j, n

      call split_edges(deck%cut, split)
      call line_system(deck, split, scene%system)
      split%pair = pack(split%pair, scene%system%equation(split%pair%side(1)) > 0 &
         & .or. scene%system%equation(split%pair%side(3)) > 0)
      n = size(split%pair)
      allocate (law(n), edge_pair(4, n))
      do j = 1, n
         law(j) = law_of_joint(deck, split%pair(j)%joint)
         edge_pair(:, j) = split%pair(j)%side
      end do
      call find_contacts(scene%system, edge_pair, law, scene%contacts)
   end subroutine join_common_edges

   !> Contacts of blocks that move: those that a search finds, with the laws of their lines
   pure subroutine search_line_contacts(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(inout) :: scene  !! The scene; its blocks and contacts are set
      type(joint_law_t) :: law(bond_joint:maxval(deck%cut%edge_joint), 1)
      integer :: j

      call line_system(deck, deck%cut, scene%system)
      do j = bond_joint, ubound(law, 1)
         law(j, 1) = law_of_joint(deck, j)
      end do
      associate (contacts => scene%contacts)
         contacts%searched = .true.
         contacts%search = new_joint_search(scene%system, law)
         contacts%search%edge_law = deck%cut%edge_joint - bond_joint + 1
         call search_contacts(scene%system, contacts)
         ! a run makes the outline again
         contacts%search%outline = outline_t()
      end associate
   end subroutine search_line_contacts

   !> Restraints, loads and monitoring points of the files
   pure subroutine points_of_lines(deck, fixed, boundary)
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: fixed(:)  !! True for blocks that need no restrained points: (n_block)
      type(boundary_t), intent(inout) :: boundary
      integer :: n(3), i

      associate (point => deck%cut%point)
         allocate (boundary%held(count(point%kind == entity_role%fix .and. .not. &
            & fixed(point%block))))
         allocate (boundary%loaded(count(point%kind == entity_role%load)))
         allocate (boundary%measured(count(point%kind == entity_role%measure)))
         n = 0
         do i = 1, size(point)
            if (point(i)%kind == entity_role%fix .and. .not. fixed(point(i)%block)) then
               n(1) = n(1) + 1
               boundary%held(n(1))%block = point(i)%block
               boundary%held(n(1))%point = point(i)%place
            else if (point(i)%kind == entity_role%load) then
               n(2) = n(2) + 1
               boundary%loaded(n(2))%block = point(i)%block
               boundary%loaded(n(2))%point = point(i)%place
               boundary%loaded(n(2))%force = force_of(deck, point(i)%source)
            else if (point(i)%kind == entity_role%measure) then
               n(3) = n(3) + 1
               boundary%measured(n(3))%block = point(i)%block
               boundary%measured(n(3))%point = point(i)%place
            end if
         end do
      end associate
   end subroutine points_of_lines

   !> Force on a load point; zero if the analysis has none
   pure type(history_t) function force_of(deck, source)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: source  !! Number of the load point

      force_of = constant_history([0.0_wp, 0.0_wp])
      if (.not. allocated(deck%file_analysis)) return
      if (source > size(deck%file_analysis%load)) return
      associate (record => deck%file_analysis%load(source)%record)
         force_of%time = record(1, :)
         force_of%value = record(2:3, :)
      end associate
   end function force_of

   !> Bolts as bars. In older files the stiffness is that of a bar of unit length
   pure function bars_of(deck) result(bar)
      type(deck_t), intent(in) :: deck
      type(bar_t), allocatable :: bar(:)  !! The bars: (n)
      real(wp) :: property(3), length
      integer :: i

      allocate (bar(size(deck%cut%bolt)))
      do i = 1, size(bar)
         associate (bolt => deck%cut%bolt(i))
            property = bolt%property
            if (property(1) < 0.0_wp) then
               property = [0.0_wp, 0.0_wp, 0.0_wp]
               if (allocated(deck%file_analysis)) property = deck%file_analysis%bolt
            end if
            bar(i)%block = bolt%block
            bar(i)%point = reshape(bolt%place, [2, 2])
            bar(i)%line = bolt%row
            length = norm2(bolt%place(3:4) - bolt%place(1:2))
            bar(i)%stiffness = max(property(1), least_stiffness)/length
            bar(i)%strength = property(2)
            bar(i)%prestress = min(property(3), property(2))
         end associate
      end do
   end function bars_of

   !> Check that the blocks of a deck can be run
   pure subroutine check_line_scene(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an unsupported item
      type(block_system_t) :: system
      character(len=:), allocatable :: problem
      logical :: searches

      problem = ""
      searches = deck%value(analysis_mode)%text == "dynamic" &
         & .and. deck%value(analysis_geometry)%text == "current"
      call line_system(deck, deck%cut, system)
      if (all(system%equation == 0)) then
         problem = "expected a block that can move, got only fixed ones; remove fixed points"
      else if (.not. (searches .or. any(system%equation(deck%cut%pair%side(1)) > 0 &
         & .or. system%equation(deck%cut%pair%side(3)) > 0))) then
         problem = "expected coincident edges of blocks, got none: other contacts occur in " &
            & //"time alone; choose mode = 'dynamic', geometry = 'current', or mode = 'limerick'"
      else if (deck%value(analysis_mode)%text == "static" &
         & .and. .not. any(system%unit_weight > 0.0_wp .and. system%equation > 0)) then
         problem = "a static analysis needs a weight on blocks that move, got none; give one"
      end if
      if (len(problem) > 0) call deck_error(error, "scene%geometry: "//problem, deck, &
         & deck%value(scene_geometry)%place)
   end subroutine check_line_scene

   !> Blocks with their materials, weights and initial states
   pure subroutine line_system(deck, cut, system)
      type(deck_t), intent(in) :: deck
      type(cut_model_t), intent(in) :: cut  !! The blocks, possibly with additional corners
      type(block_system_t), intent(out) :: system
      integer :: b, m

      system = new_block_system(cut%first_vertex, cut%vertex, held_blocks(cut), material_of(deck))
      system%unit_weight = unit_weight(deck)
      if (.not. allocated(deck%file_analysis)) return
      associate (list => deck%file_analysis%material, own => any(deck%value([material_density, &
         & material_unit_weight, load_gravity])%given))
         deallocate (system%materials)
         allocate (system%materials(size(list)))
         do m = 1, size(list)
            system%materials(m) = material_of(deck)
            ! keys of the deck take precedence
            associate (material => system%materials(m))
               if (.not. deck%value(material_density)%given) material%density = list(m)%density
               if (.not. deck%value(material_young)%given) material%young = list(m)%young
               if (.not. deck%value(material_poisson)%given) material%poisson = list(m)%poisson
               if (.not. deck%value(material_plane)%given) material%plane_strain = &
                  & deck%file_analysis%plane_strain
            end associate
         end do
         system%material = cut%material
         do b = 1, size(cut%area)
            m = cut%material(b)
            system%density(b) = system%materials(m)%density
            if (.not. own) system%unit_weight(b) = list(m)%unit_weight
            system%stress(:, b) = list(m)%stress + list(m)%stress_gradient &
               & *(system%centroid(2, b) + cut%scale%origin(2))
            system%velocity(1:3, b) = list(m)%velocity
         end do
      end associate
   end subroutine line_system

   !> Law of a joint; keys of the deck take precedence over the analysis file
   pure type(joint_law_t) function law_of_joint(deck, number) result(law)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number  !! Number of the joint material
      type(limerick_joint_t) :: listed

      if (number == bond_joint) then
         law = joint_law_t(no_slip=.true., cohesion=bond_strength, tension=bond_strength)
         return
      end if
      law = joint_law(deck)
      if (.not. allocated(deck%file_analysis)) return
      listed = deck%file_analysis%joint(number)
      if (.not. deck%value(joint_friction_deg)%given) call set_friction(listed%friction_deg, law)
      if (.not. deck%value(joint_cohesion)%given) law%cohesion = listed%cohesion
      if (.not. deck%value(joint_tension)%given) law%tension = listed%tension
   end function law_of_joint

   !> Fixed blocks: those with two distinct fixed points, in any pieces connected by a bond
   pure function held_blocks(cut) result(held)
      type(cut_model_t), intent(in) :: cut
      logical :: held(size(cut%area))  !! True for fixed blocks: (n_block)
      integer :: first(size(cut%area)), i

      held = .false.
      first = 0
      do i = 1, size(cut%point)
         if (cut%point(i)%kind /= entity_role%fix) cycle
         associate (b => cut%whole(cut%point(i)%block))
            if (first(b) == 0) first(b) = i
            if (norm2(cut%point(i)%place - cut%point(first(b))%place) > cut%scale%reach) &
               & held(b) = .true.
         end associate
      end do
      held = held(cut%whole)
   end function held_blocks
end module dda_line_scene
