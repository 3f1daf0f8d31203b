!> One case of a deck: prepared, computed, and told as rows of the result tables
module dda_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_scene, only : arch_resolution, exact_thickness, search_start
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_critical, only : critical_t, find_critical, search_t
   use dda_decision, only : decide, decision_t
   use dda_deck, only : deck_t, file_beside, flag_of, has_group, integer_of, is_given, &
      & parameter_t, real_of, text_of, word_of
   use dda_deck_check, only : search_bracket
   use dda_deck_parameter, only : find_parameter, parameter_name
   use dda_deck_scene, only : deck_family_t, deck_scene
   use dda_error, only : error_line, error_t
   use dda_forward, only : outcome_t, run_to_verdict
   use dda_frames, only : album_t
   use dda_restart, only : load_restart
   use dda_step_context, only : march_t
   use dda_kinds, only : wp
   use dda_limerick_decision, only : decide_limerick
   use dda_limerick_search, only : find_limerick_critical
   use dda_mechanism, only : follow_collapse, mechanism_of, mechanism_t
   use dda_scene, only : scene_t
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : flow_rule, settings_t
   use dda_shared_forces, only : share_forces
   use dda_text, only : to_text
   use dda_verdict, only : verdict
   use dda_write_results, only : joint_row_t, number_t, result_row_t, some_number
   implicit none
   private

   public :: case_t, prepare_case, compute_case, tell_case, verdict_name

   !> One case in three stages: prepared, computed, told. Only the second may run beside other
   !> cases:
   !> the others make texts, and gfortran keeps the length of a text that a function returns in
   !> memory
   !> that threads share
   type :: case_t
      !> The deck with the values of the case
      type(deck_t) :: deck
      !> What its scene needs
      type(scene_plan_t) :: plan
      !> Whether a critical value is searched
      logical :: searches = .false.
      !> Whether the original's scheme decides
      logical :: limerick = .false.
      !> The scenes of the search
      type(deck_family_t) :: family
      !> The search
      type(search_t) :: search
      !> What the search found
      type(critical_t) :: critical
      !> Decision of a case that searches nothing
      type(decision_t) :: decision
      !> Scene of the collapse, or of the decision
      type(scene_t) :: scene
      !> Where a dynamic run goes on, and where it ended
      type(march_t) :: onward
      !> Restart file that it goes on from; empty if there is none
      character(len=:), allocatable :: restart_file
      !> Why the case could not be computed
      type(error_t), allocatable :: error
      !> Pictures of the collapse, or of the way to rest
      type(album_t) :: album
      !> Exact critical thickness ratio
      real(wp) :: exact = 0.0_wp
      !> Whether it is known
      logical :: exact_known = .false.
      !> Wall time of the computation [s]
      real(wp) :: seconds = 0.0_wp
   end type case_t

   !> A bracket whose middle is off by more than this share of its half is lopsided
   real(wp), parameter :: lopsided = 0.05_wp

