// SPDX-License-Identifier: MIT
// What raw bytes are, before a connector is made of them.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "survey/stream_survey.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar {

/// Without waiting for a writer of a pipe; "-" is standard input.
[[nodiscard]] owned_fd open_bytes(const std::string& name) noexcept;
/// Of the regular file from `offset` on: the first 64 KiB, and up to 1 MiB until the size of a sample is decided.
[[nodiscard]] stream_survey surveyed_at(const owned_fd& fd, off_t offset);
[[nodiscard]] recognised_model model_of(const stream_survey& seen) noexcept;
/// Why a file with these bytes cannot be read; nothing if a part of it may be packets.
[[nodiscard]] std::optional<error> refusal_of(const stream_survey& seen, std::string_view title,
                                              const model* named = nullptr);

/// Why the regular file at `path` cannot be read as of `named`: packets of which samples have another size (other_device), or
/// no packets, but text or frames of another maker. Nothing if it can, or is not known. Allocates.
[[nodiscard]] std::optional<error> problem_with_bytes(const std::string& path, const model& named);

}  // namespace g4lidar
