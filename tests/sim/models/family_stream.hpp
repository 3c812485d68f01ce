// SPDX-License-Identifier: MIT
// The models of the family as tests expect them on the wire, and what a simulated one sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/device.hpp"
#include "support/family_reference.hpp"
#include "support/host_side.hpp"

namespace g4lidar::test {

/// One model. Written from the facts about the family, not from a table of the library.
struct family_model {
  std::string word;
  std::string like;  ///< Its format in reference::wire_formats.
  double
      rate_hz;  ///< What is simulated: the usual rate, else the fastest that its connection carries.
  double nearest_mm;
  double farthest_mm;
  double turn_deg;  ///< From angle 0 to where the lidar looks.
  bool answers;

  [[nodiscard]] const reference::wire_format& format() const {
    for (const auto& each : reference::wire_formats) {
      if (each.model == like) return each;
    }
    return reference::wire_formats.front();
  }
};

inline std::ostream& operator<<(std::ostream& out, const family_model& which) {
  return out << which.word;
}

inline const std::vector<family_model> family_models{
    {"g4", "g4", 9000, 280, 16'000, 180, true},
    {"g4-pro", "g4", 9000, 280, 16'000, 180, true},
    {"g5", "g4", 9000, 280, 16'000, 180, true},
    {"f4", "g4", 4000, 120, 12'000, 180, true},
    {"f4-pro", "g4", 4000, 120, 12'000, 180, true},
    {"g1", "g4", 9000, 280, 16'000, 180, true},
    {"g2", "g2", 5000, 280, 16'000, 180, true},
    {"g2a", "g4", 5000, 100, 12'000, 180, true},
    {"g2c", "g4", 4000, 100, 12'000, 180, true},
    {"g4c", "g4", 4000, 100, 12'000, 180, true},
    {"g4b", "g2", 10'000, 120, 16'000, 180, true},
    {"r2", "g4", 5000, 120, 16'000, 180, true},
    {"g6", "g6", 18'000, 280, 25'000, 180, true},
    {"g7", "g6", 18'000, 280, 25'000, 180, true},
    {"x4", "x4", 5000, 120, 10'000, 0, true},
    {"x4-pro", "x4", 5000, 120, 10'000, 0, false},
    {"x2", "x4", 3000, 100, 8000, 0, false},
    {"x2l", "x4", 3000, 100, 8000, 0, false},
    {"x3", "x4", 3000, 100, 8000, 0, false},
    {"x3-pro", "x4", 4000, 100, 8000, 0, false},
    {"s2", "x4", 5000, 80, 12'000, 0, false},
    {"s2-pro", "x4", 5000, 80, 12'000, 0, false},
    {"s2-intensity", "s4b", 3000, 80, 12'000, 0, false},
    {"s2-pro-intensity", "s4b", 3000, 80, 12'000, 0, false},
    {"s4", "x4", 4000, 100, 8000, 0, true},
    {"s4b", "s4b", 4000, 100, 8000, 0, true},
    {"scl", "scl", 3000, 120, 8000, 0, false},
    {"t-mini", "t-mini", 4000, 50, 12'000, 0, true},
    {"t-mini-pro", "t-mini", 4000, 20, 12'000, 0, true},
    {"t-mini-plus", "t-mini", 4000, 50, 12'000, 0, true},
    {"t-mini-plus-sh", "t-mini-plus-sh", 4000, 50, 25'000, 0, true},
    {"tg15", "tg15", 20'000, 50, 30'000, 180, true},
    {"tg30", "tg15", 20'000, 50, 30'000, 180, true},
    {"tg50", "tg15", 20'000, 50, 50'000, 180, true},
    {"tx8", "tg15", 4000, 50, 8000, 0, false},
    {"tx20", "tg15", 4000, 50, 20'000, 0, false},
};

/// One model for each format.
inline std::vector<family_model> models_of_each_format() {
  std::vector<family_model> found;
  for (const family_model& each : family_models) {
    if (each.word == each.like) found.push_back(each);
  }
  return found;
}

[[nodiscard]] inline sim::device_options options_of(const std::string& word,
                                                    bool other_layout = false) {
  sim::device_options options;
  if (!sim::use_model(options, word, other_layout)) options.baud = 0;  // no valid option
  options.truth_capacity = 200'000;
  return options;
}

/// What a device sent in this time, and the true values. A two-way device is started.
struct sent_stream {
  byte_vector bytes;
  std::vector<sim::sent_sample> truth;
};
[[nodiscard]] inline sent_stream stream_of(const sim::device_options& options,
                                           std::int64_t duration_ns) {
  host_side host(options);
  if (!options.one_way) host.send(command::start);
  sent_stream sent{host.listen(duration_ns), {}};
  sent.truth.resize(options.truth_capacity);
  sent.truth.resize(host.device.take_truth(sent.truth));
  return sent;
}

/// Passes each packet of `bytes`, and the number of the bytes before it that are not of it.
template <class Take>
void for_each_packet(const byte_vector& bytes, const sample_format& format, Take take) {
  stream_parser parser(format);
  std::size_t skipped_bytes = 0;
  parser.feed(bytes, [&](const event& found) {
    if (const auto* const gone = std::get_if<skipped>(&found)) skipped_bytes += gone->count;
    if (const auto* const packet = std::get_if<packet_view>(&found)) {
      take(*packet, skipped_bytes);
      skipped_bytes = 0;
    }
  });
}

}  // namespace g4lidar::test
