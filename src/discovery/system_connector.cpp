// SPDX-License-Identifier: MIT
#include "system_connector.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <utility>

#include "g4lidar/transport/serial_port.hpp"
#include "transport/port_holder.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {
namespace {

/// A lidar that was just plugged in boots, or its motor spins up.
constexpr std::int64_t opening_search_ns = 5'000'000'000;

/// Whether the user named a serial port by its path: the library may write to that port, whatever
/// is attached to it.
bool names_path(std::string_view device) noexcept {
  return !device.empty() && !device.starts_with(serial_prefix) && !device.starts_with(usb_prefix);
}

/// A number that changes when the device node is created again; 0 if there is none.
std::uint64_t node_of(const std::string& path) noexcept {
  struct stat node{};
  if (::lstat(path.c_str(), &node) != 0) return 0;
  const auto made_ns = static_cast<std::uint64_t>(node.st_ctim.tv_sec) * 1'000'000'000U +
                       static_cast<std::uint64_t>(node.st_ctim.tv_nsec);
  return made_ns ^ static_cast<std::uint64_t>(node.st_ino) << 1U ^ 1U;
}

/// The ports of this computer, those of USB adapters first, as far as an error has room for them.
std::string with_existing_ports(std::string_view missing) {
  std::string all(missing);
  auto ports = list_ports();
  if (!ports) return all;
  std::ranges::sort(*ports, {}, [](const port_info& port) {
    return std::pair(port.vendor_id == 0, std::string_view(port.path));
  });
  std::string_view before = " (ports: ";
  for (const port_info& port : *ports) {
    constexpr std::size_t longest = 90;
    if (all.size() + before.size() + port.path.size() > longest) break;
    all.append(before).append(port.path);
    before = ", ";
  }
  if (before == ", ") all.append(")");
  return all;
}

/// What a user who named a device needs to know: that this is no name, or that nothing has it.
error explained(const error& why, const std::string& device) {
  if (why == problem::bad_option) {
    return {why.doing(), why.code(), why.subject(), 0, error_detail::bad_name};
  }
  if (why != problem::no_port || device.empty()) return why;
  if (!names_path(device) && why.system_errno() == 0) {
    return {why.doing(), why.code(), with_existing_ports(device), 0, error_detail::not_attached};
  }
  const bool is_missing = why.system_errno() == ENOENT || why.system_errno() == ENOTDIR;
  if (!is_missing || !names_path(device)) return why;
  if (!device.starts_with("/dev/")) {
    return {why.doing(), why.code(), device, why.system_errno(), error_detail::missing_path};
  }
  return {why.doing(), why.code(), with_existing_ports(device), why.system_errno(),
          error_detail::missing_port};
}

}  // namespace

system_connector::system_connector(std::string_view device, std::uint32_t baud, const model* named)
    : device_(device), baud_(baud), named_baud_(baud), named_(named) {
  if (named != nullptr) found_.by = known_by::user;
}

result<std::unique_ptr<connector>> system_connector::make(std::string_view device,
                                                          std::uint32_t baud, const model* named) {
  return std::unique_ptr<connector>(new system_connector(device, baud, named));
}

result<std::unique_ptr<connector>> system_connector::find(std::string_view device,
                                                          const search_options& known, bool always,
                                                          bool probes_all_ports) {
  const model* const named = known.model;
  const std::uint32_t usual_baud = named != nullptr ? named->bauds[0] : g4_model.bauds[0];
  const std::uint32_t first_baud = known.baud != 0 ? known.baud : usual_baud;
  const bool has_one_rate = known.baud != 0 || (named != nullptr && named->bauds[1] == 0);
  std::unique_ptr<system_connector> made(new system_connector(device, first_baud, named));
  made->probes_all_ports_ = probes_all_ports;
  made->only_listens_ = known.listen_only;
  made->leaves_dtr_ = known.leave_dtr;
  if (named != nullptr && has_one_rate && !always) return made;
  made->is_searched_ = named == nullptr;
  made->named_baud_ = known.baud;
  if (auto done = made->search_first(known); !done) return tl::unexpected(done.error());
  return made;
}

result<void> system_connector::search_first(search_options known) {
  auto opened = connect();
  if (!opened) {
    searched_ = std::move(opened);
    return {};
  }
  transport& port = **opened;
  known.may_pulse_dtr = (named_ != nullptr || names_path(device_));
  auto lidar = search(port, port.now_ns() + opening_search_ns, known);
  if (!lidar) {
    const error why = with_port_conflict(lidar.error(), port);
    return failure(task::opening, why.code(), why.subject(), why.system_errno(), why.detail());
  }
  named_ = lidar->model;
  if (is_searched_) candidates_ = std::move(lidar->candidates);
  found_ = {.by = is_searched_ ? lidar->by : known_by::user,
            .number = lidar->device.model,
            .baud = lidar->baud,
            .is_silent = lidar->is_silent,
            .was_stopped = lidar->was_scanning && !lidar->is_silent && !known.listen_only &&
                           named_->link == link_kind::two_way,
            .speaks_telnet = lidar->speaks_telnet};
  if (lidar->baud != 0) baud_ = lidar->baud;
  if (named_->link == link_kind::one_way) find_place();
  searched_ = std::move(opened);
  return {};
}

