# SPDX-License-Identifier: MIT
# cmake -DNM=<nm> -DOBJECTS=<objects of a program> -DLIBRARIES=<shared libraries> -P check_needs.cmake
#
# Fails if the program needs a symbol of namespace g4lidar that the libraries do not export.

cmake_minimum_required(VERSION 3.22)

# symbols(<variable> <argument of nm>...): demangled names, without address and kind.
function(symbols variable)
  execute_process(COMMAND "${NM}" --demangle ${ARGN} OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\\[abi:[a-z0-9]+\\]" "" listing "${listing}")
  string(REGEX REPLACE "[][;]" "|" listing "${listing}")
  string(REGEX MATCHALL "[^\n]+" lines "${listing}")
  list(FILTER lines INCLUDE REGEX "^[0-9a-f]* *[A-Za-z] .*g4lidar::")
  list(TRANSFORM lines REPLACE "^[0-9a-f]* *[A-Za-z] " "")
  set(${variable} "${lines}" PARENT_SCOPE)
endfunction()

list(FILTER OBJECTS EXCLUDE REGEX "\\.gch$") # precompiled headers
symbols(needed --undefined-only ${OBJECTS})
list(FILTER needed EXCLUDE REGEX "^g4_tool::") # of the programs, with a type of the library
symbols(own --defined-only ${OBJECTS})
symbols(shown --dynamic --defined-only ${LIBRARIES})
list(REMOVE_DUPLICATES needed)
list(REMOVE_ITEM needed ${own} ${shown})
if(needed)
  list(JOIN needed "\n  " text)
  message(
    FATAL_ERROR
      "Needed, and not shown by ${LIBRARIES}:\n  ${text}\n"
      "What is public and compiled is marked with G4LIDAR_API: see include/g4lidar/detail/api.hpp"
  )
endif()
list(LENGTH shown count)
if(count EQUAL 0)
  message(FATAL_ERROR "${LIBRARIES} export nothing")
endif()
