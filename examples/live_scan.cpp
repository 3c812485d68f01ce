// SPDX-License-Identifier: MIT
// A line for each revolution of a G4, with its nearest obstacle, until Ctrl-C. No return is not free space: what
// came nearer than the shortest range gives none, so an alarm also looks at the directions of mark_near().
#include <csignal>
#include <cstdio>
#include <g4lidar/filter/too_near.hpp>
#include <g4lidar/lidar.hpp>
#include <vector>

volatile std::sig_atomic_t running = 1;

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

void use(const g4lidar::scan& scan, g4lidar::near_history& history) {
  std::vector<g4lidar::point> points(scan.begin(), scan.end());
  const auto too_near =  // what stays too near stays flagged
      mark_near(points, history, {.revolutions = g4lidar::near_limits::until_return}, *scan.model,
                scan.sample_rate_hz);
  const g4lidar::point* nearest = nullptr;
  for (const g4lidar::point& p : scan) {
    if (p.is_no_return() || p.is_too_near()) continue;  // not reliable
    if (nearest == nullptr || p.range_mm < nearest->range_mm) nearest = &p;
  }
  std::printf("%3u: %zu points at %.2f Hz, ", scan.revolution, scan.size(),
              static_cast<double>(scan.measured_frequency_hz()));
  if (nearest == nullptr) {
    std::printf("no return");
  } else {
    const auto seen = to_polar(*nearest, g4lidar::frame::robot, scan.model->turn_deg);
    std::printf("the nearest %.3f m away, %+.2f rad from ahead", static_cast<double>(seen.range_m),
                static_cast<double>(seen.bearing_rad));
  }
  if (too_near > 0) std::printf(", perhaps something nearer in %zu samples", too_near);
  std::puts("");
  std::fflush(stdout);
}

int main(int count, char** words) {
  using namespace std::chrono_literals;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { running = 0; });
  auto lidar = g4lidar::lidar::open(count > 1 ? words[1] : "");  // "": the only lidar
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  g4lidar::near_history history;
  while (running) {
    auto scan = lidar->try_scan(500ms);  // a view, valid until the next call
    if (scan) {
      use(*scan, history);
    } else if (scan.error().is_fatal()) {
      return report(scan.error());
    }
  }
}  // the destructor stops the motor
