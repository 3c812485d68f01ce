// SPDX-License-Identifier: MIT
// The source that precompiled.hpp is compiled for; the header is included by the build.
