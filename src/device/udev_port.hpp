// SPDX-License-Identifier: MIT
// A serial port as libudev knows it.
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

/// What is to be known of a tty; nothing where there is no port behind it (a virtual console, a pty,
/// a place for hardware that is not there). Without may_open and holder.
[[nodiscard]] std::optional<port_info> port_of(udev_device* device);

/// Whether this user may read and write the file.
[[nodiscard]] bool may_open(const std::string& path) noexcept;

}  // namespace g4lidar
