// SPDX-License-Identifier: MIT
// Raw bytes through the parser and the decoder to a writer, in constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/decode.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/stream_counts.hpp"
#include "g4lidar/stream_parser.hpp"
#include "output.hpp"
#include "point_writer.hpp"
#include "sample_clock.hpp"

namespace g4_dump {

/// The way of the bytes, from the parser to the writer. They tell no times: these are counted.
class byte_points {
 public:
  /// `writer` and `out` outlive this.
  byte_points(point_writer& writer, output& out, std::uint32_t rate_hz);

  void take(std::span<const std::uint8_t> data);
  /// No more will come.
  void finish();

  [[nodiscard]] const g4lidar::stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  // A G4 at its slowest makes 1,800 points in a revolution; this is nine times as many.
  static constexpr std::size_t max_scan_points = 16'384;

  void take(const g4lidar::event& found);
  void take(g4lidar::packet_view packet);

  output& out_;
  point_writer& writer_;
  bool by_scan_;
  std::uint32_t rate_hz_;
  std::uint64_t bytes_ = 0;
  g4lidar::stream_parser parser_;
  g4lidar::stream_counts counts_;
  g4lidar::revolution_counter revolutions_;
  sample_clock clock_;
  std::array<g4lidar::point, g4lidar::max_samples> points_{};
  std::vector<g4lidar::point> scan_storage_;
  g4lidar::scan_assembler assembler_;
};

}  // namespace g4_dump
