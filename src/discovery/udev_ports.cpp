// SPDX-License-Identifier: MIT
// The serial ports of this computer as libudev describes them: now, and when they change.
#include <dlfcn.h>
#include <libudev.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "g4lidar/discovery.hpp"
#include "sim/host/name_claim.hpp"
#include "transport/directory.hpp"
#include "transport/port_holder.hpp"

namespace g4lidar {
namespace {

// libudev is loaded when ports are first looked for, so that all else works where it is not installed.
// clang-format off
#define G4LIDAR_UDEV_FUNCTIONS(each) \
  each(udev_new) each(udev_unref) each(udev_device_get_action) each(udev_device_get_devnode) \
  each(udev_device_get_driver) each(udev_device_get_parent) each(udev_device_get_parent_with_subsystem_devtype) \
  each(udev_device_get_sysattr_value) each(udev_device_get_sysname) each(udev_device_new_from_syspath) \
  each(udev_device_unref) each(udev_enumerate_add_match_subsystem) each(udev_enumerate_get_list_entry) \
  each(udev_enumerate_new) each(udev_enumerate_scan_devices) each(udev_enumerate_unref) \
  each(udev_list_entry_get_name) each(udev_list_entry_get_next) each(udev_monitor_enable_receiving) \
  each(udev_monitor_filter_add_match_subsystem_devtype) each(udev_monitor_get_fd) \
  each(udev_monitor_new_from_netlink) each(udev_monitor_receive_device) each(udev_monitor_unref)
#define G4LIDAR_DECLARE(name) decltype(&::name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): declared
// clang-format on
G4LIDAR_UDEV_FUNCTIONS(G4LIDAR_DECLARE)

/// False if there is no libudev. A program that has these functions itself, such as a test, keeps its own.
bool has_udev() noexcept {
  static const bool is_loaded = [] {
    ::dlopen("libudev.so.1", RTLD_NOW | RTLD_GLOBAL);
    bool has_all = true;
#define G4LIDAR_FIND(name)                                                 \
  (name) = reinterpret_cast<decltype(name)>(::dlsym(RTLD_DEFAULT, #name)); \
  has_all = has_all && (name) != nullptr;
    G4LIDAR_UDEV_FUNCTIONS(G4LIDAR_FIND)
    return has_all;
  }();
  return is_loaded;
}
#undef G4LIDAR_UDEV_FUNCTIONS
#undef G4LIDAR_DECLARE
#undef G4LIDAR_FIND

tl::unexpected<error> no_udev() noexcept {
  return failure(task::finding, problem::system, "ports with libudev.so.1", ELIBACC);
}

}  // namespace

struct release_udev {
  void operator()(udev* context) const noexcept { udev_unref(context); }
  void operator()(udev_device* device) const noexcept { udev_device_unref(device); }
  void operator()(udev_enumerate* list) const noexcept { udev_enumerate_unref(list); }
  void operator()(udev_monitor* monitor) const noexcept { udev_monitor_unref(monitor); }
};

template <class Udev>
using udev_owner = std::unique_ptr<Udev, release_udev>;

namespace {

std::string text_or_empty(const char* text) { return text != nullptr ? text : ""; }

std::uint16_t hexadecimal(const std::string& digits) noexcept {
  std::uint16_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return value;
}

std::string_view file_name(std::string_view path) noexcept {
  return path.substr(path.rfind('/') + 1);
}

/// Looked up at the path where udevd creates it, and not in its data base, which a container may
/// lack.
std::string by_id_link(const std::string& node) {
  const std::string links = "/dev/serial/by-id/";
  std::string found;
  each_entry(links, [&](std::string_view name) {
    std::string link = links + std::string(name);
    if (file_name(link_target(link)) == file_name(node)) found = std::move(link);
  });
  return found;
}

/// Of the device or of its parent: a tty itself has none.
std::string driver_of(udev_device* device) {
  for (; device != nullptr; device = udev_device_get_parent(device)) {
    if (const char* driver = udev_device_get_driver(device)) return driver;
  }
  return {};
}

/// ttyS4 and similar: names that the kernel reserves for hardware that does not exist.
bool is_empty_place(udev_device* device) noexcept {
  const char* type = udev_device_get_sysattr_value(device, "type");
  return type != nullptr && std::string_view(type) == "0";
}

/// Whether this user may read and write the file.
bool may_open(const std::string& path) noexcept { return ::access(path.c_str(), R_OK | W_OK) == 0; }

/// The properties of a tty; nothing if it is not a port (a virtual console, a pty, a name without
/// hardware). Without may_open and holder.
std::optional<port_info> port_of(udev_device* device) {
  const std::string path = text_or_empty(udev_device_get_devnode(device));
  udev_device* carrier = udev_device_get_parent(device);  // belongs to `device`
  if (path.empty() || carrier == nullptr || is_empty_place(device)) return std::nullopt;
  port_info port;
  port.path = path;
  port.by_id = by_id_link(path);
  port.driver = driver_of(carrier);
  udev_device* usb = udev_device_get_parent_with_subsystem_devtype(device, "usb", "usb_device");
  if (usb == nullptr) return port;
  // From sysfs, which has it with and without udevd.
  port.bus_path = text_or_empty(udev_device_get_sysname(usb));
  const auto attribute_of = [&](const char* attribute) {
    return text_or_empty(udev_device_get_sysattr_value(usb, attribute));
  };
  port.vendor_id = hexadecimal(attribute_of("idVendor"));
  port.product_id = hexadecimal(attribute_of("idProduct"));
  port.usb_serial = attribute_of("serial");
  port.manufacturer = attribute_of("manufacturer");
  port.product = attribute_of("product");
  return port;
}

/// Appends the simulated lidars in the directory that the environment variable G4LIDAR_SIM_DIR names:
/// each symbolic link in it that leads to a pseudo-terminal which a running simulator serves. Without the
/// variable there are none.
void append_simulated_ports(std::vector<port_info>& ports) {
  namespace fs = std::filesystem;
  const std::string directory = sim::registry();
  if (directory.empty()) return;
  std::error_code wrong;
  fs::directory_iterator each(directory, wrong);
  for (; !wrong && each != fs::directory_iterator(); each.increment(wrong)) {
    std::error_code none;
    const fs::path target = fs::read_symlink(each->path(), none);
    // Anything else may be the terminal of a person or another program: it is not to be written to.
    if (none || !target.native().starts_with("/dev/pts/")) continue;
    if (!fs::exists(target, none) || !sim::name_claim(target.native()).is_held()) continue;
    port_info port;
    port.path = each->path().native();
    port.bus_path = "sim-" + each->path().filename().native();
    port.driver = "sim";
    port.vendor_id = 0x10c4;  // like the USB bridge of a lidar, so that discovery finds it
    port.product_id = 0xea60;
    ports.push_back(std::move(port));
  }
}

/// The source of device events: udevd if it runs, because then it has processed them; else the
/// kernel.
const char* udev_source() noexcept {
  return ::access("/run/udev/control", F_OK) == 0 ? "udev" : "kernel";
}

}  // namespace

bool is_g4_bridge(const port_info& port) noexcept {
  return port.vendor_id == 0x10c4 && port.product_id == 0xea60;
}

result<std::vector<port_info>> list_ports() {
  if (!has_udev()) return no_udev();
  const udev_owner<udev> context(udev_new());
  if (!context) return failure(task::finding, problem::system, "udev", errno);
  const udev_owner<udev_enumerate> list(udev_enumerate_new(context.get()));
  if (!list) return failure(task::finding, problem::system, "udev", errno);
  udev_enumerate_add_match_subsystem(list.get(), "tty");
  const int scanned = udev_enumerate_scan_devices(list.get());
  if (scanned < 0) return failure(task::finding, problem::system, "udev", -scanned);

  std::vector<port_info> ports;
  udev_list_entry* entry = udev_enumerate_get_list_entry(list.get());
  for (; entry != nullptr; entry = udev_list_entry_get_next(entry)) {
    // A port that disappears at this moment is not listed.
    const udev_owner<udev_device> device(
        udev_device_new_from_syspath(context.get(), udev_list_entry_get_name(entry)));
    if (!device) continue;
    if (auto port = port_of(device.get())) ports.push_back(*std::move(port));
  }
  append_simulated_ports(ports);
  for (port_info& port : ports) port.may_open = may_open(port.path);
  std::ranges::sort(ports, {}, &port_info::path);
  return ports;
}

void find_holders(std::span<port_info> ports) {
  const auto holders = device_holders();
  for (port_info& port : ports) {
    const auto holder = holders.find(port.path);
    port.holder = holder != holders.end() ? holder->second : std::string();
  }
}

// ---- port_monitor ------------------------------------------------------------------------------

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
  if (!has_udev()) return no_udev();
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
    if (auto found = state_->event_of(device.get())) return found;
  }
  return std::nullopt;
}

}  // namespace g4lidar
