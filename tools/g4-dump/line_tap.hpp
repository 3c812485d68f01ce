// SPDX-License-Identifier: MIT
// Listens to what goes over the lines of a connector, both ways.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "g4lidar/bytes.hpp"
#include "g4lidar/connector.hpp"
#include "g4lidar/transport.hpp"

namespace g4_dump {

/// Something that was heard, in order. Kept until somebody takes it: a line cannot write to a file that
/// may fail.
struct heard_item {
  enum class kind : std::uint8_t { opened, closed, from_device, to_device };
  kind what;
  std::int64_t time_ns;
  std::vector<std::uint8_t> data{};
  std::string line{};  ///< Of `opened`.
};
using heard_items = std::vector<heard_item>;

/// `lines`, with everything that goes over them put into `heard`, which outlives what this gives.
[[nodiscard]] std::unique_ptr<g4lidar::connector> tapped(std::unique_ptr<g4lidar::connector> lines,
                                                         heard_items& heard);

}  // namespace g4_dump
