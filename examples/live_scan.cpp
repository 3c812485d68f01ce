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
  g4lidar::polar nearest{0, 99};
  for (const g4lidar::point& p : scan.points) {
    const auto seen = to_polar(p, g4lidar::frame::robot);  // x forward, y to the left
    const bool is_good = !p.is_no_return() && !p.is_too_near();
    if (is_good && seen.range_m < nearest.range_m) nearest = seen;
  }
  std::printf("%3u: %zu points at %.2f Hz, the nearest %.3f m away, %+.2f rad from ahead\n",
              scan.revolution, scan.points.size(),
              static_cast<double>(scan.measured_frequency_hz()),
              static_cast<double>(nearest.range_m), static_cast<double>(nearest.bearing_rad));
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
