!> Contact forces with fixed states: open, sliding or locked
!>
!> With the faces known, forces and motion are one solution of linear equations. Near the answer,
!> as where a structure goes on standing or moving as it did, that ends after one factorisation or a
!> few and leaves rounding; far from it, it ends without. Each force is tied to that of the last
!> step by a spring far firmer than the blocks: of all forces that stop them the nearest are found.
module dda_contact_faces
   use dda_contact_problem, only : admissible, contact_problem_t, move_blocks, openings, &
      & residual_of, residual_t
   use dda_block_factor, only : substitute
   use dda_friction_cone, only : cone_kind, joint_face_t, shear_bound
   use dda_joint_matrix, only : add_row_forces, factor_joints, joint_matrix_t, row_openings, &
      & lay_out_joints
   use dda_kinds, only : wp
   implicit none
   private

   public :: settle_faces

   !> Compliance of the regularisation over that of the blocks
   real(wp), parameter :: compliance = 1.0e-4_wp
   !> Maximum number of solutions, and of those with changed states
   integer, parameter :: max_turns = 24, max_passes = 8

contains

   !> Find forces that agree with their faces, from those at hand if these are near; better ones are
   !> kept
   pure subroutine settle_faces(p, tolerance, near, before, springs, force, residual, passes)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: tolerance       !! Openings against the law that are left [m]
      real(wp), intent(in) :: near            !! Residual of forces that are near [m]
      real(wp), intent(in) :: before(:, :)    !! Forces of the last step: (3, n_joint) [N/m]
      type(joint_matrix_t), intent(inout) :: springs  !! Laid out for the joints, or empty
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      integer, intent(inout) :: passes        !! Factorisations so far
      type(joint_face_t), dimension(size(p%joint)) :: face, held
      real(wp), dimension(3, size(p%joint)) :: centre, now
      real(wp) :: stiff(3, 3, size(p%joint)), motion(size(p%load, 1), size(p%load, 2)), left
      integer :: changes, i, last, pass, turn
      logical :: stale, changed(0:size(p%load, 2))

      if (residual%opening <= tolerance .or. residual%opening > near) return
      if (.not. allocated(springs%entry)) call lay_out_joints(p%block, size(p%load, 1), &
         & size(p%load, 2), .false., springs%matrix, springs%factor, springs%entry)
      now = force
      centre = before
      motion = move_blocks(p, now)
      call read_faces(p, now, motion, face)
      last = size(face)
      changes = size(face)
      pass = 0
      left = huge(left)
      do turn = 1, max_turns
         if (changes > 0) then
            if (pass == max_passes) return
            pass = pass + 1
            passes = passes + 1
            call set_springs(p, face, stiff)
            changed = pass == 1
            do i = 1, merge(0, size(face), pass == 1)
               if (face(i)%slip /= held(i)%slip .or. any(face(i)%open .neqv. held(i)%open)) &
                  & changed(p%block(:, i)) = .true.
            end do
            held = face
            call factor_joints(p%base, p%block, p%row, stiff, springs, changed(1:))
            if (.not. springs%factor%usable) return
         end if
         call take_faces(p, face, now)
         call solve_faces(p, springs, stiff, centre, now, motion)
         call change_faces(p, tolerance, now, motion, face, changes)
         if (changes > 0) then
            if (2*changes > last) return
            last = changes
            cycle
         end if
         call keep_better(p, face, now, force, residual, left, stale)
         if (residual%opening <= tolerance .or. stale) return
         centre = now
      end do
   end subroutine settle_faces

   !> Keep forces on their faces if they have the smaller residual
   pure subroutine keep_better(p, face, now, force, residual, opening, stale)
      type(contact_problem_t), intent(in) :: p
      type(joint_face_t), intent(in) :: face(:)    !! Faces: (n_joint)
      real(wp), intent(in) :: now(:, :)            !! Other forces: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)       !! The best so far: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of these
      real(wp), intent(inout) :: opening  !! Residual of the turn before in, of this out [m]
      logical, intent(out) :: stale                !! True if less than half of it has gone
      type(residual_t) :: left
      real(wp) :: trial(3, size(face))

      trial = now
      call take_faces(p, face, trial)
      trial = admissible(p, trial)
      left = residual_of(p, trial, move_blocks(p, trial))
      stale = left%opening > opening/2.0_wp
      opening = left%opening
      if (.not. left%energy < residual%energy) return
      force = trial
      residual = left
   end subroutine keep_better

   !> The faces that forces and openings speak for
   pure subroutine read_faces(p, force, motion, face)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)         !! The forces: (3, n_joint) [N/m]
      real(wp), intent(in) :: motion(:, :)        !! The motion: (n_dof, n_block) [m]
      type(joint_face_t), intent(out) :: face(:)  !! The faces: (n_joint)
      real(wp) :: opening(3, size(p%joint)), pushed(3)
      integer :: i, k

      opening = openings(p, force, motion)
      do i = 1, size(face)
         pushed = force(:, i) + p%shift(:, i)
         do k = 1, 3
            if (p%give(k, k, i) > 0.0_wp) pushed(k) = pushed(k) - opening(k, i)/p%give(k, k, i)
         end do
         do k = 1, 2
            face(i)%open(k) = .not. (p%give(k, k, i) > 0.0_wp .and. pushed(k) > 0.0_wp)
         end do
         if (abs(pushed(3)) > shear_bound(p%cone(i), max(0.0_wp, &
            & force(:, i) + p%shift(:, i))) .or. all(face(i)%open)) &
            & face(i)%slip = merge(1, -1, pushed(3) > 0.0_wp)
         if (.not. p%give(3, 3, i) > 0.0_wp) face(i)%slip = 0
      end do
   end subroutine read_faces

   !> Springs that hold the joints on their faces
   pure subroutine set_springs(p, face, stiffness)
      type(contact_problem_t), intent(in) :: p
      type(joint_face_t), intent(in) :: face(:)
      real(wp), intent(out) :: stiffness(:, :, :)  !! Stiffness of the joints: (3, 3, n_joint)
      integer :: i, k

      stiffness = 0.0_wp
      do i = 1, size(face)
         associate (stiff => stiffness(:, :, i))
            do k = 1, 2
               if (face(i)%open(k)) cycle
               stiff(k, k) = firmness(p, k, i)
               stiff(3, k) = real(face(i)%slip, wp)*p%cone(i)%friction*stiff(k, k)
            end do
            if (face(i)%slip == 0 .and. p%give(3, 3, i) > 0.0_wp) stiff(3, 3) = firmness(p, 3, i)
         end associate
      end do
   end subroutine set_springs

   !> Stiffness of the spring of one force
   pure real(wp) function firmness(p, k, i)
      type(contact_problem_t), intent(in) :: p
      integer, intent(in) :: k, i  !! The force and the joint

      firmness = 1.0_wp/(p%bar_give(k, i) + tie(p, k, i))
   end function firmness

   !> Compliance that ties a force to the one before; bars have their own
   pure real(wp) function tie(p, k, i)
      type(contact_problem_t), intent(in) :: p
      integer, intent(in) :: k, i

      tie = merge(0.0_wp, compliance*p%give(k, k, i), p%bar_give(k, i) > 0.0_wp)
   end function tie

   !> Put the forces onto their faces
   pure subroutine take_faces(p, face, force)
      type(contact_problem_t), intent(in) :: p
      type(joint_face_t), intent(in) :: face(:)
      real(wp), intent(inout) :: force(:, :)
      integer :: i

      do i = 1, size(face)
         associate (shift => p%shift(:, i), f => force(:, i))
            where (face(i)%open) f(1:2) = -shift(1:2)
            if (face(i)%slip /= 0) f(3) = face(i)%slip*shear_bound(p%cone(i), f + shift)
         end associate
      end do
   end subroutine take_faces

   !> Forces on their faces and the motion that they make
   pure subroutine solve_faces(p, springs, stiff, centre, force, motion)
      type(contact_problem_t), intent(in) :: p
      type(joint_matrix_t), intent(in) :: springs       !! Factor of the springs
      real(wp), intent(in) :: stiff(:, :, :)            !! Their stiffness: (3, 3, n_joint)
      real(wp), intent(in) :: centre(:, :)              !! Nearest forces: (3, n_joint) [N/m]
      real(wp), intent(inout), contiguous :: force(:, :)   !! Forces on their faces
      real(wp), intent(inout), contiguous :: motion(:, :)  !! The motion: (n_dof, n_block) [m]
      real(wp) :: step(size(motion, 1), size(motion, 2))
      real(wp), dimension(3, size(force, 2)) :: change, lack, opening
      integer :: b, i, k

      lack = -openings(p, force, motion)
      do i = 1, size(force, 2)
         do k = 1, 3
            lack(k, i) = lack(k, i) - tie(p, k, i)*(force(k, i) - centre(k, i))
         end do
         change(:, i) = force(:, i) + matmul(stiff(:, :, i), lack(:, i))
      end do
      step = p%load
      call add_row_forces(size(step, 1), size(force, 2), p%block, p%row, change, step)
      do b = 1, size(step, 2)
         step(:, b) = step(:, b) - matmul(p%base(:, :, b), motion(:, b))
      end do
      call substitute(springs%factor, step)
      call row_openings(size(step, 1), size(force, 2), p%block, p%row, step, opening)
      do i = 1, size(force, 2)
         force(:, i) = force(:, i) + matmul(stiff(:, :, i), lack(:, i) - opening(:, i))
      end do
      motion = motion + step
   end subroutine solve_faces

   !> Let joints that disagree with their faces change them
   pure subroutine change_faces(p, tolerance, force, motion, face, changes)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: tolerance, force(:, :), motion(:, :)
      type(joint_face_t), intent(inout) :: face(:)
      integer, intent(out) :: changes  !! Number of forces that disagree
      real(wp) :: excess, normal(3), opening(3, size(p%joint))
      logical :: sticks
      integer :: i, k

      changes = 0
      opening = openings(p, force, motion)
      do i = 1, size(face)
         normal = force(:, i) + p%shift(:, i)
         do k = 1, 2
            if (.not. p%give(k, k, i) > 0.0_wp) cycle
            if (merge(opening(k, i), p%give(k, k, i)*normal(k), face(i)%open(k)) &
               & >= -tolerance - p%noise) cycle
            face(i)%open(k) = .not. face(i)%open(k)
            changes = changes + 1
         end do
         if (.not. p%give(3, 3, i) > 0.0_wp) cycle
         excess = p%give(3, 3, i)*(abs(force(3, i)) &
            & - min(shear_bound(p%cone(i), max(0.0_wp, normal)), 2.0_wp*abs(force(3, i))))
         sticks = p%cone(i)%kind == cone_kind%no_slip
         if (all(face(i)%open)) then
            if (face(i)%slip == 0) changes = changes + 1
            if (face(i)%slip == 0) face(i)%slip = 1
         else if (face(i)%slip == 0 .and. excess > tolerance) then
            face(i)%slip = merge(1, -1, force(3, i) > 0.0_wp)
            changes = changes + 1
         else if (face(i)%slip*opening(3, i) > tolerance .or. sticks .and. face(i)%slip /= 0) then
            ! what cannot slide does not go on as it did while it was open
            face(i)%slip = 0
            changes = changes + 1
         end if
      end do
   end subroutine change_faces

end module dda_contact_faces
