!> How long a job takes and how much memory the process has taken
module dda_stopwatch
   use dda_kinds, only : wp
   implicit none
   private

   public :: job_t, timed_job_t, take_samples, median_of, peak_memory

   !> Work that is repeated and timed
   type, abstract :: job_t
   contains
      !> Make ready for one run; not timed
      procedure :: prepare
      !> The work; timed
      procedure(run_job), deferred :: run
   end type job_t

   abstract interface
      !> Do the work once
      subroutine run_job(job)
         import :: job_t
         class(job_t), intent(inout) :: job  !! The job
      end subroutine run_job
   end interface

   !> One of several jobs that are timed in turn
   type :: timed_job_t
      class(job_t), allocatable :: job  !! The job
   end type timed_job_t

   !> Time that each job may take [s]
   real(wp), parameter :: budget = 0.5_wp
   !> Fewest and most samples of one job
   integer, parameter :: fewest = 5, most = 101

contains

   !> Nothing to make ready
   subroutine prepare(job)
      class(job_t), intent(inout) :: job

      associate (unused => job)
      end associate
   end subroutine prepare

   !> Time jobs in turn, so that a disturbance of the machine meets all of them; short jobs are run
   !> several times a sample, of which the least time counts
   subroutine take_samples(timed, sample)
      type(timed_job_t), intent(inout) :: timed(:)  !! The jobs: (n)
      !> Least time of one run in each sample: (n_sample, n) [s]
      real(wp), allocatable, intent(out) :: sample(:, :)
      real(wp) :: once(size(timed))
      integer :: batch(size(timed)), i, j, n

      do j = 1, size(timed)
         once(j) = max(seconds_of(timed(j)%job, 2), 1.0e-8_wp)
      end do
      n = max(fewest, min(most, int(budget/maxval(once))))
      batch = max(1, int(budget/(once*real(n, wp))))
      allocate (sample(n, size(timed)))
      do i = 1, n
         do j = 1, size(timed)
            sample(i, j) = seconds_of(timed(j)%job, batch(j))
         end do
      end do
   end subroutine take_samples

   !> Least time of several runs in a row: other work on the machine can only add to it. What counts
   !> is the time that the processor gives to this process, not that in which it waits
   function seconds_of(job, runs) result(least)
      class(job_t), intent(inout) :: job
      integer, intent(in) :: runs  !! How many
      real(wp) :: least            !! The least [s]
      real(wp) :: start, finish
      integer :: i

      least = huge(least)
      do i = 1, runs
         call job%prepare()
         call cpu_time(start)
         call job%run()
         call cpu_time(finish)
         least = min(least, finish - start)
      end do
   end function seconds_of

   !> The value in the middle: half of the values are no larger, half no smaller
   pure real(wp) function median_of(values)
      real(wp), intent(in) :: values(:)  !! One value or more: (:)
      real(wp) :: sorted(size(values))
      integer :: at, i

      do i = 1, size(values)
         at = i
         do while (at > 1)
            if (sorted(at - 1) <= values(i)) exit
            sorted(at) = sorted(at - 1)
            at = at - 1
         end do
         sorted(at) = values(i)
      end do
      median_of = (sorted((size(values) + 1)/2) + sorted(size(values)/2 + 1))/2.0_wp
   end function median_of

   !> Most memory that this process has had at one time, where the system tells it
   integer function peak_memory()
      character(len=80) :: line  !! [kB]; -1 if it is not known
      integer :: stat, unit

      peak_memory = -1
      open (newunit=unit, file="/proc/self/status", action="read", status="old", iostat=stat)
      if (stat /= 0) return
      do
         read (unit, "(a)", iostat=stat) line
         if (stat /= 0) exit
         if (line(:6) /= "VmHWM:") cycle
         read (line(7:index(line, "kB") - 1), *, iostat=stat) peak_memory
         exit
      end do
      close (unit)
   end function peak_memory
end module dda_stopwatch
