// SPDX-License-Identifier: MIT
// Raw bytes of a lidar as points or revolutions, with times counted from samples, in constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/bulk_decoder.hpp"
#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/sample_clock.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/core/zero_offset.hpp"
#include "g4lidar/plausibility.hpp"
#include "io/text_sink.hpp"
#include "point_writer.hpp"

namespace g4_tool {

/// Parses and decodes bytes and passes them to a point_writer: as points, or as revolutions if the
/// writer accepts these. Raw bytes contain no times, so they are counted from the first point on at
/// a constant rate; samples of suspect packets are counted, lost ones are not. Points of a packet
/// whose angles do not fit (angle_check) are flagged unlikely. What the bytes state of the firmware and of the
/// offset of zero holds from there on, as for a lidar; see reply_watch. *Single thread, allocates on
/// construction*; exceptions of the sink are passed on.
class byte_points {
 public:
  /// `writer` and `out` must outlive this. `sample_rate_hz`: 1 to 10^9. The bytes are those of a lidar
  /// like `which`, which is valid as long as this. `zero`: what is added to each angle, whatever the bytes state.
  byte_points(point_writer& writer, text_sink& out, std::uint32_t sample_rate_hz,
              const model& which = g4_model, std::optional<zero_angle> zero = {});

  /// Adds the next bytes, in pieces of any size.
  void take(g4lidar::bytes data);
  /// The bytes have ended: writes the last piece of a revolution.
  void finish();

  /// What the parser found so far.
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// The number of bytes added so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Whether there are points without the offset of zero that their model has.
  [[nodiscard]] bool lacks_zero() const noexcept { return lacks_zero_; }
  /// A number that the bytes state and that the model does not have; 0: there was none.
  [[nodiscard]] std::uint8_t other_number() const noexcept { return other_number_; }

 private:
  void take(const event& found);
  void take(packet_view packet);
  void take(const response_view& heard);
  void check_number(std::uint8_t number) noexcept;

  text_sink& out_;
  point_writer& writer_;
  bool by_scan_;
  std::uint64_t bytes_ = 0;
  const model* named_;  // whatever the firmware
  const model* which_;
  stream_parser parser_{which_->samples};
  reply_watch replies_;
  ct_information_reader in_ct_;
  bool lacks_zero_ = false;
  std::uint8_t other_number_ = 0;
  bulk_decoder decoder_{*which_};  // of one packet at a time
  stream_counter counts_;
  revolution_counter revolutions_;
  angle_check angles_;
  sample_clock clock_;
  std::array<point, max_samples> points_{};
  std::vector<point> scan_storage_;
  scan_assembler assembler_;
};

}  // namespace g4_tool
