// SPDX-License-Identifier: MIT
// Raw bytes of a lidar as points or revolutions, with times counted from samples, in constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/sample_clock.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/export/point_writer.hpp"
#include "g4lidar/export/text_sink.hpp"
#include "g4lidar/plausibility.hpp"

namespace g4lidar {

/// Parses and decodes bytes and passes them to a point_writer: as points, or as revolutions if the
/// writer accepts these. Raw bytes contain no times, so they are counted from the first point on at
/// a constant rate; samples of suspect packets are counted, lost ones are not. Points of a packet
/// whose angles do not fit (angle_check) are flagged unlikely. *Single thread, allocates on
/// construction*; exceptions of the sink are passed on.
class G4LIDAR_API byte_points {
 public:
  /// `writer` and `out` must outlive this. `sample_rate_hz`: 1 to 10^9. The bytes are those of a lidar
  /// like `which`, whose `samples` and `range` are copied.
  byte_points(point_writer& writer, text_sink& out, std::uint32_t sample_rate_hz,
              const model& which = g4_model);

  /// Adds the next bytes, in pieces of any size.
  void take(g4lidar::bytes data);
  /// The bytes have ended: writes the last piece of a revolution.
  void finish();

  /// What the parser found so far.
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// The number of bytes added so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  void take(const event& found);
  void take(packet_view packet);

  text_sink& out_;
  point_writer& writer_;
  bool by_scan_;
  std::uint64_t bytes_ = 0;
  sample_format format_;
  std::uint16_t shortest_mm_;
  stream_parser parser_{format_};
  stream_counter counts_;
  revolution_counter revolutions_;
  angle_check angles_;
  sample_clock clock_;
  std::array<point, max_samples> points_{};
  std::vector<point> scan_storage_;
  scan_assembler assembler_;
};

}  // namespace g4lidar
