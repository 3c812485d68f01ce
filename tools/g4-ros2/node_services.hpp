// SPDX-License-Identifier: MIT
// The services of the node: parameters (for `ros2 param`), start and stop.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dds/service.hpp"
#include "lidar_node.hpp"
#include "options.hpp"

namespace g4_tool {

/// *Single thread*: that of the bus. With several lidars the name of a parameter begins with that of its lidar and a
/// dot.
class node_services {
 public:
  /// All arguments outlive it, but the threads of `lidars` end before it. Throws bad_value for an invalid name of the
  /// node.
  node_services(dds::bus& on, const ros2_options& options, std::vector<lidar_node*> lidars);
  ~node_services();

  /// Call it when the bus is readable, and several times a second.
  void update();
  /// A warning if more requests could not be read than at the last call.
  [[nodiscard]] diagnostic_status status();

 private:
  /// A parameter and its lidar.
  struct target {
    std::string name;  ///< "front.frequency"
    lidar_node* lidar;
    const parameter* what;
  };
  struct set_job;
  /// So many requests had another form than that of rmw_cyclonedds.
  [[nodiscard]] std::uint64_t unreadable() const;
  [[nodiscard]] const target* find(std::string_view name) const;
  void offer(const std::string& name, const dds::service_type& type,
             bool (node_services::*handle)(dds::service&, const void*, const dds::caller&));

  bool get(dds::service& via, const void* request, const dds::caller& from);
  bool get_types(dds::service& via, const void* request, const dds::caller& from);
  bool list(dds::service& via, const void* request, const dds::caller& from);
  bool describe(dds::service& via, const void* request, const dds::caller& from);
  bool set(dds::service& via, const void* request, const dds::caller& from);
  bool set_atomically(dds::service& via, const void* request, const dds::caller& from);
  bool start(dds::service& via, const void* request, const dds::caller& from);
  bool stop(dds::service& via, const void* request, const dds::caller& from);
  bool command(dds::service& via, const dds::caller& from, bool runs);

  dds::bus& on_;
  const ros2_options& options_;
  std::vector<lidar_node*> lidars_;
  std::vector<target> targets_;
  std::atomic<std::size_t> unfinished_ = 0;              // requests to set parameters
  std::vector<std::unique_ptr<dds::service>> services_;  // empty: off
  std::uint64_t unreadable_before_ = 0;
  bool was_advised_ = false;
};

}  // namespace g4_tool
