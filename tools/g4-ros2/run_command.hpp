// SPDX-License-Identifier: MIT
// The topic that rests and turns the motors, with every middleware: std_msgs/Bool.
#pragma once

#include <functional>
#include <string>

#include "dds/bus.hpp"

namespace g4_tool {

/// *Single thread*: that of the bus.
class run_command final : public dds::endpoint {
 public:
  /// `name`: "/g4lidar/run". `use` gets each command: whether the motors may turn.
  run_command(dds::bus& bus, std::string name, std::function<void(bool)> use);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;

  /// Takes the commands that are there. Call it when the bus is readable.
  void update();

 private:
  std::string name_;
  std::function<void(bool)> use_;
  dds::entity topic_;
  dds::entity reader_;
};

}  // namespace g4_tool
