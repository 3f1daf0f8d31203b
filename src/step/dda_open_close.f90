!> The open-close loop: an active-set method on the faces of the friction cones (Shi: df18 to df22)
!>
!> One step minimises a convex, piecewise quadratic energy. With the faces fixed the minimum is a
!> linear system; each joint that disagrees with its face more than its neighbours do then changes
!> it, as the simplex method pivots. Should a set of faces come again, only the worst joint does;
!> should one come again then, Newton's method with an exact line search, which must end.
!>
!> Equation (M3) of docs/method.md
module dda_open_close
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_assembly, only : equations_t, refresh, solve_faces
   use dda_friction_cone, only : joint_face_t
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_newton, only : iterate_newton
   use dda_step_state, only : disagreement, force_noise, joint_forces, step_state_t
   implicit none
   private

   public :: iterate_open_close, change_faces

   !> Joints that disagree as much as the worst except for rounding change with it: mirror images do
   real(wp), parameter :: tie = 1.0e-9_wp
   !> Joints whose disagreement is below this share of the largest wait for their turn
   real(wp), parameter :: notable = 0.1_wp
   !> Changes of faces before Newton's method takes over where blocks make no chain
   integer, parameter :: few_changes = 1

contains

   !> Find the motion and the faces of one step
   pure subroutine iterate_open_close(equations, springs, max_changes, state, one_by_one)
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Most changes of faces of a chain before Newton's method takes over
      integer, intent(in) :: max_changes
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      !> Whether only the joint that disagrees most changes its face, as it does after a repetition
      logical, intent(in), optional :: one_by_one
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), best(size(state%motion, 1), size(state%motion, 2)), least
      integer(int64) :: seen(max_changes + 1)
      integer :: change, most, since
      logical :: peaks

      call refresh(springs, equations)
      most = merge(max_changes, min(max_changes, few_changes), equations%matrix%width <= 1)
      peaks = .true.
      if (present(one_by_one)) peaks = .not. one_by_one
      since = 1
      state%settled = .false.
      best = 0.0_wp
      least = huge(least)
      do change = 1, most + 1
         seen(change) = hash(state%face)
         if (any(seen(since:change - 1) == seen(change))) then
            if (.not. peaks) exit
            peaks = .false.
            since = change
         end if
         call solve_faces(equations, springs, state%cone, state%face, state%start, state%motion)
         state%passes = state%passes + 1
         if (.not. equations%factor%usable) return
         call disagreement(springs, state, gap, wanted)
         state%settled = maxval(gap) <= force_noise(equations, springs, state)
         if (state%settled) exit
         if (maxval(gap) < least) then
            least = maxval(gap)
            best = state%motion
         end if
         if (peaks) then
            where (is_peak(equations, springs, gap)) state%face = wanted
         else
            where (gap >= (1.0_wp - tie)*maxval(gap)) state%face = wanted
         end if
      end do
      if (.not. state%settled) then
         state%motion = best
         call iterate_newton(equations, springs, state)
      end if
      if (state%settled) call joint_forces(springs, state)
   end subroutine iterate_open_close

   !> Change the faces of a motion once: where to begin, if the motion is nearly that of a step
   pure subroutine change_faces(equations, springs, state)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> The step; its faces are changed
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face))

      call disagreement(springs, state, gap, wanted)
      if (maxval(gap) <= force_noise(equations, springs, state)) return
      where (is_peak(equations, springs, gap)) state%face = wanted
   end subroutine change_faces

   !> Joints that disagree more than all others of their two blocks
   pure function is_peak(equations, springs, gap)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Disagreement: (n_joint) [N/m]
      real(wp), intent(in) :: gap(:)
      !> The joints: (n_joint)
      logical :: is_peak(size(gap))
      real(wp) :: highest, threshold
      integer :: e, j, k, side

      threshold = notable*maxval(gap)
      do j = 1, size(gap)
         is_peak(j) = gap(j) >= threshold
         if (.not. is_peak(j)) cycle
         highest = gap(j)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e == 0) cycle
            do k = equations%first_joint(e), equations%first_joint(e + 1) - 1
               highest = max(highest, gap(abs(equations%joint(k))))
            end do
         end do
         is_peak(j) = gap(j) >= (1.0_wp - tie)*highest
      end do
   end function is_peak

   !> A number that tells sets of faces apart
   pure function hash(face) result(number)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      integer(int64) :: number
      integer(int64) :: code
      integer :: j

      number = 0_int64
      do j = 1, size(face)
         code = face(j)%slip + 1
         if (face(j)%open(1)) code = code + 3
         if (face(j)%open(2)) code = code + 6
         number = ieor(ishft(number, 7) + ishft(number, -57), mixed(12_int64*j + code))
      end do

   contains

      !> A number spread over all bits by shifts, which cannot overflow
      pure function mixed(code)
         !> Number to spread
         integer(int64), intent(in) :: code
         integer(int64) :: mixed

         mixed = ieor(code, ishft(code, 21))
         mixed = ieor(mixed, ishft(mixed, -35))
         mixed = ieor(mixed, ishft(mixed, 4))
         mixed = ieor(mixed, ishft(mixed, 41))
      end function mixed
   end function hash
end module dda_open_close
