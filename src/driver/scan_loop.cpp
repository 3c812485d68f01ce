// SPDX-License-Identifier: MIT
#include "g4lidar/lidar.hpp"

#include <algorithm>
#include <optional>

#include "driver.hpp"

namespace g4lidar {

result<std::optional<scan>> scan_loop::wait(lidar& device, lidar::milliseconds slice) {
  if (!device.driver_) return moved_from();
  lidar::driver& on = *device.driver_;
  const scan_source& source = on.source();
  const std::int64_t slice_ends_ns = deadline_after_ns(source, slice);
  const auto ends_ns = [&] {
    const scan_expectation now = source.expects();
    // Not while a scan is set up: a motor that never turns is started again and again.
    const bool is_away = now.not_due_before_ns == never_ns && now.why != error_detail::spinning_up;
    if (!deadline_ns_ || is_away) deadline_ns_ = deadline_after_ns(source, timeout_);
    return std::max(*deadline_ns_, now.not_due_before_ns);
  };
  auto found = on.read_scan([&] { return std::min(slice_ends_ns, ends_ns()); },
                            [](const error& why) { return why == problem::reconnecting; });
  if (found && !*found && ends_ns() <= slice_ends_ns) found = on.timed_out();
  const bool goes_on = found ? !*found : found.error() == problem::cancelled;
  if (!goes_on) deadline_ns_.reset();
  return found;
}

lidar::milliseconds scan_loop::left(const lidar& from) const noexcept {
  if (!from.driver_) return lidar::milliseconds(0);
  const scan_source& source = from.driver_->source();
  const std::int64_t ends_ns = deadline_ns_.value_or(deadline_after_ns(source, timeout_));
  return time_until(source, std::max(ends_ns, source.expects().not_due_before_ns));
}

view_result<scan> lidar::wait_scan(milliseconds timeout) {
  const auto found = scan_loop(timeout).wait(*this, milliseconds::max());
  if (!found) return tl::unexpected(found.error());
  const std::optional<scan>& next = *found;
  if (!next) return driver_->timed_out();  // a file that is paused
  return *next;
}

view_result<scan> lidar::try_scan(milliseconds timeout) {
  if (!driver_) return moved_from();
  const std::int64_t until_ns = deadline_after_ns(driver_->source(), timeout);
  const auto found =
      driver_->read_scan([=] { return until_ns; }, [](const error&) { return false; });
  if (!found) return tl::unexpected(found.error());
  const std::optional<scan>& next = *found;
  if (!next) return driver_->timed_out();
  return *next;
}

}  // namespace g4lidar
