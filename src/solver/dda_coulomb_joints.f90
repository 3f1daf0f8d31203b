!> Joints on a loading path: scaled units and possible states
!>
!> In these units the mean weight of a block, the mean compliance of a joint, half the mean length
!> of a joint and the mean mass of a block are 1, so that every threshold of a path is a plain
!> number. An elastic displacement is of order 1.
module dda_coulomb_joints
   use dda_joint_graph, only : breaks, crushes, joint_graph_t, joint_kind, take_over
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: coulomb_joints_t, end_role, end_role_enum, shear_role, shear_role_enum
   public :: damped_mass, new_coulomb_joints, take_coulomb_joints
   public :: set_force_unit, in_units, in_newtons, in_motion_units, in_metres

   !> Possible states of a corner of a joint
   type :: end_role_enum
      integer(small) :: contact = 1_small  !! It pushes or is open
      integer(small) :: tied = 2_small     !! It pushes and pulls
      integer(small) :: absent = 3_small   !! There is none
   end type end_role_enum

   !> Possible states of a joint along itself
   type :: shear_role_enum
      integer(small) :: frictional = 1_small  !! It sticks, or slides at Coulomb's limit
      integer(small) :: tied = 2_small        !! It never slides
      integer(small) :: absent = 3_small      !! It carries no shear force
   end type shear_role_enum

   !> Names of what corners can do
   type(end_role_enum), parameter :: end_role = end_role_enum()
   !> Names of what joints can do along themselves
   type(shear_role_enum), parameter :: shear_role = shear_role_enum()

   !> Joints in units of their own
   type :: coulomb_joints_t
      type(joint_graph_t) :: graph            !! The joints, every quantity in these units
      !> Role of each corner: (2, n_joint)
      integer(small), allocatable :: end_role(:, :)
      !> Role of each joint along itself: (n_joint)
      integer(small), allocatable :: shear_role(:)
      real(wp) :: force_unit = 1.0_wp         !! Unit of forces [N/m]
      real(wp) :: arm_unit = 1.0_wp           !! Unit of arms [m]
      real(wp) :: motion_unit = 1.0_wp        !! Unit of displacements and gaps [m]
      logical :: has_weight = .false.         !! True if a load has set the unit of force
      !> Normal force over the strength, and opening beyond the springs, of joints that crush, where
      !> a state has them; unallocated if there are none: (n_joint)
      real(wp), allocatable :: share(:), slack(:)
   end type coulomb_joints_t

   !> Least strength over the weight of a block
   real(wp), parameter :: faint = 1.0e-8_wp

