# SPDX-License-Identifier: MIT
# The headers of fmt alone: the library of the system is for another C++ library.
find_path(G4LIDAR_FMT_INCLUDE fmt/format.h REQUIRED)
add_library(fmt::fmt INTERFACE IMPORTED)
set_target_properties(
  fmt::fmt PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${G4LIDAR_FMT_INCLUDE}" INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY
)
