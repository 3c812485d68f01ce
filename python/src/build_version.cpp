// SPDX-License-Identifier: MIT
// The only source that a new version compiles again.
extern const char* const build_version;
const char* const build_version = G4LIDAR_PYTHON_VERSION;
