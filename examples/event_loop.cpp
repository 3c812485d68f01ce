// SPDX-License-Identifier: MIT
// A G4 in an event loop together with other events, here signals and a timer, with reconnecting.
//   example_event_loop [DEVICE]     until Ctrl-C
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <g4lidar/lidar.hpp>

namespace {

using namespace std::chrono_literals;

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

/// The same for a system call that has just failed.
int report(const char* system_call) {
  std::perror(system_call);
  return 1;
}

/// A descriptor that is readable when the program should end; -1 on failure. The signals are blocked
/// first, before any thread is created, so that they interrupt no other call.
int signals_as_descriptor() {
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGINT);
  sigaddset(&ending, SIGTERM);
  sigprocmask(SIG_BLOCK, &ending, nullptr);
  return signalfd(-1, &ending, SFD_CLOEXEC | SFD_NONBLOCK);
}

/// For poll(); rounded up, so that it does not return too early.
int milliseconds_until(std::chrono::steady_clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::chrono::milliseconds>(left, 0ms, 1min).count());
}

/// Takes every scan and event that has arrived. False: the end.
bool take_scans(g4lidar::lidar& lidar) {
  while (true) {
    const auto scan = lidar.try_scan(0ms);
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
  if (signals < 0) return report("signalfd");
  g4lidar::lidar_options options;
  if (count > 1) options.device = words[1];
  options.reconnect = true;
  auto lidar = g4lidar::lidar::open(options);
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  g4lidar::lidar_event_loop loop = lidar->event_loop();
  int code = 0;
  while (true) {
    std::array<pollfd, 2> waiting{{{signals, POLLIN, 0}, {loop.native_handle(), POLLIN, 0}}};
    const int ready =
        poll(waiting.data(), waiting.size(), milliseconds_until(loop.next_deadline()));
    if (ready < 0 && errno != EINTR) {
      code = report("poll");
      break;
    }
    if (waiting[0].revents != 0) break;
    if (!take_scans(*lidar)) {
      code = 1;
      break;
    }
  }
  close(signals);
  return code;  // the destructor stops the motor
}
