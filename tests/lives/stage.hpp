// SPDX-License-Identifier: MIT
// Where a life takes place: a device, the time, and lines that are watched.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/connector.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/virtual_port.hpp"

namespace g4lidar::lives {

/// The calls of a driver to its lines.
struct line_calls {
  std::uint64_t reads = 0;  ///< That brought something,
  std::uint64_t empty = 0;  ///< and those that did not.
  std::uint64_t writes = 0;
  std::uint64_t pauses = 0;
  std::uint64_t connects = 0;
};

struct stage {
  stage(const sim::device_options& options, std::span<const sim::fault> faults)
      : device(sim::built_in_world(), options, faults) {}

  sim::device device;
  sim::virtual_clock clock;
  line_calls calls;
  std::function<void()> on_call;    ///< Before each call: all that was read before is digested.
  std::int64_t wake_ns = never_ns;  ///< Then somebody wakes the driver, once.
  std::function<void()> wake;
};

/// A line that tells of each call, and in which somebody may wake the driver.
class watched_line final : public transport {
 public:
  explicit watched_line(stage& on, std::unique_ptr<transport> line)
      : stage_(&on), line_(std::move(line)) {}

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    stage_->on_call();
    auto got = line_->read(out, until(deadline_ns));
    if (got && got->count == 0 && wakes()) got = line_->read(out, deadline_ns);
    ++(got && got->count > 0 ? stage_->calls.reads : stage_->calls.empty);
    return got;
  }
  result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    stage_->on_call();
    ++stage_->calls.writes;
    return line_->write(data, deadline_ns);
  }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    stage_->on_call();
    ++stage_->calls.pauses;
    auto done = line_->pause(until(deadline_ns));
    if (done && wakes()) done = line_->pause(deadline_ns);
    return done;
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return line_->now_ns(); }
  void wake() noexcept override { line_->wake(); }
  [[nodiscard]] std::string_view name() const noexcept override { return line_->name(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return line_->baud(); }

 private:
  [[nodiscard]] std::int64_t until(std::int64_t deadline_ns) const noexcept {
    return std::min(deadline_ns, std::max(stage_->wake_ns, now_ns()));
  }
  [[nodiscard]] bool wakes() noexcept {
    if (now_ns() < stage_->wake_ns) return false;
    stage_->wake_ns = never_ns;
    stage_->wake();
    return true;
  }

  stage* stage_;
  std::unique_ptr<transport> line_;
};

class watched_connector final : public connector {
 public:
  explicit watched_connector(stage& on) : stage_(&on), connector_(on.device, on.clock) {}

  result<std::unique_ptr<transport>> connect() noexcept override {
    stage_->on_call();
    ++stage_->calls.connects;
    auto line = connector_.connect();
    if (!line) return line;
    return std::make_unique<watched_line>(*stage_, std::move(*line));
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return connector_.now_ns(); }
  bool pause(std::int64_t deadline_ns) noexcept override {
    stage_->on_call();
    ++stage_->calls.pauses;
    return connector_.pause(deadline_ns);
  }
  void wake() noexcept override { connector_.wake(); }

 private:
  stage* stage_;
  sim::virtual_connector connector_;
};

}  // namespace g4lidar::lives
