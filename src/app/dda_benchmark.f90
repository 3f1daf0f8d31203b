!> The benchmark: semicircular arches of equal voussoirs, decided and searched, timed against one
!> banded factorisation and substitution of their own equations
module dda_benchmark
   use couplet_heyman_discrete, only : discrete_critical_equal, discrete_solution_t
   use dda_arch, only : arch_blocks, arch_shape_t, equal_joints
   use dda_assembly, only : assemble_blocks, equations_t, new_equations, solve_faces
   use dda_band_reference, only : band_job_t, new_band_job
   use dda_block_solve, only : factorise, substitute
   use dda_block_system, only : block_system_t
   use dda_constants, only : pi
   use dda_contact_detection, only : contacts_t, find_contacts
   use dda_critical, only : critical_t, find_critical, search_t
   use dda_decision, only : decide, decision_t
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t, material_t
   use dda_scene, only : family_t, scene_t
   use dda_stopwatch, only : job_t, median_seconds
   use dda_verdict, only : verdict
   implicit none
   private

   public :: equal_arches_t, figures_t, measure, search_once

   !> Arches of equal voussoirs that differ by their thickness ratio
   type, extends(family_t) :: equal_arches_t
      !> Number of voussoirs
      integer :: voussoirs = 36
   contains
      !> Make the arch of one thickness ratio
      procedure :: build => build_arch
   end type equal_arches_t

   !> Figures of one number of voussoirs; times are medians
   type :: figures_t
      !> Number of voussoirs
      integer :: voussoirs = 0
      !> Mean time of a decision [s]
      real(wp) :: decision = 0.0_wp
      !> Time of a search [s]
      real(wp) :: search = 0.0_wp
      !> Time of one factorisation and substitution by LAPACK [s]
      real(wp) :: lapack = 0.0_wp
      !> Decisions that came out right, of four
      integer :: right = 0
      !> Mean number of factorisations of a decision
      real(wp) :: factorisations = 0.0_wp
      !> What the search found and counted
      type(critical_t) :: critical
      !> Relative error of the middle of its bracket
      real(wp) :: error = 0.0_wp
      !> Parts of the decision's time: setting up, assembly, factor and solve, judging and the rest [s]
      real(wp) :: part(4) = 0.0_wp
      !> Memory that a search adds to the process; -1 if it is not known [kB]
      integer :: memory = -1
   end type figures_t

   !> Decisions at four distances from the critical thickness
   type, extends(job_t) :: decisions_job_t
      !> The arches: (4)
      type(scene_t) :: scene(4)
      !> Their decisions after a run: (4)
      type(decision_t) :: decision(4)
   contains
      !> Decide all four
      procedure :: run => run_decisions
   end type decisions_job_t

   !> A critical search
   type, extends(job_t) :: search_job_t
      !> The arches
      type(equal_arches_t) :: family
      !> What it found in the last run
      type(critical_t) :: critical
   contains
      !> Search
      procedure :: run => run_search
   end type search_job_t

   !> What a run does before its first step
   type, extends(job_t) :: setup_job_t
      !> The arch
      type(scene_t) :: scene
      !> Copy of its blocks
      type(block_system_t) :: system
      !> Copy of its contacts
      type(contacts_t) :: contacts
      !> Its equations
      type(equations_t) :: equations
   contains
      !> Copy blocks and contacts, set up the equations
      procedure :: run => run_setup
   end type setup_job_t

   !> One solution with faces held
   type, extends(setup_job_t) :: solve_job_t
      !> Length of the step [s]
      real(wp) :: dt = 0.0_wp
      !> The motion: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
   contains
      !> Assemble the blocks, so that the matrix is made anew
      procedure :: prepare => prepare_solve
      !> Assemble the joints, factor, substitute
      procedure :: run => run_solve
   end type solve_job_t

   !> The factorisation alone
   type, extends(solve_job_t) :: factorise_job_t
   contains
      !> Factor
      procedure :: run => run_factorise
   end type factorise_job_t

   !> The substitution alone
   type, extends(solve_job_t) :: substitute_job_t
   contains
      !> Substitute
      procedure :: run => run_substitute
   end type substitute_job_t

   !> Angle from the crown to the springing [rad]
   real(wp), parameter :: half_angle = pi/2.0_wp
   !> Weight per volume [N/m3]
   real(wp), parameter :: unit_weight = 22.0e3_wp
   !> Where to decide, from the critical thickness ratio, over that ratio
   real(wp), parameter :: distance(4) = [-1.0e-3_wp, -1.0e-5_wp, 1.0e-5_wp, 1.0e-3_wp]
   !> Free fall over elastic motion in the step whose equations are timed
   real(wp), parameter :: free_fall = 1.0e6_wp

