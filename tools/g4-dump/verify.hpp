// SPDX-License-Identifier: MIT
// Whether a recording holds what was recorded, and gives the same points again.
#pragma once

#include <string>

namespace g4_dump {

/// Reads the recording twice: its bytes, and its points through the driver. Tells what was found.
/// Throws a failure, with exit code 10, where something is not as it was recorded, or the file does not
/// say how it was.
void verify(const std::string& path);

}  // namespace g4_dump
