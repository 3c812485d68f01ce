# SPDX-License-Identifier: MIT
# cmake -DNM=<nm> -DLIBRARY=<shared library> -DLIST=<symbols.txt> [-DWRITE=ON] -P check_exports.cmake
#
# Fails unless what <LIBRARY> shows to others is what <LIST> says, one demangled name a line. Instances of
# the templates of std and tl are passed over, for a compiler makes as many as it likes; anything else
# outside namespace g4lidar is refused. With WRITE the list is written anew.

cmake_minimum_required(VERSION 3.22)
execute_process(
  COMMAND "${NM}" --dynamic --demangle --defined-only "${LIBRARY}"
  OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY
)
string(REGEX REPLACE "\\[abi:[a-z0-9]+\\]" "" listing "${listing}") # brackets would join items of a list
string(REGEX REPLACE " +>" ">" listing "${listing}") # as llvm-nm writes it
string(REGEX MATCHALL "[^\n]+" lines "${listing}")

set(shown)
set(strange)
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^[0-9a-f]* *[A-Za-z] " "" name "${line}")
  # What it belongs to: a function template's instance begins with the type of its result.
  string(REGEX REPLACE "^(typeinfo|typeinfo name|vtable|VTT|guard variable) for " "" owner "${name}")
  if(owner MATCHES "^([a-z0-9_: ]+[*&]* )?(std|tl|__gnu_cxx)::")
    continue()
  endif()
  if(name MATCHES "^typeinfo name for ")
    continue() # goes with the typeinfo
  endif()
  list(APPEND shown "${name}")
  if(NOT owner MATCHES "^g4lidar::")
    list(APPEND strange "${name}")
  endif()
endforeach()
list(REMOVE_DUPLICATES shown)
list(SORT shown)

if(WRITE)
  list(JOIN shown "\n" text)
  file(WRITE "${LIST}" "${text}\n")
endif()
file(STRINGS "${LIST}" expected)

set(faults)
foreach(name IN LISTS strange)
  string(APPEND faults "\n  outside namespace g4lidar: ${name}")
endforeach()
foreach(name IN LISTS shown)
  if(NOT name IN_LIST expected)
    string(APPEND faults "\n  shown, and not in the list: ${name}")
  endif()
endforeach()
foreach(name IN LISTS expected)
  if(NOT name IN_LIST shown)
    string(APPEND faults "\n  in the list, and not shown: ${name}")
  endif()
endforeach()
if(faults)
  message(
    FATAL_ERROR
      "${LIBRARY} does not show what ${LIST} says:${faults}\n"
      "What is public and compiled is marked with G4LIDAR_API (include/g4lidar/export.hpp), and nothing else. "
      "Where the interface was meant to change, write the list anew; where something was taken out of a "
      "release, raise the library's SOVERSION, too:\n"
      "  cmake -DWRITE=ON -DNM=${NM} -DLIBRARY=${LIBRARY} -DLIST=${LIST} -P ${CMAKE_CURRENT_LIST_FILE}\n"
  )
endif()
list(LENGTH shown count)
if(count EQUAL 0)
  message(FATAL_ERROR "${LIBRARY} shows nothing at all")
endif()
message("${count} symbols, each of them in the list")
