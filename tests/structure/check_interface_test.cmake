# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_interface.cmake> -DSCRATCH=<directory> -P check_interface_test.cmake
#
# Test of the check itself: small trees with one error each must be refused for that error.

cmake_minimum_required(VERSION 3.22)

function(expect message) # <file> <text>...: of the valid tree with these files instead
  file(REMOVE_RECURSE "${SCRATCH}")
  file(WRITE "${SCRATCH}/include/g4lidar/lidar.hpp" "#include \"g4lidar/detail/api.hpp\"\nclass lidar {\n")
  file(WRITE "${SCRATCH}/include/g4lidar/detail/api.hpp" "")
  file(WRITE "${SCRATCH}/docs/design/session.md" "`detail/retry.hpp` is the course of a request.\n")
  file(WRITE "${SCRATCH}/examples/a.cpp" "#include <g4lidar/lidar.hpp>\n")
  while(ARGN)
    list(POP_FRONT ARGN file text)
    file(WRITE "${SCRATCH}/${file}" "${text}\n")
  endwhile()
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DROOT=${SCRATCH}" -P "${SCRIPT}" OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "expected '${message}', but:\n${output}")
  endif()
endfunction()

expect("lidar.hpp includes 2 headers")
foreach(file IN ITEMS README.md docs/sim.md docs/guide/scans.md examples/b/b.hpp tests/install/find/CMakeLists.txt)
  foreach(text IN ITEMS "<g4lidar/detail/api.hpp>" "detail/api.hpp" "g4lidar::detail::api" "`detail/sim/api.hpp`")
    expect("names something of detail/" ${file} "${text}")
  endforeach()
  expect("lidar.hpp includes 2 headers" ${file} "in detail: details/more.hpp")
endforeach()
foreach(file IN ITEMS CONTRIBUTING.md docs/design/driver.md)
  expect("includes something of detail/" ${file} "#include <g4lidar/detail/api.hpp>")
  expect("includes something of detail/" ${file} "#  include \"detail/api.hpp\"")
  expect("lidar.hpp includes 2 headers" ${file} "see `detail/api.hpp`")
endforeach()
expect("befriends lidar_test" include/g4lidar/scan.hpp "  friend class lidar_test\;")
expect("lidar.hpp includes 2 headers" include/g4lidar/scan.hpp "  friend class lidar\;")
set(headers)
set(many)
foreach(number RANGE 1 18)
  list(APPEND many include/g4lidar/h${number}.hpp "//")
  string(APPEND headers "#include \"g4lidar/h${number}.hpp\"\n")
endforeach()
expect("lidar.hpp stands for 19 headers, at most 18" include/g4lidar/lidar.hpp "${headers}" ${many})
