// SPDX-License-Identifier: MIT
// Draws over one line of a terminal.
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "cli/common_options.hpp"
#include "cli/logger.hpp"

namespace g4_dump {

status_line::status_line(bool wanted)
    : on_(wanted && !our_global_options().quiet && ::isatty(2) != 0) {}

bool status_line::is_due() {
  const clock::time_point now = clock::now();
  if (!on_ || now < next_) return false;
  next_ = now + std::chrono::milliseconds(100);
  return true;
}

void status_line::draw(std::string_view text) {
  drawn_ = true;
  logger::write(fmt::format("\r{}\x1b[K", text));
}

void status_line::clear() {
  if (std::exchange(drawn_, false)) logger::write("\r\x1b[K");
}

double status_line::seconds() const {
  return std::chrono::duration<double>(clock::now() - begin_).count();
}

void progress_bar::show(std::uint64_t done_bytes) {
  if (!line_.is_due()) return;
  constexpr std::uint64_t width = 40;
  const std::uint64_t done = std::min(done_bytes, all_);  // a file may grow while it is read
  const auto filled = static_cast<int>(done * width / all_);
  const double megabytes = static_cast<double>(done) / 1e6;
  line_.draw(fmt::format("[{:#<{}}{:.<{}}] {:3}%  {:.0f} of {:.0f} MB  {:.0f} MB/s", "", filled, "",
                         static_cast<int>(width) - filled, done * 100 / all_, megabytes,
                         static_cast<double>(all_) / 1e6,
                         megabytes / std::max(line_.seconds(), 1e-3)));
}

}  // namespace g4_dump
