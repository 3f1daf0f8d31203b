!> Analysis files in DDAML, the XML form
submodule (dda_read_limerick) dda_ddaml_analysis
   use dda_ddaml_form, only : analysis_form
   use dda_ddaml_material, only : choose, element_error, number_attribute, read_history, &
      & read_joint, read_material, whole_attribute
   use dda_plain_files, only : check_steps
   use dda_word_list, only : quoted
   use dda_xml_tree, only : attribute_of, count_children, find_child
   implicit none

   !> Most steps of that phase where the file does not say it
   integer, parameter :: usual_gravity_steps = 5000

contains

   !> Read the analysis of a tree
   module procedure read_ddaml_analysis
      integer :: part, at

      analysis%file = tree%file
      ! what an absent element means to the original
      analysis%auto_time_step = .false.
      analysis%auto_penalty = .false.
      call find_part(tree, "Analysis", part, error)
      if (.not. allocated(error)) call check_elements(tree, part, analysis_form, warnings, error)
      if (allocated(error)) return
      ! weights that are not given need the gravity
      at = find_child(tree, part, "Gravaccel")
      if (at > 0) call number_attribute(tree, at, "value", 0.0_wp, analysis%gravity, error)
      if (.not. allocated(error)) call read_properties(tree, part, analysis, warnings, error)
      if (.not. allocated(error)) call read_loads(tree, part, analysis, error)
      if (.not. allocated(error)) call read_children(tree, part, analysis, warnings, error)
      if (.not. allocated(error)) call check_complete(tree, part, analysis, warnings, error)
   end procedure read_ddaml_analysis

   !> Read what an element holds
   pure recursive subroutine read_children(tree, outer, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: outer  !! Place of the element
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      at = first_child(tree, outer)
      do while (at > 0 .and. .not. allocated(error))
         call read_element(tree, at, analysis, warnings, error)
         at = next_sibling(tree, at)
      end do
   end subroutine read_children

   !> Read one child of Analysis, or of its constants of the scheme
   pure recursive subroutine read_element(tree, at, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of the child
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error

      associate (element => tree%element(at))
         select case (element%name)
         case ("Analysistype", "Rotation", "Gravity", "Autotimestep", "Autopenalty", "Planestrain")
            call read_switch(tree, at, analysis, warnings, error)
         case ("AConstants")
            call read_children(tree, at, analysis, warnings, error)
         case ("Openclose")
            call number_attribute(tree, at, "value", 0.0_wp, analysis%close_ratio, error)
         case ("Opencriteria")
            call number_attribute(tree, at, "value", 0.0_wp, analysis%open_ratio, error)
         case ("NormSpringPen")
            call number_attribute(tree, at, "value", 1.0e-30_wp, analysis%penetration_ratio, error)
         case ("AngleOverlap")
            call number_attribute(tree, at, "value", 0.0_wp, analysis%overlap_deg, error)
         case ("ShearNormRatio")
            call number_attribute(tree, at, "value", 1.0e-30_wp, analysis%stiffness_ratio, error)
         case ("Numtimesteps")
            call whole_attribute(tree, at, "timesteps", 1, analysis%max_steps, error)
         case ("Maxtimestep")
            call number_attribute(tree, at, "maxtimestep", 0.0_wp, analysis%time_step, error)
         case ("Mintimestep")
            call number_attribute(tree, at, "mintimestep", 0.0_wp, analysis%min_time_step, error)
         case ("Maxdisplacement")
            call number_attribute(tree, at, "maxdisplacement", 0.0_wp, &
               & analysis%max_displacement_ratio, error)
         case ("Opencloselimit", "OCLimit")
            call whole_attribute(tree, at, "maxopenclose", 1, analysis%open_close_limit, error)
         case ("Saveinterval")
            analysis%save_interval = 10
            if (attribute_place(tree, at, "step") > 0) &
               & call whole_attribute(tree, at, "step", 0, analysis%save_interval, error)
            if (analysis%save_interval == 0) analysis%save_interval = 10
         case ("Contactdamping", "ContactDamping")
            call number_attribute(tree, at, "value", 0.0_wp, analysis%contact_damping, error)
         case ("Gravaccel", "Writevertices")
         end select
      end associate
   end subroutine read_element

   !> Read an element that chooses
   pure subroutine read_switch(tree, at, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of the element
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      logical :: turned_on

      select case (tree%element(at)%name)
      case ("Analysistype")
         call choose(tree, at, "type", "dynamic", "static", analysis%dynamic, error)
      case ("Rotation")
         call choose(tree, at, "type", "exact secondorder", "linear", analysis%exact_rotation, &
            & error)
      case ("Gravity")
         call choose(tree, at, "flag", "yes", "no", turned_on, error)
         if (turned_on) call read_gravity(tree, at, analysis, error)
      case ("Autotimestep")
         call choose(tree, at, "flag", "yes", "no", analysis%auto_time_step, error)
      case ("Planestrain")
         call choose(tree, at, "flag", "yes", "no", analysis%plane_strain, error)
      case ("Autopenalty")
         call choose(tree, at, "flag", "yes", "no", analysis%auto_penalty, error)
         if (allocated(error)) return
         if (attribute_place(tree, at, "pfactor") > 0) then
            call number_attribute(tree, at, "pfactor", 0.0_wp, analysis%penalty_factor, error)
         else
            call add_warning(warnings, "Autopenalty needs the attribute pfactor: using 50", &
               & tree%file, tree%element(at)%row)
         end if
      end select
   end subroutine read_switch

   !> Read the phase that turns gravity on
   pure subroutine read_gravity(tree, at, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error
      character(len=*), parameter :: tolerance(2) = ["Normaltolerance", "Sheartolerance "]
      integer :: child, i

      analysis%gravity_steps = usual_gravity_steps
      child = find_child(tree, at, "Gravitysteplimit")
      if (child > 0) call whole_attribute(tree, child, "val", 1, analysis%gravity_steps, error)
      do i = 1, 2
         child = find_child(tree, at, trim(tolerance(i)))
         if (child > 0) call number_attribute(tree, child, "val", 0.0_wp, &
            & analysis%gravity_tolerance(i), error)
      end do
   end subroutine read_gravity

   !> Read the materials of blocks and joints
   pure subroutine read_properties(tree, part, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part  !! Place of Analysis
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: at, n_blocks, n_joints
      logical :: has_bolt

      has_bolt = .false.
      allocate (analysis%material(count_children(tree, part, "Blockmaterial")))
      allocate (analysis%joint(count_children(tree, part, "Jointproperties")))
      n_blocks = 0
      n_joints = 0
      at = first_child(tree, part)
      do while (at > 0 .and. .not. allocated(error))
         if (tree%element(at)%name == "Blockmaterial") then
            n_blocks = n_blocks + 1
            call check_type(tree, at, n_blocks, warnings)
            call read_material(tree, at, analysis%gravity, analysis%material(n_blocks), warnings, &
               & error)
         else if (tree%element(at)%name == "Jointproperties") then
            n_joints = n_joints + 1
            call check_type(tree, at, n_joints, warnings)
            call read_joint(tree, at, analysis%joint(n_joints), warnings, error)
         else if (tree%element(at)%name == "Boltproperties" .and. .not. has_bolt) then
            has_bolt = .true.
            call read_bolt(tree, at, analysis%bolt, error)
         end if
         at = next_sibling(tree, at)
      end do
   end subroutine read_properties

   !> Read what bolts are like: the first of these elements counts for all, as in the original
   pure subroutine read_bolt(tree, at, property, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      real(wp), intent(out) :: property(3)  !! Stiffness, strength and prestress: (3)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: what(3) = [character(len=9) :: "stiffness", "strength", &
         & "prestress"]
      type(word_list_t) :: words
      integer :: k

      property = 0.0_wp
      call element_words(tree, at, words)
      do k = 1, 3
         call take_property(words, "the "//trim(what(k))//" of bolts", property(k), error)
      end do
   end subroutine read_bolt

   !> Materials are counted in the order of the file, whatever their type says
   pure subroutine check_type(tree, at, number, warnings)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at      !! Place of the material
      integer, intent(in) :: number  !! Its number
      type(warnings_t), intent(inout) :: warnings
      character(len=:), allocatable :: given

      given = attribute_of(tree, at, "type")
      if (given == "" .or. given == to_text(number)) return
      call add_warning(warnings, "expected type "//to_text(number)//" of "//tree%element(at)%name &
         & //", its place in the file, got "//quoted(given)//": using its place", tree%file, &
         & tree%element(at)%row)
   end subroutine check_type

   !> Read the forces on load points
   pure subroutine read_loads(tree, part, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(out) :: error
      integer :: list, at, n, pass

      do pass = 1, 2
         n = 0
         list = first_child(tree, part)
         do while (list > 0)
            if (tree%element(list)%name == "Loadpointlist") then
               at = first_child(tree, list)
               do while (at > 0)
                  n = n + 1
                  if (pass == 2) call read_history(tree, at, analysis%load(n), error)
                  if (allocated(error)) return
                  at = next_sibling(tree, at)
               end do
            end if
            list = next_sibling(tree, list)
         end do
         if (pass == 1) allocate (analysis%load(n))
      end do
   end subroutine read_loads

   !> Whether all is there that an analysis needs
   pure subroutine check_complete(tree, part, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(in) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: wanted(5) = [character(len=16) :: "Numtimesteps", &
         & "Maxtimestep", "Maxdisplacement", "Blockmaterial", "Jointproperties"]
      integer :: i

      do i = 1, size(wanted)
         if (find_child(tree, part, trim(wanted(i))) == 0) call element_error(tree, part, &
            & "expected the element "//trim(wanted(i))//" in Analysis, got none; add it", error)
      end do
      if (allocated(error)) return
      if (find_child(tree, part, "Autopenalty") == 0) call add_warning(warnings, "expected " &
         & //"Autopenalty, got none: using flag=""no"" with pfactor=""50""", &
         & tree%file, tree%element(part)%row)
      call check_steps(analysis, tree%file, tree%element(part)%row, error)
   end subroutine check_complete

end submodule dda_ddaml_analysis
