!> Contact forces of blocks that move in time, joint by joint (Gauss and Seidel)
!>
!> Without springs between blocks the equations of a step are those of single blocks, A d = f + B'N,
!> and each joint sees how the blocks around it answer its forces. In a sweep each joint in turn
!> takes the forces that close its gaps and stop its slip, as far as the law of contact allows:
!>
!>    N = max(-tension, N - gap/W),   T = T - slip/W within the bounds that N makes
!>
!> That ends at the forces of Coulomb's law, bounds and all, without a factorisation. It ends soon
!> where the forces of the step before are a good beginning or blocks are few, and slowly in tall
!> stacks. Blocks that no contact joins know nothing of one another: each such group is swept by
!> itself, and those that would take long go on by interior springs (`dda_contact_interior`).
!>
!> Equation (M5) of docs/method.md
submodule (dda_multipliers) dda_contact_sweeps
   use dda_contact_types, only : unbounded
   use dda_contact_view, only : contact_view_t, move_blocks, see_joints
   use dda_friction_cone, only : cone_t, joint_face_t, shear_bound
   use dda_interior_problem, only : many
   use dda_small_systems, only : solved
   use dda_sort, only : list_by_owner
   use dda_spring_products, only : relative_displacement
   implicit none

   !> What a group is swept for
   type :: sweeps_for_enum
      integer :: a_look = 0    !! To see whether its forces stay
      integer :: rounding = 1  !! To rounding
      integer :: haste = 2     !! To see whether it settles soon
      integer :: patience = 3  !! Until no step notices what is left
      integer :: the_rest = 4  !! To make good what interior springs leave
      integer :: the_last = 5  !! The same where more may be left
      integer :: the_end = 6   !! The same where a longer step has failed by what was left
   end type sweeps_for_enum

   !> Names of what a group is swept for
   type(sweeps_for_enum), parameter :: sweeps_for = sweeps_for_enum()

   !> What sweeps work on
   type :: sweeps_t
      !> How the blocks answer
      type(contact_view_t) :: view
      !> Gap that rounding can make [m]
      real(wp) :: noise = 0.0_wp
      !> Changes that count as none, of a force [N/m] and of a gap [m]
      real(wp) :: enough(2) = 0.0_wp
      !> Forces of all joints: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Motion of the blocks, of those that do not move first: (n_dof, 0:n_equation)
      real(wp), allocatable :: motion(:, :)
      !> That by the forces before: (n_dof, n_equation) [m]
      real(wp), allocatable :: moved(:, :)
   end type sweeps_t

   !> In groups of more joints than this, passes by a factor take as long as a hundred sweeps: these
   !> end wherever they are, and only the firmest springs are tried before them
   integer, parameter :: vast = 2000

   !> Multiple of a change that counts as none that will do where more sweeps bring no less without
   !> haste either, or where many joints move
   real(wp), parameter :: coarsest = 5.0e3_wp

   interface

      !> Forces of some joints if these keep nearly to the faces that they had: of all forces that
      !> stop the blocks those nearest to the ones before
      pure module subroutine keep_to_faces(equations, springs, view, joint, hasty, fineness, &
         & before, moved, force, passes, agreed)
         type(equations_t), intent(in) :: equations
         type(joint_springs_t), intent(in) :: springs
         type(contact_view_t), intent(in) :: view
         !> Numbers of the joints: (n)
         integer, intent(in) :: joint(:)
         !> Whether sweeps rather go on where joints are so many that faces take as long
         logical, intent(in) :: hasty
         !> How much smaller than usual forces must be that faces leave
         real(wp), intent(in) :: fineness
         !> Forces of all joints in the step before: (3, n_joint) [N/m]
         real(wp), intent(in) :: before(:, :)
         !> Motion of all blocks by these: (n_dof, n_equation) [m]
         real(wp), intent(in) :: moved(:, :)
         !> Forces of all joints; those of these joints are set if they agree, or nearly where
         !> joints are very many: (3, n_joint) [N/m]
         real(wp), intent(inout) :: force(:, :)
         !> Factorisations so far
         integer, intent(inout) :: passes
         !> Whether forces and faces agree
         logical, intent(out) :: agreed
      end subroutine keep_to_faces

      !> Forces of some joints, wherever the search for them begins
      pure module subroutine solve_interior(equations, springs, view, joint, left, before, force, &
         & motion, passes, agreed)
         type(equations_t), intent(in) :: equations
         type(joint_springs_t), intent(in) :: springs
         type(contact_view_t), intent(in) :: view
         integer, intent(in) :: joint(:)
         !> Gap that springs of many joints may leave [m]
         real(wp), intent(in) :: left
         real(wp), intent(in) :: before(:, :)
         !> Forces of all joints to begin with, and those found: (3, n_joint) [N/m]
         real(wp), intent(inout) :: force(:, :)
         !> Motion of all blocks by these: (n_dof, n_equation) [m]
         real(wp), intent(in) :: motion(:, :)
         integer, intent(inout) :: passes
         logical, intent(out) :: agreed
      end subroutine solve_interior

      !> Sweep one group until nothing changes, or until that is seen to take too long
      pure module subroutine sweep_group(springs, joint, purpose, enough, sweeps, settled)
         type(joint_springs_t), intent(in) :: springs
         !> Joints of the group: (n)
         integer, intent(in) :: joint(:)
         !> One of sweeps_for
         integer, intent(in) :: purpose
         !> Changes that count as none, of a force [N/m] and of a gap [m]: (2)
         real(wp), intent(in) :: enough(2)
         type(sweeps_t), intent(inout) :: sweeps
         !> Whether it is settled
         logical, intent(out) :: settled
      end subroutine sweep_group

   end interface

   !> Change of a force that counts as none, over the sum of all that bear on the blocks
   real(wp), parameter :: tolerance = 1.0e-15_wp
   !> Change of an opening or slip that counts as none, over the size of the smallest block: of few
   !> joints, lest what rests creeps and gains energy, and of many
   real(wp), parameter :: no_matter = 1.0e-11_wp, no_matter_of_many = 1.0e-10_wp
   !> Groups of more joints than this may go on by interior springs
   integer, parameter :: few = 2
   !> Gap by which a look at so many sees forces change, over what no step notices; of speeds, which
   !> the next step begins with, a finer one
   real(wp), parameter :: look = 1.0e-3_wp, look_at_speeds = 3.0e-5_wp

