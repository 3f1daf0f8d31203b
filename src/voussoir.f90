!> Public procedures for Fortran programs: decks as in the command dda, and joints on a graph
!>
!>    call read_deck("arch.nml", deck, error)
!>    call solve_case(deck, 1, row, joint, remark, error)
!>
!> Everything else is internal to the program and may change.
module voussoir
   use couplet_heyman_discrete, only : discrete_critical_equal, discrete_solution_t
   use dda_case, only : case_t, prepare_case
   use dda_compute_case, only : compute_case
   use dda_case_rows, only : tell_case
   use dda_deck, only : deck_t
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_error, only : error_line, error_t, fatal_error
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_line_scene, only : cut_lines
   use dda_limit_load, only : find_limit, limit_load_t, limit_state
   use dda_read_deck, only : parse_deck, read_deck
   use dda_text, only : to_text
   use dda_write_results, only : joint_row_t, number_t, result_row_t, told_blocks_t
   implicit none
   private

   public :: wp, error_t, error_line
   public :: deck_t, read_deck, parse_deck, n_cases
   public :: solve_case, result_row_t, joint_row_t, number_t
   public :: joint_graph_t, joint_kind
   public :: find_limit, limit_load_t, limit_state
   public :: decide_load, load_decision_t, load_state
   public :: discrete_critical_equal, discrete_solution_t

contains

   !> Compute one case of a deck. Not thread-safe, because it makes texts
   subroutine solve_case(deck, number, row, joint, remark, error)
      type(deck_t), intent(in) :: deck
      !> Number of the case, from 1 to n_cases(deck)
      integer, intent(in) :: number
      type(result_row_t), intent(out) :: row
      !> Rows of joints.csv: (n_joint); (0) if there are none
      type(joint_row_t), allocatable, intent(out) :: joint(:)
      !> Remark as in the log, including the reason of `undecided`
      character(len=:), allocatable, intent(out) :: remark
      !> Allocated for a number out of range or an invalid case
      type(error_t), allocatable, intent(out) :: error
      type(deck_t), allocatable :: case_of_deck
      type(case_t) :: this
      type(told_blocks_t) :: blocks

      remark = ""
      allocate (joint(0))
      if (number < 1 .or. number > n_cases(deck)) call fatal_error(error, &
         & "number of the case: expected 1 to "//to_text(n_cases(deck))//", got " &
         & //to_text(number))
      if (allocated(error)) return
      allocate (case_of_deck)
      call turn_to_case(deck, number, case_of_deck, error)
      if (.not. allocated(error)) call cut_lines(case_of_deck, error)
      if (allocated(error)) return
      call prepare_case(case_of_deck, this)
      call compute_case(this)
      call tell_case(this, row, joint, blocks, remark)
   end subroutine solve_case
end module voussoir
