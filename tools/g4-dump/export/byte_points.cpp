// SPDX-License-Identifier: MIT
#include "byte_points.hpp"

#include <variant>

namespace g4_tool {
namespace {

/// Its times were counted from its samples, so they do not show its duration.
scan_record record_of(const g4lidar::scan& scan) {
  scan_record made{.scan = scan};
  if (!scan.points.empty()) made.time_ns = scan.points.front().time_ns;
  g4lidar::scan untimed = scan;
  untimed.duration_ns = 0;
  made.measured_hz = static_cast<double>(untimed.measured_frequency_hz());
  return made;
}

}  // namespace

byte_points::byte_points(point_writer& writer, text_sink& out, std::uint32_t rate_hz,
                         const model& which, std::optional<zero_angle> zero)
    : out_(out),
      writer_(writer),
      by_scan_(writer.takes_scans()),
      named_(&which),
      which_(&which),
      clock_(rate_hz),
      scan_storage_(by_scan_ ? 2 * largest_scan(which) : 1),
      assembler_(scan_storage_, which) {
  assembler_.set_sample_rate(rate_hz);
  if (zero) decoder_.zero().set(*zero, zero_offset::known_by::user);
}

void byte_points::take(g4lidar::bytes data) {
  bytes_ += data.size();
  parser_.feed(data, [this](const event& found) { take(found); });
}

void byte_points::finish() {
  while (const auto found = parser_.finish()) take(*found);
  if (!by_scan_) return;
  if (const auto scan = assembler_.finish()) {
    writer_.write_scan(record_of(*scan), out_);
  }
}

void byte_points::take(const event& found) {
  counts_.add(found);
  if (const auto* heard = std::get_if<response_view>(&found)) return take(*heard);
  replies_.pass();
  if (const auto* packet = std::get_if<packet_view>(&found)) return take(*packet);
  if (const auto* gone = std::get_if<skipped>(&found)) {
    in_ct_.add(*gone);
    angles_.lost();
    assembler_.add(*gone);
  }
}

void byte_points::take(const response_view& heard) {
  const auto stated = replies_.take(heard, *which_);
  if (stated.zero) decoder_.zero().set(*stated.zero, zero_offset::known_by::device);
  if (!stated.firmware) return;
  check_number(stated.firmware->model);
  which_ = &with_firmware(*named_, *stated.firmware);
  parser_.set_layout(which_->samples.layout);
  const zero_offset zero = decoder_.zero();
  decoder_ = bulk_decoder(*which_);
  decoder_.zero() = zero;
  assembler_.become(*which_);
}

void byte_points::check_number(std::uint8_t number) noexcept {
  if (number != 0 && !detail::may_report(*named_, number)) other_number_ = number;
}

void byte_points::take(g4lidar::packet_view packet) {
  if (counts_.packets == 1) writer_.begin(out_);
  // NOLINTNEXTLINE(bugprone-unchecked-optional-access): checked in the same expression
  if (in_ct_.add(packet)) check_number(in_ct_.last()->id_low_bits);
  g4lidar::decoded decoded = without_points(packet, revolutions_.count(packet));
  if (!decoded.suspect) {
    g4lidar::bytes data = packet.data();
    decoded.points = decoder_.decode(data, points_);
    lacks_zero_ = lacks_zero_ || (which_->zero_angle_divisor != 0 && !decoder_.zero().angle());
  }
  for (g4lidar::point& p : std::span(points_).first(decoded.points.size())) {
    p.revolution = decoded.revolution;
    p.time_ns = clock_.now_ns();
    clock_.tick();
  }
  if (!angles_.fits(packet)) mark_unlikely(std::span(points_).first(decoded.points.size()));
  // The samples of a suspect packet were also measured, although their angles are not known. The
  // clock begins with the first point.
  if (decoded.suspect && counts_.points > 0) clock_.tick(decoded.sample_count);
  if (!by_scan_) return writer_.write_points(decoded.points, out_);
  if (counts_.crc.last() == ct_check::result::mismatch) assembler_.crc_mismatch();
  while (const auto scan = assembler_.next(decoded)) {
    writer_.write_scan(record_of(*scan), out_);
  }
}

}  // namespace g4_tool
