// SPDX-License-Identifier: MIT
// A G4 in an event loop beside other things, here signals and a clock, and back after an unplug.
//   example_event_loop [DEVICE]     until Ctrl-C
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <g4lidar/lidar.hpp>

namespace {

using namespace std::chrono_literals;

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

/// A descriptor that is readable when the program is to end. The signals are blocked first, before
/// any thread is made; nothing else is ever interrupted by them.
int signals_as_descriptor() {
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGINT);
  sigaddset(&ending, SIGTERM);
  sigprocmask(SIG_BLOCK, &ending, nullptr);
  return signalfd(-1, &ending, SFD_CLOEXEC | SFD_NONBLOCK);
}

int milliseconds_until(std::int64_t deadline_ns) {
  if (deadline_ns == g4lidar::never_ns) return -1;
  const std::int64_t now_ns = std::chrono::steady_clock::now().time_since_epoch() / 1ns;
  constexpr std::int64_t longest_ms = 60'000;
  const std::int64_t left_ms = (deadline_ns - now_ns + 999'999) / 1'000'000;  // not too early
  return static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, longest_ms));
}

/// Everything that has come by now. False: the end.
bool take_scans(g4lidar::lidar& lidar) {
  while (true) {
    const auto scan = lidar.next_scan(0ms);
    if (scan) {
      std::printf("scan %u: %zu points\n", scan->revolution, scan->points.size());
    } else if (scan.error().is_fatal()) {
      report(scan.error());
      return false;
    } else {
      break;
    }
  }
  while (const auto event = lidar.next_event()) {
    const auto what = name_of(event->what);
    std::printf("%.*s\n", static_cast<int>(what.size()), what.data());
  }
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int count, char** words) {
  const int signals = signals_as_descriptor();
  g4lidar::lidar_options options;
  if (count > 1) options.device = words[1];
  options.reconnect = true;
  auto lidar = g4lidar::lidar::open(options);
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  int code = 0;
  while (true) {
    std::array<pollfd, 2> waiting{{{signals, POLLIN, 0}, {lidar->native_handle(), POLLIN, 0}}};
    poll(waiting.data(), waiting.size(), milliseconds_until(lidar->next_deadline_ns()));
    if (waiting[0].revents != 0) break;
    if (!take_scans(*lidar)) {
      code = 1;
      break;
    }
  }
  close(signals);
  return code;  // and the motor stops
}
