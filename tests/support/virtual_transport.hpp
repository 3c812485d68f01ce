// SPDX-License-Identifier: MIT
// The simulated device as a transport of a driver, in virtual time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

/// A device and the time, shared by all transports to it.
struct virtual_bench {
  explicit virtual_bench(const sim::device_options& options = {},
                         std::span<const sim::fault> faults = {})
      : device(sim::built_in_world(), options, faults) {}

  sim::device device;
  std::int64_t now_ns = 1'000'000'000;
  std::int64_t step_ns = 1'000;   ///< The time that each call takes.
  std::uint32_t baud = 230400;    // of the transport
  std::size_t kept_bytes = 4095;  ///< While nobody reads.
  bool watches = true;            ///< Whether the connector learns of a replug.
  std::size_t largest_read = 0;
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t pauses = 0;
  std::atomic<bool> wake = false;

  [[nodiscard]] bool woken() noexcept { return wake.exchange(false); }
};

class virtual_transport final : public transport {
 public:
  explicit virtual_transport(virtual_bench& bench)
      : bench_(&bench), replugs_(bench.device.replugs()) {}

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    ++bench_->reads;
    bench_->now_ns += bench_->step_ns;
    while (true) {
      if (is_gone()) return failure(task::reading, problem::gone, name());
      if (bench_->woken()) return failure(task::reading, problem::cancelled, name());
      const std::size_t count = bench_->device.read(out, bench_->now_ns);
      bench_->largest_read = std::max(bench_->largest_read, count);
      if (count > 0 || bench_->now_ns >= deadline_ns) return received{count, bench_->now_ns};
      wait(deadline_ns);
    }
  }
  result<void> write(bytes data, std::int64_t /*deadline_ns*/) noexcept override {
    ++bench_->writes;
    bench_->now_ns += bench_->step_ns;
    if (is_gone()) return failure(task::writing, problem::gone, name());
    bench_->device.write(data, bench_->now_ns);
    return {};
  }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    ++bench_->pauses;
    bench_->now_ns += bench_->step_ns;
    while (bench_->now_ns < deadline_ns) {
      if (is_gone()) return failure(task::reading, problem::gone, name());
      if (bench_->woken()) return failure(task::reading, problem::cancelled, name());
      // Bytes may arrive at any time: only the unplug is checked.
      bench_->now_ns = std::min(deadline_ns, bench_->now_ns + 1'000'000);
    }
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return bench_->now_ns; }
  void wake() noexcept override { bench_->wake = true; }
  [[nodiscard]] std::string_view name() const noexcept override { return "virtual"; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return bench_->baud; }
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return bench_->kept_bytes; }

 private:
  /// A transport that was opened before an unplug stays invalid.
  [[nodiscard]] bool is_gone() noexcept {
    return !bench_->device.is_plugged(bench_->now_ns) || bench_->device.replugs() != replugs_;
  }
  void wait(std::int64_t deadline_ns) noexcept {
    const std::int64_t next = bench_->device.next_ns(bench_->now_ns);
    bench_->now_ns = std::min(deadline_ns, std::max(next, bench_->now_ns + 1));
  }

  virtual_bench* bench_;
  std::uint64_t replugs_;
};

/// Returns transports to the device while it is plugged in.
class virtual_connector final : public connector {
 public:
  explicit virtual_connector(virtual_bench& bench) : bench_(&bench) {}

  result<std::unique_ptr<transport>> connect() noexcept override {
    bench_->now_ns += bench_->step_ns;
    if (!bench_->device.is_plugged(bench_->now_ns)) {
      return failure(task::finding, problem::no_port, "virtual");
    }
    return std::make_unique<virtual_transport>(*bench_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return bench_->now_ns; }
  bool pause(std::int64_t deadline_ns) noexcept override {
    if (bench_->woken()) return false;
    bench_->now_ns += bench_->step_ns;
    while (bench_->now_ns < deadline_ns && !has_returned()) {
      bench_->now_ns = std::min(deadline_ns, bench_->now_ns + 1'000'000);
    }
    return true;
  }
  bool may_be_back() noexcept override {
    const bool changed = has_returned();
    replugs_ = bench_->device.replugs();
    return changed;
  }
  void wake() noexcept override { bench_->wake = true; }

 private:
  [[nodiscard]] bool has_returned() noexcept {
    return bench_->watches && bench_->device.is_plugged(bench_->now_ns) &&
           bench_->device.replugs() != replugs_;
  }

  virtual_bench* bench_;
  std::uint64_t replugs_ = 0;
};

inline result<lidar> open_virtual(virtual_bench& bench, const lidar_options& options = {}) {
  return lidar::open(std::make_unique<virtual_connector>(bench), options);
}

}  // namespace g4lidar::test
