!> Results as CSV: headers and rows of cases, joints, blocks, energy and reactions (Shi: df27)
module dda_write_results
   use dda_kinds, only : wp
   use dda_text, only : add_line, fields, growing_text_t, lines_of, print_number, to_text
   implicit none
   private

   public :: block_lines, blocks_header, energy_header, energy_lines, reaction_lines
   public :: reactions_header, told_blocks_t, result_row_t, joint_row_t, number_t, some_number
   public :: results_header, results_line, joints_header, joint_line

   !> The blocks of one case
   type :: told_blocks_t
      !> First corner of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> State: fixed, held (by points) or free: (n_block)
      character(len=5), allocatable :: state(:)
      !> Initial corners in user coordinates: (2, n_vertex) [m]
      real(wp), allocatable :: corner(:, :)
      !> Final displacements of the corners, or a collapse mechanism scaled to a largest
      !> displacement of 1; unallocated if not known: (2, n_vertex) [m]
      real(wp), allocatable :: displacement(:, :)
   end type told_blocks_t

   !> Names of the columns of blocks.csv
   character(len=*), parameter :: blocks_header = "case,block,state,vertex,x,y,u,v"

   !> Names of the columns
   character(len=*), parameter :: energy_header = &
      & "case,step,time,kinetic,elastic,contact,gravity,work,friction,damping,impact,numerical," &
      & //"contact_residual"

   !> Names of the columns
   character(len=*), parameter :: reactions_header = "case,time,block,point,fx,fy,moment"

   !> A number that may be unknown
   type :: number_t
      logical :: known = .false.  !! True if it is known
      real(wp) :: value = 0.0_wp  !! The number
   end type number_t

   !> One row of results.csv
   type :: result_row_t
      character(len=:), allocatable :: deck  !! Name of the deck
      integer :: number = 0                  !! Number of the case, from 1
      !> Values of the swept parameters without their own column: (n)
      character(len=:), allocatable :: swept
      integer :: blocks = 0              !! Movable blocks
      type(number_t) :: half_angle_deg   !! Angle from the crown to a springing [deg]
      type(number_t) :: thickness_ratio  !! Thickness over radius
      type(number_t) :: friction_deg     !! Friction angle [deg]
      character(len=64) :: mode = ""                  !! static or dynamic
      character(len=64) :: geometry = ""              !! reference or current
      character(len=10) :: verdict = ""               !! Verdict in one word
      type(number_t) :: critical       !! Critical value: middle of the bracket
      type(number_t) :: critical_low   !! Lower end of the bracket
      type(number_t) :: critical_high  !! Upper end of the bracket
      character(len=4) :: collapses_at = ""           !! Collapsed end of the bracket: low or high
      type(number_t) :: exact           !! The exact value
      type(number_t) :: relative_error  !! (critical - exact)/exact
      character(len=10) :: collapse_mode = ""         !! rotational, mixed, sliding or none
      type(number_t) :: sliding_share                 !! Slip over slip and opening
      real(wp), allocatable :: intrados_hinge_deg(:)  !! Hinges at the intrados [deg]: (n)
      real(wp), allocatable :: extrados_hinge_deg(:)  !! Hinges at the extrados [deg]: (n)
      !> intrados, extrados or none; blank for other structures
      character(len=8) :: springing_hinge = ""
      integer :: steps = 0  !! Time steps
      integer :: open_close_iterations = 0  !! Open-close iterations
      integer :: factorisations = 0  !! Factorisations
      real(wp) :: seconds = 0.0_wp   !! Wall time of the case [s]
      integer :: unknowns = 0        !! Unknowns of a block in the decisions
      type(number_t) :: exact_low    !! Lower bound of the associated critical value, certified
      type(number_t) :: exact_high   !! Upper bound, likewise
      !> Largest unbalanced force or moment on a block in the certificate, over the largest load
      type(number_t) :: imbalance
      !> Largest relative violation of a joint law in the certificate
      type(number_t) :: law_violation
      !> Power of the loads on the mechanism of the certificate, over its upper limit
      type(number_t) :: mechanism_power
      type(number_t) :: safety_thickness  !! Thickness of a stable arch over its critical thickness
      !> Smallest and largest thrust of a joint of a stable structure [N/m]
      type(number_t) :: thrust_min, thrust_max
      type(number_t) :: path_time       !! Time reached on the histories of a static run [s]
      type(number_t) :: worst_position  !! Worst position of the leftmost axle of a vehicle [m]
      character(len=8) :: worst_direction = ""  !! forward, backward; blank without a worst position
      !> Largest opening or slip rate that violates the contact law in a dynamic run [m/s]
      type(number_t) :: contact_residual
      logical :: tells_condition = .false.  !! True if the table has a column of condition numbers
      type(number_t) :: condition           !! Estimated condition number of the last equations
   end type result_row_t

   !> One row of joints.csv
   type :: joint_row_t
      integer :: number = 0  !! Number of the case, from 1
      integer :: joint = 0   !! Number of the joint, from 1 at the left springing
      !> Angle from the crown, positive to the right; unknown for other structures [deg]
      type(number_t) :: angle_deg
      real(wp) :: intrados(2) = 0.0_wp   !! Corner at the intrados: (2) [m]
      real(wp) :: extrados(2) = 0.0_wp   !! Corner at the extrados: (2) [m]
      real(wp) :: normal_force = 0.0_wp  !! Force on the joint, compression positive [N/m]
      !> Force along the joint on its right block, towards the extrados [N/m]
      real(wp) :: shear_force = 0.0_wp
      !> Position of the thrust: 1 at the intrados, -1 at the extrados; unknown without normal force
      !> and for a joint with one corner
      type(number_t) :: eccentricity_ratio
      real(wp) :: opening_intrados = 0.0_wp  !! Opening at the intrados [m]
      !> Opening at the extrados; unknown for a joint with one corner [m]
      type(number_t) :: opening_extrados
      !> Motion of the right block along the joint, towards the extrados [m]
      real(wp) :: slip = 0.0_wp
      character(len=14) :: state = ""  !! State of the joint in one word
      integer :: block(2) = 0          !! Its two blocks: (2)
      !> Point of application of the force; without force, the middle of the joint: (2) [m]
      real(wp) :: point(2) = 0.0_wp
      real(wp) :: force(2) = 0.0_wp            !! Force on the second block: (2) [N/m]
      character(len=14) :: mechanism = "none"  !! State in the collapse mechanism in one word
      !> Unit vector of the slip of the second block relative to the first, unknown without
      !> slip: (2)
      type(number_t) :: slides(2)
   end type joint_row_t

   !> Names of the columns of joints.csv
   character(len=*), parameter :: joints_header = &
      & "case,joint,angle_deg,x_intrados,y_intrados,x_extrados,y_extrados,normal_force," &
      & //"shear_force,eccentricity_ratio,opening_intrados,opening_extrados,slip,state," &
      & //"block_1,block_2,x,y,force_x,force_y,mechanism,slides_x,slides_y"

