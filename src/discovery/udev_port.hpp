// SPDX-License-Identifier: MIT
// A serial port as libudev describes it.
#pragma once

#include <libudev.h>

#include <memory>
#include <optional>
#include <string>

#include "g4lidar/discovery.hpp"

namespace g4lidar {

struct release_udev {
  void operator()(udev* context) const noexcept { udev_unref(context); }
  void operator()(udev_device* device) const noexcept { udev_device_unref(device); }
  void operator()(udev_enumerate* list) const noexcept { udev_enumerate_unref(list); }
  void operator()(udev_monitor* monitor) const noexcept { udev_monitor_unref(monitor); }
};

template <class Udev>
using udev_owner = std::unique_ptr<Udev, release_udev>;

/// The properties of a tty; nothing if it is not a port (a virtual console, a pty, a name without
/// hardware). Without may_open and holder.
[[nodiscard]] std::optional<port_info> port_of(udev_device* device);

/// Whether this user may read and write the file.
[[nodiscard]] bool may_open(const std::string& path) noexcept;

}  // namespace g4lidar
