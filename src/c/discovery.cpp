// SPDX-License-Identifier: MIT
#include "g4lidar/discovery.hpp"

#include <g4lidar/c/discovery.h>

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "border.hpp"
#include "handles.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_ports {
  std::vector<port_info> found;
  std::vector<std::string> candidates;  // of each lidar that was found
  std::vector<g4lidar_port> shown;      // views of both
};

struct g4lidar_port_monitor {
  port_monitor made;
  std::optional<port_event> event;
  g4lidar_port shown{};
};

namespace {

constexpr g4lidar_find_options find_defaults{
    sizeof(g4lidar_find_options), 0, 4000, false, false, {}};

g4lidar_port view_of(const port_info& from) noexcept {
  g4lidar_port made{};
  made.path = from.path.c_str();
  made.by_id = from.by_id.c_str();
  made.bus_path = from.bus_path.c_str();
  made.usb_serial = from.usb_serial.c_str();
  made.manufacturer = from.manufacturer.c_str();
  made.product = from.product.c_str();
  made.driver = from.driver.c_str();
  made.holder = from.holder.c_str();
  made.vendor_id = from.vendor_id;
  made.product_id = from.product_id;
  made.may_open = from.may_open;
  made.is_g4_bridge = is_g4_bridge(from);
  made.model = made.candidates = "";
  return made;
}

/// Makes a list of what `find` finds. It gets the options, and returns a result of ports.
template <class Find>
int listed(const g4lidar_find_options* given, g4lidar_ports** ports, g4lidar_error* error,
           Find find) noexcept {
  return created(ports, error, [&]() -> int {
    g4lidar_find_options taken = find_defaults;
    if (!take_options(given, taken)) return refuse(error, bad_options);
    const find_options options{.probe_all_ports = taken.probe_all_ports,
                               .baud = taken.baud,
                               .probe_timeout = std::chrono::milliseconds(taken.probe_timeout_ms)};
    auto made = std::make_unique<g4lidar_ports>();
    std::vector<recognised_lidar> lidars;
    if (const auto found = find(options, made->found, lidars); !found) {
      return fail(error, found.error());
    }
    if (taken.find_holders) find_holders(made->found);
    for (const port_info& each : made->found) made->shown.push_back(view_of(each));
    for (const recognised_lidar& each : lidars) {
      made->candidates.push_back(model_words(each.candidates));
    }
    for (std::size_t i = 0; i < lidars.size(); ++i) {
      g4lidar_port& shown = made->shown[i];
      shown.has_lidar = true;
      shown.lidar = identity_of(lidars[i].device);
      shown.model = lidars[i].model->word.data();  // literals
      shown.candidates = made->candidates[i].c_str();
      shown.baud = lidars[i].baud;
    }
    *ports = made.release();
    return succeed(error);
  });
}

}  // namespace

void g4lidar_find_options_init(g4lidar_find_options* options, size_t size) {
  set_defaults(options, size, find_defaults);
}

int g4lidar_list_ports(const g4lidar_find_options* options, g4lidar_ports** ports,
                       g4lidar_error* error) {
  return listed(options, ports, error,
                [](const find_options&, auto& found, const auto&) -> result<void> {
                  auto all = list_ports();
                  if (!all) return tl::unexpected(all.error());
                  found = std::move(*all);
                  return {};
                });
}

int g4lidar_find_lidars(const g4lidar_find_options* options, g4lidar_ports** ports,
                        g4lidar_error* error) {
  return listed(options, ports, error,
                [](const find_options& given, auto& found, auto& lidars) -> result<void> {
                  auto all = find_lidars(given);
                  if (!all) return tl::unexpected(all.error());
                  for (found_lidar& each : *all) {
                    found.push_back(std::move(each.port));
                    lidars.push_back(std::move(each.lidar));
                  }
                  return {};
                });
}

int g4lidar_select_port(const char* name, const g4lidar_find_options* options,
                        g4lidar_ports** ports, g4lidar_error* error) {
  return listed(options, ports, error,
                [name](const find_options& given, auto& found, const auto&) -> result<void> {
                  auto only = select_port(text_of(name), given);
                  if (!only) return tl::unexpected(only.error());
                  found.push_back(std::move(*only));
                  return {};
                });
}

size_t g4lidar_ports_count(const g4lidar_ports* ports) {
  return ports == nullptr ? 0 : ports->shown.size();
}

const g4lidar_port* g4lidar_ports_at(const g4lidar_ports* ports, size_t index) {
  return index < g4lidar_ports_count(ports) ? &ports->shown[index] : nullptr;
}

void g4lidar_ports_free(g4lidar_ports* ports) { delete ports; }

int g4lidar_port_monitor_open(g4lidar_port_monitor** monitor, g4lidar_error* error) {
  return created(monitor, error, [&]() -> int {
    auto made = port_monitor::open();
    if (!made) return fail(error, made.error());
    *monitor = new g4lidar_port_monitor{std::move(*made), std::nullopt, {}};
    return succeed(error);
  });
}

int g4lidar_port_monitor_descriptor(const g4lidar_port_monitor* monitor) {
  return monitor == nullptr ? -1 : monitor->made.native_handle();
}

int g4lidar_port_monitor_next(g4lidar_port_monitor* monitor, bool* plugged,
                              const g4lidar_port** port) {
  return guarded(
      nullptr,
      [&]() -> int {
        auto next = monitor->made.next();
        if (!next) return G4LIDAR_NOTHING;
        monitor->event = std::move(next);
        monitor->shown = view_of(monitor->event->port);
        *plugged = monitor->event->plugged;
        *port = &monitor->shown;
        return G4LIDAR_OK;
      },
      monitor, plugged, port);
}

void g4lidar_port_monitor_free(g4lidar_port_monitor* monitor) { delete monitor; }
