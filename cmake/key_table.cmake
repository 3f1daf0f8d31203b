# Two Fortran modules of the keys of a page, names and registry, from its section "Groups and keys"
# (variables: PAGE; NAMES and KEYS, the modules; PREFIX of the arrays of KEYS; FIXED, groups that
# nothing varies, with | between; OUT, the file)
#
# "### GROUP" begins a group, and the first sentence below says what it is. A row of its table is
# | `KEY` | UNIT | RANGE | `DEFAULT` or (what holds without the key) | MEANING |
# with a cell of what the key requires before the last where any key of the table requires anything:
# `GROUP%KEY = 'WORD' or 'WORD'`, a key of the group that must be given, or `no` and one that must not.
# Groups but that of &analysis are named.
# A range is text, name (of another key), flag, list of numbers, list of words, `'WORD'`, `'WORD'`,
# or an interval, which may have "list in " before it or ", whole" behind it. Behind a range may stand
# ", search from LOW to HIGH", ", not swept", and ", swept as GROUP%KEY" for a name of two groups.
cmake_minimum_required(VERSION 3.16)
string(REPEAT "." 90 row_of_text)

# End with the line of the page
function(refuse expected)
  message(FATAL_ERROR "${PAGE}:${number}: expected ${expected}, got ${line}")
endfunction()

# A real number of Fortran
function(real out number)
  string(REGEX REPLACE "^(-?[0-9]+)$" "\\1.0" number "${number}")
  set(${out} "${number}_wp" PARENT_SCOPE)
endfunction()

# A text of Fortran in short lines, without the page's marks and links
function(literal out text)
  string(REGEX REPLACE "\\[([^][]*)\\]\\([^)]*\\)" "\\1" text "${text}")
  string(REPLACE "`" "" text "${text}")
  string(REGEX REPLACE "(${row_of_text})(.)" "\\1\"// &\n            \"\\2" text "${text}")
  set(${out} "\"${text}\"" PARENT_SCOPE)
endfunction()

# What a key takes, as arguments of key_t
function(read_range out range)
  set(more "")
  string(REPLACE "`" "" range "${range}")
  if(range MATCHES "^(.*), swept as [a-z_%]+$")
    set(range "${CMAKE_MATCH_1}")
    string(APPEND more ", bare=.false.")
  endif()
  if(range MATCHES "^(.*), not swept$")
    set(range "${CMAKE_MATCH_1}")
    string(APPEND more ", varies=.false.")
  elseif(range STREQUAL "name" OR group MATCHES "^(${FIXED})$")
    string(APPEND more ", varies=.false.")
  endif()
  if(range MATCHES "^(.*), search from ([^ ]+)( to ([^ ]+))?$")
    set(range "${CMAKE_MATCH_1}")
    set(high "${CMAKE_MATCH_4}")
    real(low "${CMAKE_MATCH_2}")
    string(APPEND more ", search_low=${low}")
    if(NOT high STREQUAL "")
      real(high "${high}")
      string(APPEND more ", search_high=${high}")
    endif()
  endif()
  if(range MATCHES "^(text|flag)$")
    set(kind ${range})
  elseif(range STREQUAL "name")
    set(kind text)
  elseif(range STREQUAL "list of numbers")
    set(kind numbers)
  elseif(range STREQUAL "list of words")
    set(kind texts)
  elseif(range MATCHES "^'[a-z-]+'(, '[a-z-]+')*$")
    set(kind word)
    string(REGEX REPLACE "[',]" "" range "${range}")
    string(APPEND more ", words=\"${range}\"")
  elseif(range MATCHES "^(list in )?([[(])([^ ,]+), ([^ ,]+)([])])(, whole)?$")
    set(kind number)
    set(opening "${CMAKE_MATCH_2}")
    set(closing "${CMAKE_MATCH_5}")
    set(high "${CMAKE_MATCH_4}")
    if(CMAKE_MATCH_1)
      set(kind numbers)
    elseif(CMAKE_MATCH_6)
      set(kind whole)
    endif()
    real(low "${CMAKE_MATCH_3}")
    real(high "${high}")
    string(APPEND more ", within=[${low}, ${high}]")
    if(opening STREQUAL "(")
      string(APPEND more ", above=${low}")
    endif()
    if(closing STREQUAL ")")
      string(APPEND more ", below=${high}")
    endif()
  else()
    refuse("a range such as [0, 90), text, or words in quotes")
  endif()
  set(${out} "kind=key_kind%${kind}${more}" PARENT_SCOPE)
endfunction()

