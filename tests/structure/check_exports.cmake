# SPDX-License-Identifier: MIT
# cmake -DNM=<nm> -DLIBRARY=<shared library> -DLIST=<symbols.txt> [-DWRITE=ON] -P check_exports.cmake
#
# Fails unless <LIBRARY> exports exactly the symbols of <LIST>, one demangled name per line.
# Instances of templates of std and tl are ignored, because compilers create any number of them;
# other symbols outside namespace g4lidar are refused. With WRITE the list is replaced.

cmake_minimum_required(VERSION 3.22)
execute_process(
  COMMAND "${NM}" --dynamic --demangle --defined-only "${LIBRARY}"
  OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY
)
string(REGEX REPLACE "\\[abi:[a-z0-9]+\\]" "" listing "${listing}") # brackets would join items of a list
string(REGEX REPLACE " +>" ">" listing "${listing}") # the form of llvm-nm
string(REGEX MATCHALL "[^\n]+" lines "${listing}")

set(shown)
set(strange)
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^[0-9a-f]* *[A-Za-z] " "" name "${line}")
  # The name without the result type, with which instances of function templates begin.
  string(REGEX REPLACE "^(typeinfo|typeinfo name|vtable|VTT|guard variable) for " "" owner "${name}")
  if(owner MATCHES "^([a-z0-9_: ]+[*&]* )?(std|tl|__gnu_cxx)::")
    continue()
  endif()
  if(name MATCHES "^typeinfo name for ")
    continue() # belongs to the typeinfo
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
    string(APPEND faults "\n  exported, but not in the list: ${name}")
  endif()
endforeach()
foreach(name IN LISTS expected)
  if(NOT name IN_LIST shown)
    string(APPEND faults "\n  in the list, but not exported: ${name}")
  endif()
endforeach()
if(faults)
  message(
    FATAL_ERROR
      "${LIBRARY} does not export the symbols of ${LIST}:${faults}\n"
      "Only public compiled declarations have the attribute G4LIDAR_API (include/g4lidar/detail/api.hpp). "
      "If the interface was changed on purpose, replace the list; if something was removed from a "
      "release, raise the library's SOVERSION, too:\n"
      "  cmake -DWRITE=ON -DNM=${NM} -DLIBRARY=${LIBRARY} -DLIST=${LIST} -P ${CMAKE_CURRENT_LIST_FILE}\n"
  )
endif()
list(LENGTH shown count)
if(count EQUAL 0)
  message(FATAL_ERROR "${LIBRARY} exports nothing")
endif()
message("${count} symbols, all of them in the list")
