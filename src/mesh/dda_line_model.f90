!> Lines and points as a geometry file gives them, before they are cut into blocks
module dda_line_model
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   implicit none
   private

   public :: line_model_t, entities_t, new_entities, new_line_model, add_bolt, add_entity

   !> Segments or points of one kind, in the order of the file
   type :: entities_t
      integer :: n = 0  !! How many there are
      !> Ends x1, y1, x2, y2; a point has both ends in one place: (4, n or more) [m]
      real(wp), allocatable :: place(:, :)
      !> Material of the joint or of the blocks, where the kind has one: (n or more)
      integer, allocatable :: material(:)
      integer, allocatable :: row(:)  !! Line of the file: (n or more)
   end type entities_t

   !> Everything that a geometry file says
   type :: line_model_t
      character(len=:), allocatable :: file  !! Name of the file, for messages
      !> Shi's e00: nodes closer than this, times the size of the model, become one
      real(wp) :: edge_node_ratio = 0.0_wp
      !> So many of the first lines are boundary lines, which are never deleted
      integer :: n_boundary = 0
      type(entities_t) :: line  !! Boundary lines, then joints, with the material of the joint
      !> Lines that give blocks their material
      type(entities_t) :: material_line
      type(entities_t) :: fixed     !! Lines, or points, that hold blocks
      type(entities_t) :: load      !! Points where forces act
      type(entities_t) :: measured  !! Points that are followed
      type(entities_t) :: hole      !! Points whose blocks are taken out
      type(entities_t) :: seismic   !! Points of seismic records, which nothing uses yet
      type(entities_t) :: bolt      !! Bolts
      !> Stiffness, strength and prestress of each: (3, n or more); below 0 where the analysis
      !> file says them
      real(wp), allocatable :: bolt_property(:, :)
   end type line_model_t

contains

   !> An empty list with room
   pure subroutine new_entities(entities, room)
      type(entities_t), intent(out) :: entities
      integer, intent(in) :: room  !! How many are expected

      allocate (entities%place(4, room), entities%material(room), entities%row(room))
   end subroutine new_entities

   !> A model without lines
   pure subroutine new_line_model(model)
      type(line_model_t), intent(out) :: model

      call new_entities(model%line, 64)
      call new_entities(model%material_line, 0)
      call new_entities(model%fixed, 0)
      call new_entities(model%load, 0)
      call new_entities(model%measured, 0)
      call new_entities(model%hole, 0)
      call new_entities(model%seismic, 0)
      call new_entities(model%bolt, 0)
      allocate (model%bolt_property(3, 1))
   end subroutine new_line_model

   !> Add a bolt
   pure subroutine add_bolt(model, place, property, row)
      type(line_model_t), intent(inout) :: model
      real(wp), intent(in) :: place(4)  !! Its ends: (4) [m]
      !> Stiffness, strength and prestress, below 0 where the analysis file says them: (3)
      real(wp), intent(in) :: property(3)
      integer, intent(in) :: row  !! Line of the file

      call add_entity(model%bolt, place, 0, row)
      call make_room(model%bolt_property, model%bolt%n)
      model%bolt_property(:, model%bolt%n) = property
   end subroutine add_bolt

   !> Add a segment or a point
   pure subroutine add_entity(entities, place, material, row)
      type(entities_t), intent(inout) :: entities
      real(wp), intent(in) :: place(4)
      integer, intent(in) :: material  !! Its material; 0 if the kind has none
      integer, intent(in) :: row

      call make_room(entities%place, entities%n + 1)
      call make_room(entities%material, entities%n + 1)
      call make_room(entities%row, entities%n + 1)
      entities%n = entities%n + 1
      entities%place(:, entities%n) = place
      entities%material(entities%n) = material
      entities%row(entities%n) = row
   end subroutine add_entity
end module dda_line_model
