// SPDX-License-Identifier: MIT
#include "g4lidar/discovery.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "core/time_limit.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "port_words.hpp"

namespace g4lidar {
namespace {

result<recognised_lidar> search_at(const port_info& port, const find_options& options) {
  auto opened =
      serial_port::open(port.path, {.baud = options.baud != 0 ? options.baud : g4_model.bauds[0]});
  if (!opened) return tl::unexpected(opened.error());
  transport& to_device = **opened;
  return search(to_device, to_device.now_ns() + limited_ns(options.probe_timeout),
                {.baud = options.baud, .listen_only = options.listen_only});
}

/// The ports that the library may write to: only this function decides that. `others` gets the rest.
result<std::vector<port_info>> candidates(const find_options& options,
                                          std::vector<port_info>* others = nullptr) {
  auto ports = list_ports();
  if (!ports) return ports;
  if (options.probe_all_ports) find_holders(*ports);
  const auto is_written = [&options](const port_info& port) {
    const bool is_free = port.holder.empty() && !is_reserved(port);
    return is_g4_bridge(port) || (options.probe_all_ports && is_free);
  };
  if (others != nullptr) {
    std::ranges::copy_if(*ports, std::back_inserter(*others), std::not_fn(is_written));
  }
  std::erase_if(*ports, std::not_fn(is_written));
  return ports;
}

/// A port that could not be queried, so that a lidar may be attached to it.
bool is_unasked(const error& why) noexcept {
  return why == problem::busy || why == problem::permission;
}

tl::unexpected<error> several(const std::vector<port_info>& ports) {
  std::string paths;
  for (const port_info& port : ports) paths.append(paths.empty() ? "" : ", ").append(port.path);
  return failure(task::finding, problem::several_ports, paths);
}

result<port_info> the_only_one(std::vector<port_info> ports, std::string_view name) {
  if (ports.empty()) return failure(task::finding, problem::no_port, name);
  if (ports.size() > 1) return several(ports);
  return std::move(ports.front());
}

result<port_info> at_usb_place(std::string_view place, std::string_view name) {
  if (place.empty()) return failure(task::finding, problem::bad_option, name);
  auto ports = list_ports();
  if (!ports) return tl::unexpected(ports.error());
  std::erase_if(*ports, [&](const port_info& port) { return port.bus_path != place; });
  return the_only_one(*std::move(ports), name);
}

bool is_serial_number(std::string_view digits) noexcept {
  return digits.size() == 16 && digits.find_first_not_of("0123456789") == std::string_view::npos;
}

result<port_info> with_serial_number(std::string_view digits, std::string_view name,
                                     const find_options& options) {
  if (!is_serial_number(digits)) {
    return failure(task::finding, problem::bad_option, std::string(name) + ", not 16 digits");
  }
  const auto ports = candidates(options);
  if (!ports) return tl::unexpected(ports.error());
  std::optional<error> unasked;
  for (const port_info& port : *ports) {
    const auto found = search_at(port, options);
    if (found && found->device.serial_number() == digits) return port;
    if (!found && !unasked && is_unasked(found.error())) unasked = found.error();
  }
  if (unasked) return tl::unexpected(*unasked);
  return failure(task::finding, problem::no_port, name);
}

result<port_info> the_only_lidar(const find_options& options) {
  std::vector<port_info> others;
  auto ports = candidates(options, &others);
  if (!ports) return tl::unexpected(ports.error());
  const bool has_looked = ports->size() > 1;
  if (has_looked) {
    std::erase_if(*ports, [&](const port_info& port) {
      const auto lidar = search_at(port, options);
      return !lidar && !is_unasked(lidar.error());
    });
  }
  if (ports->empty()) return tl::unexpected(no_lidar(others, has_looked));
  return the_only_one(*std::move(ports), "");
}

}  // namespace

result<std::vector<found_lidar>> find_lidars(const find_options& options) {
  auto ports = candidates(options);
  if (!ports) return tl::unexpected(ports.error());
  std::vector<found_lidar> found;
  for (port_info& port : *ports) {
    if (auto lidar = search_at(port, options))
      found.push_back({std::move(port), *std::move(lidar)});
  }
  return found;
}

result<port_info> select_port(std::string_view name, const find_options& options) {
  if (name.empty()) return the_only_lidar(options);
  if (const auto wrong = misspelled(name)) return tl::unexpected(*wrong);
  if (name.starts_with(usb_prefix)) return at_usb_place(name.substr(usb_prefix.size()), name);
  if (name.starts_with(serial_prefix)) {
    return with_serial_number(name.substr(serial_prefix.size()), name, options);
  }
  port_info named;
  named.path = name;
  return named;
}

}  // namespace g4lidar
