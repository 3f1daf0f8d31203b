!> The cost of a step by its parts, for walls and loose blocks of rising size
module dda_step_benchmark
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_assembly, only : new_equations, refresh, solve_faces
   use dda_block_factor, only : factorise, substitute
   use dda_block_inertia, only : assemble_blocks
   use dda_contact_search, only : store_near_edges, near_joints
   use dda_contact_transfer, only : renew_contacts
   use dda_contact_types, only : joint_t
   use dda_cost_scenes, only : loose_blocks, wall
   use dda_forward, only : run_to_verdict
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_step_context, only : march_t
   use dda_step_reach, only : first_reach, travel_of
   use dda_step_state, only : equations_t
   use dda_stopwatch, only : job_t, median_of, take_samples, timed_job_t
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: step_case_t, step_figures_t, measure_steps

   !> A scene and how it is run
   type :: step_case_t
      character(len=24) :: name = ""  !! Name of the scene
      !> Courses and bricks in a course; without courses as many loose blocks in square
      integer :: size(2) = 0
      logical :: dynamic = .false.  !! True if velocities are kept
      logical :: current = .false.  !! True if blocks move
      !> Steps before those that are timed, and steps that are timed, which may be none: (2)
      integer :: steps(2) = [0, 1]
   end type step_case_t

   !> Parts of a step
   character(len=12), parameter :: part_name(6) = [character(len=12) :: "search", "transfer", &
      & "assemble", "factorise", "substitute", "step"]

   !> What a step costs
   type :: step_figures_t
      integer :: blocks = 0  !! Movable blocks
      !> Time of one call of each part but the last, of one step with the setting up of its share of
      !> the run for that, 0 if it was not timed: (6) [s]
      real(wp) :: part(6) = 0.0_wp
      !> Searches, passes of the open-close loop and factorisations of a step: (3)
      real(wp) :: count(3) = 0.0_wp
   end type step_figures_t

   !> The state that steps start from
   type, extends(job_t) :: step_job_t
      type(scene_t) :: scene                 !! The scene at that state
      type(march_t) :: march                 !! The march
      type(equations_t) :: equations         !! Its equations
      real(wp), allocatable :: motion(:, :)  !! Motion of the blocks: (n_dof, n_equation)
      type(scene_t) :: copy                  !! The scene that a run works on
      integer :: part = 0                    !! Which part is timed: a place in part_name
      integer :: steps = 0                   !! Steps of a run
      type(outcome_t) :: outcome             !! How the run ended
   contains
      !> Make the copies
      procedure :: prepare => prepare_step
      !> Do the part once
      procedure :: run => run_step
   end type step_job_t

contains

   !> Time the parts of a step
   subroutine measure_steps(step_case, figures)
      type(step_case_t), intent(in) :: step_case    !! The scene and how it is run
      type(step_figures_t), intent(out) :: figures  !! Receives the figures
      type(step_job_t) :: job
      type(timed_job_t) :: timed(1)
      real(wp), allocatable :: sample(:, :)
      real(wp) :: start, finish
      integer :: before(2), j

      call make_job(step_case, job)
      figures%blocks = count(job%scene%system%equation > 0)
      do j = 1, 5
         job%part = j
         allocate (timed(1)%job, source=job)
         call take_samples(timed, sample)
         figures%part(j) = median_of(sample(:, 1))
         deallocate (timed(1)%job)
      end do
      figures%part(2) = max(0.0_wp, figures%part(2) - figures%part(1))
      job%steps = step_case%steps(2)
      if (job%steps == 0) return
      ! a run goes on from where the last one ended: it is timed once
      job%part = 6
      before = [job%march%steps, job%march%passes]
      call job%prepare()
      call cpu_time(start)
      call job%run()
      call cpu_time(finish)
      associate (n => real(max(1, job%march%steps - before(1)), wp))
         figures%part(6) = (finish - start)/n
         figures%count = [merge(merge(2.0_wp, 1.0_wp, step_case%dynamic), 0.0_wp, &
            & step_case%current), real(job%outcome%passes - before(2), wp)/n, &
            & real(job%outcome%factorisations, wp)/n]
      end associate
   end subroutine measure_steps

   !> Run a scene to where its steps are timed
   subroutine make_job(step_case, job)
      type(step_case_t), intent(in) :: step_case  !! The scene and how it is run
      type(step_job_t), intent(out) :: job
      type(outcome_t) :: outcome

      if (step_case%size(1) > 0) then
         call wall(step_case%size(1), step_case%size(2), step_case%dynamic, step_case%current, &
            & job%scene)
      else
         call loose_blocks(step_case%size(2), step_case%dynamic, job%scene)
      end if
      associate (scene => job%scene)
         scene%settings%max_steps = step_case%steps(1)
         call run_to_verdict(scene%settings, scene%system, scene%contacts, outcome, &
            & onward=job%march)
         if (.not. allocated(job%march%reach)) &
            & job%march%reach = first_reach(scene%system, scene%settings, job%march)
         call new_equations(scene%system, scene%settings, job%equations)
         call assemble_blocks(scene%system, scene%settings, job%march%dt, job%equations)
         allocate (job%motion, source=job%equations%weight)
         call solve_faces(job%equations, scene%contacts%springs, scene%contacts%springs%cone, &
            & scene%contacts%face, scene%contacts%trial, job%motion)
      end associate
      call store_near_edges(job%scene%contacts%search, job%scene%system, job%march%reach)
   end subroutine make_job

   !> Copy what a run changes
   subroutine prepare_step(job)
      class(step_job_t), intent(inout) :: job

      job%copy = job%scene
   end subroutine prepare_step

   !> Do the part of a step once
   subroutine run_step(job)
      class(step_job_t), intent(inout) :: job
      type(joint_t), allocatable :: joint(:)
      integer(int64) :: none(0)

      associate (scene => job%copy, settings => job%scene%settings)
         select case (part_name(job%part))
         case ("search")
            call near_joints(scene%contacts%search, scene%system, travel_of(scene%system, &
               & settings, job%march), none, job%march%reach, .not. scene%contacts%remember, &
               & joint)
         case ("transfer")
            call renew_contacts(scene%system, travel_of(scene%system, settings, job%march), &
               & job%march%reach, settings%penalty_ratio, settings%n_dof, scene%contacts)
         case ("assemble")
            job%equations%new_numbers = .true.
            call refresh(scene%contacts%springs, job%equations)
            call assemble_blocks(scene%system, settings, job%march%dt, job%equations)
         case ("factorise")
            call factorise(job%equations%matrix, job%equations%factor)
         case ("substitute")
            job%motion = job%equations%weight
            call substitute(job%equations%factor, job%motion)
         case default
            scene%settings%max_steps = job%march%steps + job%steps
            call run_to_verdict(scene%settings, scene%system, scene%contacts, job%outcome, &
               & onward=job%march)
         end select
      end associate
   end subroutine run_step
end module dda_step_benchmark
