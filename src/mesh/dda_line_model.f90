!> Lines and points of a geometry file
module dda_line_model
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   implicit none
   private

   public :: line_model_t, entities_t, entity_role, role_name, entity_name, add_entity

   !> Roles of lines and points
   type :: entity_role_enum
      integer :: joint = 1     !! A joint
      integer :: material = 2  !! Assigns its material to the blocks that it crosses
      integer :: fix = 3       !! Fixes the blocks that it crosses or lies in
      integer :: load = 4      !! Point of a load
      integer :: measure = 5   !! Monitoring point
      integer :: hole = 6      !! Removes its block
      integer :: bolt = 7      !! A bolt
      integer :: seismic = 8   !! Place of seismic records, not used
   end type entity_role_enum

   !> The roles by name
   type(entity_role_enum), parameter :: entity_role = entity_role_enum()

   !> Names of the roles in joint maps and tables
   character(len=*), parameter :: role_name(8) = [character(len=8) :: "joint", "material", "fix", &
      & "load", "measure", "hole", "bolt", "seismic"]

   !> Names of one entity of each role in messages
   character(len=*), parameter :: entity_name(8) = [character(len=16) :: "line", &
      & "material line", "fixed point", "load point", "monitoring point", "hole point", "bolt", &
      & "seismic point"]

   !> Segments or points of one role, in the order of the file
   type :: entities_t
      integer :: n = 0  !! Number of entities
      !> Ends x1, y1, x2, y2; equal for a point: (4, n or more) [m]
      real(wp), allocatable :: place(:, :)
      !> Material of the joint or of the blocks, if the role has one: (n or more)
      integer, allocatable :: material(:)
      integer, allocatable :: row(:)  !! Line of the file: (n or more)
      !> Stiffness, strength and prestress of bolts, negative if given in the analysis file: (3, n
      !> or more)
      real(wp), allocatable :: property(:, :)
   end type entities_t

   !> Contents of a geometry file
   type :: line_model_t
      character(len=:), allocatable :: file  !! Name of the file, for messages
      !> Shi's e00: nodes closer than this are merged, over the size of the model
      real(wp) :: edge_node_ratio = 0.0_wp
      !> Number of boundary lines, the first ones, which are never deleted
      integer :: n_boundary = 0
      type(entities_t) :: line  !! Boundary lines, then joints, each with its joint material
      type(entities_t) :: of(entity_role%material:entity_role%seismic)  !! Other entities by role
   end type line_model_t

contains

   !> Add a segment or a point
   pure subroutine add_entity(entities, place, material, row, property)
      type(entities_t), intent(inout) :: entities
      real(wp), intent(in) :: place(4)  !! Ends: (4) [m]
      integer, intent(in) :: material   !! Material; 0 if the role has none
      integer, intent(in) :: row        !! Line of the file
      !> Stiffness, strength and prestress of a bolt; absent or unallocated for other entities: (3)
      real(wp), intent(in), optional :: property(3)

      if (.not. allocated(entities%place)) allocate (entities%place(4, 8))
      call make_room(entities%place, entities%n + 1)
      call make_room(entities%material, entities%n + 1)
      call make_room(entities%row, entities%n + 1)
      entities%n = entities%n + 1
      entities%place(:, entities%n) = place
      entities%material(entities%n) = material
      entities%row(entities%n) = row
      if (.not. present(property)) return
      if (.not. allocated(entities%property)) allocate (entities%property(3, 8))
      call make_room(entities%property, entities%n)
      entities%property(:, entities%n) = property
   end subroutine add_entity
end module dda_line_model
