!> Proofs of a case as rows of proof_forces.csv and proof_motion.csv
module dda_proof_rows
   use dda_bar_joints, only : bar_joint
   use dda_contacts, only : joint_place
   use dda_growing_text, only : add_line, fields, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_search, only : proof_t
   use dda_text, only : to_text
   implicit none
   private

   public :: proof_forces_header, proof_forces_lines, proof_motion_header, proof_motion_lines

   !> Names of the columns of proof_forces.csv
   character(len=*), parameter :: proof_forces_header = &
      & "case,value,kind,block_1,block_2,x_1,y_1,x_2,y_2,normal_1,normal_2,shear"
   !> Names of the columns of proof_motion.csv
   character(len=*), parameter :: proof_motion_header = "case,value,block,x,y,u,v,spin"

contains

   !> Forces that carry the load: of joints, at their two corners and along them on the second
   !> block; of held points, along x and y
   pure function proof_forces_lines(number, value, proof) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      !> Value of what is searched as text; empty if nothing is
      character(len=*), intent(in) :: value
      type(proof_t), intent(in) :: proof
      !> Rows, parted by line ends
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      character(len=:), allocatable :: start
      integer :: j, n

      lines = ""
      if (.not. allocated(proof%force)) return
      start = to_text(number)//","//value//","
      n = size(proof%scene%contacts%joint)
      do j = 1, n
         associate (joint => proof%scene%contacts%joint(j), &
            & place => joint_place(proof%scene%system, proof%scene%contacts, j))
            call add_line(rows, start//"contact,"//to_text(joint%block(1))//"," &
               & //to_text(joint%block(2))//","//fields([place%point(:, 1) &
               & + proof%scene%origin, place%point(:, joint%n_contact) &
               & + proof%scene%origin, proof%force(:, j)]))
         end associate
      end do
      call add_held(start, proof, n, rows)
      call add_bounded(start, proof, n, rows)
      call add_bars(start, proof, rows)
      lines = lines_of(rows)
   end function proof_forces_lines

   !> Rows of the forces of held points
   pure subroutine add_held(start, proof, n, rows)
      !> First fields of a row
      character(len=*), intent(in) :: start
      type(proof_t), intent(in) :: proof
      !> Number of the last joint before them; theirs are added
      integer, intent(inout) :: n
      type(growing_text_t), intent(inout) :: rows
      real(wp) :: force(3)
      integer :: i

      if (.not. allocated(proof%scene%settings%boundary%held)) return
      do i = 1, size(proof%scene%settings%boundary%held)
         associate (held => proof%scene%settings%boundary%held(i))
            if (proof%scene%system%equation(held%block) == 0) cycle
            n = n + 1
            force = [proof%force(1, n), proof%force(3, n), 0.0_wp]
            ! one that holds along one axis does so by both of its forces
            if (.not. held%along(1)) force = [0.0_wp, sum(force), 0.0_wp]
            if (.not. held%along(2)) force = [sum(force), 0.0_wp, 0.0_wp]
            call add_line(rows, start//"held,0,"//to_text(held%block)//"," &
               & //fields([held%point + proof%scene%origin, held%point + proof%scene%origin, &
               & force]))
         end associate
      end do
   end subroutine add_held

   !> Rows of bounded forces, along x and y, with the bound as the third; empty without one
   pure subroutine add_bounded(start, proof, n, rows)
      character(len=*), intent(in) :: start
      type(proof_t), intent(in) :: proof
      integer, intent(inout) :: n
      type(growing_text_t), intent(inout) :: rows
      character(len=:), allocatable :: line
      integer :: i

      if (.not. allocated(proof%scene%settings%boundary%bounded)) return
      do i = 1, size(proof%scene%settings%boundary%bounded)
         associate (bounded => proof%scene%settings%boundary%bounded(i))
            n = n + 1
            line = start//"bounded,0,"//to_text(bounded%block)//"," &
               & //fields([bounded%point + proof%scene%origin, bounded%point &
               & + proof%scene%origin, proof%force(1, n)*bounded%direction])//","
            if (bounded%most < huge(bounded%most)) then
               ! then come the stop and the guide of its carrier
               n = n + 2
               line = line//to_text(bounded%most)
            end if
         end associate
         call add_line(rows, line)
      end do
   end subroutine add_bounded

   !> Rows of bars: the force that pulls their ends together
   pure subroutine add_bars(start, proof, rows)
      character(len=*), intent(in) :: start
      type(proof_t), intent(in) :: proof
      type(growing_text_t), intent(inout) :: rows
      integer :: i, j

      associate (scene => proof%scene)
         if (.not. allocated(scene%settings%boundary%bar)) return
         do i = 1, size(scene%settings%boundary%bar)
            j = bar_joint(scene%settings, size(proof%force, 2), i)
            associate (bar => scene%settings%boundary%bar(i))
               call add_line(rows, start//"bar,"//to_text(bar%block(1))//"," &
                  & //to_text(bar%block(2))//","//fields([bar%point(:, 1) + scene%origin, &
                  & bar%point(:, 2) + scene%origin, proof%force(1, j)])//",,")
            end associate
         end do
      end associate
   end subroutine add_bars

   !> Velocities of the mechanism: of the centres of blocks that move, and their spins
   pure function proof_motion_lines(number, value, proof) result(lines)
      integer, intent(in) :: number
      character(len=*), intent(in) :: value
      type(proof_t), intent(in) :: proof
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      integer :: b, e

      lines = ""
      if (.not. (allocated(proof%velocity) .and. proof%same_shape)) return
      do b = 1, size(proof%scene%system%equation)
         e = proof%scene%system%equation(b)
         if (e == 0) cycle
         call add_line(rows, to_text(number)//","//value//","//to_text(b)//"," &
            & //fields([proof%scene%system%centroid(:, b) + proof%scene%origin, &
            & proof%velocity(1:3, e)]))
      end do
      lines = lines_of(rows)
   end function proof_motion_lines
end module dda_proof_rows
