!> Geometry and analysis files of the Limerick format, plain and DDAML, as texts
module dda_write_limerick
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t, analysis_material_t
   use dda_line_model, only : entities_t, entity_role, line_model_t
   use dda_plain_files, only : n_coordinates, plain_order
   use dda_text, only : fields, to_text
   implicit none
   private

   public :: plain_geometry, plain_analysis, ddaml_geometry, ddaml_analysis

   !> The end of a line
   character(len=1), parameter :: lf = achar(10)
   !> First lines of a DDAML file, with the root element still open
   character(len=*), parameter :: head = '<?xml version="1.0" standalone="no"?>'//lf &
      & //'<Berkeley:DDA xmlns:Berkeley="http://www.tsoft.com/~bdoolin/dda">'//lf &
      & //'<!-- voussoir -->'

contains

   !> Write a geometry in the plain format
   pure function plain_geometry(model) result(text)
      type(line_model_t), intent(in) :: model
      character(len=:), allocatable :: text  !! Text of the file without its last line end
      integer :: k

      text = to_text(model%edge_node_ratio)//lf//to_text(model%line%n)//" " &
         & //to_text(model%n_boundary)
      do k = 1, size(plain_order)
         text = text//lf//to_text(model%of(plain_order(k))%n)
      end do
      text = text//records(model%line, entity_role%joint)
      do k = 1, size(plain_order)
         text = text//records(model%of(plain_order(k)), plain_order(k))
      end do
   end function plain_geometry

   !> Write the records of one role in the plain format
   pure function records(entities, role) result(text)
      type(entities_t), intent(in) :: entities
      integer, intent(in) :: role            !! One of entity_role
      character(len=:), allocatable :: text  !! Lines, each preceded by a line end
      integer :: i

      text = ""
      do i = 1, entities%n
         text = text//lf//fields(entities%place(:n_coordinates(role), i), " ")
         if (role <= entity_role%material) text = text//" "//to_text(entities%material(i))
         if (role == entity_role%bolt) text = text//" " &
            & //fields(max(entities%property(:, i), 0.0_wp), " ")
      end do
   end function records

   !> Attributes with the properties of a bolt; Shi's program reads only the first
   pure function bolt_attributes(property) result(text)
      real(wp), intent(in) :: property(3)    !! Stiffness, strength and prestress: (3)
      character(len=:), allocatable :: text  !! Attributes, each preceded by a blank

      text = ' type="1"'
      if (property(1) >= 0.0_wp) text = text//' stiffness="'//to_text(property(1)) &
         & //'" strength="'//to_text(property(2))//'" pretension="'//to_text(property(3))//'"'
   end function bolt_attributes

   !> Write a geometry in DDAML
   pure function ddaml_geometry(model) result(text)
      type(line_model_t), intent(in) :: model
      character(len=:), allocatable :: text

      text = head//lf//"<Geometry>"//lf//empty("Edgenodedist", "distance", &
         & to_text(model%edge_node_ratio)) &
         & //list("Boundlist", "Line", model%line, 1, model%n_boundary) &
         & //list("Jointlist", "Joint", model%line, model%n_boundary + 1) &
         & //list("Matlinelist", "Line", model%of(entity_role%material), 1) &
         & //list("Fixedpointlist", "", model%of(entity_role%fix), 1) &
         & //list("Loadpointlist", "Point", model%of(entity_role%load), 1) &
         & //list("Measuredpointlist", "Point", model%of(entity_role%measure), 1) &
         & //list("Holepointlist", "Point", model%of(entity_role%hole), 1) &
         & //list("Boltlist", "Bolt", model%of(entity_role%bolt), 1) &
         & //"</Geometry>"//lf//"</Berkeley:DDA>"
   end function ddaml_geometry

   !> Write a list in DDAML
   pure function list(name, item, entities, first, until) result(text)
      character(len=*), intent(in) :: name  !! Name of the list
      !> Name of its elements; if empty, Point for points and Line for lines
      character(len=*), intent(in) :: item
      type(entities_t), intent(in) :: entities
      integer, intent(in) :: first            !! First of them
      integer, intent(in), optional :: until  !! Last of them; absent for the whole list
      !> Lines, each with its line end; empty for an empty list
      character(len=:), allocatable :: text
      character(len=:), allocatable :: kind
      integer :: i, last

      text = ""
      last = entities%n
      if (present(until)) last = until
      if (last < first) return
      text = "<"//name//">"//lf
      do i = first, last
         kind = item
         if (item == "") kind = trim(merge("Point", "Line ", &
            & all(abs(entities%place(3:4, i) - entities%place(1:2, i)) <= 0.0_wp)))
         text = text//"<"//kind
         if (entities%material(i) > 0) text = text//' type="'//to_text(entities%material(i))//'"'
         if (kind == "Bolt") text = text//bolt_attributes(entities%property(:, i))
         text = text//"> "//fields(entities%place(:merge(2, 4, kind == "Point"), i), " ")//" </" &
            & //kind//">"//lf
      end do
      text = text//"</"//name//">"//lf
   end function list

   !> An element without text
   pure function empty(name, attribute, value, more) result(text)
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: attribute  !! Name of its attribute
      character(len=*), intent(in) :: value      !! Value of the attribute
      !> Further attributes, each preceded by a blank
      character(len=*), intent(in), optional :: more
      character(len=:), allocatable :: text  !! The element with its line end

      text = "<"//name//" "//attribute//'="'//value//'"'
      if (present(more)) text = text//more
      text = text//"/>"//lf
   end function empty

   !> An element with text
   pure function filled(name, inside) result(text)
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: inside  !! Content of the element
      character(len=:), allocatable :: text

      text = "<"//name//"> "//inside//" </"//name//">"//lf
   end function filled

   !> Write an analysis in the plain format, which has no constants, flags and loads
   pure function plain_analysis(analysis) result(text)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=:), allocatable :: text
      integer :: i

      text = merge("1", "0", analysis%dynamic)//lf//to_text(analysis%max_steps)//lf &
         & //to_text(size(analysis%material))//lf//to_text(size(analysis%joint))//lf &
         & //to_text(analysis%max_displacement_ratio)//lf//to_text(analysis%time_step)
      do i = 1, size(analysis%material)
         associate (material => analysis%material(i))
            text = text//lf//fields([material%density, material%unit_weight, material%young, &
               & material%poisson], " ")//lf//fields(material%stress, " ")//lf &
               & //fields(material%stress_gradient, " ")//lf//fields(material%velocity, " ")
         end associate
      end do
      do i = 1, size(analysis%joint)
         associate (joint => analysis%joint(i))
            text = text//lf//fields([joint%friction_deg, joint%cohesion, joint%tension], " ")
         end associate
      end do
   end function plain_analysis

   !> Write an analysis in DDAML, without loads
   pure function ddaml_analysis(analysis) result(text)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=:), allocatable :: text
      integer :: i

      text = head//lf//"<Analysis>"//lf//switches(analysis)//constants(analysis)
      do i = 1, size(analysis%material)
         text = text//material_element(analysis%material(i), i)
      end do
      do i = 1, size(analysis%joint)
         associate (joint => analysis%joint(i))
            text = text//'<Jointproperties type="'//to_text(i)//'">'//lf &
               & //filled("Friction", to_text(joint%friction_deg)) &
               & //filled("Cohesion", to_text(joint%cohesion)) &
               & //filled("Tensile", to_text(joint%tension))//"</Jointproperties>"//lf
         end associate
      end do
      text = text//"</Analysis>"//lf//"</Berkeley:DDA>"
   end function ddaml_analysis

   !> Elements with choices and limits
   pure function switches(analysis) result(text)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=:), allocatable :: text  !! Elements, each with its line end

      text = empty("Analysistype", "type", trim(merge("dynamic", "static ", analysis%dynamic))) &
         & //empty("Rotation", "type", trim(merge("exact ", "linear", analysis%exact_rotation))) &
         & //gravity_phase(analysis)//empty("Gravaccel", "value", to_text(analysis%gravity)) &
         & //empty("Autotimestep", "flag", yes_no(analysis%auto_time_step)) &
         & //empty("Autopenalty", "flag", yes_no(analysis%auto_penalty), &
         & ' pfactor="'//to_text(analysis%penalty_factor)//'"') &
         & //empty("Planestrain", "flag", yes_no(analysis%plane_strain)) &
         & //empty("Numtimesteps", "timesteps", to_text(analysis%max_steps)) &
         & //empty("Maxtimestep", "maxtimestep", to_text(analysis%time_step)) &
         & //empty("Mintimestep", "mintimestep", to_text(analysis%min_time_step)) &
         & //empty("Maxdisplacement", "maxdisplacement", to_text(analysis%max_displacement_ratio)) &
         & //empty("Opencloselimit", "maxopenclose", to_text(analysis%open_close_limit)) &
         & //empty("Saveinterval", "step", to_text(analysis%save_interval)) &
         & //empty("ContactDamping", "value", to_text(analysis%contact_damping))
   end function switches

   !> Element of the phase that applies gravity
   pure function gravity_phase(analysis) result(text)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=:), allocatable :: text

      if (analysis%gravity_steps == 0) then
         text = empty("Gravity", "flag", "no")
      else
         text = '<Gravity flag="yes">'//lf &
            & //empty("Gravitysteplimit", "val", to_text(analysis%gravity_steps)) &
            & //empty("Normaltolerance", "val", to_text(analysis%gravity_tolerance(1))) &
            & //empty("Sheartolerance", "val", to_text(analysis%gravity_tolerance(2))) &
            & //"</Gravity>"//lf
      end if
   end function gravity_phase

   !> Elements of the constants of the scheme
   pure function constants(analysis) result(text)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=:), allocatable :: text

      text = "<AConstants>"//lf//empty("Openclose", "value", to_text(analysis%close_ratio)) &
         & //empty("Opencriteria", "value", to_text(analysis%open_ratio)) &
         & //empty("NormSpringPen", "value", to_text(analysis%penetration_ratio)) &
         & //empty("AngleOverlap", "value", to_text(analysis%overlap_deg)) &
         & //empty("ShearNormRatio", "value", to_text(analysis%stiffness_ratio)) &
         & //"</AConstants>"//lf
   end function constants

   !> Element of a block material
   pure function material_element(material, number) result(text)
      type(analysis_material_t), intent(in) :: material
      integer, intent(in) :: number  !! Its number
      character(len=:), allocatable :: text

      text = '<Blockmaterial type="'//to_text(number)//'">'//lf &
         & //filled("Unitmass", to_text(material%density)) &
         & //filled("Unitweight", to_text(material%unit_weight)) &
         & //filled("Youngsmod", to_text(material%young)) &
         & //filled("Poissonratio", to_text(material%poisson))//filled("Damping", "0") &
         & //filled("Istress", fields(material%stress, " ")) &
         & //filled("Ivelocity", fields(material%velocity, " ")) &
         & //filled("Istrain", fields(material%strain, " "))//"</Blockmaterial>"//lf
   end function material_element

   !> Word for a flag in DDAML
   pure function yes_no(flag) result(word)
      logical, intent(in) :: flag            !! The flag
      character(len=:), allocatable :: word  !! yes or no

      word = trim(merge("yes", "no ", flag))
   end function yes_no
end module dda_write_limerick
