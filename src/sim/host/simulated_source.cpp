// SPDX-License-Identifier: MIT
#include "g4lidar/sim/setup.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <variant>

namespace g4lidar::sim {
namespace {

/// Where it is wrong, and why, as far as an error has room.
tl::unexpected<error> refused(problem code, const std::string& where, const std::string& why) {
  constexpr std::size_t longest = 159;
  std::string text = where + " (" + why + ")";
  if (text.size() > longest) text.replace(longest - 4, std::string::npos, "...)");
  return failure(task::opening, code, text, 0, error_detail::simulated);
}

tl::unexpected<error> refused(const std::string& file, const world_error& wrong) {
  const std::string line = wrong.line > 0 ? ", line " + std::to_string(wrong.line) : "";
  return refused(problem::bad_file, file + line, wrong.message);
}

}  // namespace

result<simulated_source> open_simulated(std::string_view source) {
  auto read = parse_setup(source);
  if (const auto* wrong = std::get_if<setup_error>(&read)) {
    return refused(problem::bad_option, "sim:", wrong->message);
  }
  const setup& wanted = std::get<setup>(read);
  auto scene = load_world(wanted.world_file);
  if (const auto* wrong = std::get_if<world_error>(&scene))
    return refused(wanted.world_file, *wrong);
  world& in = std::get<world>(scene);
  if (!wanted.path_file.empty()) {
    if (const auto wrong = load_path(in, wanted.path_file))
      return refused(wanted.path_file, *wrong);
  }
  auto served = serve_alone(device(in, wanted.device, wanted.faults));
  if (!served) return tl::unexpected(served.error());
  simulated_source made{*std::move(served), std::nullopt, 0, wanted.model};
  made.mounted_at = in.mounted_at;
  made.port->with([&](const device&, std::int64_t now_ns) {
    const std::chrono::nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
    made.begin_ns = now.count() - now_ns;
  });
  if (!in.path.empty())
    made.robot.emplace(in, odometry_options{.seed = wanted.device.scanner.seed});
  return made;
}

}  // namespace g4lidar::sim
