!> One step of Shi's scheme: length, contact stiffness, and motion (Shi: df24, df25)
module dda_limerick_step
   use dda_bar_springs, only : elongation_by
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_assembly, only : assemble_limerick, couple_blocks, limerick_equations_t
   use dda_limerick_contact, only : begin_contacts, contact_list_t, contact_spring_t, &
      & place_springs, transfer_contacts
   use dda_limerick_model, only : force_at, limerick_blocks_t, limerick_march_t, limerick_model_t, &
      & limerick_state, measure_blocks, next_record
   use dda_material, only : elasticity_matrix
   implicit none
   private

   public :: advance_limerick, choose_interval, corners_t, entrance_lines, find_limerick_contacts
   public :: judge_limerick_step, limerick_run_t, measure_corners, move_vertices, open_and_close
   public :: overlap, turn, update

   !> State of a run from step to step
   type :: limerick_run_t
      type(limerick_blocks_t) :: blocks                 !! The blocks
      type(contact_list_t) :: contacts                  !! Contacts of the last step
      type(limerick_march_t) :: march                   !! Scalar state
      type(contact_list_t) :: before                    !! Work space: contacts of the previous step
      type(contact_spring_t), allocatable :: spring(:)  !! Work space: springs of the contacts
      type(limerick_equations_t) :: equations           !! Work space: the equations
      !> Work space: corners at the end of an attempt: (2, n_vertex) [m]
      real(wp), allocatable :: moved(:, :)
      integer, allocatable :: order(:)  !! Work space: blocks from left to right: (n_block)
   end type limerick_run_t

   !> Shape of all corners of a step
   type :: corners_t
      !> Direction of the edge that starts at each vertex: (n_vertex) [deg, 0 to 360]
      real(wp), allocatable :: direction(:)
      real(wp), allocatable :: angle(:)   !! Inner angle: (n_vertex) [deg]
      real(wp), allocatable :: length(:)  !! Length of the edge that starts there: (n_vertex) [m]
   end type corners_t

   interface

      !> Solve and update states until no contact opens or closes
      pure module subroutine open_and_close(model, run, first_pass, settled)
         type(limerick_model_t), intent(in) :: model
         !> The run; states of its contacts are changed, and the motion is set. Closing contacts get
         !> a new shear spring
         type(limerick_run_t), intent(inout) :: run
         !> True before the first solution of this step; false after it
         logical, intent(inout) :: first_pass
         !> True if no contact opened or closed in the last iteration
         logical, intent(out) :: settled
      end subroutine open_and_close

      !> Directions, inner angles and lengths of all corners
      pure module subroutine measure_corners(blocks, corners)
         type(limerick_blocks_t), intent(in) :: blocks
         type(corners_t), intent(out) :: corners
      end subroutine measure_corners

      !> Anticlockwise angle from one direction to another
      pure real(wp) module function turn(from, to)
         real(wp), intent(in) :: from  !! First direction [deg]
         real(wp), intent(in) :: to    !! Second direction [deg]
      end function turn

      !> True if two sectors overlap by more than a limit
      pure logical module function overlap(start_a, angle_a, start_b, angle_b, least)
         real(wp), intent(in) :: start_a  !! Start of the first sector [deg]
         real(wp), intent(in) :: angle_a  !! Angle of the first sector [deg]
         real(wp), intent(in) :: start_b  !! Start of the second sector [deg]
         real(wp), intent(in) :: angle_b  !! Angle of the second sector [deg]
         real(wp), intent(in) :: least    !! Limit of the overlap [deg]
      end function overlap

      !> The two lines that a pair of corners may cross, the steeper first, which preserves symmetry
      pure module function entrance_lines(blocks, corners, i, j, overlap_deg) result(line)
         type(limerick_blocks_t), intent(in) :: blocks
         type(corners_t), intent(in) :: corners
         integer, intent(in) :: i             !! Vertex of the first block
         integer, intent(in) :: j             !! Vertex of the second block
         real(wp), intent(in) :: overlap_deg  !! Permitted overlap [deg]
         integer :: line(3, 2)                !! Vertex and ends of the edge: (3, 2)
      end function entrance_lines

      !> Find all contacts of the present blocks, open, sorted by pairs of blocks
      pure module subroutine find_limerick_contacts(blocks, reach, overlap_deg, order, list)
         type(limerick_blocks_t), intent(in) :: blocks
         real(wp), intent(in) :: reach        !! Search distance [m]
         real(wp), intent(in) :: overlap_deg  !! Permitted overlap of two corners [deg]
         !> Blocks from left to right, approximately on entry: (n_block)
         integer, intent(inout) :: order(:)
         type(contact_list_t), intent(inout) :: list
      end subroutine find_limerick_contacts

   end interface

   !> Maximum number of attempts per step
   integer, parameter :: max_attempts = 200

   !> Factor of the time step after an attempt without convergence
   real(wp), parameter :: cut = 0.3_wp
   !> Largest growth of the time step
   real(wp), parameter :: growth = 1.3_wp
   !> Motion over the permitted one from which a step is repeated
   real(wp), parameter :: too_far = 3.0_wp
   !> Penetration over its target from which a step is repeated with ten times the penalty
   real(wp), parameter :: too_deep = 2.5_wp
   !> Distance to the time of a load record at which the step ends there, over the step
   real(wp), parameter :: short = 1.0e-6_wp
   !> Smallest penalty over the previous one
   real(wp), parameter :: relaxation = 1.0_wp/3.0_wp

