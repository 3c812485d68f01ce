// SPDX-License-Identifier: MIT
#include "g4lidar/scan_loop.hpp"

#include <algorithm>
#include <chrono>

#include "driver.hpp"

namespace g4lidar {

result<std::optional<scan>> scan_loop::wait(lidar& from, lidar::milliseconds slice) {
  if (!from.driver_) return moved_from();
  lidar::driver& on = *from.driver_;
  const std::int64_t slice_ends_ns = on.deadline_after_ns(slice);
  if (!deadline_ns_ || on.not_due_before_ns() == never_ns)
    deadline_ns_ = on.deadline_after_ns(timeout_);
  const auto ends_ns = [&] { return std::max(*deadline_ns_, on.not_due_before_ns()); };
  auto found = on.read_scan([&] { return std::min(slice_ends_ns, ends_ns()); },
                            [](const error& why) { return why == problem::reconnecting; });
  if (found && !*found && ends_ns() <= slice_ends_ns) found = on.timed_out();
  const bool goes_on = found ? !*found : found.error() == problem::cancelled;
  if (!goes_on) deadline_ns_.reset();
  return found;
}

lidar::milliseconds scan_loop::left(const lidar& from) const noexcept {
  if (!from.driver_) return lidar::milliseconds(0);
  const std::int64_t due_ns = from.driver_->not_due_before_ns();
  const std::int64_t ends_ns =
      std::max(due_ns, deadline_ns_.value_or(from.driver_->deadline_after_ns(timeout_)));
  return from.driver_->time_until(ends_ns);
}

view_result<scan> lidar::wait_scan(milliseconds timeout) {
  const auto found = scan_loop(timeout).wait(*this, milliseconds::max());
  if (!found) return tl::unexpected(found.error());
  if (!*found) return driver_->timed_out();  // a file that is paused
  return **found;
}

}  // namespace g4lidar
