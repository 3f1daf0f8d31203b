# A Fortran module of the two tables in a page's section "Models", line by line
# (variables: PAGE; MODULE; OUT, the file)
cmake_minimum_required(VERSION 3.16)
file(READ ${PAGE} text)
string(REGEX REPLACE "^.*\n## Models\n" "" text "${text}")
string(REGEX REPLACE "\n## .*$" "" text "${text}")
string(REPEAT "[^\n]" 90 row_of_text)
set(arrays "")
foreach(name IN ITEMS model_row search_row)
  if(NOT text MATCHES "\n((\\|[^\n\"]*\n)+)")
    message(FATAL_ERROR "${PAGE}: expected two tables in the section Models, got fewer")
  endif()
  set(table "${CMAKE_MATCH_1}")
  string(FIND "${text}" "${table}" start)
  string(LENGTH "${table}" length)
  math(EXPR start "${start} + ${length}")
  string(SUBSTRING "${text}" ${start} -1 text)
  string(REGEX REPLACE "\n$" "" table "${table}")
  string(REGEX REPLACE "(${row_of_text})" "\\1\"// &\n         & \"" table "${table}")
  string(REGEX REPLACE "\n\\|" "\", &\n      & \"|" table "${table}")
  string(APPEND arrays "\n   character(len=400), parameter :: ${name}(*) = [character(len=400) :: &\n"
    "      & \"${table}\"]\n")
endforeach()
get_filename_component(page ${PAGE} NAME)
file(WRITE ${OUT} "!> Tables of models and searches as docs/${page} has them, line by line
module ${MODULE}
   implicit none
   public
${arrays}end module ${MODULE}
")
