// SPDX-License-Identifier: MIT
#include "g4lidar/transport/source.hpp"

#include <sys/stat.h>

#include <numbers>
#include <string>
#include <utility>

#include "core/number_text.hpp"
#include "discovery/port_words.hpp"
#include "discovery/system_connector.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/transport.hpp"
#include "option_problems.hpp"
#include "recording/new_file.hpp"
#include "recording/play/byte_survey.hpp"
#include "transport/tcp_port.hpp"
#if defined(G4LIDAR_HAS_SIM)
#include <variant>

#include "g4lidar/sim/setup.hpp"
#endif

namespace g4lidar {
namespace {

constexpr std::string_view file_prefix = "file:";
constexpr std::string_view sim_prefix = "sim:";
constexpr std::string_view model_suffix = "?model=";

struct named_parts {
  std::string_view path;
  std::string_view model;  // empty: not given
};

/// The parts of `file:PATH?model=WORD`, or of a device; what follows `sim:` is none of this.
named_parts divided(std::string_view name) {
  if (name.starts_with(sim_prefix)) return {name, {}};
  const bool is_file = name.starts_with(file_prefix);
  const std::string_view whole = is_file ? name.substr(file_prefix.size()) : name;
  const std::size_t at = whole.rfind(model_suffix);
  struct stat found{};
  if (at == std::string_view::npos || ::stat(std::string(whole).c_str(), &found) == 0) {
    return {whole, {}};
  }
  return {whole.substr(0, at), whole.substr(at + model_suffix.size())};
}

option_users users_of(source_kind kind, const std::string& path) {
  using namespace option_user;
  if (kind == source_kind::recording) return recording;
  if (kind == source_kind::simulated) return live;
  if (kind == source_kind::device) return is_bridge(path) ? live : live | port;
  struct stat found{};
  const bool is_there = (path == "-" ? ::fstat(0, &found) : ::stat(path.c_str(), &found)) == 0;
  const bool is_file = !is_there || S_ISREG(found.st_mode) || S_ISDIR(found.st_mode);
  return is_file ? raw_file : pipe;
}

option_users users_of(std::string_view name) {
  return users_of(kind_of_source(name), path_of_source(name));
}

search_options known_of(const lidar_options& options, const model* named) {
  return {.model = named,
          .baud = options.baud,
          .listen_only = options.listen_only,
          .leave_dtr = options.leave_dtr,
          .is_cancelled = options.is_cancelled};
}

/// To a source that states its model, or for which its user does.
class stated_connector : public forwarding_connector {
 public:
  stated_connector(std::unique_ptr<connector> inner, const model& model, known_by basis)
      : forwarding_connector(std::move(inner)), model_(&model), by_(basis) {}

  [[nodiscard]] connector_traits traits() const noexcept override {
    connector_traits known = forwarding_connector::traits();
    known.recognised.model = model_;
    known.recognised.by = by_;
    known.recognised.candidates = {};
    known.begun_as = nullptr;
    return known;
  }

 private:
  const model* model_;
  known_by by_;
};

#if defined(G4LIDAR_HAS_SIM)
/// To the port of a simulated lidar, which it owns.
class simulated_connector final : public stated_connector {
 public:
  simulated_connector(std::unique_ptr<connector> inner, sim::simulated_source simulated)
      : stated_connector(std::move(inner), model_of(simulated), known_by::recording),
        of_(std::move(simulated)) {}

  [[nodiscard]] const sim::simulated_source& source() const noexcept { return of_; }

  [[nodiscard]] static const model& model_of(const sim::simulated_source& of) noexcept {
    const model* const named = model_named(of.model);
    return named != nullptr ? *named : g4_model;
  }

