# SPDX-License-Identifier: MIT
# g4lidar_headers(<target> <header>...): the public headers of a target, relative to
# include/g4lidar. Builds with CMAKE_VERIFY_INTERFACE_HEADER_SETS compile each of them alone (CMake
# 3.24 and later).

function(g4lidar_headers target)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(scope INTERFACE)
  else()
    set(scope PUBLIC)
  endif()

  # Set in addition to the file set: an installation made with CMake 3.23 and later is also used by
  # CMake 3.22, which does not know file sets.
  target_include_directories(
    ${target} ${scope} "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
  )
  if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.23)
    list(TRANSFORM ARGN PREPEND "${PROJECT_SOURCE_DIR}/include/g4lidar/")
    target_sources(
      ${target} ${scope} FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include" FILES ${ARGN}
    )
  endif()
endfunction()

# g4lidar_layers(<variable> <first layer> <last layer>): the public headers of these layers, by
# cmake/layers.txt, which is the only list of them that is kept by hand.
function(g4lidar_layers variable first last)
  set(list "${PROJECT_SOURCE_DIR}/cmake/layers.txt")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${list}")
  file(STRINGS "${list}" lines REGEX "^[0-9]")
  set(found)
  foreach(line IN LISTS lines)
    string(REPLACE " " ";" words "${line}")
    list(POP_FRONT words layer)
    if(layer GREATER_EQUAL first AND layer LESS_EQUAL last)
      list(APPEND found ${words})
    endif()
  endforeach()
  list(FILTER found EXCLUDE REGEX "^src/")
  list(TRANSFORM found APPEND ".hpp")
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()
