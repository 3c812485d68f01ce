# SPDX-License-Identifier: MIT
# GTest::gtest, GTest::gmock, GTest::gtest_main: those of the system, or, for another processor,
# built from the sources of the package googletest in /usr/src.

include(GoogleTest)

if(NOT CMAKE_CROSSCOMPILING)
  find_package(GTest 1.12 REQUIRED)
  return()
endif()

set(G4LIDAR_GOOGLETEST_SOURCE "/usr/src/googletest" CACHE PATH "GoogleTest's sources, for a cross build")
set(INSTALL_GTEST OFF)
add_subdirectory("${G4LIDAR_GOOGLETEST_SOURCE}" "${PROJECT_BINARY_DIR}/googletest" EXCLUDE_FROM_ALL)