/// A reconnect must not end the program if there is no memory.
result<std::unique_ptr<transport>> system_connector::connect() noexcept {
  try {
    if (auto found = std::exchange(searched_, std::nullopt)) return *std::move(found);
    auto opened = open_transport();
    if (!opened && first_.path.empty()) return tl::unexpected(explained(opened.error(), device_));
    return opened;
  } catch (const std::bad_alloc&) {
    return failure(task::opening, problem::system, device_, ENOMEM);
  }
}

result<std::unique_ptr<transport>> system_connector::open_transport() {
  const std::string_view device = device_;
  if (is_bridge(device)) {
    if (const auto wrong = misspelled(device)) return tl::unexpected(*wrong);
    tcp_options how;
    how.baud = baud_;
    return tcp_port::open(device.substr(tcp_prefix.size()), how);
  }
  return first_.path.empty() ? first_connect() : connect_again();
}

result<std::unique_ptr<transport>> system_connector::first_connect() {
  find_options how;
  how.probe_all_ports = probes_all_ports_;
  how.listen_only = only_listens_;
  how.baud = named_baud_;
  const auto port = select_port(device_, how);
  if (!port) return tl::unexpected(port.error());
  auto opened = serial_port::open(port->path, {.baud = baud_, .leave_dtr = leaves_dtr_});
  if (opened) {
    first_ = *port;
    last_path_ = port->path;
    if (named_ != nullptr && named_->link == link_kind::one_way) find_place();
  }
  return opened;
}

/// A port that was named by its path has no more than this so far.
void system_connector::find_place() {
  const auto ports = list_ports();
  if (!ports) return;
  const auto at = std::ranges::find(*ports, first_.path, &port_info::path);
  if (at != ports->end()) first_ = *at;
}

/// Each call tries the next candidate; at the end of a round it fails with no_port once.
result<std::unique_ptr<transport>> system_connector::connect_again() {
  if (paths_.empty()) list_candidates();
  while (!paths_.empty()) {
    const std::string next = std::move(paths_.front());
    paths_.erase(paths_.begin());
    if (next.empty()) break;
    if (auto opened = serial_port::open(next, {.baud = baud_, .leave_dtr = leaves_dtr_})) {
      last_path_ = next;
      return opened;
    }
  }
  return failure(task::finding, problem::no_port, first_.path);
}

/// The path that the user named, then the old path, then the other ports; an empty one ends the round.
void system_connector::list_candidates() {
  if (names_path(device_) && !goes_by_place() && !is_refused(first_.path)) {
    paths_.push_back(first_.path);
  }
  if (const auto ports = list_ports()) {
    for (const port_info& port : *ports) {
      if (!may_be_ours(port) || is_refused(port.path)) continue;
      if (std::ranges::find(paths_, port.path) != paths_.end()) continue;
      paths_.insert(port.path == first_.path ? paths_.begin() : paths_.end(), port.path);
    }
  }
  paths_.emplace_back();
}

/// The usual USB bridge, or an adapter of the same model at the USB port that the user named.
bool system_connector::may_be_ours(const port_info& port) const noexcept {
  const bool is_same = port.bus_path == first_.bus_path && port.vendor_id == first_.vendor_id &&
                       port.product_id == first_.product_id;
  if (goes_by_place()) return is_same;
  if (is_g4_bridge(port)) return true;
  return is_same && (probes_all_ports_ || device_.starts_with(usb_prefix));
}

bool system_connector::is_refused(const std::string& path) const {
  return std::ranges::find(refused_, refused_port{path, node_of(path)}) != refused_.end();
}

/// Another lidar is attached there. Its port is not opened again before a replug.
void system_connector::refuse() noexcept {
  try {
    std::erase_if(refused_, [&](const refused_port& old) { return old.path == last_path_; });
    if (!last_path_.empty()) refused_.push_back({last_path_, node_of(last_path_)});
  } catch (const std::bad_alloc&) {
    refused_.clear();  // they are queried again, at the interval of the driver's backoff
  }
}

/// Of a network bridge nothing is known before the attempt.
int system_connector::watch() noexcept {
  try {
    if (!watch_ && !first_.path.empty()) watch_.emplace(first_.path);
  } catch (const std::bad_alloc&) {
    return -1;  // the driver tries without it
  }
  return watch_handle();
}

bool system_connector::may_be_back() noexcept {
  if (!watch_ || !watch_->take()) return false;
  paths_.clear();
  return true;
}

bool system_connector::pause(std::int64_t deadline_ns) noexcept {
  short found = 0;
  return waker_.wait(watch_handle(), POLLIN, deadline_ns, &found) != waker::ended::woken;
}

}  // namespace g4lidar