contains

   !> Take one step: blocks and contacts change only when it is accepted, the penalty at each
   !> attempt
   pure subroutine advance_limerick(model, run, error)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      type(error_t), allocatable, intent(out) :: error  !! Allocated if no attempt was accepted
      logical :: first_pass, settled, accepted
      integer :: attempt

      call choose_interval(model, run%march)
      call meet(model, run)
      first_pass = .true.
      do attempt = 1, max_attempts
         call assemble_limerick(model, run%blocks, run%march, run%equations)
         run%contacts%item(:run%contacts%n)%before = limerick_state%open
         call open_and_close(model, run, first_pass, settled)
         if (.not. solved(run%equations)) then
            call fatal_error(error, "the equations of a step have no usable solution")
            return
         end if
         call move_vertices(model, run)
         call judge_limerick_step(model, run%contacts, settled, run%march, accepted)
         if (accepted) exit
      end do
      if (accepted) call update(model, run)
      if (.not. accepted) call fatal_error(error, "no convergence at one step in the attempts "// &
         & "that are allowed (Shi's program loops forever)")
   end subroutine advance_limerick

   !> True if the solution of the equations is finite
   pure logical function solved(equations)
      type(limerick_equations_t), intent(in) :: equations  !! The equations after a solution

      solved = equations%factor%usable
      if (solved) solved = sum(abs(equations%motion)) <= huge(1.0_wp)
   end function solved

   !> Find the contacts of the step with the states of the previous step, and their springs
   pure subroutine meet(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      type(contact_list_t) :: swap
      integer :: c

      call move_alloc(run%before%item, swap%item)
      call move_alloc(run%contacts%item, run%before%item)
      call move_alloc(swap%item, run%contacts%item)
      run%before%n = run%contacts%n
      call find_limerick_contacts(run%blocks, run%march%reach, model%constants%overlap_deg, &
         & run%order, run%contacts)
      if (run%march%passes == 0) then
         call begin_contacts(run%blocks, model%constants%dynamic, &
            & model%constants%close_ratio*run%march%reach, run%contacts)
      else
         call transfer_contacts(run%blocks, run%before, run%contacts)
      end if
      if (size(run%spring) < run%contacts%n) then
         deallocate (run%spring)
         allocate (run%spring(2*run%contacts%n))
      end if
      do c = 1, run%contacts%n
         call place_springs(run%blocks, run%contacts%item(c), run%spring(c))
      end do
      call couple_blocks(model, run%blocks, run%contacts, run%equations, run%spring)
   end subroutine meet

   !> Length of the next step from the largest acceleration (Shi: step); a step ends at each load
   !> record
   pure subroutine choose_interval(model, march)
      type(limerick_model_t), intent(in) :: model
      type(limerick_march_t), intent(inout) :: march  !! State of the run; its time step is set
      real(wp) :: acceleration, velocity, allowed, load, mass, longest, record, stress
      integer :: i, m

      if (.not. model%constants%auto_time_step) return
      associate (loaded => model%boundary%loaded)
         if (march%steps == 0) then
            load = maxval([0.0_wp, (maxval(abs(loaded(i)%force%value)), i=1, size(loaded))])
         else
            load = maxval([0.0_wp, (abs(force_at(model, i, march%time)), i=1, size(loaded))])
         end if
      end associate
      allowed = model%constants%max_displacement_ratio*march%half_size
      mass = march%mean_area*model%material(1)%density
      velocity = 0.0_wp
      if (march%steps == 0) then
         longest = march%time_step
         stress = maxval([(abs(model%material(m)%stress), m=1, size(model%material))])
         velocity = maxval([(abs(model%material(m)%velocity), m=1, size(model%material))])
         acceleration = max(model%material(1)%unit_weight/model%material(1)%density, &
            & 4.0_wp*stress*sqrt(march%mean_area)/mass, load/mass)
         if (acceleration > 0.0_wp .or. velocity > 0.0_wp) longest = huge(longest)
      else
         longest = growth*march%time_step
         acceleration = max(march%penetration*march%half_size*march%used_penalty, load)/mass
         if (model%constants%dynamic) velocity = march%displacement_ratio*allowed/march%time_step
      end if
      ! root of velocity*t + acceleration*t**2/2 = allowed, in the form without cancellation
      velocity = velocity + sqrt(velocity**2 + 2.0_wp*acceleration*allowed)
      march%time_step = longest
      if (velocity > 0.0_wp) march%time_step = min(longest, 2.0_wp*allowed/velocity)
      record = next_record(model, march%time + short*march%time_step)
      march%time_step = min(march%time_step, record - march%time)
   end subroutine choose_interval

   !> Accept a step, or change its length or the penalty
   pure subroutine judge_limerick_step(model, contacts, settled, march, accepted)
      type(limerick_model_t), intent(in) :: model
      type(contact_list_t), intent(in) :: contacts
      logical, intent(in) :: settled  !! True if the open-close iteration converged
      !> State of the run; time step, penalty and penetration are set
      type(limerick_march_t), intent(inout) :: march
      logical, intent(out) :: accepted  !! True if the step is accepted
      real(wp) :: shortest
      logical :: moved_too_far

      shortest = model%constants%time_step/100.0_wp
      moved_too_far = march%displacement_ratio > too_far
      accepted = settled .and. .not. moved_too_far
      if (.not. settled) then
         if (model%constants%auto_time_step) march%time_step = max(cut*march%time_step, shortest)
      else if (moved_too_far) then
         march%time_step = max(march%time_step/sqrt(march%displacement_ratio), shortest)
      else if (model%constants%auto_penalty) then
         call adapt_penalty(model, contacts, march)
         accepted = march%penetration <= too_deep*model%constants%penetration_ratio
         if (.not. accepted) march%penalty = 10.0_wp*march%penalty
      end if
   end subroutine judge_limerick_step

   !> Scale the penalty towards the target penetration, at most down to a third (Shi: spri)
   pure subroutine adapt_penalty(model, contacts, march)
      type(limerick_model_t), intent(in) :: model
      type(contact_list_t), intent(in) :: contacts
      type(limerick_march_t), intent(inout) :: march
      real(wp) :: opening
      integer :: c

      march%penetration = 0.0_wp
      opening = 0.0_wp
      do c = 1, contacts%n
         if (contacts%item(c)%state == limerick_state%open) cycle
         march%penetration = max(march%penetration, -contacts%item(c)%gap/march%half_size)
         opening = max(opening, contacts%item(c)%gap/march%half_size)
      end do
      associate (constants => model%constants)
         march%penalty = march%penalty*max(march%penetration/constants%penetration_ratio, &
            & opening/(2.0_wp*constants%max_displacement_ratio), relaxation)
      end associate
   end subroutine adapt_penalty

   !> Corners at the end of the step, and the largest displacement ratio (Shi: df24)
   pure subroutine move_vertices(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run  !! The run; the displacement ratio is set
      real(wp) :: farthest, step(2)
      integer :: b, v

      farthest = 0.0_wp
      associate (blocks => run%blocks, motion => run%equations%motion)
         do b = 1, size(blocks%area)
            do v = blocks%first_vertex(b), blocks%first_vertex(b + 1) - 1
               step = displacement(model, motion(:, b), &
                  & blocks%vertex(:, v) - blocks%centroid(:, b))
               run%moved(:, v) = blocks%vertex(:, v) + step
               farthest = max(farthest, step(1)**2 + step(2)**2)
            end do
         end do
      end associate
      run%march%displacement_ratio = sqrt(farthest) &
         & /(run%march%half_size*model%constants%max_displacement_ratio)
   end subroutine move_vertices

   !> Displacement of a point of a block
   pure function displacement(model, motion, arm) result(step)
      type(limerick_model_t), intent(in) :: model
      real(wp), intent(in) :: motion(6)  !! Unknowns of the block: (6)
      real(wp), intent(in) :: arm(2)     !! Arm of the point: (2) [m]
      real(wp) :: step(2)                !! The displacement: (2) [m]
      real(wp) :: turn(2)

      ! change of the arm by the rotation, along and across it
      turn = [0.0_wp, motion(3)]
      if (model%constants%exact_rotation) turn = [cos(motion(3)) - 1.0_wp, sin(motion(3))]
      associate (x => arm(1), y => arm(2))
         step(1) = motion(1) + turn(1)*x - turn(2)*y + motion(4)*x + motion(6)*y/2.0_wp
         step(2) = motion(2) + turn(2)*x + turn(1)*y + motion(5)*y + motion(6)*x/2.0_wp
      end associate
   end function displacement

   !> Update blocks, points and contacts after an accepted step (Shi: df25)
   pure subroutine update(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      real(wp), allocatable :: before(:, :)
      real(wp) :: step(2)
      integer :: b, i

      associate (blocks => run%blocks, motion => run%equations%motion, march => run%march)
         do i = 1, size(model%boundary%held)
            step = point_step(blocks%fixed_point(:, i), model%boundary%held(i)%block)
            blocks%fixed_point(:, i) = blocks%fixed_point(:, i) + step
            blocks%fixed_drift(:, i) = blocks%fixed_drift(:, i) + step
         end do
         do i = 1, size(model%boundary%loaded)
            blocks%load_point(:, i) = blocks%load_point(:, i) &
               & + point_step(blocks%load_point(:, i), model%boundary%loaded(i)%block)
         end do
         do i = 1, size(model%boundary%measured)
            blocks%measured_point(:, i) = blocks%measured_point(:, i) &
               & + point_step(blocks%measured_point(:, i), model%boundary%measured(i)%block)
         end do
         do i = 1, size(blocks%bolt_force)
            associate (bolt => model%boundary%bar(i))
               blocks%bolt_force(i) = blocks%bolt_force(i) &
                  & + bolt%stiffness*elongation_by(run%equations%bolts, motion, i)
               do b = 1, 2
                  if (bolt%block(b) > 0) blocks%bolt_point(:, b, i) = blocks%bolt_point(:, b, i) &
                     & + point_step(blocks%bolt_point(:, b, i), bolt%block(b))
               end do
            end associate
         end do
         do b = 1, size(blocks%area)
            blocks%stress(:, b) = blocks%stress(:, b) + matmul(elasticity_matrix( &
               & model%material(model%block_material(b))%material_t), motion(4:6, b))
            blocks%velocity(:, b) = 2.0_wp/march%time_step*motion(:, b) - blocks%velocity(:, b)
         end do
         blocks%rotation = blocks%rotation + motion(3, :)
         call move_alloc(blocks%vertex, before)
         call move_alloc(run%moved, blocks%vertex)
         call move_alloc(before, run%moved)
         call measure_blocks(blocks)
         march%time = march%time + march%time_step
         march%steps = march%steps + 1
      end associate

   contains

      !> Displacement of a point in the step
      pure function point_step(point, block) result(step)
         real(wp), intent(in) :: point(2)  !! The point at the beginning of the step: (2) [m]
         integer, intent(in) :: block      !! Number of the block
         real(wp) :: step(2)

         step = displacement(model, run%equations%motion(:, block), &
            & point - run%blocks%centroid(:, block))
      end function point_step
   end subroutine update

end module dda_limerick_step
