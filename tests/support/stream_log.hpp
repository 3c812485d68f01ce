// SPDX-License-Identifier: MIT
// Runs the parser over an input in pieces with the shortest possible lifetime, and logs its results
// in the terms of the reference, so that the two can be compared.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/stream_parser.hpp"
#include "support/event_text.hpp"
#include "support/reference_parser.hpp"

namespace g4lidar::test {

using buffer = std::vector<std::uint8_t>;

[[nodiscard]] inline reference::kind kind_of(const event& found) {
  if (std::holds_alternative<packet_view>(found)) return reference::kind::packet;
  if (std::holds_alternative<response_view>(found)) return reference::kind::response;
  if (std::holds_alternative<time_packet_view>(found)) return reference::kind::time_packet;
  if (std::holds_alternative<empty_packet_view>(found)) return reference::kind::empty_packet;
  switch (std::get<skipped>(found).reason) {
    case skip_reason::noise:
      return reference::kind::noise;
    case skip_reason::bad_header:
      return reference::kind::bad_header;
    case skip_reason::bad_checksum:
      return reference::kind::bad_checksum;
    case skip_reason::truncated:
      break;
  }
  return reference::kind::truncated;
}

/// Observes a parser: collects its events and records the first promise that it breaks.
class stream_log {
 public:
  explicit stream_log(const buffer& whole) : whole_(whole) {}

  /// Feeds the next `count` bytes of the complete input, in memory of their own.
  void feed(stream_parser& parser, std::size_t count) {
    const auto from = whole_.begin() + static_cast<std::ptrdiff_t>(fed_);
    const buffer piece(from, from + static_cast<std::ptrdiff_t>(count));
    fed_ += count;
    bytes rest(piece);
    while (const auto found = parser.next(rest)) {
      take(*found);
      expect(reported_ + parser.held() + rest.size() == fed_, "bytes went astray after an event");
    }
    expect(rest.empty(), "input is left though there is no event");
    expect(reported_ + parser.held() == fed_, "bytes went astray");
    expect(parser.held() < max_packet_size, "too many bytes are held");
  }

  /// Ends the input.
  void finish(stream_parser& parser) {
    held_from_ = fed_ - parser.held();
    while (const auto found = parser.finish()) {
      take(*found);
      expect(reported_ + parser.held() == fed_, "bytes went astray in finish()");
    }
    expect(reported_ == fed_ && parser.held() == 0, "finish() leaves bytes behind");
  }

  [[nodiscard]] const std::vector<reference::stretch>& stretches() const { return stretches_; }
  /// The offset of the bytes that were held when finish() was called.
  [[nodiscard]] std::size_t held_from() const { return held_from_; }
  /// The first broken promise; empty if none is.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  void take(const event& found) {
    const std::size_t size = size_of(found);
    const reference::kind what = kind_of(found);
    expect(size > 0, "an event of no bytes");
    if (std::holds_alternative<skipped>(found)) {
      if (!stretches_.empty() && stretches_.back().what == what) {
        stretches_.back().size += size;
      } else {
        stretches_.push_back({reported_, size, what});
      }
    } else {
      const bytes data = transcript::data_of(found);
      const auto place = whole_.begin() + static_cast<std::ptrdiff_t>(reported_);
      expect(reported_ + size <= fed_ && std::equal(data.begin(), data.end(), place),
             "a view of other bytes than those of the input");
      stretches_.push_back({reported_, size, what});
    }
    reported_ += size;
  }

  void expect(bool holds, const char* otherwise) {
    if (!holds && complaint_.empty()) {
      complaint_ = std::string(otherwise) + " at byte " + std::to_string(reported_);
    }
  }

  const buffer& whole_;
  std::size_t fed_ = 0;
  std::size_t reported_ = 0;  // bytes covered by the events so far
  std::size_t held_from_ = 0;
  std::vector<reference::stretch> stretches_;
  std::string complaint_;
};

/// The first difference between the log and the reference, as text; empty if there is none.
[[nodiscard]] inline std::string difference(const stream_log& log,
                                            const reference::reading& wanted) {
  if (!log.complaint().empty()) return log.complaint();
  const auto& got = log.stretches();
  const auto [a, b] =
      std::mismatch(got.begin(), got.end(), wanted.stretches.begin(), wanted.stretches.end());
  const auto text = [](auto at, auto end) {
    if (at == end) return std::string("the end");
    return reference::name_of(at->what) + " of " + std::to_string(at->size) + " at byte " +
           std::to_string(at->offset);
  };
  if (a != got.end() || b != wanted.stretches.end()) {
    return "the parser has " + text(a, got.end()) + ", the reference " +
           text(b, wanted.stretches.end());
  }
  if (log.held_from() != wanted.held_from) {
    return "held from byte " + std::to_string(log.held_from()) + ", not " +
           std::to_string(wanted.held_from);
  }
  return {};
}

}  // namespace g4lidar::test