# Read a row of a table
function(read_row)
  if(NOT line MATCHES
      "^\\| `([a-z0-9_]+)` \\|([^|]*)\\|([^|]+)\\|([^|]+)\\|(([^|]*)\\|)? ([^|\"]+) \\|$")
    refuse("a row | `KEY` | UNIT | RANGE | DEFAULT | MEANING |")
  endif()
  set(name ${CMAKE_MATCH_1})
  string(STRIP "${CMAKE_MATCH_6}" needs)
  string(STRIP "${CMAKE_MATCH_2}" unit)
  string(STRIP "${CMAKE_MATCH_3}" range)
  string(STRIP "${CMAKE_MATCH_4}" default)
  literal(meaning "${CMAKE_MATCH_7}")
  if(default MATCHES "^`(.+)`$")
    set(default "default=\"${CMAKE_MATCH_1}\"")
  elseif(default MATCHES "^\\((.+)\\)$")
    string(REPLACE "`" "" default "without=\"${CMAKE_MATCH_1}\"")
  else()
    refuse("`DEFAULT` or (what holds without the key)")
  endif()
  read_range(takes "${range}")
  if(NOT needs STREQUAL "")
    string(REPLACE "`" "" needs "${needs}")
    string(APPEND takes ", &\n            needs=\"${needs}\"")
  endif()
  set(names "${names}, &\n         & ${group}_${name}" PARENT_SCOPE)
  set(keys "${keys}, &
      key_t(\"${group}\", \"${name}\", unit=\"${unit}\", ${default}, &
            ${takes}, &
            meaning=${meaning})" PARENT_SCOPE)
endfunction()

# End a group: its names, its entry, and the array of its keys, each behind ", &" and a line end
macro(end_group)
  if(NOT group STREQUAL "")
    string(SUBSTRING "${keys}" 3 -1 keys)
    string(APPEND arrays "\n   type(key_t), parameter :: ${group}_keys(*) = [ &${keys}]\n")
    string(APPEND groups ", &\n      group_t(\"${group}\", ${meaning})")
    string(APPEND group_names ", &\n         & ${group}_group")
    string(APPEND all ", &\n      ${group}_keys")
    set(group "")
    set(keys "")
  endif()
endmacro()

file(READ ${PAGE} text)
foreach(part IN ITEMS group names group_names groups keys arrays all)
  set(${part} "")
endforeach()
set(number 0)
set(is_table FALSE)
while(NOT text STREQUAL "")
  math(EXPR number "${number} + 1")
  string(FIND "${text}" "\n" end)
  string(SUBSTRING "${text}" 0 ${end} line)
  math(EXPR end "${end} + 1")
  string(SUBSTRING "${text}" ${end} -1 text)
  if(line MATCHES "^##? ")
    string(COMPARE EQUAL "${line}" "## Groups and keys" is_table)
    end_group()
  elseif(is_table AND line MATCHES "^### ([a-z_]+)$")
    set(next ${CMAKE_MATCH_1})
    end_group()
    set(group ${next})
    set(meaning "")
  elseif(NOT group STREQUAL "" AND meaning STREQUAL "" AND NOT line STREQUAL "")
    if(NOT line MATCHES "^([A-Z][^.|\"]+)\\.")
      refuse("a sentence on &${group} before its table")
    endif()
    literal(meaning "${CMAKE_MATCH_1}")
  elseif(NOT group STREQUAL "" AND line MATCHES "^\\| `")
    read_row()
  endif()
endwhile()
end_group()
foreach(list IN ITEMS names group_names groups all)
  string(REGEX REPLACE "^, &\n *&? ?" "" ${list} "${${list}}")
endforeach()
string(REGEX REPLACE "^[a-z_0-9]+" "\\0 = 1" names "${names}")
string(REGEX REPLACE "^[a-z_0-9]+" "\\0 = 1" group_names "${group_names}")
get_filename_component(page ${PAGE} NAME)
file(WRITE ${OUT} "!> Names of keys and groups in the order of docs/${page}: deck%value(arch_radius)
module ${NAMES}
   implicit none
   public

   enum, bind(c)
      enumerator :: ${names}
   end enum

   enum, bind(c)
      enumerator :: ${group_names}
   end enum
end module ${NAMES}

!> Groups and keys as docs/${page} has them
module ${KEYS}
   use dda_deck_key, only : group_t, key_kind, key_t
   use dda_kinds, only : wp
   implicit none
   public
   private :: group_t, key_kind, key_t, wp

   type(group_t), parameter :: ${PREFIX}_group(*) = [ &
      ${groups}]
${arrays}
   type(key_t), parameter :: ${PREFIX}_key(*) = [ &
      ${all}]
end module ${KEYS}
")
