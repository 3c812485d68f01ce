# SPDX-License-Identifier: MIT
# cmake -DROOT=<project> -DBUDGETS=<cmake/budgets.txt> -DAWK=<awk> -P check_budgets.cmake
#
# Fails if a room of the project has more lines than its budget, or one of them more files. Only files of text count.

cmake_minimum_required(VERSION 3.22)

file(STRINGS "${BUDGETS}" rows REGEX "^[^#]")
file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/include/*" "${ROOT}/src/*" "${ROOT}/tools/*" "${ROOT}/python/*" "${ROOT}/ros/*"
     "${ROOT}/tests/*" "${ROOT}/fuzz/*" "${ROOT}/bench/*" "${ROOT}/scripts/*" "${ROOT}/.ci/*"
)
list(FILTER files EXCLUDE REGEX "(/__pycache__/|\\.(png|pyc|so|bin|mcap|zst|npz)$|/\\.[a-z_]+_cache/)")
if(NOT files)
  message(FATAL_ERROR "No sources in ${ROOT}")
endif()

set(all ${files})
set(faults)
set(report)
foreach(row IN LISTS rows)
  if(row MATCHES "^([0-9]+) files ([a-z]+) (.+)$")
    set(most "${CMAKE_MATCH_1}")
    set(name "${CMAKE_MATCH_2}")
    set(own ${all})
    list(FILTER own INCLUDE REGEX "${CMAKE_MATCH_3}")
    list(LENGTH own count)
    list(APPEND report "${name}: ${count} of ${most} files")
    if(count GREATER most)
      list(APPEND faults "${name}: ${count} files, at most ${most}")
    endif()
    continue()
  endif()
  if(NOT row MATCHES "^([0-9]+|-) ([a-z]+) (.+)$")
    message(FATAL_ERROR "${BUDGETS}: not a room: ${row}")
  endif()
  set(most "${CMAKE_MATCH_1}")
  set(name "${CMAKE_MATCH_2}")
  set(paths "${CMAKE_MATCH_3}")
  set(own ${files})
  list(FILTER own INCLUDE REGEX "${paths}")
  list(FILTER files EXCLUDE REGEX "${paths}")
  if(most STREQUAL "-" OR NOT own)
    continue()
  endif()
  execute_process(
    COMMAND "${AWK}" "END { print NR }" ${own} WORKING_DIRECTORY "${ROOT}" OUTPUT_VARIABLE lines
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY
  )
  list(APPEND report "${name}: ${lines} of ${most}")
  if(lines GREATER most)
    list(APPEND faults "${name}: ${lines} lines, at most ${most}")
  endif()
endforeach()
list(JOIN report ", " report)
if(faults)
  list(JOIN faults "\n  " faults)
  message(FATAL_ERROR "Rooms with too many lines or files:\n  ${faults}")
endif()
message("${report}")
