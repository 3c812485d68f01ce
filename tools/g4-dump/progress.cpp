// SPDX-License-Identifier: MIT
// Draws over one line of a terminal.
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "say.hpp"

namespace g4_dump {

progress_bar::progress_bar(bool wanted, std::uint64_t all_bytes)
    : on_(wanted && all_bytes >= least_bytes && ::isatty(2) != 0), all_(all_bytes) {}

void progress_bar::show(std::uint64_t done_bytes) {
  if (!on_) return;
  const clock::time_point now = clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  drawn_ = true;
  constexpr std::uint64_t width = 40;
  const std::uint64_t done = std::min(done_bytes, all_);  // a file may grow while it is read
  const auto filled = static_cast<int>(done * width / all_);
  const std::chrono::duration<double> took = now - begin_;
  const double megabytes = static_cast<double>(done) / 1e6;
  say(fmt::format("\r[{:#<{}}{:.<{}}] {:3}%  {:.0f} of {:.0f} MB  {:.0f} MB/s\x1b[K", "", filled,
                  "", static_cast<int>(width) - filled, done * 100 / all_, megabytes,
                  static_cast<double>(all_) / 1e6, megabytes / std::max(took.count(), 1e-3)));
}

void progress_bar::clear() {
  if (drawn_) say("\r\x1b[K");
  drawn_ = false;
}

}  // namespace g4_dump
