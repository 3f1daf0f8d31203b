!> Where a collapse stops: its joints, frozen, are traced to the value at which they cease to move
module dda_collapse_trace
   use dda_assembly, only : new_equations, solve_faces
   use dda_block_factor, only : substitute
   use dda_block_inertia, only : assemble_blocks
   use dda_block_system, only : begin_motion, block_system_t
   use dda_contact_types, only : joint_springs_t, joint_t, new_joint_springs, same_joint
   use dda_contacts, only : joint_place
   use dda_error, only : error_t
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, link_once, scene_t
   use dda_search, only : critical_t, decision_t, search_t
   use dda_settings, only : flow_rule, settings_t
   use dda_step_state, only : equations_t
   implicit none
   private

   public :: frozen_mechanism_t, proposal_t, least_half, mechanism_power, trace, trace_chain

   !> A collapse to be traced from one value of the parameter to another
   type :: frozen_mechanism_t
      type(joint_t), allocatable :: joint(:)      !! The joints: (n_joint)
      type(joint_face_t), allocatable :: face(:)  !! Faces of the joints in its last step: (n_joint)
      !> Motion of its last step without strains: (3, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Length of a step long enough that elastic motion hides nothing, and short enough that
      !> rounding leaves the power smooth [s]
      real(wp) :: dt = 0.0_wp
   end type frozen_mechanism_t

   !> Where a frozen collapse stops
   type :: proposal_t
      logical :: usable = .false.  !! Whether it stops anywhere
      real(wp) :: value = 0.0_wp   !! The value
      !> Half the width of the bracket to close around it: of the tolerance, or of what the rounded
      !> coordinates can tell apart
      real(wp) :: half = 0.0_wp
      !> How far beyond and before it to decide; more than half where the frozen joints, which know
      !> nothing of moving blocks, only come near
      real(wp) :: reach = 0.0_wp
   end type proposal_t

   !> Share of the value by which moving blocks are first looked for beyond frozen ones
   real(wp), parameter :: first_reach = 1.0e-3_wp
   !> Half a bracket is no narrower than this share of its value
   real(wp), parameter :: least_share = 4.0e-12_wp
   !> What each joint adds to that share
   real(wp), parameter :: share_of_joint = 2.0e-14_wp
   !> Margin over the noise that three samples show
   real(wp), parameter :: noise_margin = 20.0_wp
   !> Roots whose mean is taken where rounding is more than the tolerance
   integer, parameter :: n_roots = 32
   !> How much of what the parabola corrects it may leave itself, over the relative width of the
   !> values that it goes through
   real(wp), parameter :: curving = 1.0e3_wp
   !> Most passes of the secant method
   integer, parameter :: max_passes = 20
   !> Free fall over elastic motion in the step that traces a mechanism
   real(wp), parameter :: free_fall = 1.0e6_wp

   interface

      !> Trace a chain to where it ceases to collapse, by the secant method on the deficit of chains
      !> in which only some of its joints part
      pure module subroutine trace_chain(family, search, from, limit, frozen, critical, proposal)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         real(wp), intent(in) :: from     !! Where to begin
         real(wp), intent(in) :: limit    !! The end of the range on the side that stands
         !> Whether the mechanism at the beginning is kept: all values before the one proposed then
         !> collapse
         logical, intent(in) :: frozen
         type(critical_t), intent(inout) :: critical
         type(proposal_t), intent(out) :: proposal
      end subroutine trace_chain

   end interface

contains

   !> Trace the last collapse to where it stops, by the secant method on the power of the loads;
   !> from the third value on the parabola through three tells what the secant leaves. A chain is
   !> traced by its deficit
   pure subroutine trace(family, search, limit, critical, proposal)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: limit  !! The end of the range on the side that stands
      !> What was found so far; the factorisations are counted
      type(critical_t), intent(inout) :: critical
      type(proposal_t), intent(out) :: proposal  !! Where the collapse stops
      type(frozen_mechanism_t) :: mechanism
      real(wp) :: x(2), power(2), first_power, noise, next, slope, coarse_slope, step
      real(wp) :: bend, last_slope, least, near, x_before
      integer :: pass
      logical :: usable, stopped, only_noise

      least = least_half(search, critical%falls, size(critical%fallen%contacts%face))
      proposal%half = least*max(abs(critical%falls), tiny(1.0_wp))
      if (critical%fallen%flow /= flow_rule%associated) return
      if (takes_power(critical%fallen)) return
      call link_once(family, critical%falls, critical%link)
      if (critical%link%known) then
         call trace_chain(family, search, critical%falls, limit, .true., critical, proposal)
         return
      end if
      call freeze(critical%fallen, mechanism)
      x(1) = critical%falls
      call power_at(family, mechanism, x(1), critical, power(1), noise, usable)
      if (.not. usable) return
      first_power = power(1)
      step = min(0.3_wp, max(1.0e-3_wp, 1.25_wp*critical%fallen%outcome%acceleration_ratio))
      step = min(step*max(abs(x(1)), 0.01_wp*abs(limit - x(1))), abs(limit - x(1)))
      x(2) = x(1) + sign(step, limit - x(1))
      last_slope = 0.0_wp
      x_before = x(1)
      do pass = 1, max_passes
         call power_at(family, mechanism, x(2), critical, power(2), noise, usable)
         if (.not. usable .or. .not. abs(power(2) - power(1)) > 0.0_wp) return
         slope = (power(2) - power(1))/(x(2) - x(1))
         if (pass == 1) coarse_slope = slope
         next = x(2) - power(2)/slope
         bend = 0.0_wp
         ! back where it began: the collapse stood at its own stop
         if (pass > 1 .and. .not. abs(x(2) - x_before) > 0.0_wp) return
         if (pass > 1) bend = (slope - last_slope)/slope*(next - x(2))*(next - x(1)) &
            & /(x(2) - x_before)
         next = next - bend
         if (next < search%low .or. next > search%high) return
         near = 0.02_wp*least*abs(next)
         stopped = abs(next - x(2)) <= near .or. pass > 1 &
            & .and. abs(bend*(x(2) - x(1)))*curving < near*abs(next)
         only_noise = abs(power(2)) < 1.0e-3_wp*abs(first_power) .and. abs(power(2)) > abs(power(1))
         if (stopped .or. only_noise) exit
         last_slope = slope
         x_before = x(1)
         x = [x(2), next]
         power(1) = power(2)
      end do
      call propose(family, search, mechanism, least, next, coarse_slope, noise, critical, proposal)
   end subroutine trace

   !> Whether a collapse takes power that the loads alone do not tell: what is crushed does, and a
   !> bar that yields
   pure logical function takes_power(fallen)
      type(decision_t), intent(in) :: fallen

      takes_power = .false.
      if (allocated(fallen%system%bar)) takes_power = size(fallen%system%bar) > 0
      if (takes_power .or. .not. allocated(fallen%contacts%joint)) return
      associate (contacts => fallen%contacts)
         takes_power = any(contacts%law(contacts%joint%law)%strength < huge(1.0_wp))
      end associate
   end function takes_power

   !> Where a mechanism stops, and how near to that to decide
   pure subroutine propose(family, search, mechanism, least, next, coarse_slope, noise, critical, &
      & proposal)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(frozen_mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: least         !! Least half width of the bracket over the value
      real(wp), intent(in) :: next          !! Where it stops
      real(wp), intent(in) :: coarse_slope  !! Change of its power with the value
      real(wp), intent(inout) :: noise      !! Noise of the power; raised where rounding shows
      type(critical_t), intent(inout) :: critical
      type(proposal_t), intent(inout) :: proposal

      proposal%usable = .true.
      proposal%value = next
      if (critical%current) then
         proposal%reach = first_reach*abs(next)
         proposal%half = least*abs(next)
         return
      end if
      call refine_noise(family, mechanism, next, critical, noise)
      ! the stop may be off by the one; beside it, by the other, a mechanism becomes too slow for a
      ! decision to tell it from rest
      associate (outcome => critical%fallen%outcome)
         proposal%half = max(least*abs(next), abs(noise/coarse_slope) &
            & + 2.0_wp*abs(next - critical%falls)*outcome%rest_tolerance/outcome%acceleration_ratio)
      end associate
      proposal%reach = proposal%half
      if (proposal%half > search%tolerance*abs(next)) &
         & call average_root(family, mechanism, coarse_slope, critical, proposal)
   end subroutine propose

   !> Freeze a collapse
   pure subroutine freeze(fallen, mechanism)
      type(decision_t), intent(in) :: fallen
      type(frozen_mechanism_t), intent(out) :: mechanism

      mechanism%joint = fallen%contacts%joint
      mechanism%face = fallen%contacts%face
      mechanism%motion = fallen%outcome%motion(:3, :)
      mechanism%dt = sqrt(free_fall)*fallen%outcome%elastic_time
   end subroutine freeze

   !> Half the width of a bracket over its value: of the tolerance, or of what rounding leaves
   pure real(wp) function least_half(search, value, n)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: value  !! A value near the critical one
      integer, intent(in) :: n       !! Number of joints
      real(wp) :: resolution

      resolution = search%resolution
      if (search%resolution_at > 0.0_wp) &
         & resolution = resolution*(search%resolution_at/value)**2
      least_half = max(search%tolerance/2.0_wp, resolution, &
         & least_share + share_of_joint*real(n, wp))
   end function least_half

   !> Where rounding leaves more than the tolerance: the mean of many roots, as each value of the
   !> parameter rounds the coordinates otherwise
   pure subroutine average_root(family, mechanism, slope, critical, proposal)
      class(family_t), intent(in) :: family
      type(frozen_mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: slope                !! Change of the power with the value
      type(critical_t), intent(inout) :: critical
      type(proposal_t), intent(inout) :: proposal  !! The proposal; its value is set
      real(wp) :: power, ignored, total
      logical :: usable
      integer :: i

      total = 0.0_wp
      do i = 1, n_roots
         call power_at(family, mechanism, proposal%value &
            & + proposal%half*real(2*i - 1 - n_roots, wp)/real(n_roots, wp), critical, power, &
            & ignored, usable)
         if (.not. usable) return
         total = total + power
      end do
      proposal%value = proposal%value - total/real(n_roots, wp)/slope
   end subroutine average_root

   !> Rounding in the solution of the equations: what another length of the step makes of the power
   pure subroutine refine_noise(family, mechanism, value, critical, noise)
      class(family_t), intent(in) :: family
      type(frozen_mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: value  !! The value
      type(critical_t), intent(inout) :: critical
      real(wp), intent(inout) :: noise
      type(frozen_mechanism_t) :: other
      real(wp) :: power(3), ignored
      logical :: usable
      integer :: i

      other = mechanism
      do i = 1, 3
         other%dt = mechanism%dt*0.7_wp**(i - 2)
         call power_at(family, other, value, critical, power(i), ignored, usable)
         if (.not. usable) return
      end do
      noise = max(noise, noise_margin*(maxval(power) - minval(power)))
   end subroutine refine_noise

   !> Power of the loads on a frozen mechanism at one value
   pure subroutine power_at(family, mechanism, value, critical, power, noise, usable)
      class(family_t), intent(in) :: family
      type(frozen_mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: value
      type(critical_t), intent(inout) :: critical
      real(wp), intent(out) :: power  !! The power
      real(wp), intent(out) :: noise  !! What the rounding of coordinates alone makes of it
      logical, intent(out) :: usable  !! Whether the power could be found
      type(error_t), allocatable :: error
      type(scene_t) :: scene

      power = 0.0_wp
      noise = 0.0_wp
      call family%build(value, scene, error)
      usable = .not. allocated(error)
      if (.not. usable) return
      call begin_motion(scene%system)
      call mechanism_power(mechanism, scene, power, noise, usable)
      critical%factorisations = critical%factorisations + 1
   end subroutine power_at

   !> Power of the loads on the mechanism. The structure with faces held moves under its loads;
   !> two more solutions with its own inertia as the load leave of that motion the mechanism
   !> alone, which is then measured by the mechanism's motion at the value where it was found
   pure subroutine mechanism_power(mechanism, scene, power, noise, usable)
      type(frozen_mechanism_t), intent(in) :: mechanism
      type(scene_t), intent(in) :: scene  !! Scene of the value wanted
      real(wp), intent(out) :: power      !! Power: positive where the mechanism moves by itself
      !> What the rounding of the corners' coordinates alone makes of it
      real(wp), intent(out) :: noise
      logical, intent(out) :: usable  !! Whether the power could be found
      type(equations_t) :: equations
      type(joint_springs_t) :: springs
      type(settings_t) :: settings
      real(wp), allocatable :: motion(:, :)
      real(wp) :: scale, trial(3, size(mechanism%face))
      integer :: b, e, pass

      power = 0.0_wp
      noise = 0.0_wp
      usable = is_of(mechanism, scene)
      if (.not. usable) return
      settings = scene%settings
      settings%n_dof = 3
      call new_joint_springs(scene%system, 0.0_wp*scene%system%motion, scene%contacts%joint, &
         & scene%contacts%law, &
         & [(joint_place(scene%system, scene%contacts, b), b=1, size(scene%contacts%joint))], &
         & settings%penalty_ratio, settings%n_dof, springs)
      call new_equations(scene%system, springs, settings, equations)
      allocate (motion, source=mechanism%motion)
      call assemble_blocks(scene%system, settings, mechanism%dt, equations)
      trial = 0.0_wp
      call solve_faces(equations, springs, springs%cone, mechanism%face, trial, motion)
      usable = equations%factor%usable
      if (.not. usable) return
      do pass = 1, 2
         call weigh(equations, mechanism%dt, motion)
         call substitute(equations%factor, motion)
      end do
      call weigh(equations, mechanism%dt, motion)
      power = sum(motion*mechanism%motion)
      motion = mechanism%motion
      call weigh(equations, mechanism%dt, motion)
      scale = sum(motion*mechanism%motion)
      power = power/scale
      do b = 1, size(scene%system%equation)
         e = scene%system%equation(b)
         if (e > 0) noise = noise + area_rounding(scene%system, b) &
            & *abs(dot_product(equations%weight(:, e), mechanism%motion(:, e)))
      end do
      noise = noise/scale
   end subroutine mechanism_power

   !> Whether a scene has the blocks and joints of a mechanism, in the same order
   pure logical function is_of(mechanism, scene)
      type(frozen_mechanism_t), intent(in) :: mechanism
      type(scene_t), intent(in) :: scene

      is_of = size(mechanism%motion, 2) == maxval(scene%system%equation) &
         & .and. size(mechanism%joint) == size(scene%contacts%joint)
      if (is_of) is_of = all(same_joint(mechanism%joint, scene%contacts%joint))
   end function is_of

   !> Multiply a motion by the inertia
   pure subroutine weigh(equations, dt, motion)
      type(equations_t), intent(in) :: equations
      real(wp), intent(in) :: dt               !! Length of the step [s]
      real(wp), intent(inout) :: motion(:, :)  !! Motion in, inertia force out: (n_dof, n_equation)
      integer :: e

      do e = 1, size(motion, 2)
         motion(:, e) = (2.0_wp/dt**2)*matmul(equations%mass(:, :, e), motion(:, e))
      end do
   end subroutine weigh

   !> Relative error of a block's area by the rounding of its corners' coordinates
   pure real(wp) function area_rounding(system, block)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block  !! Number of the block

      associate (vertex => system%vertex(:, &
         & system%first_vertex(block):system%first_vertex(block + 1) - 1))
         area_rounding = epsilon(1.0_wp)*maxval(abs(vertex)) &
            & *sum(norm2(vertex - cshift(vertex, 1, dim=2), dim=1))/system%area(block)
      end associate
   end function area_rounding
end module dda_collapse_trace
