// SPDX-License-Identifier: MIT
// A line for each revolution of a G4, with its nearest obstacle, until Ctrl-C.
#include <csignal>
#include <cstdio>
#include <g4lidar/lidar.hpp>

volatile std::sig_atomic_t running = 1;

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

void use(const g4lidar::scan& scan) {
  const g4lidar::point* nearest = nullptr;
  for (const g4lidar::point& p : scan) {
    if (p.is_no_return() || p.is_too_near()) continue;  // not reliable
    if (nearest == nullptr || p.range_mm < nearest->range_mm) nearest = &p;
  }
  std::printf("%3u: %zu points at %.2f Hz, ", scan.revolution, scan.size(),
              static_cast<double>(scan.measured_frequency_hz()));
  if (nearest == nullptr) {
    std::puts("no return");
  } else {
    const auto seen = to_polar(*nearest, g4lidar::frame::robot);  // x forward, y to the left
    std::printf("the nearest %.3f m away, %+.2f rad from ahead\n",
                static_cast<double>(seen.range_m), static_cast<double>(seen.bearing_rad));
  }
  std::fflush(stdout);
}

int main(int count, char** words) {
  using namespace std::chrono_literals;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { running = 0; });
  auto lidar = g4lidar::lidar::open(count > 1 ? words[1] : "");  // "": the only G4
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  while (running) {
    auto scan = lidar->next_scan(500ms);  // a view, valid until the next call
    if (scan) {
      use(*scan);
    } else if (scan.error().is_fatal()) {
      return report(scan.error());
    }
  }
}  // the destructor stops the motor
