// SPDX-License-Identifier: MIT
#include "g4lidar/message/ros_messages.hpp"

#include <string_view>

#include "cdr.hpp"
#include "schema_text.hpp"

namespace g4lidar {
namespace {

constexpr std::string_view array_text = R"(std_msgs/Header header
diagnostic_msgs/DiagnosticStatus[] status
)";
constexpr std::string_view status_text = R"(MSG: diagnostic_msgs/DiagnosticStatus
byte OK=0
byte WARN=1
byte ERROR=2
byte STALE=3
byte level
string name
string message
string hardware_id
diagnostic_msgs/KeyValue[] values
)";
constexpr std::string_view value_text = R"(MSG: diagnostic_msgs/KeyValue
string key
string value
)";

}  // namespace

message_schema diagnostic_array_schema() noexcept {
  return {"diagnostic_msgs/msg/DiagnosticArray",
          schema::text<array_text, schema::header, schema::time, status_text, value_text>};
}

void put_diagnostic_array(std::span<const diagnostic_status> statuses, std::int64_t stamp_ns,
                          std::vector<std::uint8_t>& out) {
  cdr_writer message(out);
  put_header(message, stamp_ns, "");
  message.put(static_cast<std::uint32_t>(statuses.size()));
  for (const diagnostic_status& each : statuses) {
    message.put(static_cast<std::uint8_t>(each.level));
    for (const std::string* text : {&each.name, &each.message, &each.hardware_id}) {
      message.put(std::string_view(*text));
    }
    message.put(static_cast<std::uint32_t>(each.values.size()));
    for (const auto& [name, value] : each.values) {
      message.put(std::string_view(name));
      message.put(std::string_view(value));
    }
  }
}

}  // namespace g4lidar
