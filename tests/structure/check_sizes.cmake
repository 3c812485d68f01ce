# SPDX-License-Identifier: MIT
# cmake -DROOT=<project> -DAWK=<awk> [-DMOST_MEMBERS=<number>] [-DMOST_FUNCTIONS=<number>] [-DMOST_FUNCTION_LINES=<number>] [-DMOST_LINES=<number>] -P check_sizes.cmake
#
# Fails if a class of include, src, tools, ros or python/src has more than 20 data members, those of its base classes
# included, or more than 25 functions besides constructors, or a function of more than 60 lines, or if a source file has
# more than 350 lines.

cmake_minimum_required(VERSION 3.22)
if(NOT DEFINED MOST_MEMBERS)
  set(MOST_MEMBERS 20)
endif()
if(NOT DEFINED MOST_FUNCTIONS)
  set(MOST_FUNCTIONS 25)
endif()
if(NOT DEFINED MOST_FUNCTION_LINES)
  set(MOST_FUNCTION_LINES 60)
endif()
if(NOT DEFINED MOST_LINES)
  set(MOST_LINES 350)
endif()

# Classes that may be larger, and why.
set(larger
    device_options # of the simulator: one member for each property of a G4 that docs/sim_device.md lists
    g4lidar_options # of the C interface: new members follow those of its first version
    lidar # one function for each thing that a program does with one
    lidar_options # one member for each option of a program
)

function(sources variable) # <directory>...
  set(all)
  foreach(directory IN LISTS ARGN)
    file(GLOB_RECURSE found RELATIVE "${ROOT}" "${ROOT}/${directory}/*.[ch]pp" "${ROOT}/${directory}/*.[ch]"
         "${ROOT}/${directory}/*.py"
    )
    list(APPEND all ${found})
  endforeach()
  list(FILTER all EXCLUDE REGEX "/__pycache__/")
  if(NOT all)
    message(FATAL_ERROR "No sources in ${ROOT}")
  endif()
  set(${variable} "${all}" PARENT_SCOPE)
endfunction()

function(awk_lines variable) # <argument of awk>...
  execute_process(
    COMMAND "${AWK}" ${ARGN} WORKING_DIRECTORY "${ROOT}" OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY
  )
  string(STRIP "${text}" text)
  string(REPLACE "\n" ";" lines "${text}")
  set(${variable} "${lines}" PARENT_SCOPE)
endfunction()

sources(library include src tools ros python/src)
sources(all include src tools ros python tests bench examples)
awk_lines(faults -v most=${MOST_MEMBERS} -v most_functions=${MOST_FUNCTIONS} -f "${CMAKE_CURRENT_LIST_DIR}/count_members.awk" ${library})
list(POP_BACK faults classes)
awk_lines(long_functions -v most=${MOST_FUNCTION_LINES} -f "${CMAKE_CURRENT_LIST_DIR}/long_functions.awk" ${library})
list(APPEND faults ${long_functions})
foreach(name IN LISTS larger)
  list(FILTER faults EXCLUDE REGEX ": ${name} has ")
endforeach()
awk_lines(long "FNR == ${MOST_LINES} + 1 { print FILENAME }" ${all})
list(TRANSFORM long APPEND " has more than ${MOST_LINES} lines")

if(faults OR long)
  list(JOIN faults "\n  " classes)
  list(JOIN long "\n  " files)
  message(FATAL_ERROR "At most ${MOST_MEMBERS} data members, ${MOST_FUNCTIONS} functions and ${MOST_LINES} lines:\n  ${classes}\n  ${files}")
endif()
list(LENGTH all count)
message("${classes}, each with at most ${MOST_MEMBERS} data members and ${MOST_FUNCTIONS} functions; ${count} files of at most ${MOST_LINES} lines")
