# SPDX-License-Identifier: MIT
# cmake --install: headers, libraries, the CMake package g4lidar, and two pkg-config files.
