// SPDX-License-Identifier: MIT
// A lidar in memory, without a system call.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/transport/transport.hpp"
#include "pty_writer.hpp"

namespace g4lidar::bench {

/// A transport that returns a recording in bursts, at the rate of a real connection, and answers
/// the commands of a start.
class memory_transport final : public transport {
 public:
  memory_transport(const bench::recording& from, std::size_t scans, std::size_t burst,
                   const model& which, std::int64_t& now)
      : from_(from),
        left_(scans / 20),
        burst_(burst),
        baud_(which.bauds.front()),
        now_(now),
        scanning_(which.link == link_kind::one_way),
        device_(sim::built_in_world(), device_of(which)) {}

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    if (!scanning_) {
      now_ += 100'000;
      const std::size_t count = device_.read(out, now_);
      if (count == 0 && now_ < deadline_ns) now_ = std::min(deadline_ns, now_ + 10'000'000);
      return received{count, now_};
    }
    if (place_ == from_.data.size()) {
      place_ = 0;
      if (--left_ == 0) return failure(task::reading, problem::end_of_input);
    }
    const std::size_t count = std::min(burst_, from_.data.size() - place_);
    const std::int64_t there_ns =
        last_ns_ + static_cast<std::int64_t>(count * 10'000'000'000U / baud_);
    now_ = std::max(now_, std::min(there_ns, deadline_ns));
    if (now_ < there_ns) return received{};
    std::memcpy(out.data(), from_.data.data() + place_, count);
    place_ += count;
    last_ns_ = there_ns;
    return received{count, now_};
  }
  result<void> write(bytes data, std::int64_t /*deadline_ns*/) noexcept override {
    if (scanning_) return {};  // from now on it returns the recording only
    device_.write(data, now_);
    scanning_ = data.size() == 2 && data[1] == static_cast<std::uint8_t>(command::start);
    last_ns_ = now_;
    return {};
  }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    now_ = deadline_ns;
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return "memory"; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }

 private:
  static sim::device_options device_of(const model& which) {
    sim::device_options options;
    if (!sim::use_model(options, which.word)) std::abort();
    return options;
  }

  const bench::recording& from_;
  std::size_t left_;
  std::size_t burst_;
  std::uint32_t baud_;
  std::size_t place_ = 0;
  std::int64_t last_ns_ = 0;  // the time of the last burst
  std::int64_t& now_;
  bool scanning_;
  sim::device device_;
};

class memory_connector final : public connector {
 public:
  memory_connector(const bench::recording& from, std::size_t scans, std::size_t burst,
                   const model& which)
      : next_(std::make_unique<memory_transport>(from, scans, burst, which, now_)) {}
  result<std::unique_ptr<transport>> connect() noexcept override { return std::move(next_); }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_; }
  bool pause(std::int64_t /*deadline_ns*/) noexcept override { return true; }
  void wake() noexcept override {}

 private:
  std::int64_t now_ = 1'000'000'000;
  std::unique_ptr<transport> next_;
};

}  // namespace g4lidar::bench
