// SPDX-License-Identifier: MIT
#include "soak.hpp"

#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "environment.hpp"
#include "g4lidar/lidar.hpp"
#include "parameters.hpp"
#include "text.hpp"

namespace g4lidar::simulation {
namespace {

using std::chrono::milliseconds;

std::int64_t memory_in_use() { return static_cast<std::int64_t>(mallinfo2().uordblks); }

std::int64_t open_handles() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return std::distance(begin(all), end(all));
}

class soaking {
 public:
  soaking() : environment_(device_options(), {}) {
    environment_.on_call = [] {};
    environment_.wake = [] {};
  }

  soak_report run(std::uint64_t unplugs) {
    lidar_options options;
    options.reconnect = true;
    auto opened = lidar::open(std::make_unique<observed_connector>(environment_), options);
    if (!opened || !opened->start()) return failed("it does not start");
    const std::uint64_t early = std::min<std::uint64_t>(unplugs / 10, 100);
    std::int64_t memory = 0;
    std::int64_t handles = 0;
    for (; report_.unplugs < unplugs; ++report_.unplugs) {
      if (report_.unplugs == early) {
        memory = memory_in_use();
        handles = open_handles();
      }
      if (!unplug_once(*opened)) return failed("it does not come back");
    }
    report_.reconnects = opened->counts().reconnects;
    report_.grown_bytes = memory_in_use() - memory;
    report_.grown_handles = open_handles() - handles;
    // The device may still have been preparing when it was unplugged: fewer returns than unplugs.
    if (report_.grown_bytes > 4096) return failed("memory has grown");
    if (report_.grown_handles > 0) return failed("descriptors were left open");
    if (!opened->close()) return failed("it does not close");
    environment_.clock.advance_to(now() + 100 * ms);
    if (!environment_.device.is_plugged(now()) || !environment_.device.is_idle_and_silent(now())) {
      return failed("the device does not end idle and silent");
    }
    return report_;
  }

 private:
  static sim::device_options device_options() {
    sim::device_options options;
    options.boot_ns = 200 * ms;
    options.truth_capacity = 0;
    options.log_capacity = 0;
    return options;
  }

  [[nodiscard]] std::int64_t now() const { return environment_.clock.now_ns(); }

  soak_report failed(const char* why) {
    report_.failure =
        text_of("%s, at unplug %llu", why, static_cast<unsigned long long>(report_.unplugs));
    return report_;
  }

  /// While it scans, or, now and then, at any moment of coming back.
  bool unplug_once(lidar& here) {
    environment_.device.unplug(now());
    read_until(here, now() + dice_.between(1 * ms, 500 * ms));
    environment_.device.replug(now());
    if (dice_.chance(0.3)) {
      read_until(here, now() + dice_.between(1 * ms, second));
      return true;
    }
    const std::int64_t plugged_ns = now();
    while (here.try_scan(milliseconds(0))) {  // from before
    }
    const std::uint64_t before = here.counts().scans;
    while (here.counts().scans < before + 2) {
      static_cast<void>(here.try_scan(milliseconds(500)));
      if (now() - plugged_ns > 4 * second) return false;
    }
    report_.slowest_ns = std::max(report_.slowest_ns, now() - plugged_ns);
    return true;
  }

  void read_until(lidar& here, std::int64_t until_ns) {
    while (now() < until_ns) {
      static_cast<void>(here.try_scan(milliseconds((until_ns - now()) / ms + 1)));
      while (here.next_event()) {
      }
    }
  }

  dice dice_{1, 0x50AC};
  environment environment_;
  soak_report report_;
};

}  // namespace

soak_report soak(std::uint64_t unplugs) { return soaking().run(unplugs); }

}  // namespace g4lidar::simulation
