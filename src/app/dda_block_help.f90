!> dda help blocks: the format of a file of blocks
module dda_block_help
   implicit none
   private

   public :: on_blocks

   !> The page, line by line
   character(len=*), parameter :: on_blocks(*) = [character(len=96) :: &
      & "A file of blocks (scene%kind = 'blocks', scene%geometry = 'FILE') is plain text in", &
      & "UTF-8: one entry per line, with rows of numbers below it. Blanks separate words, case", &
      & "is ignored, and ! starts a comment. Units are SI per metre of depth.", &
      & "", &
      & "   block fixed              ! never moves", &
      & "   -1 -1", &
      & "    2 -1", &
      & "    2  0", &
      & "   -1  0", &
      & "   block material 2", &
      & "    0  0", &
      & "    1  0", &
      & "    1  2", &
      & "    0  2", &
      & "   material 2 density 2500 young 1e10", &
      & "   joint 1 2 friction_deg 35", &
      & "", &
      & "block [fixed] [material N] [velocity vx vy w] [stress sx sy txy]", &
      & "   A polygon; rows x y of its corners [m] follow. Velocity [m/s], spin [rad/s], stress", &
      & "   [Pa].", &
      & "material N [density d] [unit_weight w] [young e] [poisson p] [compressive_strength s]", &
      & "   Material N from 2. Material 1 and omitted values are those of the deck.", &
      & "joint I J [friction_deg f] [cohesion c] [tension t] [residual_deg r] [slip_length d]", &
      & "   Law of the joints between materials I and J.", &
      & "fix x y [x or y]", &
      & "   Restraint of a point, in one direction if named.", &
      & "fix_line x1 y1 x2 y2 [x or y]", &
      & "   Restraints at both ends of the part of the line in each block.", &
      & "measure x y", &
      & "   Monitoring point, for points.csv.", &
      & "load x y fx fy", &
      & "   Dead load on a point [N/m]; instead of fx fy, rows time fx fy may follow.", &
      & "load block N x y fx fy", &
      & "   Dead load on block N. live, fix, measure and displacement accept block N as well.", &
      & "live x y fx fy", &
      & "   Live load, multiplied by load%load_factor.", &
      & "displacement x y ux uy", &
      & "   Prescribed displacement [m], or rows time ux uy; load%displacement_factor scales it.", &
      & "bar x1 y1 x2 y2 stiffness S [strength T] [prestress P] [slack] [breaks]", &
      & "   Bolt, anchor or tie [N/m, N]; `ea V` instead of stiffness is divided by the length.", &
      & "water x y x y ... [unit_weight W] [factor F]", &
      & "   Piezometric line from left to right; rows time rise may follow.", &
      & "absorb x1 y1 x2 y2 [x or y] [p_speed V] [s_speed V]", &
      & "   Absorbing boundary along the faces on a line (mode = 'dynamic').", &
      & "remove block N ... at T, add block N ... at T", &
      & "   Blocks removed or built at time T [s]; `polygon` and rows x y select them by their", &
      & "   centre of gravity.", &
      & "base_acceleration ax ay", &
      & "   Ground acceleration [m/s2], or rows time ax ay.", &
      & "base_velocity, base_displacement", &
      & "   Ground motion [m/s, m]: rows time x y.", &
      & "", &
      & "Instead of rows of times: file 'RECORD' [columns T X [Y]] [scale S]. Columns are", &
      & "numbers from 1 or names of the header, in quotes if they contain blanks.", &
      & "Draw the file: 'voussoir plot FILE.blocks'. The key: 'dda help output%blocks'."]
end module dda_block_help
