// SPDX-License-Identifier: MIT
// Reads a transport when a read is worth its system calls.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>

#include "g4lidar/transport/transport.hpp"
#include "read_schedule.hpp"

namespace g4lidar {

/// What a read waits for.
enum class reading : std::uint8_t {
  at_once,  ///< Any byte.
  paced,    ///< When the next packet can be complete.
  scans,    ///< When the revolution can be complete.
  batched,  ///< The interval that the caller has chosen.
};

/// *Single thread.* *Allocates on open.*
class receiver {
 public:
  explicit receiver(std::chrono::nanoseconds batch, const model& model = g4_model)
      : batch_ns_(batch.count()), pace_(model) {}

  /// Another transport follows. `baud` 0: bytes take no time. See read_schedule.
  void reset(std::uint32_t baud, std::size_t kept, std::int64_t now_ns) noexcept {
    pace_.reset(baud, kept);
    read_until_ns_ = now_ns;
  }

  /// What is received comes from a lidar like `model`. Before reset().
  void become(const model& model) noexcept { pace_ = read_schedule(model); }

  /// One read, which waits until bytes arrive or the deadline. The result is valid until the next
  /// read. `held` bytes of a packet have arrived, and at least `missing` have not.
  [[nodiscard]] result<received> receive(transport& port, reading reading, std::size_t held,
                                         std::size_t missing, std::int64_t deadline_ns) noexcept {
    auto got = read(port, reading, again_ns(reading, held, missing), deadline_ns);
    // A program that is woken before each call must make progress, too: available bytes are read.
    if (is_woken(got)) got = port.read({buffer_.get(), size}, at_once);
    if (is_woken(got)) return received{};
    if (!got) return got;
    read_until_ns_ = got->count == 0 ? port.now_ns() : got->arrival_ns;
    if (got->count == 0) return got;
    pace_.received(got->count, got->arrival_ns);
    return got;
  }
  /// Begins with the bytes of the last read.
  [[nodiscard]] bytes buffer() const noexcept { return bytes(buffer_.get(), size); }

  /// A packet was complete; see read_schedule.
  void packet(packet_view found, std::size_t behind, std::int64_t measured_ns,
              double period_ns) noexcept {
    pace_.packet(found, behind, measured_ns, period_ns);
  }
  [[nodiscard]] bool is_batched() const noexcept { return batch_ns_ > 0; }
  /// Bytes that arrived by this time have been read.
  [[nodiscard]] std::int64_t read_until_ns() const noexcept { return read_until_ns_; }

  /// When a reading is worth its system calls; what comes before that is not waited for.
  [[nodiscard]] std::int64_t again_ns(reading pace, std::size_t held,
                                      std::size_t missing) const noexcept {
    if (pace == reading::batched) return read_until_ns_ + batch_ns_;
    if (pace == reading::at_once) return 0;
    return pace_.next_ns(held, missing, pace == reading::scans ? demand::scans : demand::points);
  }

 private:
  static constexpr std::size_t size = 65536;
  static constexpr std::int64_t at_once = 0;  // a deadline that has passed

  [[nodiscard]] static bool is_woken(const result<received>& got) noexcept {
    return !got && got.error() == problem::cancelled;
  }
  /// Waits until a read is worth it, then for bytes. After a wait they have usually arrived; a poll
  /// first would be an additional call.
  [[nodiscard]] result<received> read(transport& port, reading pace, std::int64_t again_ns,
                                      std::int64_t deadline_ns) noexcept {
    const std::int64_t until = std::min(again_ns, deadline_ns);
    const bool is_batched = pace == reading::batched;
    if (until > port.now_ns()) {
      const auto paused = port.pause(until);
      const bool woken = !paused && paused.error() == problem::cancelled;
      if (paused || woken) {  // a transport that broke is read to its end, like any other
        const auto got = port.read({buffer_.get(), size}, at_once);
        if (woken || is_batched || until == deadline_ns || !got || got->count > 0) return got;
        if (pace == reading::paced) pace_.nothing_complete();
      }
    }
    return port.read({buffer_.get(), size}, is_batched ? at_once : deadline_ns);
  }

  std::int64_t batch_ns_;
  /// Most reads need few pages of it.
  std::unique_ptr<std::uint8_t[]> buffer_ = std::make_unique_for_overwrite<std::uint8_t[]>(size);
  read_schedule pace_;
  std::int64_t read_until_ns_ = 0;
};

}  // namespace g4lidar
