// SPDX-License-Identifier: MIT
// From bytes to points in a ring and revolutions, whether the bytes are live or recorded.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/lidar.hpp"
#include "link/event_reader.hpp"
#include "timed_decoder.hpp"

namespace g4lidar {

/// *Allocates on open.* Memory that takes no pages before it is written: room for the largest number of points, of which a program mostly uses few: a vector
/// would write to all of it. Only what was written may be read.
class point_storage {
 public:
  explicit point_storage(std::size_t count)
      : points_(static_cast<point*>(::operator new(count * sizeof(point)))), count_(count) {
    static_assert(std::is_aggregate_v<point> && std::is_trivially_destructible_v<point>);
  }
  point_storage(const point_storage&) = delete;
  point_storage& operator=(const point_storage&) = delete;
  ~point_storage() { ::operator delete(points_); }

  /// Room for other points: those before are destroyed.
  void resize(std::size_t count) {
    auto* const made = static_cast<point*>(::operator new(count * sizeof(point)));
    ::operator delete(std::exchange(points_, made));
    count_ = count;
  }

  [[nodiscard]] std::span<point> all() noexcept { return {points_, count_}; }

 private:
  point* points_;
  std::size_t count_;
};

/// *Allocates on open.* The ring of a lidar and its first reader, which are made when the first of them is wanted, in
/// memory that takes no pages before.
class lazy_ring {
 public:
  /// A ring that begins with point 0, and its reader. *Any thread.*
  struct ring_and_reader {
    explicit ring_and_reader(std::span<lidar_ring::slot> memory) noexcept : ring(memory) {}

    lidar_ring ring;
    lidar_ring::reader reader = ring.make_reader();
  };

  /// For the points of at least 1.8 s at the highest sample rate of the model.
  explicit lazy_ring(const model& model)
      : size_(std::bit_ceil(std::max(least, std::size_t{highest_rate_hz(model)} * 9 / 5))),
        memory_(::operator new(sizeof(ring_and_reader) + size_ * sizeof(lidar_ring::slot))) {
    static_assert(std::is_trivially_destructible_v<ring_and_reader> &&
                  std::is_trivially_destructible_v<lidar_ring::slot>);
    static_assert(sizeof(ring_and_reader) % alignof(lidar_ring::slot) == 0);
  }
  lazy_ring(const lazy_ring&) = delete;
  lazy_ring& operator=(const lazy_ring&) = delete;
  ~lazy_ring() { ::operator delete(memory_); }

  /// *Any thread.*
  [[nodiscard]] ring_and_reader& made_once() noexcept {
    std::call_once(once_, [this] {
      auto* const slots =
          reinterpret_cast<lidar_ring::slot*>(static_cast<ring_and_reader*>(memory_) + 1);
      std::uninitialized_value_construct_n(slots, size_);
      made_.store(new (memory_) ring_and_reader({slots, size_}), std::memory_order_release);
    });
    return *if_made();
  }
  /// Nothing before the first call of made_once().
  [[nodiscard]] ring_and_reader* if_made() const noexcept {
    return made_.load(std::memory_order_acquire);
  }

 private:
  static constexpr std::size_t least = 16'384;

  std::size_t size_;  // in points
  void* memory_;
  std::once_flag once_;
  std::atomic<ring_and_reader*> made_ = nullptr;
};

/// *Single thread, allocates on open.* The bytes of one read are fed at a time. Then, until nothing
/// is left:
///
///     find_scan()   decodes the last event, if points are wanted; stops at a scan
///     next()        the next event; the caller handles it before the next find_scan()
///
/// So a scan is delivered before the following bytes are parsed, and nothing here calls back.
class point_pipeline {
 public:
  point_pipeline(std::int64_t transport_delay_ns, bool partial_scans, const model& model = g4_model)
      : which_(&model),
        partial_scans_(partial_scans),
        input_(model.samples),
        decoder_(transport_delay_ns, model),
        ring_(model),
        storage_(largest_scan(model)),
        assembler_(storage_.all(), model) {}

  /// The bytes of one read at a time, and the place in them. Fed only if is_empty().
  [[nodiscard]] event_reader& input() noexcept { return input_; }
  [[nodiscard]] const event_reader& input() const noexcept { return input_; }
  /// Whether everything that was fed has been processed.
  [[nodiscard]] bool is_empty() const noexcept { return input_.is_empty() && !scan_ && !is_open_; }