contains

   !> Make the arch of one thickness ratio: radius 10 m, joints that cannot slide
   pure subroutine build_arch(family, value, scene, error)
      !> The family
      class(equal_arches_t), intent(in) :: family
      !> Thickness over radius
      real(wp), intent(in) :: value
      !> The scene
      type(scene_t), intent(out) :: scene
      !> Never allocated
      type(error_t), allocatable, intent(out) :: error
      type(arch_shape_t) :: shape
      type(material_t) :: material
      type(joint_law_t) :: law(family%voussoirs + 1)
      integer, allocatable :: edge_pair(:, :)

      shape%thickness_ratio = value
      shape%joint_angle = equal_joints(family%voussoirs, half_angle)
      allocate (shape%facets((family%voussoirs + 1)/2), source=1)
      call arch_blocks(shape, material, scene%system, edge_pair)
      scene%system%unit_weight = unit_weight
      law%no_slip = .true.
      call find_contacts(scene%system, edge_pair, law, scene%settings%penalty_ratio, &
         & scene%settings%n_dof, scene%contacts)
   end subroutine build_arch

   !> All figures but the memory
   subroutine measure(voussoirs, figures)
      !> Number of voussoirs
      integer, intent(in) :: voussoirs
      !> Receives the figures
      type(figures_t), intent(inout) :: figures
      type(decisions_job_t) :: decisions
      type(search_job_t) :: search
      type(discrete_solution_t) :: exact
      type(error_t), allocatable :: error
      integer :: answer(4), i

      figures%voussoirs = voussoirs
      search%family%voussoirs = voussoirs
      call discrete_critical_equal(voussoirs, half_angle, pi, .true., exact)
      do i = 1, size(distance)
         call search%family%build(exact%eta*(1.0_wp + distance(i)), decisions%scene(i), error)
      end do
      figures%decision = median_seconds(decisions)/real(size(distance), wp)
      answer = decisions%decision%outcome%verdict
      figures%right = count(answer == merge(verdict%stable, verdict%collapsed, distance > 0.0_wp))
      figures%factorisations = real(sum(decisions%decision%outcome%factorisations), wp) &
         & /real(size(distance), wp)
      figures%search = median_seconds(search)
      figures%critical = search%critical
      figures%error = (search%critical%falls + search%critical%stands)/2.0_wp/exact%eta - 1.0_wp
      call measure_parts(decisions, figures)
   end subroutine measure

   !> Where the time of a decision goes: what is called apart is timed apart and multiplied by the
   !> number of its calls, the rest is what is left. The equations are those of the first decision
   subroutine measure_parts(decisions, figures)
      !> The four decisions
      type(decisions_job_t), intent(in) :: decisions
      !> Receives the parts and LAPACK's time
      type(figures_t), intent(inout) :: figures
      type(setup_job_t) :: setup
      type(solve_job_t) :: solve
      type(factorise_job_t) :: factorising
      type(substitute_job_t) :: substituting
      type(band_job_t) :: band
      real(wp) :: solves, solve_time, factorise_time, substitute_time

      setup%scene = decisions%scene(1)
      call setup%run()
      ! every run begins with one solution with all joints glued
      solves = 1.0_wp + real(sum(decisions%decision%outcome%passes), wp)/real(size(distance), wp)
      solve%setup_job_t = setup
      associate (decision => decisions%decision(1))
         solve%contacts%face = decision%contacts%face
         solve%motion = decision%outcome%motion
         solve%dt = sqrt(free_fall)*decision%outcome%elastic_time
      end associate
      solve_time = median_seconds(solve)
      factorising%solve_job_t = solve
      factorise_time = median_seconds(factorising)
      substituting%solve_job_t = solve
      substitute_time = median_seconds(substituting)
      call new_band_job(solve%equations%matrix, solve%equations%weight, band)
      figures%lapack = median_seconds(band)
      figures%part(1) = median_seconds(setup)
      figures%part(2) = figures%factorisations*(solve_time - factorise_time - substitute_time)
      figures%part(3) = figures%factorisations*factorise_time + solves*substitute_time
      figures%part(4) = figures%decision - sum(figures%part(:3))
   end subroutine measure_parts

   !> One search and nothing else
   subroutine search_once(voussoirs)
      !> Number of voussoirs
      integer, intent(in) :: voussoirs
      type(search_job_t) :: search

      search%family%voussoirs = voussoirs
      call search%run()
   end subroutine search_once

   !> Decide all four
   subroutine run_decisions(job)
      !> The job
      class(decisions_job_t), intent(inout) :: job
      integer :: i

      do i = 1, size(job%scene)
         call decide(job%scene(i)%settings, job%scene(i)%system, job%scene(i)%contacts, &
            & job%decision(i))
      end do
   end subroutine run_decisions

   !> Search to 1e-8, from where a deck without bounds makes a search begin
   subroutine run_search(job)
      !> The job
      class(search_job_t), intent(inout) :: job
      type(search_t) :: search

      search%start = 0.8_wp*half_angle**4/48.0_wp*(1.0_wp - half_angle**2/10.0_wp)
      search%low = 1.0e-5_wp*search%start
      search%high = 1.99_wp
      search%check_far_end = .false.
      call find_critical(job%family, search, job%critical)
   end subroutine run_search

   !> Copy blocks and contacts, set up the equations
   subroutine run_setup(job)
      !> The job
      class(setup_job_t), intent(inout) :: job

      job%system = job%scene%system
      job%contacts = job%scene%contacts
      call new_equations(job%system, job%contacts%springs, job%scene%settings, job%equations)
   end subroutine run_setup

   !> Assemble the blocks, so that the matrix is made anew
   subroutine prepare_solve(job)
      !> The job
      class(solve_job_t), intent(inout) :: job

      call assemble_blocks(job%system, job%scene%settings, job%dt, job%equations)
   end subroutine prepare_solve

   !> Assemble the joints, factor, substitute
   subroutine run_solve(job)
      !> The job
      class(solve_job_t), intent(inout) :: job

      call solve_faces(job%equations, job%contacts%springs, job%contacts%springs%cone, &
         & job%contacts%face, job%contacts%trial, job%motion)
   end subroutine run_solve

   !> Factor
   subroutine run_factorise(job)
      !> The job
      class(factorise_job_t), intent(inout) :: job

      call factorise(job%equations%matrix, job%equations%factor)
   end subroutine run_factorise

   !> Substitute
   subroutine run_substitute(job)
      !> The job
      class(substitute_job_t), intent(inout) :: job

      job%motion = job%equations%weight
      call substitute(job%equations%factor, job%motion)
   end subroutine run_substitute
end module dda_benchmark
