// SPDX-License-Identifier: MIT
#include "byte_points.hpp"

#include <variant>

#include "g4lidar/correction.hpp"
#include "scan_summary.hpp"

namespace g4_dump {

byte_points::byte_points(point_writer& writer, output& out, std::uint32_t rate_hz)
    : out_(out),
      writer_(writer),
      by_scan_(writer.takes_scans()),
      rate_hz_(rate_hz),
      clock_(rate_hz),
      scan_storage_(by_scan_ ? max_scan_points : 1),
      assembler_(scan_storage_) {}

void byte_points::take(std::span<const std::uint8_t> data) {
  bytes_ += data.size();
  parser_.feed(data, [this](const g4lidar::event& found) { take(found); });
}

void byte_points::finish() {
  while (const auto found = parser_.finish()) take(*found);
  if (!by_scan_) return;
  if (const auto scan = assembler_.finish()) {
    writer_.write_scan(counted_scan(*scan, rate_hz_), out_);
  }
}

void byte_points::take(const g4lidar::event& found) {
  counts_.add(found);
  if (const auto* packet = std::get_if<g4lidar::packet_view>(&found)) return take(*packet);
  if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) assembler_.add(*gone);
}

void byte_points::take(g4lidar::packet_view packet) {
  if (counts_.packets == 1) writer_.begin(out_);
  g4lidar::decoded decoded =
      g4lidar::decode(packet, g4lidar::compact_correction{}, revolutions_.count(packet), points_);
  for (g4lidar::point& p : std::span(points_).first(decoded.points.size())) {
    p.time_ns = clock_.now_ns();
    clock_.tick();
  }
  // The samples of a suspect packet were measured, too, though nobody can tell where. The clock
  // begins with the first point.
  if (decoded.suspect && counts_.points > 0) clock_.tick(decoded.sample_count);
  if (!by_scan_) return writer_.write_points(decoded.points, out_);
  while (const auto scan = assembler_.next(decoded)) {
    writer_.write_scan(counted_scan(*scan, rate_hz_), out_);
  }
}

}  // namespace g4_dump
