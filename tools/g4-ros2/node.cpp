// SPDX-License-Identifier: MIT
#include "node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "dds/bus.hpp"
#include "io/interrupt.hpp"
#include "io/service_watch.hpp"
#include "lidar_publisher.hpp"
#include "node_announcement.hpp"
#include "run_command.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto update_interval = 100ms;
constexpr auto network_interval = 1s;

class node {
 public:
  explicit node(const ros2_options& options)
      : options_(options),
        bus_(dds::read_network(options.transport.domain, options.transport.interface)) {
    const std::vector<named_source> lidars = sources_of(options_);
    if (options_.merges) {
      nodes_.push_back(std::make_unique<lidar_publisher>(bus_, options_, lidars, true));
    } else {
      for (const named_source& each : lidars)
        nodes_.push_back(
            std::make_unique<lidar_publisher>(bus_, options_, std::vector{each}, nodes_.empty()));
    }
    if (const std::string name = run_topic(options_); name != "off") {
      run_.emplace(bus_, full_name(options_.name_space, name), [this](bool runs) {
        for (const auto& each : nodes_) each->allow(runs);
      });
    }
    announcement_.emplace(bus_, options_.transport.announced,
                          full_name(options_.name_space, options_.node));
  }

  int run() {
    bus_.update();
    for (const auto& each : nodes_) each->start();
    while (interrupt() == 0 && !limits_.is_over() && !has_ended()) {
      bus_.clear();
      if (const auto now = clock::now(); now >= network_due_) {
        bus_.update();
        network_due_ = now + network_interval;
      }
      if (run_) run_->update();
      for (const auto& each : nodes_) each->update();
      report();
      static_cast<void>(wait_for_input(bus_.handle(), -1, clock::now() + update_interval));
    }
    service_.stopping();
    const std::optional<failure> why = failure_of_any();
    for (const auto& each : nodes_) each->allow(false);  // all motors, before each is waited for
    nodes_.clear();
    bus_.close();
    if (why) throw failure(*why);
    return exit_code_now();
  }

 private:
  /// Whether all lidars have ended.
  [[nodiscard]] bool has_ended() const {
    return std::ranges::all_of(nodes_, [](const auto& each) { return each->has_ended(); });
  }

  [[nodiscard]] std::optional<failure> failure_of_any() const {
    for (const auto& each : nodes_) {
      if (auto why = each->failure_of_any()) return why;
    }
    return std::nullopt;
  }

  template <class Use>
  void for_each_lidar(Use use) const {
    for (const auto& each : nodes_) {
      for (std::size_t lidar = 0; lidar < each->size(); ++lidar) use(*each, lidar);
    }
  }

  /// Reports to systemd: ready even without a network, and alive with each turn.
  void report() {
    service_.ready();
    service_.alive();
    if (!service_.has_manager()) return;
    std::string text;
    for_each_lidar([&](const lidar_publisher& each, std::size_t lidar) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", each.name_space(lidar),
                          name_of(each.state(lidar)));
    });
    service_.status(text);
  }

  const ros2_options& options_;
  dds::bus bus_;
  std::vector<std::unique_ptr<lidar_publisher>> nodes_;
  std::optional<run_command> run_;
  std::optional<node_announcement> announcement_;
  time_limits limits_{options_.common.duration, 0ns};
  service_watch service_;
  clock::time_point network_due_{};
};

}  // namespace

int run_node(const ros2_options& options) {
  if (options.order == scan_order::time && options.common.deskew != deskewing::none) {
    throw bad_value("--order time cannot be used with --deskew: deskewed points have one time");
  }
  note_order(options.order);
  return node(options).run();
}

}  // namespace g4_tool
