!> One case of a deck, ready to be computed
module dda_case
   use dda_arch_scene, only : arch_resolution, search_start
   use dda_deck, only : deck_t, file_beside, has_group, parameter_name, parameter_t, source_of
   use dda_deck_check_case, only : search_bracket
   use dda_deck_scene, only : deck_family_t, new_family
   use dda_error, only : error_t
   use dda_frames, only : album_t
   use dda_key_names, only : analysis_mode, analysis_restart, arch_thickness_ratio, search_group, &
      & search_high, search_low, search_tolerance
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_search, only : critical_t, decision_t, proof_t, search_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: case_t, prepare_case, searched_name

   !> One case in three stages: prepared, computed, reported. Only the second may run beside other
   !> cases: the others make texts, and gfortran keeps the length of a text that a function returns
   !> in memory that threads share
   type :: case_t
      type(scene_plan_t) :: plan  !! Plan of its scene
      !> True to search a critical value; to write tables of joints or blocks
      logical :: searches = .false., writes_tables = .true.
      logical :: proves = .true.     !! True if its verdict is proven
      logical :: limerick = .false.  !! True if Shi's scheme decides
      type(deck_family_t) :: family  !! The scenes of the search
      type(search_t) :: search       !! The search
      type(critical_t) :: critical   !! Result of the search
      type(decision_t) :: decision   !! Decision of a case that searches nothing
      !> Scene of the collapse, or of the decision; before the computation that of the deck, if a
      !> check has made it
      type(scene_t) :: scene
      type(scene_t) :: standing  !! Scene nearest to critical that stands, where it was asked for
      type(march_t) :: onward    !! Where a dynamic run goes on, and where it ended
      !> Restart file that it goes on from; empty if there is none
      character(len=:), allocatable :: restart_file
      type(error_t), allocatable :: error  !! Why the case could not be computed
      type(album_t) :: album               !! Pictures of the collapse, or of the way to rest
      !> True if the vehicle was put where the least load factor is carried
      logical :: has_worst = .false.
      logical :: misses_worst = .false.  !! True if the least load factor was not found
      !> True if it drives the other way there: the deck has its axles the other way round then
      logical :: drives_backward = .false.
      !> True if the other direction of travel has the same least factor
      logical :: either_direction = .false.
      real(wp) :: other_place = 0.0_wp            !! Worst position in that direction [m]
      character(len=:), allocatable :: jump_note  !! Jump of the factor between positions, if any
      type(proof_t) :: proof                      !! Proof of the verdict, if tables are written
      real(wp) :: exact = 0.0_wp                  !! Exact critical thickness ratio
      logical :: exact_known = .false.            !! True if it is known
      real(wp) :: seconds = 0.0_wp                !! Wall time of the computation [s]
   end type case_t

contains

   !> Make a case ready to be computed
   pure subroutine prepare_case(deck, this)
      !> The deck with the values of the case; goes into it
      type(deck_t), allocatable, intent(inout) :: deck
      type(case_t), intent(out) :: this
      character(len=:), allocatable :: searched

      this%restart_file = file_beside(deck, deck%value(analysis_restart)%text)
      this%plan = plan_scene(deck)
      searched = searched_name(deck)
      this%searches = has_group(deck, search_group)
      this%limerick = deck%value(analysis_mode)%text == "limerick"
      this%exact_known = (searched == "" .or. searched == "thickness_ratio") &
         & .and. source_of(deck) == "arch"
      call move_alloc(deck, this%family%deck)
      if (this%searches) then
         call prepare_search(this%plan, searched, this%family, this%search)
      else
         call new_family(parameter_t(key=arch_thickness_ratio), this%family)
      end if
   end subroutine prepare_case

   !> Name of the searched parameter, empty if nothing is searched
   pure function searched_name(deck) result(name)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: name  !! Name of a key

      name = ""
      if (has_group(deck, search_group)) name = trim(parameter_name(deck%searched))
   end function searched_name

   !> Search of a deck
   pure subroutine prepare_search(plan, searched, family, search)
      type(scene_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: searched      !! Name of the searched parameter
      type(deck_family_t), intent(inout) :: family  !! New apart from its deck
      type(search_t), intent(inout) :: search

      call new_family(family%deck%searched, family)
      associate (deck => family%deck)
         call search_bracket(deck, search%low, search%high)
         search%in_time = plan%velocities
         search%tolerance = deck%value(search_tolerance)%number
         ! Shi's verdicts near the limit are no sharper, nor those of a motion in steps
         if (deck%value(analysis_mode)%text /= "static" &
            & .and. .not. deck%value(search_tolerance)%given) search%tolerance = 1.0e-4_wp
         if (source_of(deck) == "arch") search%resolution = arch_resolution(deck)
         search%start = search%low
         if (searched /= "thickness_ratio" .or. plan%velocities) return
         ! a chain keeps its digits
         if (family%decides_chains) search%resolution = 0.0_wp
         if (.not. family%decides_chains) search%resolution_at = &
            & deck%value(arch_thickness_ratio)%number
         search%start = search_start(deck)
         if (.not. deck%value(search_low)%given) search%low = 1.0e-5_wp*search%start
         search%check_far_end = deck%value(search_high)%given
         if (.not. search%check_far_end) search%high = 1.99_wp
         search%start = min(max(search%start, search%low), search%high)
      end associate
   end subroutine prepare_search
end module dda_case
