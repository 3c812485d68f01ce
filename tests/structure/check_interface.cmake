# SPDX-License-Identifier: MIT
# cmake -DROOT=<project> -P check_interface.cmake
#
# The rules for public headers: lidar.hpp includes few headers; files for users (README, docs,
# examples, tests/install) do not name anything in detail/, and those for developers (docs/design,
# CONTRIBUTING) do not include it; no public header has a test as friend.

cmake_minimum_required(VERSION 3.22)
set(include "${ROOT}/include")
set(most_of_lidar 18)
set(faults)

# ---- the direct and indirect includes of lidar.hpp ---------------------------------------------
set(closure g4lidar/lidar.hpp)
set(left ${closure})
while(left)
  list(POP_FRONT left header)
  file(STRINGS "${include}/${header}" lines REGEX "^#include [\"<]g4lidar/")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "g4lidar/[^\">]+" other "${line}")
    if(NOT other IN_LIST closure)
      list(APPEND closure "${other}")
      list(APPEND left "${other}")
    endif()
  endforeach()
endwhile()
list(LENGTH closure count)
if(count GREATER most_of_lidar)
  list(JOIN closure " " text)
  list(APPEND faults "lidar.hpp stands for ${count} headers, at most ${most_of_lidar}: ${text}")
endif()

# ---- files for users and developers ------------------------------------------------------------
file(GLOB_RECURSE seen "${ROOT}/examples/*" "${ROOT}/tests/install/*" "${ROOT}/tests/documents/wrappers/*")
file(GLOB pages "${ROOT}/README.md" "${ROOT}/docs/*.md" "${ROOT}/docs/guide/*.md")
foreach(file IN LISTS seen pages)
  file(STRINGS "${file}" lines REGEX "(^|[^a-z_])detail(/[a-z_/]+\\.hpp|::)")
  if(lines)
    list(APPEND faults "${file} names something of detail/: ${lines}")
  endif()
endforeach()
file(GLOB pages "${ROOT}/docs/design/*.md" "${ROOT}/CONTRIBUTING.md")
foreach(file IN LISTS pages)
  file(STRINGS "${file}" lines REGEX "include *[<\"].*detail/")
  if(lines)
    list(APPEND faults "${file} includes something of detail/: ${lines}")
  endif()
endforeach()

# ---- friends ------------------------------------------------------------------------------------
file(GLOB_RECURSE headers "${include}/*.hpp")
file(GLOB_RECURSE sources "${ROOT}/src/*.[ch]pp")
set(known)
foreach(file IN LISTS headers sources)
  file(STRINGS "${file}" lines REGEX "^ *(template.*)?(class|struct) ")
  string(APPEND known ";${lines}")
endforeach()
foreach(file IN LISTS headers)
  file(STRINGS "${file}" lines REGEX "friend (class|struct) ")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "friend (class|struct) ([a-z0-9_:]+)" friend "${line}")
    set(name "${CMAKE_MATCH_2}")
    if(NOT known MATCHES "(class|struct) [^;]*${name}[^;]*{")
      list(APPEND faults "${file} befriends ${name}, which neither include nor src defines")
    endif()
  endforeach()
endforeach()

if(faults)
  list(JOIN faults "\n  " text)
  message(FATAL_ERROR "The public interface is broken:\n  ${text}")
endif()
message("lidar.hpp includes ${count} headers; users' files do not name detail/, and no test is a friend")
