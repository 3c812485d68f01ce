// SPDX-License-Identifier: MIT
#include "system_connector.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <new>
#include <utility>

#include "g4lidar/byte_file.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/recording_reader.hpp"
#include "g4lidar/replay.hpp"
#include "g4lidar/serial_port.hpp"
#include "g4lidar/tcp_port.hpp"

namespace g4lidar {
namespace {

constexpr std::string_view tcp_prefix = "tcp:";
constexpr std::string_view file_prefix = "file:";

}  // namespace

system_connector::system_connector(std::string_view device, std::uint32_t baud)
    : device_(device), baud_(baud), wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

system_connector::~system_connector() {
  if (wake_ >= 0) ::close(wake_);
}

result<std::unique_ptr<connector>> system_connector::make(std::string_view device,
                                                          std::uint32_t baud) {
  std::string_view path = device;
  if (path.starts_with(file_prefix)) path.remove_prefix(file_prefix.size());
  if (is_recording(path)) return replay::open(path);
  return std::unique_ptr<connector>(new system_connector(device, baud));
}

/// A lidar that is found again must not end the program for want of memory.
result<std::unique_ptr<transport>> system_connector::connect() noexcept {
  try {
    return open_line();
  } catch (const std::bad_alloc&) {
    return failure(task::opening, problem::system, device_, ENOMEM);
  }
}

result<std::unique_ptr<transport>> system_connector::open_line() {
  const std::string_view device = device_;
  if (device.starts_with(tcp_prefix)) {
    tcp_options how;
    how.baud = baud_;
    return tcp_port::open(device.substr(tcp_prefix.size()), how);
  }
  if (device.starts_with(file_prefix)) return byte_file::open(device.substr(file_prefix.size()));
  return path_.empty() ? first_connect() : connect_again();
}

result<std::unique_ptr<transport>> system_connector::first_connect() {
  find_options how;
  how.baud = baud_;
  const auto port = select_port(device_, how);
  if (!port) return tl::unexpected(port.error());
  auto opened = serial_port::open(port->path, {.baud = baud_});
  if (opened) path_ = port->path;
  return opened;
}

/// The port where it was, then every other one behind a G4's bridge: one a call, then no_port once.
result<std::unique_ptr<transport>> system_connector::connect_again() {
  if (paths_.empty()) {
    if (const auto ports = list_ports()) {
      for (const port_info& port : *ports) {
        if (port.path != path_ && is_g4_bridge(port)) paths_.push_back(port.path);
      }
    }
    paths_.insert(paths_.begin(), path_);
    paths_.emplace_back();  // the end of a round
  }
  while (!paths_.empty()) {
    const std::string next = std::move(paths_.front());
    paths_.erase(paths_.begin());
    if (next.empty()) break;
    if (auto opened = serial_port::open(next, {.baud = baud_})) return opened;
  }
  return failure(task::finding, problem::no_port, path_);
}

std::int64_t system_connector::now_ns() const noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool system_connector::pause(std::int64_t deadline_ns) noexcept {
  while (true) {
    const std::int64_t left = std::max<std::int64_t>(deadline_ns - now_ns(), 0);
    const timespec time{static_cast<std::time_t>(left / 1'000'000'000),
                        static_cast<long>(left % 1'000'000'000)};
    pollfd woken{wake_, POLLIN, 0};
    const int ready = ppoll(&woken, 1, &time, nullptr);
    if (ready > 0) {
      eventfd_t count = 0;
      static_cast<void>(eventfd_read(wake_, &count));
      return false;
    }
    if (ready == 0) return true;  // else a signal came: go on waiting
  }
}

void system_connector::wake() noexcept { static_cast<void>(eventfd_write(wake_, 1)); }

}  // namespace g4lidar