 private:
  sim::simulated_source of_;
};

result<std::unique_ptr<connector>> connect_simulated(const lidar_options& options, bool always) {
  auto made = sim::open_simulated(options.device);
  if (!made) return tl::unexpected(made.error());
  auto inner = system_connector::find(
      made->port->path(), known_of(options, &simulated_connector::model_of(*made)), always);
  if (!inner) return inner;
  return std::make_unique<simulated_connector>(*std::move(inner), *std::move(made));
}
#else
result<std::unique_ptr<connector>> connect_simulated(const lidar_options& options, bool) {
  return failure(task::opening, problem::bad_option, options.device, 0, error_detail::no_simulator);
}
#endif

/// With a model that is given, and another one in the name.
std::optional<error> problem_with_name(const lidar_options& options, const model* in_name) {
  return problem_with_model({.model = options.model}, {.model = in_name, .by = known_by::user},
                            "the name");
}

/// `opened`, read as the model of the options, or an error if it cannot be.
result<std::unique_ptr<connector>> of_model(result<std::unique_ptr<connector>> opened,
                                            const lidar_options& options) {
  if (!opened || options.model == nullptr) return opened;
  const recognition stated = (*opened)->traits().recognised;
  if (const auto wrong = problem_with_model(options, stated, "the source")) {
    return tl::unexpected(*wrong);
  }
  if (*stated.model == *options.model) return opened;
  return std::make_unique<stated_connector>(*std::move(opened), *options.model, known_by::user);
}

}  // namespace

source_kind kind_of_source(std::string_view name) {
  if (name == "-") return source_kind::raw_bytes;
  if (name.starts_with(sim_prefix)) return source_kind::simulated;
  const std::string path = path_of_source(name);
  struct stat found{};
  if (path.empty() || ::stat(path.c_str(), &found) != 0 || S_ISCHR(found.st_mode)) {
    return name.starts_with(file_prefix) ? source_kind::raw_bytes : source_kind::device;
  }
  return S_ISREG(found.st_mode) && is_recording(path) ? source_kind::recording
                                                      : source_kind::raw_bytes;
}

std::string path_of_source(std::string_view name) { return std::string(divided(name).path); }

bool reads_file(std::string_view name, const std::string& path) {
  const auto is_at = [&path](const std::string& file) { return are_one_file(file, path); };
  if (name == "-") return is_at("/dev/stdin");
#if defined(G4LIDAR_HAS_SIM)
  if (sim::is_simulated(name)) {
    const auto read = sim::parse_setup(name);
    const auto* const setup = std::get_if<sim::setup>(&read);
    return setup != nullptr && (is_at(setup->world_file) || is_at(setup->path_file));
  }
#endif
  return is_at(path_of_source(name));
}

result<const model*> model_in_source(std::string_view name) {
  const std::string_view word = divided(name).model;
  if (word.empty()) return nullptr;
  const model* const found = model_named(word);
  if (found != nullptr) return found;
  return failure(task::opening, problem::bad_option, "model: " + why_no_model(word));
}

result<const model*> model_of_source(const lidar_options& options) {
  const std::string_view name = options.device;
  const std::string path = path_of_source(name);
  const source_kind kind = kind_of_source(name);
  const auto in_name = model_in_source(name);
  if (!in_name) return in_name;
  if (const auto wrong = problem_with_name(options, *in_name)) return tl::unexpected(*wrong);
  const model* const wanted = *in_name != nullptr ? *in_name : options.model;
  if (kind == source_kind::raw_bytes) {
    if (wanted == nullptr) return &model_of_bytes(path);
    const auto wrong = problem_with_bytes(path, *wanted);
    if (wrong && wrong->detail() == error_detail::other_samples) return tl::unexpected(*wrong);
    return wanted;
  }
#if defined(G4LIDAR_HAS_SIM)
  if (kind == source_kind::simulated) {
    const auto read = sim::parse_setup(name);
    const auto* const setup = std::get_if<sim::setup>(&read);
    const model* const named = setup != nullptr ? model_named(setup->model) : nullptr;
    return named != nullptr ? named : &g4_model;
  }
#endif
  if (kind != source_kind::recording) return wanted;
  lidar_options known = options;
  known.model = wanted;
  return of_model(replay::open(path, {}, options.is_cancelled), known).map([](const auto& of) {
    return of->traits().recognised.model;
  });
}

result<std::unique_ptr<connector>> connector_for(const lidar_options& options) {
  return connector_for(options, false);
}

result<std::unique_ptr<connector>> connector_for(const lidar_options& options, bool at_any_rate) {
  const std::string path = path_of_source(options.device);
  const source_kind kind = kind_of_source(options.device);
  const auto named = model_in_source(options.device);
  if (!named) return tl::unexpected(named.error());
  if (const auto wrong = problem_with_name(options, *named)) return tl::unexpected(*wrong);
  const model* const wanted = *named != nullptr ? *named : options.model;
  lidar_options known = options;
  known.model = wanted;
  if (wanted == nullptr && kind == source_kind::simulated) {
    known.model = model_of_source(options).value_or(nullptr);
  }
  if (const auto wrong = problem_with_users(options, users_of(kind, path)))
    return tl::unexpected(*wrong);
  const bool is_searched = wanted == nullptr && kind == source_kind::device;
  const auto wrong = is_searched ? problem_with_use(known) : problem_with(known);
  if (wrong) return tl::unexpected(*wrong);
  switch (kind) {
    case source_kind::recording:
      return of_model(replay::open(path, options.playback, options.is_cancelled), known);
    case source_kind::raw_bytes:
      if (wanted != nullptr) {
        if (const auto other = problem_with_bytes(path, *wanted)) return tl::unexpected(*other);
      }
      return open_raw_bytes(path, options.raw_sample_rate_hz, options.playback,
                            options.is_cancelled, wanted);
    case source_kind::simulated:
      return connect_simulated(options, at_any_rate);
    case source_kind::device:
      break;
  }
  return system_connector::find(path, known_of(options, wanted), at_any_rate,
                                options.probe_all_ports);
}

std::optional<error> problem_with_source(const lidar_options& options) {
  return problem_with_users(options, users_of(options.device));
}

lidar_options usable_options(lidar_options options) {
  const option_users users = users_of(options.device);
  return without_others(std::move(options), users);
}

const sim::simulated_source* simulation_of([[maybe_unused]] const connector& from) noexcept {
#if defined(G4LIDAR_HAS_SIM)
  const auto* const found = dynamic_cast<const simulated_connector*>(&from);
  return found == nullptr ? nullptr : &found->source();
#else
  return nullptr;
#endif
}

bool has_simulated_robot([[maybe_unused]] std::string_view name) {
#if defined(G4LIDAR_HAS_SIM)
  if (!sim::is_simulated(name)) return false;
  const auto read = sim::parse_setup(name);
  const auto* const setup = std::get_if<sim::setup>(&read);
  if (setup == nullptr) return false;
  if (!setup->path_file.empty()) return true;
  const auto scene = sim::load_world(setup->world_file);
  const auto* const world = std::get_if<sim::world>(&scene);
  return world != nullptr && !world->path.empty();
#else
  return false;
#endif
}

std::function<stamped_odometry()> robot_of([[maybe_unused]] const sim::simulated_source& of) {
#if defined(G4LIDAR_HAS_SIM)
  if (!of.robot) return {};
  return [robot = *of.robot, begin_ns = of.begin_ns]() mutable {
    const sim::odometry_sample at = robot.next();
    return stamped_odometry{at.time_ns + begin_ns,
                            {at.x_m, at.y_m, at.yaw_rad},
                            {at.forward_m_per_s, at.left_m_per_s, at.yaw_rad_per_s}};
  };
#else
  return {};
#endif
}

mounting mounting_on_robot([[maybe_unused]] const sim::simulated_source& of) {
#if defined(G4LIDAR_HAS_SIM)
  const sim::pose& at = of.mounted_at;
  return {.pose = {at.x_m, at.y_m, at.heading_deg * std::numbers::pi / 180.0}};
#else
  return {};
#endif
}

}  // namespace g4lidar
