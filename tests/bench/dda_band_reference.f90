!> The reference of the benchmark: LAPACK's banded Cholesky and substitution of one matrix, apart
!> from whatever solver the program itself has
module dda_band_reference
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   use dda_stopwatch, only : job_t
   use lapack_reference, only : band_factor_t, factor_band, fill_band, substitute
   implicit none
   private

   public :: band_job_t, new_band_job

   !> One factorisation and one substitution
   type, extends(job_t) :: band_job_t
      type(band_factor_t) :: matrix            !! The matrix in LAPACK's band
      type(band_factor_t) :: factor            !! Its factor after a run
      real(wp), allocatable :: load(:, :)      !! Right-hand side: (n_dof, n_block)
      real(wp), allocatable :: solution(:, :)  !! Solution after a run: (n_dof, n_block)
   contains
      !> Lay matrix and right-hand side ready, for LAPACK overwrites them
      procedure :: prepare => prepare_band
      !> Factor and substitute
      procedure :: run => run_band
   end type band_job_t

contains

   !> Lay a block matrix into LAPACK's band storage
   pure subroutine new_band_job(matrix, load, job)
      type(block_matrix_t), intent(in) :: matrix
      real(wp), intent(in) :: load(:, :)  !! Right-hand side: (n_dof, n_block)
      type(band_job_t), intent(out) :: job

      call fill_band(matrix, job%matrix)
      job%factor = job%matrix
      allocate (job%load, source=load)
      allocate (job%solution, source=load)
   end subroutine new_band_job

   !> Lay matrix and right-hand side ready
   subroutine prepare_band(job)
      class(band_job_t), intent(inout) :: job

      job%factor%band = job%matrix%band
      job%solution = job%load
   end subroutine prepare_band

   !> Factor and substitute
   subroutine run_band(job)
      class(band_job_t), intent(inout) :: job

      call factor_band(job%factor)
      if (job%factor%usable) call substitute(job%factor, job%solution)
   end subroutine run_band
end module dda_band_reference
