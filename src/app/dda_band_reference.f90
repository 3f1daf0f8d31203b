!> The yardstick of the benchmark: LAPACK's banded Cholesky and substitution of one matrix, apart
!> from whatever solver the program itself has
module dda_band_reference
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   use dda_stopwatch, only : job_t
   implicit none
   private

   public :: band_job_t, new_band_job

   !> One factorisation and one substitution
   type, extends(job_t) :: band_job_t
      !> The matrix, lower triangle: (width of the band + 1, number of unknowns)
      real(wp), allocatable :: matrix(:, :)
      !> Its factor after a run, likewise
      real(wp), allocatable :: factor(:, :)
      !> Right-hand side: (number of unknowns)
      real(wp), allocatable :: load(:)
      !> Solution after a run: (number of unknowns)
      real(wp), allocatable :: solution(:)
      !> 0 if all went well
      integer :: info = 0
   contains
      !> Lay matrix and right-hand side ready, for LAPACK overwrites them
      procedure :: prepare => prepare_band
      !> Factor and substitute
      procedure :: run => run_band
   end type band_job_t

   interface
      !> LAPACK: Cholesky factorisation of a band matrix
      subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
         import :: wp
         !> "L": the lower triangle is stored
         character(len=1), intent(in) :: uplo
         !> Number of unknowns
         integer, intent(in) :: n
         !> Number of diagonals below the main one
         integer, intent(in) :: kd
         !> Rows of ab
         integer, intent(in) :: ldab
         !> Matrix in, factor out: (ldab, n)
         real(wp), intent(inout) :: ab(ldab, *)
         !> 0, or the order of the minor that is not positive definite
         integer, intent(out) :: info
      end subroutine dpbtrf

      !> LAPACK: substitution with a band factor
      subroutine dpbtrs(uplo, n, kd, nrhs, ab, ldab, b, ldb, info)
         import :: wp
         !> "L": the lower factor is stored
         character(len=1), intent(in) :: uplo
         !> Number of unknowns
         integer, intent(in) :: n
         !> Number of diagonals below the main one
         integer, intent(in) :: kd
         !> Number of right-hand sides
         integer, intent(in) :: nrhs
         !> Rows of ab
         integer, intent(in) :: ldab
         !> Rows of b
         integer, intent(in) :: ldb
         !> Factor: (ldab, n)
         real(wp), intent(in) :: ab(ldab, *)
         !> Right-hand sides in, solutions out: (ldb, nrhs)
         real(wp), intent(inout) :: b(ldb, *)
         !> 0 if all is well
         integer, intent(out) :: info
      end subroutine dpbtrs
   end interface

contains

   !> Lay a block matrix into LAPACK's band storage
   pure subroutine new_band_job(matrix, load, job)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Right-hand side: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The job
      type(band_job_t), intent(out) :: job
      integer :: b, c, e, first, offset, nd, n

      nd = matrix%n_dof
      n = nd*size(matrix%place)
      allocate (job%matrix(nd*(matrix%width + 1), n), job%load(n))
      job%matrix = 0.0_wp
      do b = 1, size(matrix%place)
         first = nd*(matrix%place(b) - 1)
         job%load(first + 1:first + nd) = load(:, b)
         do c = 1, nd
            job%matrix(:nd - c + 1, first + c) = matrix%diagonal(c:, c, b)
         end do
      end do
      do e = 1, size(matrix%pair, 2)
         first = nd*(matrix%place(matrix%pair(2, e)) - 1)
         offset = nd*(matrix%place(matrix%pair(1, e)) - 1) - first
         do c = 1, nd
            associate (column => job%matrix(offset - c + 2:offset - c + 1 + nd, first + c))
               column = column + matrix%coupling(:, c, e)
            end associate
         end do
      end do
      allocate (job%factor, source=job%matrix)
      allocate (job%solution, source=job%load)
   end subroutine new_band_job

   !> Lay matrix and right-hand side ready
   subroutine prepare_band(job)
      !> The job
      class(band_job_t), intent(inout) :: job

      job%factor = job%matrix
      job%solution = job%load
   end subroutine prepare_band

   !> Factor and substitute
   subroutine run_band(job)
      !> The job
      class(band_job_t), intent(inout) :: job
      integer :: kd, n

      kd = size(job%factor, 1) - 1
      n = size(job%factor, 2)
      call dpbtrf("L", n, kd, job%factor, kd + 1, job%info)
      if (job%info == 0) call dpbtrs("L", n, kd, 1, job%factor, kd + 1, job%solution, n, job%info)
   end subroutine run_band
end module dda_band_reference
