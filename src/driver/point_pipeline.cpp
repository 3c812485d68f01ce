// SPDX-License-Identifier: MIT
#include "point_pipeline.hpp"

#include <variant>

namespace g4lidar {

const event* point_pipeline::next() noexcept {
  const bool has_bytes = !input_.unparsed().empty();
  const event* const found = input_.next();
  if (found != nullptr) {
    stream_counts_.add(*found);
    if (const auto* const heard = std::get_if<response_view>(found)) {
      const auto stated = replies_.take(*heard, decoder_.like());
      if (stated.firmware) identified(*stated.firmware);
      if (stated.zero) zero().set(*stated.zero, zero_offset::stated_by::device);
    } else {
      replies_.pass();
    }
  } else if (has_bytes && delivers_) {
    decoder_.seen(input_.held(), input_.arrival_ns());
  }
  return found;
}

void point_pipeline::become(const model& model, std::uint32_t baud) {
  end();
  drop_scan();
  which_ = &model;
  input_.become(model.samples);
  decoder_.become(model);
  decoder_.forget_transport();
  decoder_.follow(baud);
  storage_.resize(largest_scan(model));
  assembler_ = scan_assembler(storage_.all(), model);
  begin(first_rate_hz(model));
}

void point_pipeline::identified(const device_information& who) noexcept {
  const model& now = with_firmware(*which_, who);
  if (&now == &decoder_.like()) return;
  input_.set_layout(now.samples.layout);
  decoder_.become(now);
  assembler_.become(now);
}

bool point_pipeline::find_scan() noexcept {
  while (!scan_) {
    if (is_open_) {
      const auto found = assembler_.next(open_);
      is_open_ = found.has_value();
      if (found) keep(*found);
    } else if (const event* const found = input_.current()) {
      const auto* const packet = std::get_if<packet_view>(found);
      const auto* const gone = std::get_if<skipped>(found);
      if (delivers_ && packet != nullptr) {
        add(*packet);
      } else if (delivers_ && gone != nullptr) {
        assembler_.add(*gone);
        decoder_.gone(*gone);
      }
      input_.pass();
    } else {
      return false;
    }
  }
  return true;
}

/// Decodes the packet into the storage of the scan, where its points stay.
void point_pipeline::add(packet_view packet) noexcept {
  const std::span<point> room = assembler_.room();
  const bool fits = room.size() >= max_samples;
  bool lost = false;
  open_ = decoder_.decode(packet, input_.arrival_ns(), input_.unparsed().size(),
                          fits ? room.first<max_samples>() : std::span(spare_), lost);
  points_ += open_.points.size();
  if (auto* const made = ring_.if_made()) made->ring.push(open_.points);
  if (stream_counts_.crc.last() == ct_check::result::mismatch) assembler_.crc_mismatch();
  if (lost) assembler_.lost();  // whole packets are missing, so no bytes were skipped
  is_open_ = true;
}

/// Counts a scan, and keeps it if the caller wants it: revolutions, also with lost points, and
/// pieces according to the options.
void point_pipeline::keep(const scan& found) noexcept {
  ++(found.is_piece() ? counts_.partial_scans : counts_.scans);
  if (found.is_piece() && !partial_scans_) return;
  drop_scan();
  scan_ = found;
}

ring_read point_pipeline::read(std::span<point> out) noexcept {
  if (ring_.if_made() == nullptr) {
    lidar_ring& first = ring();
    if (scan_) first.push(scan_->points);
    first.push(assembler_.unfinished());
    if (is_open_) first.push(open_.points);
  }
  return ring_.made_once().reader.read(out);
}

void point_pipeline::begin(std::uint32_t sample_rate_hz, bool counts_times) noexcept {
  end();
  decoder_.begin(sample_rate_hz, counts_times);
  stream_counts_.crc = {};
  assembler_.set_sample_rate(sample_rate_hz);
  input_.expect(sample_size(which_->samples.layout));
}

void point_pipeline::end() noexcept {
  if (const auto rest = assembler_.finish()) keep(*rest);
}

lidar_counts point_pipeline::counts() const noexcept {
  lidar_counts all = counts_;
  all.stream = stream_counts_;
  all.stream.points = points_;  // the packets of a device that is being stopped make none
  all.bytes = input_.bytes_parsed();
  all.held = input_.held();
  all.samples_lost = decoder_.samples_lost();
  all.largest_gap_ns = decoder_.largest_gap_ns();
  return all;
}

}  // namespace g4lidar
