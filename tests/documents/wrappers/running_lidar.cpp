// SPDX-License-Identifier: MIT
// Round lines that are gone through again and again with a `lidar` that scans.
#include <chrono>
#include <cstdio>

#include <g4lidar/lidar.hpp>

namespace {

int scans = 0;

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

[[maybe_unused]] void use(const g4lidar::scan&) { ++scans; }

int go_on(g4lidar::lidar* lidar) {
  using namespace std::chrono_literals;
@fragment@
  return 0;
}

}  // namespace

int main(int, char** words) {
  auto lidar = g4lidar::lidar::open(words[1]);
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  for (int i = 0; i < 4; ++i) {
    if (const int code = go_on(&*lidar); code != 0) return code;
  }
  std::printf("%d scans\n", scans);
}
