// SPDX-License-Identifier: MIT
// One clear message from compilers with an older standard. Every public header includes it,
// directly or indirectly, before other headers of this library.
#pragma once

#if __cplusplus < 202002L
#error "libg4lidar needs C++20: compile with -std=c++20 or later"
// A missing file ends the compilation; otherwise hundreds of errors would hide the message above.
#include <libg4lidar-needs-c++20>
#endif