  // ---- events ----

  /// The next event, or nothing; valid until the next call. Only after find_scan() has returned
  /// false.
  [[nodiscard]] const event* next() noexcept;

  /// Whether packets produce points from here on, including the packet of the last event.
  void deliver(bool wanted) noexcept { delivers_ = wanted; }
  [[nodiscard]] bool delivers() const noexcept { return delivers_; }
  /// A new stream of points begins, including those of the last event. The unfinished revolution
  /// becomes a piece. See timed_decoder::begin().
  void begin(std::uint32_t sample_rate_hz, bool counts_times = false) noexcept;
  /// The stream of points has ended: the unfinished revolution becomes a piece.
  void end() noexcept;
  /// The following bytes are from another transport; see transport::baud(). Before begin(). With
  /// `times_restart` their times may be earlier ones.
  void follow(std::uint32_t baud, bool times_restart = false) noexcept {
    if (times_restart) decoder_.forget();
    decoder_.follow(baud);
  }

  /// A command was sent: the answer to 93 is added to all angles behind it, and that to 90 has the firmware.
  void sent(bytes command) noexcept { replies_.sent(command); }
  /// Packets are read as the firmware of this device sends them.
  void identified(const device_information& who) noexcept;
  /// The bytes that follow are those of a lidar like `model`, whatever the size of its samples: a new stream of points
  /// begins with the usual sample rate. Only if is_empty(). *Allocates.*
  void become(const model& model, std::uint32_t baud);
  /// What is added to all angles.
  [[nodiscard]] zero_offset& zero() noexcept { return decoder_.zero(); }

  // ---- scans ----

  /// Whether there is a scan. It must be taken or dropped before other calls.
  [[nodiscard]] bool find_scan() noexcept;
  [[nodiscard]] bool has_scan() const noexcept { return scan_.has_value(); }
  /// Valid until the next call of find_scan(), begin() or end().
  [[nodiscard]] scan take_scan() noexcept {
    const scan found = scan_.value_or(scan{});
    scan_.reset();
    return found;
  }
  /// It is counted as missed.
  void drop_scan() noexcept {
    if (scan_) ++counts_.scans_missed;
    scan_.reset();
  }

  /// Of the packets. Its next_sample_ns() is that of the last event.
  [[nodiscard]] const timed_decoder& decoder() const noexcept { return decoder_; }

  // ---- points ----

  /// The ring, which is written from the first call on. *Any thread.*
  [[nodiscard]] lidar_ring& ring() noexcept { return ring_.made_once().ring; }
  /// The oldest points that this function has not returned yet. The first call begins with those of
  /// a scan that was not taken, and of the unfinished revolution.
  [[nodiscard]] ring_read read(std::span<point> out) noexcept;
  /// Drops the points that read() would return, and returns their number.
  std::uint64_t drop_points() noexcept {
    auto* const made = ring_.if_made();
    if (made == nullptr) return 0;
    const std::uint64_t left = made->reader.ahead();
    made->reader = made->ring.make_reader();
    return left;
  }
  /// The points that were decoded before the ring was written.
  [[nodiscard]] std::uint64_t unwritten() const noexcept {
    const auto* const made = ring_.if_made();
    return points_ - (made != nullptr ? made->ring.written() : 0);
  }
  /// All counts except those of the caller.
  [[nodiscard]] lidar_counts counts() const noexcept;

 private:
  void add(packet_view packet) noexcept;
  void keep(const scan& found) noexcept;

  const model* which_;  // as given, whatever the firmware
  bool partial_scans_;
  bool delivers_ = false;
  bool is_open_ = false;  // the last packet may complete more scans
  event_reader input_;
  timed_decoder decoder_;
  reply_watch replies_;
  lazy_ring ring_;
  point_storage storage_;
  scan_assembler assembler_;
  std::array<point, max_samples> spare_{};  // used where the storage ends
  decoded open_{};
  std::optional<scan> scan_;
  lidar_counts counts_;
  std::uint64_t points_ = 0;  // decoded
  stream_counter stream_counts_;
};

}  // namespace g4lidar
