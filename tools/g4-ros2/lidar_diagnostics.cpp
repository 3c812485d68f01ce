// SPDX-License-Identifier: MIT
#include "lidar_diagnostics.hpp"

namespace g4_tool {
namespace {

constexpr std::chrono::seconds diagnostics_interval{1};
/// The prefix of all statuses, which is replaced before they are published.
constexpr std::string_view program_name = "g4lidar: ";

}  // namespace

diagnostic_status topic_report::status(const named_counts& topics) {
  diagnostic_status made{.name = "g4lidar: topics", .message = "ok"};
  totals now;
  for (const auto& [name, counts] : topics) {
    const auto add = [&made, &topic = name](const char* what, std::uint64_t count) {
      made.values.emplace_back(topic + " " + what, std::to_string(count));
    };
    add("subscribers", counts.subscribers);
    add("sent", counts.sent);
    add("lost", counts.lost);
    add("unacknowledged", counts.unacknowledged);
    add("refused", counts.refused);
    now.lost += counts.lost;
    now.refused += counts.refused;
  }
  const totals before = std::exchange(before_, now);
  if (now.lost > before.lost) made.message = "messages could not be sent";
  if (now.refused > before.refused) {
    made.message = "a subscriber wants a quality of service that is not offered: see --qos";
  }
  if (made.message != "ok") made.level = diagnostic_level::warn;
  return made;
}

lidar_diagnostics::lidar_diagnostics(dds::bus& bus, const ros2_options& options,
                                     std::string_view name_space, std::string_view name)
    : prefix_(full_name(options.name_space, options.node).substr(1) + ": "),
      topic_(publisher_of(bus, name_space, options.topics.diagnostics,
                          {.type = &dds::diagnostic_array, .depth = 10})) {
  if (!name.empty()) prefix_.append(name).append(" ");
}

void lidar_diagnostics::update(const std::function<std::vector<diagnostic_status>()>& diagnose,
                               const scan_messages& messages, std::int64_t stamp_ns) {
  const auto now = clock::now();
  if (!topic_ || now < due_ || stamp_ns == 0) return;
  due_ = now + diagnostics_interval;
  if (!topic_->is_wanted()) return;
  std::vector<diagnostic_status> statuses = diagnose();
  statuses.push_back(topics_.status(messages.counts()));
  statuses.back().hardware_id = statuses.front().hardware_id;
  for (diagnostic_status& each : statuses) each.name.replace(0, program_name.size(), prefix_);
  std::vector<std::uint8_t> message;
  put_diagnostic_array(statuses, stamp_ns, message);
  topic_->publish(message);
}

}  // namespace g4_tool
