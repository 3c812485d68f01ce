// SPDX-License-Identifier: MIT
// A reader of /diagnostics in the process of the test.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "subscriber.hpp"

namespace ros2 {

/// The values of /diagnostics that come, by their keys; the status of a name by "NAME level", and its last message
/// that was not of level 0 by "NAME warning".
class diagnosis {
 public:
  explicit diagnosis(const test_domain& in)
      : messages_(in, "/diagnostics", dds::diagnostic_array) {}
  std::string operator[](const std::string& key) {
    messages_.take([this](const diagnostic_message& message) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        const auto& status = message.status._buffer[i];
        values_[std::string(status.name) + " level"] = std::to_string(status.level);
        if (status.level != 0) values_[std::string(status.name) + " warning"] = status.message;
        for (std::uint32_t k = 0; k < status.values._length; ++k) {
          values_[status.values._buffer[k].key] = status.values._buffer[k].value;
        }
      }
    });
    return values_[key];
  }

 private:
  subscriber<diagnostic_message> messages_;
  std::map<std::string, std::string> values_;
};

}  // namespace ros2
