# A Fortran module with a mark of the build: a digest of the sources and of what compiles them, by
# which results of another build are known
# (variables: SOURCE, folder of the sources; COMPILED_BY; OUT, the file)
file(GLOB_RECURSE sources RELATIVE ${SOURCE} ${SOURCE}/*.f90 ${SOURCE}/*.inc)
list(SORT sources)
list(APPEND sources ../docs/input.md)
set(text "${COMPILED_BY}")
foreach(file IN LISTS sources)
  file(SHA256 ${SOURCE}/${file} digest)
  string(APPEND text "\n${file} ${digest}")
endforeach()
string(SHA256 mark "${text}")
string(SUBSTRING ${mark} 0 12 mark)
file(WRITE ${OUT} "!> Which build this is
module dda_build_mark
   implicit none
   private

   !> Digest of the sources and of what has compiled them
   character(len=*), parameter, public :: build_mark = \"${mark}\"
end module dda_build_mark
")