contains

   !> Joints in units of their own, of a graph that is kept
   pure subroutine new_coulomb_joints(graph, load, joints)
      type(joint_graph_t), intent(in) :: graph
      !> Their load, which sets the unit of force: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The same in units of their own
      type(coulomb_joints_t), intent(out) :: joints
      type(joint_graph_t) :: taken

      taken = graph
      call take_coulomb_joints(taken, load, joints)
   end subroutine new_coulomb_joints

   !> Joints in units of their own, from a graph
   pure subroutine take_coulomb_joints(graph, load, joints)
      type(joint_graph_t), intent(inout) :: graph
      !> Their load, which sets the unit of force: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The same in units of their own
      type(coulomb_joints_t), intent(out) :: joints
      real(wp) :: compliance, mass

      call take_over(graph, joints%graph)
      associate (scaled => joints%graph)
         joints%arm_unit = positive_or_one(0.5_wp*mean(scaled%length))
         compliance = typical(scaled%compliance)
         mass = positive_or_one(mean(scaled%mass(1, :)))
         joints%motion_unit = compliance
         scaled%row(3:, :, :, :) = scaled%row(3:, :, :, :)/joints%arm_unit
         ! the unit of length is set
         deallocate (scaled%length)
         scaled%compliance = scaled%compliance/compliance
         if (allocated(scaled%gap)) scaled%gap = scaled%gap/joints%motion_unit
         scaled%mass = scaled%mass/mass
         scaled%mass(3:, :) = scaled%mass(3:, :)/joints%arm_unit**2
      end associate
      call set_force_unit(joints, load)
      if (crushes(joints%graph)) &
         & allocate (joints%share(size(joints%graph%kind)), joints%slack(size(joints%graph%kind)), &
         & source=0.0_wp)
      call drop_faint_strength(joints)
      call set_roles(joints)
      ! roles replace the kinds
      deallocate (joints%graph%kind)
   end subroutine take_coulomb_joints

   !> Remove strength that is small beside all forces: dry joints have a start of their own
   pure subroutine drop_faint_strength(joints)
      type(coulomb_joints_t), intent(inout) :: joints

      if (.not. (breaks(joints%graph) .and. joints%has_weight)) return
      if (any(joints%graph%cohesion > faint) .or. any(joints%graph%pull > faint)) return
      deallocate (joints%graph%cohesion, joints%graph%pull)
   end subroutine drop_faint_strength

   !> Choose the unit of force, and with it that of motion; not by a load that is zero
   pure subroutine set_force_unit(joints, load)
      type(coulomb_joints_t), intent(inout) :: joints
      real(wp), intent(in) :: load(:, :)  !! Their load: (3, n_block) [N/m, N/m, N]
      real(wp) :: unit

      unit = mean(norm2(load(:2, :), 1))
      if (.not. unit > 0.0_wp) unit = mean(maxval(abs(load), 1))/joints%arm_unit
      joints%has_weight = unit > 0.0_wp
      if (.not. joints%has_weight) return
      if (allocated(joints%graph%gap)) &
         & joints%graph%gap = joints%graph%gap*(joints%force_unit/unit)
      if (breaks(joints%graph)) then
         joints%graph%pull = joints%graph%pull*(joints%force_unit/unit)
         joints%graph%cohesion = joints%graph%cohesion*(joints%force_unit/unit)
      end if
      if (crushes(joints%graph)) then
         where (joints%graph%crush < huge(1.0_wp)) &
            & joints%graph%crush = joints%graph%crush*(joints%force_unit/unit)
      end if
      joints%motion_unit = joints%motion_unit*(unit/joints%force_unit)
      joints%force_unit = unit
   end subroutine set_force_unit

   !> Roles of corners and of joints by their kind
   pure subroutine set_roles(joints)
      type(coulomb_joints_t), intent(inout) :: joints
      integer :: j

      allocate (joints%end_role(2, size(joints%graph%kind)), &
         & joints%shear_role(size(joints%graph%kind)))
      do j = 1, size(joints%shear_role)
         associate (ends => joints%end_role(:, j), shear => joints%shear_role(j))
            ends = end_role%contact
            shear = shear_role%tied
            select case (joints%graph%kind(j))
            case (joint_kind%contact)
               shear = slide_role(joints%graph, j)
            case (joint_kind%corner)
               ends(2) = end_role%absent
               shear = slide_role(joints%graph, j)
            case (joint_kind%corner_no_slip)
               ends(2) = end_role%absent
            case (joint_kind%pin)
               ends = [end_role%tied, end_role%absent]
            case (joint_kind%mirror)
               ends = end_role%tied
               shear = shear_role%absent
            end select
         end associate
      end do
   end subroutine set_roles

   !> Role of a joint that may slide
   pure integer(small) function slide_role(graph, j)
      type(joint_graph_t), intent(in) :: graph
      integer, intent(in) :: j  !! Number of the joint

      slide_role = merge(shear_role%frictional, shear_role%absent, graph%friction(j) > 0.0_wp)
      if (.not. breaks(graph)) return
      if (any(graph%cohesion(:, j) > 0.0_wp)) slide_role = shear_role%frictional
   end function slide_role

   !> Loads in the units of the joints
   pure function in_units(joints, load) result(scaled)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: load(:, :)                !! Loads: (3, n_block) [N/m, N/m, N]
      real(wp) :: scaled(size(load, 1), size(load, 2))  !! The same in units: (3, n_block)

      scaled(:2, :) = load(:2, :)/joints%force_unit
      scaled(3:, :) = load(3:, :)/(joints%force_unit*joints%arm_unit)
   end function in_units

   !> Loads in SI units
   pure function in_newtons(joints, load) result(newtons)
      type(coulomb_joints_t), intent(in) :: joints
      !> Loads in units: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Loads: (3, n_block) [N/m, N/m, N]
      real(wp) :: newtons(size(load, 1), size(load, 2))

      newtons(:2, :) = load(:2, :)*joints%force_unit
      newtons(3:, :) = load(3:, :)*(joints%force_unit*joints%arm_unit)
   end function in_newtons

   !> Motion of blocks in the units of the joints
   pure function in_motion_units(joints, motion) result(scaled)
      type(coulomb_joints_t), intent(in) :: joints
      !> Motion: (3, n_block) [m, m, 1]
      real(wp), intent(in) :: motion(:, :)
      !> The same in units: (3, n_block)
      real(wp) :: scaled(size(motion, 1), size(motion, 2))

      scaled(:2, :) = motion(:2, :)/joints%motion_unit
      scaled(3:, :) = motion(3:, :)*(joints%arm_unit/joints%motion_unit)
   end function in_motion_units

   !> Motion of blocks in SI units
   pure function in_metres(joints, motion) result(metres)
      type(coulomb_joints_t), intent(in) :: joints
      !> Motion in units: (3, n_block)
      real(wp), intent(in) :: motion(:, :)
      !> Motion: (3, n_block) [m, m, 1]
      real(wp) :: metres(size(motion, 1), size(motion, 2))

      metres(:2, :) = motion(:2, :)*joints%motion_unit
      metres(3:, :) = motion(3:, :)*(joints%motion_unit/joints%arm_unit)
   end function in_metres

   !> Matrix of each block without joints: a multiple of its mass
   pure function damped_mass(joints, damping) result(matrix)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: damping                  !! The multiple
      real(wp) :: matrix(3, 3, joints%graph%n_block)  !! The matrices: (3, 3, n_block)
      integer :: k

      matrix = 0.0_wp
      do k = 1, 3
         matrix(k, k, :) = damping*joints%graph%mass(k, :)
      end do
   end function damped_mass

   !> Mean of numbers, 0 if there are none
   pure real(wp) function mean(x)
      real(wp), intent(in) :: x(:)  !! The numbers: (:)

      mean = sum(x)/real(max(1, size(x)), wp)
   end function mean

   !> Mean magnitude of those of some numbers that are positive, 1 if there are none: a few soft
   !> joints of fill or bolts are no measure of the others
   pure real(wp) function typical(x)
      real(wp), intent(in) :: x(:)

      typical = exp(mean(log(pack(x, x > 0.0_wp))))
   end function typical

   !> The number itself if it is positive, else 1
   pure real(wp) function positive_or_one(x)
      real(wp), intent(in) :: x  !! The number

      positive_or_one = merge(x, 1.0_wp, x > 0.0_wp)
   end function positive_or_one
end module dda_coulomb_joints
