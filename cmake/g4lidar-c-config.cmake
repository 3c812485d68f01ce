# SPDX-License-Identifier: MIT
# find_package(g4lidar-c): the target g4lidar::c, the C interface, a shared library. It needs nothing else, and no
# C++ compiler. find_package(g4lidar COMPONENTS c) finds it, too.
if(NOT TARGET g4lidar::c)
  include("${CMAKE_CURRENT_LIST_DIR}/g4lidar-c.cmake")
endif()
