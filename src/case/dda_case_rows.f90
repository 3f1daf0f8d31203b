!> Rows of a computed case in the result tables
module dda_case_rows
   use dda_block_rows, only : ends_on_path, fallen_contacts, joint_rows, tell_blocks, &
      & tell_mechanism, tell_mechanism_motion, tell_nearest, tell_roles, tell_total_motion
   use dda_block_scene, only : lacks_friction
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t, searched_name
   use dda_case_remarks, only : change_remark, completed_remark, contact_remark, fall_remark, &
      & has_bracket, joined, jump_remark, path_remark, range_remark, undecided_remark
   use dda_deck, only : deck_t, source_of
   use dda_deck_scene, only : movable_blocks
   use dda_error, only : error_line
   use dda_key_names, only : analysis_geometry, analysis_mode, arch_half_angle_deg, &
      & arch_thickness_ratio, joint_friction_deg, output_condition, scene_kind, vehicle_position
   use dda_kinds, only : wp
   use dda_search, only : critical_t, decision_t, proof_t
   use dda_settings, only : verdict
   use dda_text, only : short_text
   use dda_verdict, only : outcome_t
   use dda_write_results, only : joint_row_t, result_row_t, some_number, told_blocks_t
   implicit none
   private

   public :: tell_case

   !> Offset of the middle of a bracket, over its half, that causes a remark
   real(wp), parameter :: lopsided = 0.05_wp
   !> Words for the verdicts, by their number
   character(len=10), parameter :: verdict_word(0:4) = [character(len=10) :: "undecided", &
      & "stable", "collapsed", "completed", "found"]

   !> Distance of centres along x that is none, over the width of all blocks
   real(wp), parameter :: same_place = 1.0e-9_wp

