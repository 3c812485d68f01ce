// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cerrno>
#include <map>
#include <string_view>
#include <utility>

#include "g4lidar/discovery.hpp"
#include "udev_port.hpp"

namespace g4lidar {
namespace {

/// The source of device events: udevd if it runs, because then it has processed them; else the
/// kernel.
const char* udev_source() noexcept {
  return ::access("/run/udev/control", F_OK) == 0 ? "udev" : "kernel";
}

}  // namespace

struct G4LIDAR_HIDDEN port_monitor::state {
  udev_owner<udev> context;
  udev_owner<udev_monitor> monitor;
  std::map<std::string, port_info>
      known;  // by path: sysfs has no data about a port that has disappeared

  [[nodiscard]] std::optional<port_event> event_of(udev_device* device);
  [[nodiscard]] std::optional<port_event> went(const std::string& path);
};

std::optional<port_event> port_monitor::state::event_of(udev_device* device) {
  const char* action = udev_device_get_action(device);
  const char* path = udev_device_get_devnode(device);
  if (action == nullptr || path == nullptr) return std::nullopt;
  if (std::string_view(action) == "remove") return went(path);
  if (std::string_view(action) != "add") return std::nullopt;
  auto port = port_of(device);
  if (!port) return std::nullopt;
  port->may_open = may_open(port->path);
  known.insert_or_assign(port->path, *port);
  return port_event{true, *std::move(port)};
}

std::optional<port_event> port_monitor::state::went(const std::string& path) {
  auto last = known.extract(path);
  if (last.empty()) return std::nullopt;  // a console or the like
  last.mapped().may_open = false;
  last.mapped().holder.clear();
  return port_event{false, std::move(last.mapped())};
}

result<port_monitor> port_monitor::open() {
  auto made = std::make_unique<state>();
  made->context.reset(udev_new());
  if (!made->context) return failure(task::finding, problem::system, "udev", errno);
  made->monitor.reset(udev_monitor_new_from_netlink(made->context.get(), udev_source()));
  if (!made->monitor) return failure(task::finding, problem::system, "udev monitor", errno);
  udev_monitor_filter_add_match_subsystem_devtype(made->monitor.get(), "tty", nullptr);
  const int enabled = udev_monitor_enable_receiving(made->monitor.get());
  if (enabled < 0) return failure(task::finding, problem::system, "udev monitor", -enabled);
  // Listed after the monitor listens, so that no port is missed in between.
  auto ports = list_ports();
  if (!ports) return tl::unexpected(ports.error());
  for (port_info& port : *ports) made->known.emplace(port.path, std::move(port));
  return port_monitor(std::move(made));
}

port_monitor::port_monitor(std::unique_ptr<state> made) noexcept : state_(std::move(made)) {}
port_monitor::port_monitor(port_monitor&&) noexcept = default;
port_monitor& port_monitor::operator=(port_monitor&&) noexcept = default;
port_monitor::~port_monitor() = default;

int port_monitor::native_handle() const noexcept {
  return udev_monitor_get_fd(state_->monitor.get());
}

std::optional<port_event> port_monitor::next() {
  // The socket of libudev is non-blocking.
  while (const udev_owner<udev_device> device{udev_monitor_receive_device(state_->monitor.get())}) {
    if (auto event = state_->event_of(device.get())) return event;
  }
  return std::nullopt;
}

}  // namespace g4lidar