contains

   !> Rows of the blocks of one case in blocks.csv
   pure function block_lines(number, blocks) result(lines)
      integer, intent(in) :: number  !! Number of the case
      type(told_blocks_t), intent(in) :: blocks
      character(len=:), allocatable :: lines
      character(len=:), allocatable :: common
      type(growing_text_t) :: rows
      integer :: b, v

      do b = 1, size(blocks%state)
         if (blocks%state(b) == "") cycle
         common = to_text(number)//","//to_text(b)//","//trim(blocks%state(b))//","
         do v = blocks%first_vertex(b), blocks%first_vertex(b + 1) - 1
            if (allocated(blocks%displacement)) then
               call add_line(rows, common//fields([real(v - blocks%first_vertex(b) + 1, wp), &
                  & blocks%corner(:, v), blocks%displacement(:, v)]))
            else
               call add_line(rows, common//to_text(v - blocks%first_vertex(b) + 1)//"," &
                  & //fields(blocks%corner(:, v))//",,")
            end if
         end do
      end do
      lines = lines_of(rows)
   end function block_lines

   !> Rows of one case in energy.csv
   pure function energy_lines(number, value) result(lines)
      integer, intent(in) :: number
      !> Time and energies after each step, in the order of the columns: (11, n_step) [s, J per
      !> metre, m/s]
      real(wp), intent(in) :: value(:, :)
      character(len=:), allocatable :: lines
      type(growing_text_t) :: text
      integer :: k

      do k = 1, size(value, 2)
         call add_line(text, to_text(number)//","//to_text(k)//","//fields(value(:, k)))
      end do
      lines = lines_of(text)
   end function energy_lines

   !> Rows of one case in reactions.csv
   pure function reaction_lines(number, time, support, reaction, origin) result(lines)
      integer, intent(in) :: number
      real(wp), intent(in) :: time(:)       !! The times: (n_time) [s]
      integer, intent(in) :: support(:, :)  !! Block, and restrained point or 0: (2, n)
      !> Force, and moment about the origin of the coordinates: (3, n, n_time) [N/m, N/m, N]
      real(wp), intent(in) :: reaction(:, :, :)
      real(wp), intent(in) :: origin(2)  !! Origin in user coordinates: (2) [m]
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      real(wp) :: moment
      integer :: i, k

      do k = 1, size(time)
         do i = 1, size(support, 2)
            associate (r => reaction(:, i, k))
               moment = r(3) + origin(1)*r(2) - origin(2)*r(1)
               call add_line(rows, to_text(number)//","//to_text(time(k))//"," &
                  & //to_text(support(1, i))//","//to_text(support(2, i))//"," &
                  & //fields([r(1:2), moment]))
            end associate
         end do
      end do
      lines = lines_of(rows)
   end function reaction_lines

   !> Make a known number
   elemental type(number_t) function some_number(value)
      real(wp), intent(in) :: value  !! The value

      some_number = number_t(.true., value)
   end function some_number

   !> Header of results.csv
   pure function results_header(swept, tells_condition) result(line)
      !> Names of the swept parameters without their own column, each followed by a comma
      character(len=*), intent(in) :: swept
      logical, intent(in) :: tells_condition  !! True if the table has a column of condition numbers
      character(len=:), allocatable :: line

      line = "deck,case,"//swept//"blocks,half_angle_deg,thickness_ratio,friction_deg,mode," &
         & //"geometry,verdict,critical,critical_low,critical_high,collapses_at,exact," &
         & //"relative_error,collapse_mode,sliding_share,intrados_hinge_deg,extrados_hinge_deg," &
         & //"springing_hinge,steps,open_close_iterations,factorisations,seconds,unknowns," &
         & //"exact_low,exact_high,imbalance,law_violation,mechanism_power,safety_thickness," &
         & //"thrust_min,thrust_max,path_time,worst_position,worst_direction"
      if (tells_condition) line = line//",condition"
      line = line//",contact_residual"
   end function results_header

   !> One row of results.csv
   pure function results_line(row) result(line)
      type(result_row_t), intent(in) :: row
      character(len=:), allocatable :: line

      line = quoted(row%deck)//","//to_text(row%number)//","//row%swept//to_text(row%blocks) &
         & //","//number_fields([row%half_angle_deg, row%thickness_ratio, row%friction_deg])//"," &
         & //trim(row%mode)//","//trim(row%geometry)//","//trim(row%verdict)//"," &
         & //number_fields([row%critical, row%critical_low, row%critical_high])//"," &
         & //trim(row%collapses_at)//","//number_fields([row%exact, row%relative_error])//"," &
         & //trim(row%collapse_mode)//","//number_fields([row%sliding_share])//"," &
         & //joined(row%intrados_hinge_deg)//","//joined(row%extrados_hinge_deg)//"," &
         & //trim(row%springing_hinge)//","//to_text(row%steps)//"," &
         & //to_text(row%open_close_iterations)//","//to_text(row%factorisations)//"," &
         & //to_text(row%seconds)//","//to_text(row%unknowns)//"," &
         & //number_fields([row%exact_low, row%exact_high, row%imbalance, row%law_violation, &
         & row%mechanism_power, row%safety_thickness, row%thrust_min, row%thrust_max, &
         & row%path_time, row%worst_position])//","//trim(row%worst_direction)
      if (row%tells_condition) line = line//","//number_fields([row%condition])
      line = line//","//number_fields([row%contact_residual])
   end function results_line

   !> One row of joints.csv
   pure function joint_line(row) result(line)
      type(joint_row_t), intent(in) :: row
      character(len=:), allocatable :: line

      line = number_fields([some_number(real([row%number, row%joint], wp)), row%angle_deg, &
         & some_number([row%intrados, row%extrados, row%normal_force, row%shear_force]), &
         & row%eccentricity_ratio, some_number(row%opening_intrados), row%opening_extrados, &
         & some_number(row%slip)])//","//trim(row%state)//"," &
         & //fields([real(row%block, wp), row%point, row%force])//","//trim(row%mechanism)//"," &
         & //number_fields(row%slides)
   end function joint_line

   !> Numbers separated by commas, empty fields for unknown ones
   pure function number_fields(number) result(text)
      type(number_t), intent(in) :: number(:)  !! The numbers: (n)
      character(len=:), allocatable :: text
      character(len=33*size(number)) :: buffer
      integer :: i, k, n

      n = 0
      do i = 1, size(number)
         if (number(i)%known) then
            call print_number(number(i)%value, buffer(n + 1:n + 32), k)
            n = n + k
         end if
         n = n + 1
         buffer(n:n) = ","
      end do
      text = buffer(:n - 1)
   end function number_fields

   !> Angles separated by semicolons, rounded to remove round-off
   pure function joined(angles) result(text)
      real(wp), intent(in), allocatable :: angles(:)  !! The angles: (:) [deg]
      character(len=:), allocatable :: text
      integer :: i

      text = ""
      if (.not. allocated(angles)) return
      do i = 1, size(angles)
         if (i > 1) text = text//";"
         text = text//to_text(anint(angles(i)*1.0e9_wp)/1.0e9_wp)
      end do
   end function joined

   !> A text as a field of CSV, in quotes if necessary
   pure function quoted(text) result(field)
      character(len=*), intent(in) :: text  !! Any text
      character(len=:), allocatable :: field
      integer :: i

      field = text
      if (scan(text, ",;"""//achar(10)//achar(13)) == 0) return
      field = ""
      do i = 1, len(text)
         if (text(i:i) == """") field = field//""""
         field = field//text(i:i)
      end do
      field = """"//field//""""
   end function quoted

end module dda_write_results
