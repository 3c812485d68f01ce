// SPDX-License-Identifier: MIT
// Words in the metadata records of a file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/recording/contents.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

/// A map of strings to strings, as in metadata.
using word_map = std::vector<std::pair<std::string, std::string>>;
void put_map(record_text& out, const word_map& words);
/// The value of this name; empty if there is none.
[[nodiscard]] std::string word_in(field_reader map, std::string_view name);

inline constexpr std::string_view device_metadata = "g4lidar.device";
inline constexpr std::string_view digest_metadata = "g4lidar.digest";
/// The version of the computation of points from bytes. It increases with each change that gives
/// other points: digests of points of different versions cannot be compared. A recording without
/// one has version 1.
inline constexpr std::string_view points_version = "6";
[[nodiscard]] word_map words_of(const recorded_device& device);
/// `known`, and what only `before` knows.
[[nodiscard]] recorded_device joined(const recorded_device& before, const recorded_device& known);
/// Missing or invalid fields are not known.
[[nodiscard]] recorded_device device_of(field_reader& map);
/// The digests of a file, and the time of its last item.
[[nodiscard]] recorded_digest digest_of(field_reader& map, std::int64_t& last_ns);

}  // namespace g4lidar::mcap
