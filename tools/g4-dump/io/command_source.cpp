// SPDX-License-Identifier: MIT
#include "command_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "cli/logger.hpp"
#include "io/output.hpp"

namespace g4_tool {

void refuse_files(const common_options& options, task doing) {
  if (names_file(options.source)) throw failure(error(doing, problem::read_only, options.source));
}

void refuse_listening(const common_options& options) {
  if (options.expected.listen_only)
    throw bad_value(
        "--listen: nothing is sent, and this command sends something; omit one of them");
}

command_source::command_source(const common_options& options, task doing)
    : source_((refuse_files(options, doing), options)) {
  while (const auto event = lidar().next_event()) {
    was_scanning_ = was_scanning_ || event->what == lidar_event::kind::found_scanning;
  }
  if (was_scanning_)
    logger::info(fmt::format("{}: was scanning and has been stopped\n", lidar().name()));
}

verb device_verb(verb made, exit_code (*run)(const common_options&), bool has_output) {
  const auto options = std::make_shared<common_options>();
  made.arguments = {source_argument(*options)};
  if (has_output) made.options = joined(json_row(*options), output_rows(*options));
  made.options = joined(made.options, device_rows(*options));
  made.run = [options, run] { return static_cast<int>(run(*options)); };
  return made;
}

void write_object(output& out, const nlohmann::ordered_json& value, std::size_t width,
                  bool as_json) {
  if (as_json) return out.write(json_line(value));
  const nlohmann::ordered_json all = value.flatten();
  for (const auto& [path, each] : all.items()) {
    std::string name = path.substr(1);
    std::replace(name.begin(), name.end(), '/', '_');
    const std::string text = each.is_string() ? printable(each.get<std::string>()) : each.dump();
    out.write(fmt::format("{:<{}}{}\n", name, width, each.is_null() ? "unknown" : text));
  }
}

}  // namespace g4_tool