contains

   !> Rows of a case
   pure subroutine tell_case(this, row, joint_row, blocks, remark)
      type(case_t), intent(in) :: this
      !> Its row; the fields deck, number and swept are left to the caller
      type(result_row_t), intent(out) :: row
      !> Rows of the joints: (n_joint), or (0) if there are none
      type(joint_row_t), allocatable, intent(out) :: joint_row(:)
      type(told_blocks_t), intent(out) :: blocks            !! Its blocks; unallocated without any
      character(len=:), allocatable, intent(out) :: remark  !! For the user, beside the row

      remark = ""
      allocate (joint_row(0))
      call describe(this, row)
      if (allocated(this%error)) then
         row%verdict = verdict_word(verdict%undecided)
         remark = error_line(this%error)
      else if (this%searches) then
         call tell_search(this, row, joint_row, blocks, remark)
      else
         call tell_decision(this, row, joint_row, blocks, remark)
      end if
      if (source_of(this%family%deck) == "shape") call turn_rows(this%scene%system, joint_row)
      if (this%has_worst) then
         row%worst_position = some_number(this%family%deck%value(vehicle_position)%number)
         row%worst_direction = merge("backward", "forward ", this%drives_backward)
         remark = joined(remark, trim(merge("dead loads collapse", "least load factor  ", &
            & row%verdict == "collapsed"))//position_words(this, row)//this%jump_note)
      end if
      call tell_proof(this%proof, row)
      if (row%verdict == "stable" .and. row%exact%known .and. row%thickness_ratio%known) &
         & row%safety_thickness = some_number(row%thickness_ratio%value/row%exact%value)
   end subroutine tell_case

   !> Worst position and direction of a vehicle, in words
   pure function position_words(this, row) result(words)
      type(case_t), intent(in) :: this
      type(result_row_t), intent(in) :: row
      character(len=:), allocatable :: words

      words = " with the leftmost axle at "//short_text(row%worst_position%value)//" m"
      if (.not. this%either_direction) then
         words = words//", driving "//trim(row%worst_direction)
      else if (abs(this%other_place - row%worst_position%value) > 0.0_wp) then
         words = " in either direction,"//words//" ("//trim(row%worst_direction)//") or " &
            & //short_text(this%other_place)//" m (" &
            & //trim(merge("forward ", "backward", this%drives_backward))//")"
      else
         words = words//", in either direction"
      end if
   end function position_words

   !> Fill the columns of the proof
   pure subroutine tell_proof(proof, row)
      type(proof_t), intent(in) :: proof
      type(result_row_t), intent(inout) :: row

      if (allocated(proof%force)) row%imbalance = some_number(proof%imbalance)
      if (allocated(proof%force) .or. allocated(proof%velocity)) &
         & row%law_violation = some_number(proof%law_violation)
      if (allocated(proof%velocity)) row%mechanism_power = some_number(proof%power)
      if (proof%has_limit) row%exact_low = some_number(proof%limit(1))
      if (proof%has_limit) row%exact_high = some_number(proof%limit(2))
      if (proof%has_thrust(1)) row%thrust_min = some_number(proof%thrust(1))
      if (proof%has_thrust(2)) row%thrust_max = some_number(proof%thrust(2))
   end subroutine tell_proof

   !> Fill the columns that are known before anything is computed
   pure subroutine describe(this, row)
      type(case_t), intent(in) :: this
      type(result_row_t), intent(inout) :: row
      character(len=:), allocatable :: searched

      searched = searched_name(this%family%deck)
      row%mode = this%family%deck%value(analysis_mode)%text
      row%geometry = this%family%deck%value(analysis_geometry)%text
      if (this%limerick) row%geometry = "current"
      row%blocks = movable_blocks(this%family%deck)
      if (source_of(this%family%deck) == "arch") then
         row%springing_hinge = "none"
         if (searched /= "half_angle_deg") &
            & row%half_angle_deg = some_number(this%family%deck%value(arch_half_angle_deg)%number)
         if (searched /= "thickness_ratio") &
            & row%thickness_ratio = some_number(this%family%deck%value(arch_thickness_ratio)%number)
      end if
      if (deck_friction_acts(this%family%deck) .and. searched /= "friction_deg") &
         & row%friction_deg = some_number(this%family%deck%value(joint_friction_deg)%number)
      row%collapse_mode = "none"
      if (this%exact_known) row%exact = some_number(this%exact)
      row%seconds = this%seconds
      row%unknowns = this%plan%unknowns
      row%tells_condition = this%family%deck%value(output_condition)%flag
   end subroutine describe

   !> True if the friction of the deck may be that of a joint: those of lines have that of their
   !> analysis file, those of blocks that of the law of their materials, where there is one
   pure logical function deck_friction_acts(deck)
      type(deck_t), intent(in) :: deck

      deck_friction_acts = deck%value(joint_friction_deg)%given
      if (deck_friction_acts) return
      deck_friction_acts = .not. allocated(deck%file_analysis)
      if (deck%value(scene_kind)%text == "blocks") deck_friction_acts = lacks_friction(deck%plan)
   end function deck_friction_acts

   !> Rows of a case without a search
   pure subroutine tell_decision(this, row, joint_row, blocks, remark)
      type(case_t), intent(in) :: this
      type(result_row_t), intent(inout) :: row
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      type(told_blocks_t), intent(inout) :: blocks
      character(len=:), allocatable, intent(inout) :: remark  !! Why the verdict is undecided

      associate (outcome => this%decision%outcome)
         row%verdict = verdict_word(outcome%verdict)
         if (allocated(outcome%reason)) remark = outcome%reason
         if (outcome%has_path) then
            row%path_time = some_number(outcome%path_time)
            remark = joined(remark, path_remark(outcome))
         end if
         remark = joined(remark, jump_remark(outcome%jumps, outcome%largest_jump))
         if (outcome%verdict == verdict%completed .and. .not. this%limerick) &
            & remark = joined(remark, completed_remark(this%scene%settings, this%decision%system))
         if (outcome%has_residual) row%contact_residual = some_number(outcome%residual)
         remark = joined(remark, contact_remark(outcome%rough, outcome%reduced))
         if (outcome%verdict == verdict%collapsed .and. allocated(outcome%motion) &
            & .and. .not. this%plan%velocities .and. source_of(this%family%deck) /= "arch") &
            & remark = joined(remark, fall_remark(this%scene%system, outcome%motion))
         if (allocated(this%decision%contacts%joint)) joint_row = &
            & joint_rows(this%decision%system, this%decision%contacts, &
            & this%scene%joint_angle_deg, this%scene%origin)
         if (outcome%verdict == verdict%collapsed) then
            call tell_mechanism(this%decision, this%scene%joint_angle_deg, row)
            if (size(joint_row) > 0) call tell_roles(fallen_contacts(this%decision), &
               & this%decision%system, this%decision%contacts, joint_row, outcome%motion)
         end if
         if (allocated(this%decision%system%equation)) call tell_end(this, blocks)
         row%steps = outcome%steps
         row%open_close_iterations = outcome%passes
         row%factorisations = outcome%factorisations
         call tell_condition(outcome, row)
      end associate
   end subroutine tell_decision

   !> Rows of the blocks at the end of a decision
   pure subroutine tell_end(this, blocks)
      type(case_t), intent(in) :: this
      type(told_blocks_t), intent(inout) :: blocks
      logical :: moves

      moves = this%limerick .or. this%scene%settings%current
      call tell_blocks(this%scene, blocks)
      if (this%decision%outcome%verdict == verdict%collapsed .and. .not. moves) then
         call tell_mechanism_motion(this%scene%system, this%decision%outcome%motion, blocks)
      else
         call tell_total_motion(this%decision%system, moves, blocks)
      end if
   end subroutine tell_end

   !> Row of the search of a case
   pure subroutine tell_search(this, row, joint_row, blocks, remark)
      type(case_t), intent(in) :: this
      type(result_row_t), intent(inout) :: row
      !> Rows of the joints: of the decision nearest to critical that stands, else of that which
      !> falls
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      type(told_blocks_t), intent(inout) :: blocks
      character(len=:), allocatable, intent(inout) :: remark

      associate (critical => this%critical)
         row%verdict = verdict_word(critical%verdict)
         if (critical%verdict == verdict%undecided) &
            & remark = undecided_remark(this%search, critical)
         if (critical%verdict == verdict%found) call tell_bracket(critical, row)
         if (critical%verdict == verdict%undecided) call tell_open_bracket(critical, row)
         if (ends_on_path(critical%standing)) &
            & row%path_time = some_number(critical%standing%outcome%path_time)
         if (critical%limit%known) then
            row%exact_low = some_number(minval(critical%limit%value))
            row%exact_high = some_number(maxval(critical%limit%value))
         end if
         if (critical%has_other) remark = "it also collapses at "//short_text(critical%other)
         remark = joined(remark, jump_remark(critical%jumps, critical%largest_jump))
         ! a dynamic run has a remark on the values between the ends
         if (critical%verdict == verdict%stable .and. critical%others == 0) &
            & remark = joined(remark, &
            & range_remark(this%family%deck, this%search, this%scene%settings))
         if (critical%others > 0 .and. critical%verdict /= verdict%undecided) &
            & remark = joined(remark, change_remark(critical))
         if (allocated(critical%fallen)) &
            & call tell_mechanism(critical%fallen, this%scene%joint_angle_deg, row)
         if (this%writes_tables) call tell_nearest(this, joint_row, blocks)
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
      type(outcome_t), intent(in) :: outcome
      type(result_row_t), intent(inout) :: row

      if (outcome%condition > 0.0_wp .and. outcome%condition < huge(1.0_wp)) &
         & row%condition = some_number(outcome%condition)
   end subroutine tell_condition

   !> Fill the columns of a bracket that could not be closed; the critical value stays blank
   pure subroutine tell_open_bracket(critical, row)
      type(critical_t), intent(in) :: critical
      type(result_row_t), intent(inout) :: row

      if (.not. has_bracket(critical)) return
      row%critical_low = some_number(min(critical%falls, critical%stands))
      row%critical_high = some_number(max(critical%falls, critical%stands))
      row%collapses_at = merge("low ", "high", critical%falls < critical%stands)
   end subroutine tell_open_bracket

   !> Fill the columns of a closed bracket. If its ends are at different distances from the value at
   !> which the collapse stops, that value is its middle; its width is at least the rounding error,
   !> and what jumps leave
   pure subroutine tell_bracket(critical, row)
      type(critical_t), intent(in) :: critical
      type(result_row_t), intent(inout) :: row
      real(wp) :: middle, half, off

      middle = (critical%falls + critical%stands)/2.0_wp
      half = abs(critical%stands - critical%falls)/2.0_wp
      off = abs(critical%stop - middle)
      if (critical%stops .and. off > lopsided*half .and. off < 2.0_wp*half) middle = critical%stop
      half = max(abs(critical%stands - middle), abs(critical%falls - middle), critical%half)
      row%critical = some_number(middle)
      row%critical_low = some_number(min(middle - half, critical%reach(1)))
      row%critical_high = some_number(max(middle + half, critical%reach(2)))
      row%collapses_at = merge("low ", "high", critical%falls < critical%stands)
      if (row%exact%known) row%relative_error = &
         & some_number((row%critical%value - row%exact%value)/row%exact%value)
   end subroutine tell_bracket

   !> Turn joints of an arch whose first block is on the right, as at a left springing: their
   !> intrados and extrados become those of the arch
   pure subroutine turn_rows(system, row)
      type(block_system_t), intent(in) :: system  !! The blocks
      type(joint_row_t), intent(inout) :: row(:)  !! The rows: (n_joint)
      real(wp) :: width
      integer :: j

      if (size(row) == 0) return
      width = maxval(system%vertex(1, :)) - minval(system%vertex(1, :))
      do j = 1, size(row)
         associate (x => system%centroid(1, row(j)%block))
            if (x(2) < x(1) - same_place*width) call turn_row(row(j))
         end associate
      end do
   end subroutine turn_rows

   !> Take the second block of a joint for the first: shear and slip stay, as the way along the
   !> joint turns with them
   pure elemental subroutine turn_row(row)
      type(joint_row_t), intent(inout) :: row
      real(wp) :: extrados(2), opening

      extrados = row%intrados
      row%intrados = row%extrados
      row%extrados = extrados
      row%block = row%block([2, 1])
      row%force = -row%force
      row%slides%value = -row%slides%value
      row%eccentricity_ratio%value = -row%eccentricity_ratio%value
      row%state = other_end(row%state)
      row%mechanism = other_end(row%mechanism)
      if (.not. row%opening_extrados%known) return
      opening = row%opening_intrados
      row%opening_intrados = row%opening_extrados%value
      row%opening_extrados%value = opening
   end subroutine turn_row

   !> The hinge at the other end of a joint; any other word as it is
   pure elemental character(len=14) function other_end(word)
      character(len=14), intent(in) :: word  !! State or role of a joint

      other_end = word
      if (word == "hinge_intrados") other_end = "hinge_extrados"
      if (word == "hinge_extrados") other_end = "hinge_intrados"
   end function other_end
end module dda_case_rows
