!> Blocks and joints put together one by one, and the scene that they make
module scene_model
   use dda_block_system, only : new_block_system
   use dda_contacts, only : find_contacts, raise_springs
   use dda_contact_search, only : new_joint_search
   use dda_contact_transfer, only : search_contacts
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t, material_t
   use dda_scene, only : scene_t
   use dda_settings, only : settings_t
   implicit none
   private

   public :: model_t, empty, add_block, add_joint, scene_of, searched_scene, rectangle, turned

   !> What a scene is made of
   type :: model_t
      type(material_t) :: material           !! Material of all blocks
      real(wp) :: unit_weight = 25000.0_wp   !! Weight per volume of all blocks [N/m3]
      type(settings_t) :: settings           !! Settings of the run
      real(wp), allocatable :: vertex(:, :)  !! Corners of all blocks: (2, n_vertex) [m]
      !> First vertex of each block, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      logical, allocatable :: fixed(:)  !! Blocks that cannot move: (n_block)
      !> Block and edge, block and edge of each joint: (4, n_joint)
      integer, allocatable :: edge_pair(:, :)
      type(joint_law_t), allocatable :: law(:)  !! Law of each joint: (n_joint)
   end type model_t

contains

   !> Take all blocks and joints out, and all settings
   pure subroutine empty(model)
      type(model_t), intent(out) :: model  !! Receives what a declared model is

   end subroutine empty

   !> Add a block
   pure subroutine add_block(model, vertex, fixed)
      type(model_t), intent(inout) :: model  !! Receives the block as its last
      real(wp), intent(in) :: vertex(:, :)   !! Corners, counter-clockwise: (2, n) [m]
      !> Whether the block cannot move; it can if this is left out
      logical, intent(in), optional :: fixed
      logical :: held

      held = .false.
      if (present(fixed)) held = fixed
      if (.not. allocated(model%vertex)) allocate (model%vertex(2, 0), model%fixed(0))
      if (.not. allocated(model%first_vertex)) model%first_vertex = [1]
      model%vertex = reshape([model%vertex, vertex], [2, size(model%vertex, 2) + size(vertex, 2)])
      model%first_vertex = [model%first_vertex, size(model%vertex, 2) + 1]
      model%fixed = [model%fixed, held]
   end subroutine add_block

   !> Add a joint of two edges that lie together
   pure subroutine add_joint(model, edge_pair, law)
      type(model_t), intent(inout) :: model  !! Receives the joint as its last
      integer, intent(in) :: edge_pair(4)    !! Block and edge, block and edge: (4)
      type(joint_law_t), intent(in) :: law   !! Law of the joint

      if (.not. allocated(model%law)) allocate (model%edge_pair(4, 0), model%law(0))
      model%edge_pair = reshape([model%edge_pair, edge_pair], [4, size(model%edge_pair, 2) + 1])
      model%law = [model%law, law]
   end subroutine add_joint

   !> The scene of a model whose joints are searched
   pure function searched_scene(model, law) result(scene)
      !> The model, with a block or more; its joints do not count
      type(model_t), intent(in) :: model
      type(joint_law_t), intent(in) :: law  !! Law of all joints
      type(scene_t) :: scene

      scene%settings = model%settings
      scene%system = new_block_system(model%first_vertex, model%vertex, model%fixed, model%material)
      scene%system%unit_weight = model%unit_weight
      scene%contacts%searched = .true.
      scene%contacts%search = new_joint_search(scene%system, reshape([law], [1, 1]))
      call search_contacts(scene%system, scene%contacts)
      call raise_springs(scene%settings, scene%system, scene%contacts)
   end function searched_scene

   !> The scene of a model
   pure function scene_of(model) result(scene)
      type(model_t), intent(in) :: model  !! The model, with a block and a joint or more
      type(scene_t) :: scene

      scene%settings = model%settings
      scene%system = new_block_system(model%first_vertex, model%vertex, model%fixed, model%material)
      scene%system%unit_weight = model%unit_weight
      call find_contacts(scene%system, model%edge_pair, model%law, scene%contacts)
      call raise_springs(scene%settings, scene%system, scene%contacts)
   end function scene_of

   !> A rectangle whose edges 1 to 4 are bottom, right, top and left
   pure function rectangle(corner, width, height) result(vertex)
      real(wp), intent(in) :: corner(2)  !! Lower left corner: (2) [m]
      real(wp), intent(in) :: width      !! From left to right [m]
      real(wp), intent(in) :: height     !! From bottom to top [m]
      real(wp) :: vertex(2, 4)           !! Corners: (2, 4) [m]

      vertex = reshape([corner, corner + [width, 0.0_wp], corner + [width, height], &
         & corner + [0.0_wp, height]], [2, 4])
   end function rectangle

   !> Points turned about the origin
   pure function turned(vertex, angle) result(other)
      real(wp), intent(in) :: vertex(:, :)   !! Points: (2, n) [m]
      real(wp), intent(in) :: angle          !! Counter-clockwise [rad]
      real(wp) :: other(2, size(vertex, 2))  !! The points: (2, n) [m]

      other(1, :) = cos(angle)*vertex(1, :) - sin(angle)*vertex(2, :)
      other(2, :) = sin(angle)*vertex(1, :) + cos(angle)*vertex(2, :)
   end function turned
end module scene_model
