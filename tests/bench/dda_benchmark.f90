!> The benchmark: semicircular arches of equal voussoirs, decided and searched, timed against one
!> banded factorisation and substitution of their own equations
module dda_benchmark
   use couplet_heyman_discrete, only : discrete_critical_equal, discrete_solution_t
   use dda_arch, only : arch_blocks, equal_joints
   use dda_arch_chain, only : arch_chain, arch_numbers_t, arch_rays
   use dda_assembly, only : new_equations, refresh, solve_faces
   use dda_block_inertia, only : assemble_blocks
   use dda_band_reference, only : band_job_t, new_band_job
   use dda_block_factor, only : factorise, substitute
   use dda_block_system, only : block_system_t
   use dda_chain, only : chain_t
   use dda_chain_decision, only : decide_chain, unfold
   use dda_chain_programme, only : deficit_t
   use dda_contacts, only : contacts_t, find_contacts, raise_springs
   use dda_kinds, only : pi, wp
   use dda_critical, only : find_critical
   use dda_decision, only : decide
   use dda_error, only : error_t
   use dda_material, only : joint_law_t, material_t
   use dda_scene, only : family_t, scene_t
   use dda_search, only : critical_t, decision_t, search_t
   use dda_settings, only : settings_t, verdict
   use dda_step_state, only : equations_t
   use dda_stopwatch, only : job_t, median_of, take_samples, timed_job_t
   implicit none
   private

   public :: equal_arches_t, figures_t, measure, search_once

   !> Arches of equal voussoirs that differ by their thickness ratio
   type, extends(family_t) :: equal_arches_t
      integer :: voussoirs = 36  !! Number of voussoirs
      !> Unknowns of a block; arches of 3 are chains, as where a deck asks for no more
      integer :: unknowns = 6
   contains
      !> Make the arch of one thickness ratio
      procedure :: build => build_arch
   end type equal_arches_t

   !> Figures of one number of voussoirs; times are medians
   type :: figures_t
      integer :: voussoirs = 0       !! Number of voussoirs
      integer :: unknowns = 6        !! Unknowns of a block
      real(wp) :: decision = 0.0_wp  !! Mean time of a decision [s]
      real(wp) :: search = 0.0_wp    !! Time of a search [s]
      real(wp) :: lapack = 0.0_wp    !! Time of one factorisation and substitution by LAPACK [s]
      !> Decision over LAPACK: median of the ratios of samples taken one after the other
      real(wp) :: ratio = 0.0_wp
      integer :: right = 0                 !! Decisions that came out right, of four
      real(wp) :: factorisations = 0.0_wp  !! Mean number of factorisations of a decision
      type(critical_t) :: critical         !! Result and counts of the search
      real(wp) :: error = 0.0_wp           !! Relative error of the middle of its bracket
      !> Shares of setting up, assembly, factor and solve, judging and the rest in a decision's time
      real(wp) :: share(4) = 0.0_wp
      !> Memory that a search adds to the process; -1 if it is not known [kB]
      integer :: memory = -1
   end type figures_t

   !> Decisions at four distances from the critical thickness
   type, extends(job_t) :: decisions_job_t
      type(scene_t), allocatable :: scene(:)        !! The arches: (4)
      type(chain_t), allocatable :: chain(:)        !! The same as chains, if they are: (4)
      type(decision_t), allocatable :: decision(:)  !! Their decisions after a run: (4)
   contains
      !> Decide all four
      procedure :: run => run_decisions
   end type decisions_job_t

   !> A critical search
   type, extends(job_t) :: search_job_t
      type(equal_arches_t) :: family  !! The arches
      type(critical_t) :: critical    !! Result of the last run
   contains
      !> Search
      procedure :: run => run_search
   end type search_job_t

   !> What a run does before its first step
   type, extends(job_t) :: setup_job_t
      type(scene_t) :: scene          !! The arch
      type(block_system_t) :: system  !! Copy of its blocks
      type(contacts_t) :: contacts    !! Copy of its contacts
      type(equations_t) :: equations  !! Its equations
   contains
      !> Copy blocks and contacts, set up the equations
      procedure :: run => run_setup
   end type setup_job_t

   !> One solution with faces held
   type, extends(setup_job_t) :: solve_job_t
      real(wp) :: dt = 0.0_wp                !! Length of the step [s]
      real(wp), allocatable :: motion(:, :)  !! The motion: (n_dof, n_equation)
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

   !> Arches of radius 10 m whose joints cannot slide
   pure function new_arches(voussoirs, unknowns) result(family)
      integer, intent(in) :: voussoirs  !! Number of voussoirs
      integer, intent(in) :: unknowns   !! Unknowns of a block, 3 or 6
      type(equal_arches_t) :: family
      type(material_t) :: material
      type(settings_t) :: settings

      family%voussoirs = voussoirs
      family%unknowns = unknowns
      family%chains = .true.
      family%decides_chains = unknowns == 3
      family%numbers = arch_numbers_t(family%numbers%shape, material%density, material%young, &
         & [0.0_wp, -unit_weight], settings%penalty_ratio, joint_law_t(no_slip=.true.), &
         & halved=family%decides_chains)
      allocate (family%numbers%shape%joint_angle, source=equal_joints(voussoirs, half_angle))
      allocate (family%numbers%shape%facets((voussoirs + 1)/2), source=1)
      call arch_rays(family%numbers, family%rays)
   end function new_arches

   !> Make the arch of one thickness ratio
   pure subroutine build_arch(family, value, scene, error)
      class(equal_arches_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Thickness over radius
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error  !! Never allocated
      type(arch_numbers_t) :: numbers
      type(material_t) :: material
      type(joint_law_t) :: law(family%voussoirs + 1)
      integer, allocatable :: edge_pair(:, :)

      numbers = family%numbers
      numbers%shape%thickness_ratio = value
      call arch_blocks(numbers%shape, material, scene%system, edge_pair)
      scene%system%unit_weight = unit_weight
      scene%settings%n_dof = family%unknowns
      law = numbers%law
      scene%settings%penalty_ratio = numbers%penalty_ratio
      call find_contacts(scene%system, edge_pair, law, scene%contacts)
   end subroutine build_arch

   !> All figures but the memory
   subroutine measure(voussoirs, unknowns, figures)
      integer, intent(in) :: voussoirs           !! Number of voussoirs
      integer, intent(in) :: unknowns            !! Unknowns of a block
      type(figures_t), intent(inout) :: figures  !! Receives the figures
      type(decisions_job_t) :: decisions
      type(search_job_t) :: search
      type(timed_job_t) :: searching(1)
      type(discrete_solution_t) :: exact
      type(error_t), allocatable :: error
      real(wp), allocatable :: sample(:, :)
      integer :: answer(4), i

      figures%voussoirs = voussoirs
      figures%unknowns = unknowns
      allocate (decisions%scene(size(distance)), decisions%decision(size(distance)))
      if (unknowns == 3) allocate (decisions%chain(size(distance)))
      search%family = new_arches(voussoirs, unknowns)
      call discrete_critical_equal(voussoirs, half_angle, pi, .true., exact)
      do i = 1, size(distance)
         call search%family%build(exact%eta*(1.0_wp + distance(i)), decisions%scene(i), error)
         if (unknowns == 3) call arch_chain(search%family%numbers, search%family%rays, &
            & exact%eta*(1.0_wp + distance(i)), decisions%chain(i))
      end do
      call decisions%run()
      call unfold(decisions%decision)
      answer = decisions%decision%outcome%verdict
      figures%right = count(answer == merge(verdict%stable, verdict%collapsed, distance > 0.0_wp))
      call search%run()
      figures%critical = search%critical
      figures%error = (search%critical%falls + search%critical%stands)/2.0_wp/exact%eta - 1.0_wp
      allocate (searching(1)%job, source=search)
      call take_samples(searching, sample)
      figures%search = median_of(sample(:, 1))
      call measure_decisions(decisions, figures)
   end subroutine measure

   !> Time the decisions, LAPACK and the parts of a decision, but for those of a chain. What is
   !> called apart is timed apart and multiplied by the number of its calls, the rest is what is
   !> left. The equations are those of the first decision
   subroutine measure_decisions(decisions, figures)
      type(decisions_job_t), intent(in) :: decisions  !! The four decisions, run once
      type(figures_t), intent(inout) :: figures       !! Receives the figures
      type(setup_job_t) :: setup
      type(solve_job_t) :: solve
      type(factorise_job_t) :: factorising
      type(substitute_job_t) :: substituting
      type(band_job_t) :: band
      type(timed_job_t) :: timed(6)
      real(wp), allocatable :: sample(:, :)
      real(wp) :: solves, cost(2:6)
      type(decision_t) :: decision
      integer :: j

      setup%scene = decisions%scene(1)
      call setup%run()
      solve%setup_job_t = setup
      ! a chain knows no elastic motion
      call decide(setup%scene, decision)
      solve%contacts%face = decision%contacts%face
      solve%motion = decision%outcome%motion
      solve%dt = sqrt(free_fall)*decision%outcome%elastic_time
      call solve%prepare()
      call solve%run()
      factorising%solve_job_t = solve
      substituting%solve_job_t = solve
      call new_band_job(solve%equations%matrix, solve%equations%weight, band)
      allocate (timed(1)%job, source=decisions)
      allocate (timed(2)%job, source=band)
      allocate (timed(3)%job, source=setup)
      allocate (timed(4)%job, source=solve)
      allocate (timed(5)%job, source=factorising)
      allocate (timed(6)%job, source=substituting)
      call take_samples(timed, sample)
      sample(:, 1) = sample(:, 1)/real(size(distance), wp)
      figures%decision = median_of(sample(:, 1))
      figures%lapack = median_of(sample(:, 2))
      figures%ratio = median_of(sample(:, 1)/sample(:, 2))
      do j = 2, 6
         cost(j) = median_of(sample(:, j)/sample(:, 1))
      end do
      associate (outcome => decisions%decision%outcome)
         figures%factorisations = real(sum(outcome%factorisations), wp)/real(size(distance), wp)
         ! every run begins with one solution with all joints glued
         solves = 1.0_wp + real(sum(outcome%passes), wp)/real(size(distance), wp)
      end associate
      figures%share(1) = cost(3)
      figures%share(2) = figures%factorisations*(cost(4) - cost(5) - cost(6))
      figures%share(3) = figures%factorisations*cost(5) + solves*cost(6)
      figures%share(4) = 1.0_wp - sum(figures%share(:3))
   end subroutine measure_decisions

   !> One search and nothing else
   subroutine search_once(voussoirs, unknowns)
      integer, intent(in) :: voussoirs  !! Number of voussoirs
      integer, intent(in) :: unknowns   !! Unknowns of a block
      type(search_job_t) :: search

      search%family = new_arches(voussoirs, unknowns)
      call search%run()
   end subroutine search_once

   !> Decide all four
   subroutine run_decisions(job)
      class(decisions_job_t), intent(inout) :: job
      type(deficit_t) :: deficit
      logical :: decided
      integer :: i

      do i = 1, size(job%scene)
         if (allocated(job%chain)) then
            deficit = deficit_t()
            call decide_chain(job%scene(i)%settings, job%chain(i), job%decision(i), decided, deficit)
            if (decided) cycle
         end if
         call decide(job%scene(i), job%decision(i))
      end do
   end subroutine run_decisions

   !> Search to 1e-8, from where a deck without bounds makes a search begin
   subroutine run_search(job)
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
      class(setup_job_t), intent(inout) :: job

      job%system = job%scene%system
      job%contacts = job%scene%contacts
      call raise_springs(job%scene%settings, job%system, job%contacts)
      call new_equations(job%system, job%scene%settings, job%equations)
      call refresh(job%contacts%springs, job%equations)
   end subroutine run_setup

   !> Assemble the blocks, so that the matrix is made anew
   subroutine prepare_solve(job)
      class(solve_job_t), intent(inout) :: job

      call assemble_blocks(job%system, job%scene%settings, job%dt, job%equations)
   end subroutine prepare_solve

   !> Assemble the joints, factor, substitute
   subroutine run_solve(job)
      class(solve_job_t), intent(inout) :: job

      call solve_faces(job%equations, job%contacts%springs, job%contacts%springs%cone, &
         & job%contacts%face, job%contacts%trial, job%motion)
   end subroutine run_solve

   !> Factor
   subroutine run_factorise(job)
      class(factorise_job_t), intent(inout) :: job

      call factorise(job%equations%matrix, job%equations%factor)
   end subroutine run_factorise

   !> Substitute
   subroutine run_substitute(job)
      class(substitute_job_t), intent(inout) :: job

      job%motion = job%equations%weight
      call substitute(job%equations%factor, job%motion)
   end subroutine run_substitute
end module dda_benchmark
