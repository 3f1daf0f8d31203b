!> Contact forces joint by joint (Gauss-Seidel), accelerated by conjugate gradients (Silcowitz,
!> Niebe, Erleben 2010)
!>
!> They converge to the forces of Coulomb's law without a factorisation: fast where the forces of
!> the last step are near or blocks are few, slowly in tall stacks.
module dda_contact_sweeps
   use dda_contact_problem, only : contact_problem_t, find_answers, move_blocks, &
      & residual_of, residual_t
   use dda_friction_cone, only : cone_kind, shear_bound
   use dda_joint_answer, only : answer_joint, joint_view_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: sweep_joints

   !> Sweeps between two residuals
   integer, parameter :: round = 8

   !> Variables of sweeps
   type :: sweeps_t
      !> Forces: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Motion of the blocks, of what does not move first: (n_dof, 0:n_block) [m]
      real(wp), allocatable :: motion(:, :)
      !> Directions that the joints slid in last, or 0: (n_joint)
      integer, allocatable :: slip(:)
   end type sweeps_t

contains

   !> Sweep until openings are against the law of contact by no more than the tolerance, or until
   !> so many sweeps are done; the forces that come nearest to it are kept
   pure subroutine sweep_joints(p, tolerance, most, force, residual)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: tolerance       !! The tolerance [m]
      integer, intent(in) :: most             !! Most sweeps
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      type(sweeps_t) :: sweeps, before, way
      type(residual_t) :: now
      real(wp), allocatable :: answer(:, :, :, :)
      real(wp) :: last, square
      integer :: k

      if (residual%opening <= tolerance) return
      call find_answers(p, answer)
      sweeps%force = force
      allocate (sweeps%motion(size(p%load, 1), 0:size(p%load, 2)))
      sweeps%motion(:, 0) = 0.0_wp
      sweeps%motion(:, 1:) = move_blocks(p, force)
      allocate (sweeps%slip(size(p%joint)), source=0)
      way = sweeps
      last = 0.0_wp
      do k = 1, most
         before%force = sweeps%force
         before%motion = sweeps%motion
         call sweep(p, answer, modulo(k, 2) == 1, sweeps)
         square = square_of(p, sweeps%force - before%force)
         if (modulo(k, round) == 0 .or. k == most .or. .not. square > 0.0_wp) then
            now = residual_of(p, sweeps%force, sweeps%motion(:, 1:))
            if (now%energy < residual%energy) then
               force = sweeps%force
               residual = now
            end if
            if (residual%opening <= tolerance .or. .not. square > 0.0_wp) return
         end if
         call go_on(before, merge(square/last, 2.0_wp, last > 0.0_wp), way, sweeps)
         last = square
      end do
   end subroutine sweep_joints

   !> Square of a change of forces, over what the blocks give
   pure real(wp) function square_of(p, change)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: change(:, :)  !! The change: (3, n_joint) [N/m]
      integer :: i

      square_of = 0.0_wp
      do i = 1, size(change, 2)
         square_of = square_of + p%give(1, 1, i)*change(1, i)**2 + p%give(2, 2, i)*change(2, i)**2 &
            & + p%give(3, 3, i)*change(3, i)**2
      end do
   end function square_of

   !> Go on in the direction of the sweeps so far, unless the last has changed more than the one
   !> before
   pure subroutine go_on(before, ratio, way, sweeps)
      type(sweeps_t), intent(in) :: before     !! Forces and motion before the last sweep
      real(wp), intent(in) :: ratio            !! Square of what it has changed, over the last one's
      type(sweeps_t), intent(inout) :: way     !! The direction
      type(sweeps_t), intent(inout) :: sweeps  !! Forces and motion
      integer :: i, k
      real(wp) :: change

      if (ratio > 1.0_wp) then
         way%force = sweeps%force - before%force
         way%motion = sweeps%motion - before%motion
         return
      end if
      do i = 1, size(way%force, 2)
         do k = 1, 3
            change = sweeps%force(k, i) - before%force(k, i)
            call follow(ratio, change, way%force(k, i), sweeps%force(k, i))
         end do
      end do
      do i = 1, size(way%motion, 2) - 1
         do k = 1, size(way%motion, 1)
            change = sweeps%motion(k, i) - before%motion(k, i)
            call follow(ratio, change, way%motion(k, i), sweeps%motion(k, i))
         end do
      end do
   end subroutine go_on

   !> Follow one direction
   pure subroutine follow(ratio, change, way, at)
      real(wp), intent(in) :: ratio   !! Part of the direction so far
      real(wp), intent(in) :: change  !! The last change
      real(wp), intent(inout) :: way  !! The direction
      real(wp), intent(inout) :: at   !! Value that moves along it

      way = ratio*way
      at = at + way
      ! what fades away would become denormal
      if (abs(way) < sqrt(tiny(way))) way = 0.0_wp
      way = way + change
   end subroutine follow

   !> One sweep over the joints, forwards or backwards
   pure subroutine sweep(p, answer, forwards, sweeps)
      type(contact_problem_t), intent(in) :: p
      !> Motion of the blocks by a unit of each force: (n_dof, 3, 2, n_joint) [m/(N/m)]
      real(wp), intent(in), contiguous :: answer(:, :, :, :)
      logical, intent(in) :: forwards  !! True if forwards
      type(sweeps_t), intent(inout) :: sweeps
      integer :: i, k, n

      n = size(p%joint)
      do k = 1, n
         i = merge(k, n + 1 - k, forwards)
         call relax(size(p%load, 1), p, i, answer(:, :, :, i), sweeps%slip(i), &
            & sweeps%force(:, i), sweeps%motion)
      end do
   end subroutine sweep

   !> Let one joint take the forces that the law of contact asks for
   pure subroutine relax(n_dof, p, i, answer, slip, force, motion)
      integer, intent(in) :: n_dof            !! Unknowns of one block
      type(contact_problem_t), intent(in) :: p
      integer, intent(in) :: i                !! Number of the joint
      !> Motion of its blocks by a unit of each force: (n_dof, 3, 2) [m/(N/m)]
      real(wp), intent(in) :: answer(n_dof, 3, 2)
      integer, intent(inout) :: slip          !! Direction that it slid in
      real(wp), intent(inout) :: force(3)     !! Its forces: (3) [N/m]
      !> Motion of the blocks: (n_dof, 0:n_block) [m]
      real(wp), intent(inout) :: motion(n_dof, 0:*)
      type(joint_view_t) :: joint
      real(wp) :: before(3), found(3), opening(3)
      integer :: a, b
      logical :: solved

      a = p%block(1, i)
      b = p%block(2, i)
      opening = p%apart(:, i) + p%bar_give(:, i)*force
      call see(n_dof, p%row(:, :, 1, i), motion(:, a), opening)
      call see(n_dof, p%row(:, :, 2, i), motion(:, b), opening)
      before = force
      opening(1:2) = sign(max(0.0_wp, abs(opening(1:2)) - p%noise), opening(1:2))
      associate (cone => p%cone(i), shift => p%shift(:, i), give => p%give(:, :, i))
         if (.not. any(abs(force + shift) > 0.0_wp) .and. all(opening(1:2) >= 0.0_wp) &
            & .and. .not. cone%limit > 0.0_wp) return
         solved = .false.
         if (.not. any(p%bar_give(:, i) > 0.0_wp)) then
            joint%give = give
            joint%rest = opening - matmul(give, force + shift)
            joint%limit = cone%limit
            joint%friction = cone%friction
            joint%sticks = cone%kind == cone_kind%no_slip
            call answer_joint(joint, slip, found, solved)
            if (solved) force = found - shift
         end if
         if (.not. solved) call project_forces(p, i, opening, force)
      end associate
      call push(n_dof, answer(:, :, 1), force - before, motion(:, a))
      call push(n_dof, answer(:, :, 2), force - before, motion(:, b))
   end subroutine relax

   !> Let the forces of a joint take one after the other what each asks for
   pure subroutine project_forces(p, i, gap, force)
      type(contact_problem_t), intent(in) :: p
      integer, intent(in) :: i
      real(wp), intent(inout) :: gap(3)    !! Openings and slip, which follow: (3) [m]
      real(wp), intent(inout) :: force(3)
      real(wp) :: bound, wanted
      integer :: k

      do k = 1, 3
         if (.not. p%give(k, k, i) > 0.0_wp) cycle
         wanted = force(k) - gap(k)/p%give(k, k, i)
         if (k < 3) then
            wanted = max(-p%shift(k, i), wanted)
         else
            bound = shear_bound(p%cone(i), force + p%shift(:, i))
            wanted = max(-bound, min(bound, wanted))
         end if
         gap = gap + (wanted - force(k))*p%give(:, k, i)
         force(k) = wanted
      end do
   end subroutine project_forces

   !> Add to openings and slip what one block brings
   pure subroutine see(n_dof, row, motion, opening)
      integer, intent(in) :: n_dof
      real(wp), intent(in) :: row(n_dof, 3)     !! Rows of the joint for its unknowns
      real(wp), intent(in) :: motion(n_dof)     !! Its motion [m]
      real(wp), intent(inout) :: opening(3)     !! Openings and slip: (3) [m]
      integer :: i, k

      ! three unknowns at a time, so that the length is constant
      do i = 1, n_dof, 3
         do k = 1, 3
            opening(k) = opening(k) + row(i, k)*motion(i) + row(i + 1, k)*motion(i + 1) &
               & + row(i + 2, k)*motion(i + 2)
         end do
      end do
   end subroutine see

   !> Let one block answer a change of the joint's forces
   pure subroutine push(n_dof, answer, change, motion)
      integer, intent(in) :: n_dof
      real(wp), intent(in) :: answer(n_dof, 3)  !! Its motion by a unit of each force
      real(wp), intent(in) :: change(3)         !! The change: (3) [N/m]
      real(wp), intent(inout) :: motion(n_dof)
      integer :: i, k

      do i = 1, n_dof, 3
         do k = i, i + 2
            motion(k) = motion(k) + answer(k, 1)*change(1) + answer(k, 2)*change(2) &
               & + answer(k, 3)*change(3)
         end do
      end do
   end subroutine push

end module dda_contact_sweeps
