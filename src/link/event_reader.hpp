// SPDX-License-Identifier: MIT
// The events in the bytes of one read at a time, and the place that was reached in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>

#include "g4lidar/core/stream_parser.hpp"
#include "sample_size_watch.hpp"

namespace g4lidar {

/// *Single thread, never allocates.*
class event_reader {
 public:
  explicit event_reader(sample_format format = g4_format) noexcept : parser_(format) {}

  /// The bytes of one read; valid until they are parsed. Only if the bytes before are parsed.
  void feed(bytes reading, std::int64_t arrival_ns) noexcept {
    input_ = reading;
    arrival_ns_ = arrival_ns;
    events_ = 0;
    if (!sizes_) return;
    sizes_->take(input_);
    if (sizes_->is_settled()) sizes_.reset();
  }
  /// No more bytes follow: the unparsed bytes are discarded, and the next calls of next() parse the
  /// held bytes again.
  void cut() noexcept {
    input_ = {};
    is_cutting_ = true;
  }
  /// The next event, or nothing; valid until the next call. Inlined, and constructed in its place: a copy costs
  /// more than the rest.
  [[nodiscard, gnu::always_inline]] const event* next() noexcept {
    if (is_cutting_) {
      event_ = parser_.finish();
      is_cutting_ = event_.has_value();
    } else {
      const std::size_t before = input_.size();
      new (&event_) std::optional<event>(parser_.next(input_));
      bytes_ += before - input_.size();
    }
    return current();
  }
  /// The last event, until pass().
  [[nodiscard]] const event* current() const noexcept { return event_ ? &*event_ : nullptr; }
  /// The last event has been handled.
  void pass() noexcept {
    ++events_;
    event_.reset();
  }
  /// Whether next() returns nothing, and the last event has been handled.
  [[nodiscard]] bool is_empty() const noexcept { return input_.empty() && !is_cutting_ && !event_; }

  [[nodiscard]] const stream_parser& parser() const noexcept { return parser_; }

  /// The packets that follow are of another format. Bytes that are held are dropped.
  void become(sample_format format) noexcept { parser_ = stream_parser(format); }
  /// A stream begins whose samples should have this size: until they have, it is watched.
  void expect(std::size_t sample_bytes) noexcept { sizes_.emplace(sample_bytes); }
  /// The samples since expect(), if they have another size. See sample_size_watch::other().
  [[nodiscard]] stream_samples other() const noexcept {
    return sizes_ ? sizes_->other() : stream_samples{};
  }
  /// Whether the samples since expect() have another size, whatever else is known of them.
  [[nodiscard]] bool has_other_size() const noexcept { return sizes_ && sizes_->is_other(); }
  /// Whether packets since expect() have shown that the size is right.
  [[nodiscard]] bool is_as_expected() const noexcept { return !sizes_; }
  /// See stream_parser::set_layout().
  void set_layout(sample_layout layout) noexcept { parser_.set_layout(layout); }

  // ---- the place ----
  [[nodiscard]] bytes unparsed() const noexcept { return input_; }
  /// The events of the last read that have been handled.
  [[nodiscard]] std::uint32_t events_of_reading() const noexcept { return events_; }
  [[nodiscard]] std::int64_t arrival_ns() const noexcept { return arrival_ns_; }
  /// Bytes of an unfinished packet or response, and how many are missing at least.
  [[nodiscard]] std::size_t held() const noexcept { return parser_.held(); }
  [[nodiscard]] std::size_t missing() const noexcept { return parser_.missing(); }
  /// All bytes that were parsed.
  [[nodiscard]] std::uint64_t bytes_parsed() const noexcept { return bytes_; }

 private:
  stream_parser parser_;
  bytes input_;
  std::int64_t arrival_ns_ = 0;
  std::optional<event> event_;
  std::uint32_t events_ = 0;
  bool is_cutting_ = false;
  std::uint64_t bytes_ = 0;
  std::optional<sample_size_watch> sizes_;
};

}  // namespace g4lidar
