!> What the user should know of a case beside its row
submodule (dda_case_rows) dda_case_remarks
   implicit none

   !> A block moves in a collapse if it goes this share of the way of the one that goes farthest
   real(wp), parameter :: moves = 1.0e-3_wp
   !> Most blocks that are named
   integer, parameter :: most_named = 5

contains

   !> Which blocks fall, where most of them stay
   module procedure fall_remark
      real(wp) :: way(size(system%equation))
      integer :: b, e, i, n

      remark = before
      way = 0.0_wp
      do b = 1, size(way)
         e = system%equation(b)
         if (e > 0 .and. e <= size(motion, 2)) way(b) = norm2(motion(1:2, e)) &
            & + abs(motion(3, e))*sqrt(system%area(b))
      end do
      n = count(way > moves*maxval(way))
      if (n == 0 .or. 3*n > count(system%equation > 0)) return
      if (len(remark) > 0) remark = remark//"; "
      remark = remark//"of "//to_text(count(system%equation > 0))//" blocks "//to_text(n)//" move:"
      do i = 1, min(n, most_named)
         b = maxloc(way, dim=1)
         way(b) = -1.0_wp
         if (i > 1) remark = remark//","
         remark = remark//" "//to_text(b)
      end do
      if (n > most_named) remark = remark//" and others"
   end procedure fall_remark

   !> What the user should know of the path of a static run
   module procedure path_remark
      remark = before
      if (outcome%verdict /= verdict%stable) then
         if (len(remark) > 0) remark = remark//"; "
         remark = remark//trim(merge("the blocks collapse at     ", "equilibrium is proven up to", &
            & outcome%verdict == verdict%collapsed))
         if (outcome%path_time < 0.0_wp) then
            remark = remark//" "//to_text(1.0_wp + outcome%path_time) &
               & //" of the prescribed displacement"
         else
            remark = remark//" time "//to_text(outcome%path_time)
         end if
      end if
      remark = order_remark(outcome, remark)
   end procedure path_remark

   !> Why forces after stages are not those of the last shape built at once
   pure function order_remark(outcome, before) result(remark)
      type(outcome_t), intent(in) :: outcome
      character(len=*), intent(in) :: before
      character(len=:), allocatable :: remark

      remark = before
      if (.not. (outcome%n_slid > 0 .or. outcome%has_built .or. outcome%slides_at_once)) return
      if (len(remark) > 0) remark = remark//"; "
      if (outcome%n_slid > 0) remark = remark//"joints that slid between stages: " &
         & //to_text(outcome%n_slid)//numbered(outcome%slid)//"; "
      if (outcome%has_built) remark = remark//"blocks were built between stages; "
      if (outcome%slides_at_once) remark = remark//"no joint slid between stages, " &
         & //"but the last shape slides or collapses if it is built at once; "
      remark = remark//"forces depend on the order of the stages"
   end function order_remark

   !> Numbers of joints in parentheses, not too many of them; nothing for none
   pure function numbered(joint) result(text)
      integer, intent(in) :: joint(:)  !! The numbers: (n)
      character(len=:), allocatable :: text
      integer, parameter :: most = 12
      integer :: i

      text = ""
      do i = 1, min(size(joint), most)
         text = text//", "//to_text(joint(i))
      end do
      if (size(joint) > most) text = text//" and others"
      if (len(text) > 0) text = " ("//text(3:)//")"
   end function numbered

   !> What a search in time has found on both sides of its bracket
   module procedure change_remark
      integer :: i

      remark = before
      if (len(remark) > 0) remark = remark//"; "
      if (.not. allocated(critical%other_change)) then
         remark = remark//to_text(critical%others)//" values between the ends agree with them"
      else if (size(critical%other_change) == 0) then
         remark = remark//to_text(critical%others)//" values on both sides agree with it"
      else
         remark = remark//"not monotone: the answer changes again"
         do i = 1, size(critical%other_change, 2)
            if (i > 1) remark = remark//","
            remark = remark//" between "//to_text(critical%other_change(1, i))//" and " &
               & //to_text(critical%other_change(2, i))
         end do
      end if
   end procedure change_remark

   !> What the user should know of jumps on the loading path
   module procedure jump_remark
      remark = before
      if (jumps == 0) return
      if (len(remark) > 0) remark = remark//"; "
      remark = remark//"jumps on the loading path: "//to_text(jumps)//", the largest " &
         & //to_text(largest)//" m"
   end procedure jump_remark

end submodule dda_case_remarks
