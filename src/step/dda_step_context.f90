!> State of a run: blocks, contacts, equations, history, and results of one step
module dda_step_context
   use dda_block_system, only : block_pose_t, block_system_t
   use dda_contacts, only : contacts_t
   use dda_kinds, only : wp
   use dda_load_clock, only : load_clock_t
   use dda_settings, only : settings_t
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: energy_t, march_t, contact_note_t, run_state_t, run_t, step_context_t, step_outcome_t
   public :: in_time, may_shorten, most_spare_cuts, near, near_gap, shortest

   !> Maximum number of spare cuts; each step adds one, each cut costs three
   integer, parameter :: most_spare_cuts = 1000

   !> Energies of a dynamic run; what is gone or brought in is a sum since the beginning [J/m]
   type :: energy_t
      real(wp) :: time = 0.0_wp     !! Time [s]
      real(wp) :: kinetic = 0.0_wp  !! Of motion
      real(wp) :: elastic = 0.0_wp  !! Of strained blocks
      real(wp) :: contact = 0.0_wp  !! Of the joints' springs, where blocks do not move
      real(wp) :: gravity = 0.0_wp  !! Of height, zero at the beginning
      !> Brought in by forces on points, prescribed points and the shaking ground
      real(wp) :: work = 0.0_wp
      real(wp) :: friction = 0.0_wp   !! Gone by sliding
      real(wp) :: damping = 0.0_wp    !! Gone by damping
      real(wp) :: impact = 0.0_wp     !! Gone by impacts
      real(wp) :: numerical = 0.0_wp  !! Gone by the time step
      !> Largest opening or slip against the law of contact that the step has left [m/s]
      real(wp) :: residual = 0.0_wp
   end type energy_t

   !> A value to report of one contact, with its time
   type :: contact_note_t
      real(wp) :: value = 0.0_wp  !! Value
      real(wp) :: time = 0.0_wp   !! When [s]
      integer :: block(2) = 0     !! Where: the two blocks, or none at a bar
   end type contact_note_t

   !> Outcome of the checks of a try: acceptance, or changes of the next try
   type :: step_outcome_t
      !> True if the step counts
      logical :: accepted = .false.
      !> Length of the next try [s]
      real(wp) :: dt = 0.0_wp
      !> True if the step after goes on carefully, because a longer one did not settle
      logical :: was_cut = .false.
      !> True if the next try ends at an impact, or where slip turns
      logical :: ends_at_event = .false.
      logical :: ends_at_turn = .false.  !! True if that is the end of a slip
      !> True if a corner moves beyond the margin of its block: margins must be wider
      logical :: beyond_margin = .false.
      !> True if the separating axes must be chosen by the motion of this try
      logical :: wrong_axes = .false.
      !> True if such an axis alone has closed a contact by which the step was cut
      logical :: met_nothing = .false.
      !> Depth of contacts that meet in the step at its end without their forces [m]
      real(wp) :: overshoot = huge(1.0_wp)
   end type step_outcome_t

   !> One step
   type :: step_context_t
      real(wp) :: dt = 0.0_wp       !! Length of the step [s]
      type(step_state_t) :: state   !! Motion of the blocks and states of the joints
      !> Gaps at its end beyond those of the rows, in a dynamic run:
      !> (3, n_joint) [m]
      real(wp), allocatable :: curve(:, :)
      real(wp), allocatable :: end_gap(:, :)  !! Gaps at its end: (3, n_joint) [m]
      !> Speeds at which the contacts part and slip at its beginning: (3, n_joint) [m/s]
      real(wp), allocatable :: speed(:, :)
      !> Depth of the last try beyond an impact [m]
      real(wp) :: overshoot = huge(1.0_wp)
      type(block_pose_t) :: after  !! Where the blocks are at its end, likewise
      !> Velocities at its end in a dynamic run: (n_dof, n_equation)
      real(wp), allocatable :: velocity(:, :)
      !> Mean forces of the joints, impacts among them, that change the velocities in a dynamic
      !> run: (3, n_joint) [N/m]
      real(wp), allocatable :: mean_force(:, :)
      !> Likewise those of the springs at restrained points: (n_spring) [N/m]
      real(wp), allocatable :: held_mean_force(:)
      !> Largest opening or slip against the law of contact that the velocities have [m/s], and its
      !> joint
      real(wp) :: residual = 0.0_wp
      integer :: worst = 0
      real(wp) :: impact = 0.0_wp          !! Energy that impacts took from the velocities [J/m]
      real(wp) :: restitution = 1.0_wp     !! Share of the restitution that its impacts have
      integer :: fastest_impact = 0        !! Joint of the fastest of them
      real(wp) :: slowest_impact = 0.0_wp  !! Contacts that meet more slowly do not rebound [m/s]
      logical :: has_velocity = .false.    !! True if there are velocities for its end
      !> Expected motion of the corners, where contacts are searched: (2, n_vertex) [m]
      real(wp), allocatable :: travel(:, :)
      !> True if the contacts must be placed, or searched, for the next try
      logical :: renews = .false.
      !> The contacts at the end of the last step, where a search must not go by an earlier one
      type(contacts_t), allocatable :: kept
      !> Number of times that the separating axes were chosen by the motion of a try
      integer :: choices = 0
      logical :: accepted = .false.  !! True if the step counts
      logical :: was_cut = .false.   !! True if a longer step did not settle
      logical :: ends_at_event = .false.  !! True if it has been cut to end at such an event
      logical :: ends_at_turn = .false.   !! True if that is the end of a slip
      integer :: event_cuts = 0           !! Number of these cuts
      !> Length before the first of them; 0 after it has been tried again [s]
      real(wp) :: uncut = 0.0_wp
      !> True if no contact broke in it, so that its end is one of equilibrium
      logical :: whole = .true.
      !> Largest motion of a point, in it and in the try before: [m]
      real(wp) :: farthest = 0.0_wp, last_farthest = 0.0_wp
      real(wp) :: acceleration = 0.0_wp  !! Largest acceleration of a point [m/s2]
      !> Largest share that the inertia of a block's translation and rotation has of its load
      real(wp) :: residue = 0.0_wp
      !> Largest share that the inertia of a block's strains has of what strains it
      real(wp) :: strain_residue = 0.0_wp
      real(wp) :: work = 0.0_wp     !! Work of the loads [J/m]
      real(wp) :: kinetic = 0.0_wp  !! Twice the kinetic energy that the work was turned into [J/m]
      real(wp) :: stored = 0.0_wp   !! Growth of the energy stored in blocks and springs [J/m]
      !> Forces that nothing balances at its end, which its inertia bears: (n_dof, n_equation); not
      !> allocated before the first step of a run, or of a stride of its path
      real(wp), allocatable :: unbalanced(:, :)
      real(wp) :: last_dt = 0.0_wp    !! Length of the last step [s]
      !> True if this one is shorter: stiff parts relax less in it, so their forces may grow
      logical :: is_shorter = .false.
      !> Farther motion, in the direction of this one, that would bring the blocks to rest; 0 where
      !> nothing drove them at its beginning, huge where nothing slows them [m]
      real(wp) :: way_to_rest = 0.0_wp
   end type step_context_t

   !> Data that are carried from step to step beside blocks and contacts
   type :: march_t
      !> Steps accepted so far
      integer :: steps = 0
      !> Sum of their lengths, or in a static run with a path its clock [s]
      real(wp) :: time = 0.0_wp
      !> Clock of what is live in a static run
      type(load_clock_t) :: clock
      !> Accepted steps in a row by which time hardly goes on
      integer :: stuck = 0
      !> Steps accepted when the clock went on last
      integer :: begun = 0
      !> Largest motion of a corner since then, where blocks move or a displacement means collapse
      !> [m]
      real(wp) :: moved = 0.0_wp
      !> That motion over the time that the clock went on, at the last rest [m/s]
      real(wp) :: rate = 0.0_wp
      !> Number of jumps of the blocks to another rest
      integer :: jumps = 0
      !> The largest of these jumps [m]
      real(wp) :: largest_jump = 0.0_wp
      !> Largest motion of a point in the first step after the clock went on; 0 before the path
      !> begins [m]
      real(wp) :: first_motion = 0.0_wp
      !> Length of the next step [s]
      real(wp) :: dt = 0.0_wp
      !> Number of steps that may still be cut to end at an impact, or where slip turns
      integer :: spare_cuts = most_spare_cuts
      !> Most that a corner may move in a step, where blocks move [m]
      real(wp) :: allowed_motion = 0.0_wp
      !> Most that the corners of each block may move before contacts are searched again, where they
      !> are searched: (n_block) [m]
      real(wp), allocatable :: reach(:)
      !> Largest motion of a corner since the beginning [m]
      real(wp) :: displacement = 0.0_wp
      !> Displacement or rotation over that of collapse in a dynamic run
      real(wp) :: progress = 0.0_wp
      !> The most of it before the last part of the run
      real(wp) :: early_progress = 0.0_wp
      !> True if a block has turned over or left what carried it, where blocks move
      logical :: has_fallen = .false.
      !> Motions that the coordinates of corners do not resolve [m]
      real(wp) :: resolution = 0.0_wp
      !> Apparent motion by rounding of coordinates, where blocks move [m]
      real(wp) :: rounding = 0.0_wp
      !> True if that rounding presses a block with more than its load, where springs give
      logical :: drowned = .false.
      !> Longest step: the one that was asked for in a dynamic run; in a static one that which
      !> leaves the matrix well enough conditioned [s]
      real(wp) :: longest = 0.0_wp
      !> Largest motion if every joint were closed for good: the scale of elastic motion [m]
      real(wp) :: elastic_motion = 0.0_wp
      !> Size of all that can move: no elastic motion is as large [m]
      real(wp) :: extent = 0.0_wp
      !> Farthest rest that the forces of a step have pointed to since the clock went on, at least
      !> the motion of the first step, where blocks move: the elastic motion of blocks that walls
      !> hold, which the bonded ones hide [m]
      real(wp) :: expected_rest = 0.0_wp
      !> Acceleration that the loads would give to free blocks [m/s2]
      real(wp) :: free_acceleration = 0.0_wp
      !> Acceleration in the last step [m/s2]
      real(wp) :: last_acceleration = 0.0_wp
      !> Motion of the last step, where blocks move: (n_dof, n_equation)
      real(wp), allocatable :: last_motion(:, :)
      !> Forces of the springs at restrained points, which the next step begins with: (n_spring)
      !> [N/m]
      real(wp), allocatable :: held_force(:)
      !> Passes of the open-close loop so far
      integer :: passes = 0
      !> Energies after the last step of a dynamic run
      type(energy_t) :: energy
      !> Largest opening or slip against the law of contact in this run [m/s]
      real(wp) :: residual = 0.0_wp
      !> The largest opening or slip of those that matter [m/s]
      type(contact_note_t) :: rough
      !> Largest reduction of restitution, as a share
      type(contact_note_t) :: reduced
   end type march_t

   !> Data that the next step of a run begins with
   type :: run_state_t
      type(block_system_t) :: system  !! The blocks
      type(contacts_t) :: contacts    !! The contacts
      type(march_t) :: march          !! Data that are carried on beside them
   end type run_state_t

   !> A rest on the path of a static run, to return to
   type :: rest_t
      type(run_state_t) :: state  !! The run there
      integer :: n_frame = 0    !! Pictures kept so far
      integer :: n_track = 0    !! Steps so far of which the monitoring points are kept
      real(wp) :: due = 0.0_wp  !! Displacement or time at which the next picture is due [m or s]
   end type rest_t

   !> All that a run holds
   type, extends(run_state_t) :: run_t
      type(settings_t) :: settings       !! Settings of the run
      type(equations_t) :: equations     !! The equations of a step
      type(step_context_t) :: step       !! The step
      type(rest_t), allocatable :: rest  !! The last rest on a path; not allocated before the first
      !> The pairs of blocks that touched at the beginning: (2, n_pair)
      integer, allocatable :: neighbours(:, :)
      !> Contacts after the first full step from the last rest on a path: if the blocks fall, that
      !> is how it begins
      type(contacts_t), allocatable :: onset
      real(wp), allocatable :: onset_motion(:, :)  !! Motion of that step: (n_dof, n_equation)
   end type run_t

   !> Gap of a closed contact, or depth of an open one, over the size of the smaller block
   real(wp), parameter :: near = 1.0e-8_wp
   !> Shortest step over the longest one that is reduced for residual forces or penetration, and
   !> over the permitted one where displacements are prescribed
   real(wp), parameter :: shortest = 1.0e-3_wp

contains

   !> True in a dynamic run with current geometry: forces are multipliers, impacts change velocities
   pure logical function in_time(run)
      type(run_t), intent(in) :: run

      in_time = run%settings%dynamic .and. run%settings%current
   end function in_time

   !> True if a step is long enough to be reduced for residual forces or penetration
   pure logical function may_shorten(run)
      type(run_t), intent(in) :: run

      may_shorten = run%step%dt > shortest*run%march%longest
   end function may_shorten

   !> Gap below which two blocks count as touching
   pure real(wp) function near_gap(system, pair)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: pair(2)  !! The two blocks: (2)

      near_gap = near*sqrt(minval(system%area(pair)))
   end function near_gap
end module dda_step_context