contains

   !> Settle contact forces and motion of one step, or begin to
   module procedure sweep_contacts
      type(sweeps_t) :: sweeps
      integer, allocatable :: joint(:)
      integer :: begun, first(size(springs%stiffness) + 1), g, most, n
      real(wp) :: size_of
      logical :: settled(size(springs%stiffness))

      call see_joints(equations, springs, state, sweeps%view)
      call group_joints(springs, size(state%motion, 2), n, first, joint)
      sweeps%force = state%force
      allocate (sweeps%moved, mold=state%motion)
      allocate (sweeps%motion(size(state%motion, 1), 0:size(state%motion, 2)))
      call move_blocks(equations, springs, sweeps%view, sweeps%force, sweeps%moved)
      sweeps%motion(:, 0) = 0.0_wp
      sweeps%motion(:, 1:) = sweeps%moved
      sweeps%noise = min(1.0_wp, state%fineness)*equations%gap_noise
      sweeps%enough(1) = tolerance*equations%force_scale
      ! by the radius of gyration of the smallest block
      size_of = state%fineness*sqrt(12.0_wp*minval(equations%mass(3, 3, :)/equations%mass(1, 1, :)))
      settled = .false.
      begun = state%passes
      most = 0
      state%effort%many = any(first(2:n + 1) - first(:n) > many) .and. .not. state%effort%patient
      do g = 1, n
         sweeps%enough(2) = merge(no_matter, no_matter_of_many, first(g + 1) - first(g) <= many) &
            & *size_of
         call settle_group(equations, springs, joint(first(g):first(g + 1) - 1), state, sweeps, &
            & settled(g))
         ! groups know nothing of one another: their passes go on side by side
         most = max(most, state%passes - begun)
         state%passes = begun
      end do
      state%passes = begun + most + 1
      state%settled = all(settled(:n))
      call keep_forces(equations, springs, sweeps, state)
   end procedure sweep_contacts

   !> Settle one group: forces that stay need no more than a look; those nearest to the ones before
   !> are found by the faces that these had, or else by interior springs; many joints that move are
   !> rather swept until no step notices what is left
   pure subroutine settle_group(equations, springs, joint, state, sweeps, settled)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)  !! Joints of the group: (n)
      !> The step, for the forces before; passes are counted
      type(step_state_t), intent(inout) :: state
      type(sweeps_t), intent(inout) :: sweeps
      logical, intent(out) :: settled  !! Whether it is settled
      real(wp) :: enough(2)
      logical :: glued, hasty

      enough = sweeps%enough
      glued = hands_on_waves(springs, joint)
      if (size(joint) <= few .and. .not. glued) then
         call sweep_group(springs, joint, sweeps_for%rounding, enough, sweeps, settled)
         return
      end if
      if (size(joint) > many) enough(2) = max(enough(2), merge(look_at_speeds, look, state%rates) &
         & *state%unseen)
      settled = .false.
      if (.not. glued) call sweep_group(springs, joint, sweeps_for%a_look, enough, sweeps, settled)
      if (settled) return
      hasty = size(joint) > vast .and. .not. state%effort%patient
      if (glued .or. asks_faces(sweeps%view, springs, joint, state)) then
         call keep_to_faces(equations, springs, sweeps%view, joint, hasty, state%fineness, &
            & state%force, sweeps%moved, sweeps%force, state%passes, settled)
         if (settled .or. hasty) call move_group(equations, springs, joint, sweeps)
         if (.not. settled) state%effort%swept = hasty
         state%effort%strayed = state%effort%strayed .or. .not. settled .and. size(joint) > many
      else if (size(joint) <= many .or. state%effort%patient) then
         enough = sweeps%enough
         call sweep_group(springs, joint, sweeps_for%haste, enough, sweeps, settled)
      end if
      if (.not. settled) call settle_by_springs(equations, springs, joint, state, sweeps, settled)
   end subroutine settle_group

   !> Settle one group that faces and a few sweeps have not: by interior springs, and sweeps that
   !> make good what these leave
   pure subroutine settle_by_springs(equations, springs, joint, state, sweeps, settled)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)
      type(step_state_t), intent(inout) :: state
      type(sweeps_t), intent(inout) :: sweeps
      logical, intent(out) :: settled
      real(wp) :: enough(2)
      integer :: purpose

      settled = .false.
      enough = [sweeps%enough(1), max(sweeps%enough(2), state%unseen/coarsest)]
      if (size(joint) > many) &
         & call sweep_group(springs, joint, sweeps_for%patience, enough, sweeps, settled)
      if (settled) return
      call solve_interior(equations, springs, sweeps%view, joint, state%unseen, state%force, &
         & sweeps%force, sweeps%motion(:, 1:), state%passes, settled)
      call move_group(equations, springs, joint, sweeps)
      if (settled) return
      purpose = merge(sweeps_for%the_last, sweeps_for%the_rest, state%rates .or. size(joint) > many)
      if (state%effort%patient) then
         purpose = sweeps_for%the_end
         ! without gravity nothing says what a speed is that no step notices
         if (state%unseen > 0.0_wp) enough(2) = state%unseen/coarsest
      end if
      call sweep_group(springs, joint, purpose, enough, sweeps, settled)
   end subroutine settle_by_springs

   !> Whether joints hold blocks together that strain: these hand on waves, finer than what sweeps
   !> leave
   pure logical function hands_on_waves(springs, joint)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)

      hands_on_waves = size(springs%row, 1) > 3 .and. any(springs%shift(:, joint) > 0.0_wp &
         & .and. springs%shift(:, joint) < unbounded)
   end function hands_on_waves

   !> Whether faces may tell the forces of a motion: those of a try of this step, or of a group that
   !> has more forces than its blocks can tell apart
   pure logical function asks_faces(view, springs, joint, state)
      type(contact_view_t), intent(in) :: view
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)
      type(step_state_t), intent(in) :: state
      logical :: is_there(0:size(view%lower, 3))
      integer :: forces, i, k

      asks_faces = .not. state%rates .and. .not. (state%effort%strayed .and. size(joint) > many)
      if (.not. asks_faces .or. state%effort%again) return
      is_there = .false.
      forces = 0
      do i = 1, size(joint)
         is_there(springs%equation(:, joint(i))) = .true.
         forces = forces + count([(view%give(k, k, joint(i)) > 0.0_wp, k=1, 3)])
      end do
      asks_faces = forces > size(view%lower, 1)*count(is_there(1:))
   end function asks_faces

   !> Motion of the blocks of a group under its forces
   pure subroutine move_group(equations, springs, joint, sweeps)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)
      type(sweeps_t), intent(inout) :: sweeps
      integer :: e, i, side
      logical :: is_there(0:size(sweeps%view%lower, 3))

      is_there = .false.
      do i = 1, size(joint)
         is_there(springs%equation(:, joint(i))) = .true.
      end do
      associate (lower => sweeps%view%lower)
         do e = 1, size(lower, 3)
            if (is_there(e)) sweeps%motion(:, e) = equations%load(:, e)
         end do
         do i = 1, size(joint)
            do side = 1, 2
               e = springs%equation(side, joint(i))
               if (e > 0) sweeps%motion(:, e) = sweeps%motion(:, e) &
                  & + matmul(springs%row(:, :, side, joint(i)), sweeps%force(:, joint(i)))
            end do
         end do
         do e = 1, size(lower, 3)
            if (is_there(e)) sweeps%motion(:, e) = solved(lower(:, :, e), sweeps%motion(:, e))
         end do
      end associate
   end subroutine move_group

   !> Forces and motion where the sweeps have ended, as the open-close loop knows them
   pure subroutine keep_forces(equations, springs, sweeps, state)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(sweeps_t), intent(in) :: sweeps
      type(step_state_t), intent(inout) :: state
      integer :: j, k

      call move_blocks(equations, springs, sweeps%view, sweeps%force, state%motion)
      state%increment = relative_displacement(springs, state%motion)
      state%force = sweeps%force
      do j = 1, size(state%force, 2)
         state%face(j) = face_of(springs%cone(j), state%force(:, j), springs%shift(:, j))
         do k = 1, 3
            state%trial(k, j) = state%force(k, j) - springs%stiffness(j)*sweeps%view%gap(k, j)
         end do
      end do
   end subroutine keep_forces

   !> The face that a joint's force lies on
   pure type(joint_face_t) function face_of(cone, force, shift) result(face)
      type(cone_t), intent(in) :: cone
      real(wp), intent(in) :: force(3)  !! The force: (3) [N/m]
      real(wp), intent(in) :: shift(3)  !! Tension that the contacts carry, and a zero: (3) [N/m]

      face%open = .not. force(1:2) + shift(1:2) > 0.0_wp
      if (abs(force(3)) >= shear_bound(cone, force + shift)) &
         & face%slip = merge(1, -1, force(3) > 0.0_wp)
      if (all(face%open) .and. .not. abs(force(3)) > 0.0_wp) face%slip = 0
   end function face_of

   !> Groups of joints whose blocks hang together: each is a problem of its own
   module procedure group_joints
      integer :: group(size(springs%equation, 2))

      call number_groups(springs, n_equation, n, group)
      first = size(group) + 1
      call list_by_owner(group, first(:n + 1), joint)
   end procedure group_joints

   !> Which group each joint is of
   pure subroutine number_groups(springs, n_equation, n, group)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_equation
      integer, intent(out) :: n
      integer, intent(out) :: group(:)  !! Number of each joint's group: (n_joint)
      integer :: root(n_equation), number(n_equation), pair(2), i, j

      root = [(i, i=1, n_equation)]
      do j = 1, size(group)
         pair = springs%equation(:, j)
         if (any(pair == 0)) cycle
         pair = [root_of(pair(1)), root_of(pair(2))]
         root(maxval(pair)) = minval(pair)
         root(springs%equation(:, j)) = minval(pair)
      end do
      n = 0
      number = 0
      do j = 1, size(group)
         i = root_of(maxval(springs%equation(:, j)))
         if (number(i) == 0) then
            n = n + 1
            number(i) = n
         end if
         group(j) = number(i)
      end do

   contains

      !> The block that stands for the group of a block
      pure integer function root_of(block)
         integer, intent(in) :: block  !! The block

         root_of = block
         do while (root(root_of) /= root_of)
            root_of = root(root_of)
         end do
      end function root_of
   end subroutine number_groups
end submodule dda_contact_sweeps