contains

   !> Make a case ready to be computed
   pure subroutine prepare_case(deck, this)
      !> The deck with the values of the case
      type(deck_t), intent(in) :: deck
      !> The case
      type(case_t), intent(out) :: this
      character(len=:), allocatable :: searched

      this%deck = deck
      this%restart_file = file_beside(deck, text_of(deck, "analysis", "restart"))
      this%plan = plan_scene(deck)
      this%searches = has_group(deck, "search")
      this%limerick = word_of(deck, "analysis", "mode") == "limerick"
      if (this%searches) call prepare_search(deck, this%family, this%search)
      searched = searched_name(deck)
      this%exact_known = (searched == "" .or. searched == "thickness_ratio") &
         & .and. word_of(deck, "scene", "kind") == "arch"
   end subroutine prepare_case

   !> Compute a case
   subroutine compute_case(this)
      !> The case, prepared
      type(case_t), intent(inout) :: this
      type(error_t), allocatable :: error
      integer(int64) :: start, finish, rate

      call system_clock(start, rate)
      call plan_album(this)
      if (this%exact_known) call exact_thickness(this%deck, this%exact, this%exact_known)
      if (this%searches .and. this%limerick) then
         ! the limit of this scheme lies somewhat above the exact value
         if (this%exact_known .and. .not. this%search%check_far_end) &
            & this%search%start = min(max(this%exact, this%search%low), this%search%high)
         call find_limerick_critical(this%family, this%search, this%critical)
         if (allocated(this%critical%fallen)) &
            & call this%family%build(this%critical%falls, this%scene, error)
      else if (this%searches) then
         call find_critical(this%family, this%search, this%critical)
         if (allocated(this%critical%fallen)) then
            call this%family%build(this%critical%falls, this%scene, error)
            call follow_collapse(this%scene, this%critical%fallen)
         end if
      else if (this%limerick) then
         call deck_scene(this%deck, this%scene)
         call decide_limerick(this%deck, this%decision)
      else
         call deck_scene(this%deck, this%scene)
         call compute_decision(this)
         if (this%decision%outcome%verdict == verdict%collapsed) &
            & call follow_collapse(this%scene, this%decision)
      end if
      if (this%plan%shared_forces) call share_told_forces(this)
      if (integer_of(this%deck, "output", "frames") > 0 .or. size(this%album%point) > 0) &
         & call take_pictures(this)
      call system_clock(finish)
      this%seconds = real(finish - start, wp)/real(rate, wp)
   end subroutine compute_case

   !> Decide the scene, from its beginning or from where an earlier run has ended
   subroutine compute_decision(this)
      !> The case, its scene made
      type(case_t), intent(inout) :: this
      type(block_system_t) :: system
      type(contacts_t) :: contacts

      system = this%scene%system
      contacts = this%scene%contacts
      if (is_given(this%deck, "analysis", "restart")) then
         call load_restart(this%restart_file, this%scene%settings, system, contacts, this%onward, &
            & this%error)
         if (allocated(this%error)) return
      end if
      call decide(this%scene%settings, system, contacts, this%decision, this%album, this%onward)
   end subroutine compute_decision

   !> What the album of the case is to hold
   pure subroutine plan_album(this)
      !> The case
      type(case_t), intent(inout) :: this
      integer :: frames

      frames = integer_of(this%deck, "output", "frames")
      allocate (this%album%point(0))
      if (this%searches) return
      this%album%audit%wanted = flag_of(this%deck, "output", "energy") &
         & .and. word_of(this%deck, "analysis", "mode") == "dynamic"
      if (allocated(this%deck%plan%boundary%measured)) &
         & this%album%point = this%deck%plan%boundary%measured
      if (frames > 0 .and. word_of(this%deck, "analysis", "mode") == "dynamic") &
         & this%album%every = max(1, integer_of(this%deck, "analysis", "steps")/frames)
   end subroutine plan_album

   !> Share out the joint forces of the arch nearest to critical that was found to stand
   pure subroutine share_told_forces(this)
      !> The case, decided
      type(case_t), intent(inout) :: this
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      if (.not. allocated(this%critical%standing)) return
      call this%family%build(this%critical%stands, scene, error)
      call share_forces(scene, this%critical%standing)
   end subroutine share_told_forces

   !> Run a static scene once more for its pictures, a collapse until a corner has moved a tenth of
   !> the radius, or of the size of the blocks
   pure subroutine take_pictures(this)
      !> The case, computed
      type(case_t), intent(inout) :: this
      type(error_t), allocatable :: error
      type(outcome_t) :: outcome
      type(settings_t) :: settings
      type(block_system_t) :: system
      type(contacts_t) :: contacts
      logical :: slides

      if (this%scene%settings%dynamic) return
      slides = this%decision%flow == flow_rule%coulomb
      if (allocated(this%critical%fallen)) then
         slides = this%critical%fallen%flow == flow_rule%coulomb
      else if (allocated(this%critical%standing)) then
         slides = this%critical%standing%flow == flow_rule%coulomb
         call this%family%build(this%critical%stands, this%scene, error)
      end if
      if (.not. allocated(this%scene%contacts%joint)) return
      settings = this%scene%settings
      settings%flow = merge(flow_rule%coulomb, flow_rule%associated, slides)
      if (.not. settings%collapse_displacement > 0.0_wp) &
         & settings%collapse_displacement = 0.1_wp*scene_size(this)
      if (integer_of(this%deck, "output", "frames") > 0) &
         & this%album%spacing = settings%collapse_displacement &
         & /real(integer_of(this%deck, "output", "frames"), wp)
      system = this%scene%system
      contacts = this%scene%contacts
      call run_to_verdict(settings, system, contacts, outcome, this%album)
   end subroutine take_pictures

   !> Radius of an arch, half size of what was cut, or mean size of the blocks that move [m]
   pure real(wp) function scene_size(this)
      !> The case
      type(case_t), intent(in) :: this

      associate (system => this%scene%system)
         scene_size = sqrt(sum(system%area, mask=system%equation > 0) &
            & /real(max(1, count(system%equation > 0)), wp))
      end associate
      if (word_of(this%deck, "scene", "kind") == "arch") &
         & scene_size = real_of(this%deck, "arch", "radius")
      if (allocated(this%deck%cut)) scene_size = this%deck%cut%scale%size
   end function scene_size

   !> Tell a case
   pure subroutine tell_case(this, row, joint_row, remark)
      !> The case, computed
      type(case_t), intent(in) :: this
      !> Its row; the fields deck, number and swept are left to the caller
      type(result_row_t), intent(out) :: row
      !> Rows of the joints: (n_joint), or (0) if there is nothing to tell
      type(joint_row_t), allocatable, intent(out) :: joint_row(:)
      !> What the user should know beside the row; empty if nothing
      character(len=:), allocatable, intent(out) :: remark

      remark = ""
      allocate (joint_row(0))
      call describe(this, row)
      if (allocated(this%error)) then
         row%verdict = verdict_name(verdict%undecided)
         remark = error_line(this%error)
      else if (this%searches) then
         call tell_search(this, row, joint_row, remark)
      else
         call tell_decision(this, row, joint_row, remark)
      end if
   end subroutine tell_case

   !> Fill the columns that are known before anything is computed
   pure subroutine describe(this, row)
      !> The case
      type(case_t), intent(in) :: this
      !> The row
      type(result_row_t), intent(inout) :: row
      character(len=:), allocatable :: searched

      searched = searched_name(this%deck)
      row%mode = word_of(this%deck, "analysis", "mode")
      row%geometry = word_of(this%deck, "analysis", "geometry")
      if (this%limerick) row%geometry = "current"
      if (word_of(this%deck, "scene", "kind") == "arch") then
         row%half_angle_deg = given_number(this%deck, "arch", "half_angle_deg", searched)
         row%thickness_ratio = given_number(this%deck, "arch", "thickness_ratio", searched)
      end if
      if (.not. allocated(this%deck%analysis) .or. is_given(this%deck, "joint", "friction_deg")) &
         & row%friction_deg = given_number(this%deck, "joint", "friction_deg", searched)
      row%collapse_mode = "none"
      row%springing_hinge = "none"
      if (this%exact_known) row%exact = some_number(this%exact)
      row%seconds = this%seconds
      row%unknowns = this%plan%unknowns
      row%tells_condition = flag_of(this%deck, "output", "condition")
   end subroutine describe

   !> Name of the searched parameter, empty if nothing is searched
   pure function searched_name(deck) result(name)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Name of a key
      character(len=:), allocatable :: name
      type(parameter_t) :: parameter
      character(len=:), allocatable :: problem

      name = ""
      if (.not. has_group(deck, "search")) return
      call find_parameter(text_of(deck, "search", "parameter"), parameter, problem)
      name = trim(parameter_name(parameter))
   end function searched_name

   !> A number of the deck, unknown if it is searched
   pure function given_number(deck, group, key, searched) result(number)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Group of the key
      character(len=*), intent(in) :: group
      !> The key
      character(len=*), intent(in) :: key
      !> Name of the searched parameter
      character(len=*), intent(in) :: searched
      !> The number
      type(number_t) :: number

      if (key /= searched) number = some_number(real_of(deck, group, key))
   end function given_number

   !> Tell a case that searches nothing
   pure subroutine tell_decision(this, row, joint_row, remark)
      !> The case
      type(case_t), intent(in) :: this
      !> Its row
      type(result_row_t), intent(inout) :: row
      !> Rows of the joints
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      !> Why the verdict is undecided
      character(len=:), allocatable, intent(inout) :: remark

      associate (outcome => this%decision%outcome)
         row%verdict = verdict_name(outcome%verdict)
         if (allocated(outcome%reason)) remark = outcome%reason
         if (outcome%verdict == verdict%collapsed) &
            & call tell_mechanism(this%decision%contacts, this%scene%joint_angle_deg, row)
         row%blocks = maxval(this%scene%system%equation)
         row%steps = outcome%steps
         row%open_close_iterations = outcome%passes
         row%factorisations = outcome%factorisations
         call tell_condition(outcome, row)
      end associate
      joint_row = joint_rows(this%decision%contacts, this%scene%joint_angle_deg, this%scene%origin)
   end subroutine tell_decision

   !> Tell the search of a case
   pure subroutine tell_search(this, row, joint_row, remark)
      !> The case
      type(case_t), intent(in) :: this
      !> Its row
      type(result_row_t), intent(inout) :: row
      !> Rows of the joints: of the decision nearest to critical that stands, else of that which
      !> falls
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      !> Why the verdict is undecided
      character(len=:), allocatable, intent(inout) :: remark
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      associate (critical => this%critical)
         row%verdict = verdict_name(critical%verdict)
         if (critical%verdict == verdict%undecided) then
            remark = "the bracket cannot be closed further"
            if (allocated(critical%reason)) &
               & remark = "at "//to_text(critical%undecided_at)//" "//critical%reason
         end if
         if (critical%verdict == verdict%found) call tell_bracket(critical, row)
         if (allocated(critical%fallen)) then
            call tell_mechanism(critical%fallen%contacts, this%scene%joint_angle_deg, row)
            joint_row = joint_rows(critical%fallen%contacts, this%scene%joint_angle_deg, &
               & this%scene%origin)
            row%blocks = maxval(this%scene%system%equation)
         end if
         if (allocated(critical%standing)) then
            call this%family%build(critical%stands, scene, error)
            joint_row = joint_rows(critical%standing%contacts, scene%joint_angle_deg, scene%origin)
            row%blocks = maxval(scene%system%equation)
         end if
         row%steps = critical%steps
         row%open_close_iterations = critical%passes
         row%factorisations = critical%factorisations
         if (allocated(critical%standing)) then
            call tell_condition(critical%standing%outcome, row)
         else if (allocated(critical%fallen)) then
            call tell_condition(critical%fallen%outcome, row)
         end if
      end associate
   end subroutine tell_search

   !> Fill the column of the condition number, if it was estimated
   pure subroutine tell_condition(outcome, row)
      !> How the decision ended
      type(outcome_t), intent(in) :: outcome
      !> The row
      type(result_row_t), intent(inout) :: row

      if (outcome%condition > 0.0_wp .and. outcome%condition < huge(1.0_wp)) &
         & row%condition = some_number(outcome%condition)
   end subroutine tell_condition

   !> What a deck asks to be searched
   pure subroutine prepare_search(deck, family, search)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Its scenes
      type(deck_family_t), intent(out) :: family
      !> The search
      type(search_t), intent(out) :: search
      character(len=:), allocatable :: problem

      family%deck = deck
      call find_parameter(text_of(deck, "search", "parameter"), family%parameter, problem)
      call search_bracket(deck, search%low, search%high)
      search%tolerance = real_of(deck, "search", "tolerance")
      ! the original's own verdicts near the limit are no sharper
      if (word_of(deck, "analysis", "mode") == "limerick" &
         & .and. .not. is_given(deck, "search", "tolerance")) search%tolerance = 1.0e-4_wp
      if (word_of(deck, "scene", "kind") == "arch") search%resolution = arch_resolution(deck)
      search%start = search%low
      if (searched_name(deck) /= "thickness_ratio") return
      search%resolution_at = real_of(deck, "arch", "thickness_ratio")
      search%start = search_start(deck)
      if (.not. is_given(deck, "search", "low")) search%low = 1.0e-5_wp*search%start
      search%check_far_end = is_given(deck, "search", "high")
      if (.not. search%check_far_end) search%high = 1.99_wp
      search%start = min(max(search%start, search%low), search%high)
   end subroutine prepare_search

   !> Fill the columns of a closed bracket. Where its ends lie lopsided about the value at which the
   !> collapse stops, that value is its middle; where they lie closer than rounding can tell apart,
   !> it is told as wide as that
   pure subroutine tell_bracket(critical, row)
      !> What was found
      type(critical_t), intent(in) :: critical
      !> The row
      type(result_row_t), intent(inout) :: row

      real(wp) :: middle, half, off

      middle = (critical%falls + critical%stands)/2.0_wp
      half = abs(critical%stands - critical%falls)/2.0_wp
      off = abs(critical%stop - middle)
      if (critical%stops .and. off > lopsided*half .and. off < 2.0_wp*half) &
         & middle = critical%stop
      half = max(abs(critical%stands - middle), abs(critical%falls - middle), critical%half)
      row%critical = some_number(middle)
      row%critical_low = some_number(middle - half)
      row%critical_high = some_number(middle + half)
      row%collapses_at = merge("low ", "high", critical%falls < critical%stands)
      if (row%exact%known) row%relative_error = &
         & some_number((row%critical%value - row%exact%value)/row%exact%value)
   end subroutine tell_bracket

   !> Fill the columns of a collapse
   pure subroutine tell_mechanism(contacts, joint_angle_deg, row)
      !> Contacts at the end of the collapse
      type(contacts_t), intent(in) :: contacts
      !> Angle of each joint from the crown: (n_joint) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      !> The row
      type(result_row_t), intent(inout) :: row
      type(mechanism_t) :: mechanism

      call mechanism_of(contacts, joint_angle_deg, mechanism)
      row%collapse_mode = mechanism%mode
      row%sliding_share = some_number(mechanism%sliding_share)
      row%intrados_hinge_deg = mechanism%intrados_deg
      row%extrados_hinge_deg = mechanism%extrados_deg
      row%springing_hinge = mechanism%springing
   end subroutine tell_mechanism

   !> Rows of all joints
   pure function joint_rows(contacts, joint_angle_deg, origin) result(row)
      !> The contacts
      type(contacts_t), intent(in) :: contacts
      !> Angle of each joint from the crown, or none: (n_joint) or (0) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      !> Where the origin of the blocks' coordinates is: (2) [m]
      real(wp), intent(in) :: origin(2)
      !> The rows, without the number of the case: (n_joint)
      type(joint_row_t) :: row(size(contacts%joint))
      integer :: j

      do j = 1, size(row)
         row(j)%joint = j
         if (size(joint_angle_deg) > 0) row(j)%angle_deg = some_number(joint_angle_deg(j))
         associate (joint => contacts%joint(j))
            row(j)%intrados = joint%contact(1)%point + origin
            row(j)%extrados = joint%contact(joint%n_contact)%point + origin
         end associate
         row(j)%normal_force = sum(contacts%force(1:2, j))
         row(j)%shear_force = contacts%force(3, j)
         if (row(j)%normal_force > 0.0_wp) row(j)%eccentricity_ratio = some_number( &
            & (contacts%force(1, j) - contacts%force(2, j))/row(j)%normal_force)
         row(j)%opening_intrados = contacts%gap(1, j)
         row(j)%opening_extrados = contacts%gap(2, j)
         row(j)%slip = contacts%gap(3, j)
         row(j)%state = "locked"
         if (contacts%face(j)%open(2)) row(j)%state = "hinge_intrados"
         if (contacts%face(j)%open(1)) row(j)%state = "hinge_extrados"
         if (contacts%face(j)%slip /= 0) row(j)%state = "sliding"
         if (all(contacts%face(j)%open)) row(j)%state = "open"
      end do
   end function joint_rows

   !> A verdict in a word
   pure function verdict_name(answer) result(name)
      !> One of verdict
      integer, intent(in) :: answer
      !> The word
      character(len=10) :: name

      name = "undecided"
      if (answer == verdict%stable) name = "stable"
      if (answer == verdict%collapsed) name = "collapsed"
      if (answer == verdict%completed) name = "completed"
      if (answer == verdict%found) name = "found"
   end function verdict_name
end module dda_case
