# SPDX-License-Identifier: MIT
# Reads the version of the project from include/g4lidar/version.hpp, the only place that defines it.
#   G4LIDAR_VERSION: MAJOR.MINOR.PATCH

set(version_header "${CMAKE_CURRENT_LIST_DIR}/../include/g4lidar/version.hpp")
file(READ "${version_header}" version_text)

set(version_parts)
foreach(part MAJOR MINOR PATCH)
  if(NOT version_text MATCHES "#define G4LIDAR_VERSION_${part} ([0-9]+)")
    message(FATAL_ERROR "${version_header} does not define G4LIDAR_VERSION_${part}")
  endif()
  list(APPEND version_parts "${CMAKE_MATCH_1}")
endforeach()
list(JOIN version_parts "." G4LIDAR_VERSION)

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${version_header}")
endif()
