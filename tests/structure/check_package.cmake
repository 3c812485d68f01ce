# SPDX-License-Identifier: MIT
# package.xml has the version of the project. -DDIRECTORY=... is the project's.
include("${DIRECTORY}/cmake/version.cmake")
file(READ "${DIRECTORY}/package.xml" text)
if(NOT text MATCHES "<version>([^<]*)</version>" OR NOT CMAKE_MATCH_1 STREQUAL G4LIDAR_VERSION)
  message(FATAL_ERROR "package.xml has the version ${CMAKE_MATCH_1}, not ${G4LIDAR_VERSION}")
endif()
