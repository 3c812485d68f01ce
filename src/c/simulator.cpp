// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <variant>
#include <vector>

#include "border.hpp"
#include "g4lidar/sim/setup.hpp"
#include "motion_values.hpp"
#include "simulation.hpp"

namespace g4lidar::c {

simulation::simulation(const sim::world& scene, std::uint64_t seed,
                       std::shared_ptr<sim::background_pty> served)
    : served_(std::move(served)) {
  follow_robot(scene, seed);
  served_->with(
      [this](const sim::device&, std::int64_t now_ns) { begin_ns_ = g4lidar_now_ns() - now_ns; });
}

void simulation::follow_robot(const sim::world& scene, std::uint64_t seed) {
  if (!scene.path.empty()) way_.emplace(scene, sim::odometry_options{.seed = seed});
}

std::unique_ptr<connector> simulation::connect() {
  return device_ ? std::make_unique<sim::virtual_connector>(*device_, clock_) : nullptr;
}

std::optional<sim::odometry_sample> simulation::next_odometry() {
  const std::int64_t now_ns = served_ ? g4lidar_now_ns() : clock_.now_ns();
  if (!way_ || way_->next_ns() + begin_ns_ > now_ns) return std::nullopt;
  sim::odometry_sample next = way_->next();
  next.time_ns += begin_ns_;
  return next;
}

namespace {

/// The world of the options. Returns a g4lidar_result.
int load_scene(const g4lidar_simulator_options& options, const sim::setup& wanted,
               sim::world& scene, g4lidar_error* error) {
  auto read = options.world != nullptr ? sim::parse_world(options.world)
                                       : sim::load_world(wanted.world_file);
  if (const auto* wrong = std::get_if<sim::world_error>(&read)) {
    return bad_text(error, wrong->line, wrong->message,
                    options.world != nullptr ? "" : wanted.world_file);
  }
  scene = std::get<sim::world>(std::move(read));
  if (options.path != nullptr) {
    auto path = sim::parse_path(options.path, scene.lidar);
    if (const auto* wrong = std::get_if<sim::world_error>(&path)) {
      return bad_text(error, wrong->line, wrong->message);
    }
    scene.path = std::get<std::vector<sim::path_point>>(std::move(path));
    scene.lidar = scene.path.front().robot.at;
  } else if (!wanted.path_file.empty()) {
    if (const auto wrong = sim::load_path(scene, wanted.path_file)) {
      return bad_text(error, wrong->line, wrong->message, wanted.path_file);
    }
  }
  return G4LIDAR_OK;
}

int bad_setup(g4lidar_error* error, std::string_view why) noexcept {
  return fail(error, G4LIDAR_BAD_OPTION, G4LIDAR_CONFIGURING, why,
              "docs/sim.md describes the setup of a simulated lidar.");
}

}  // namespace

int simulate(const g4lidar_simulator_options& options, std::shared_ptr<simulation>& made,
             g4lidar_error* error) {
  const auto read = sim::parse_setup(options.setup == nullptr ? "sim:" : options.setup);
  if (const auto* wrong = std::get_if<sim::setup_error>(&read)) {
    return bad_setup(error, wrong->message);
  }
  const auto& wanted = std::get<sim::setup>(read);
  for (const sim::fault& each : wanted.faults) {
    if (const auto wrong = sim::problem_with(each); !wrong.empty()) return bad_setup(error, wrong);
  }
  sim::world scene;
  if (const int code = load_scene(options, wanted, scene, error); code != G4LIDAR_OK) return code;
  const std::uint64_t seed = wanted.device.scanner.seed;
  sim::device simulated(scene, wanted.device, wanted.faults);
  if (options.virtual_time) {
    made = std::make_shared<simulation>(scene, seed, std::move(simulated));
    made->set_simulated(model_named(wanted.device.model));
    return succeed(error);
  }
  std::shared_ptr<sim::background_pty> served;
  if (options.link == nullptr) {
    auto alone = sim::serve_alone(std::move(simulated));
    if (!alone) return fail(error, alone.error());
    served = *std::move(alone);
  } else {
    auto linked = sim::background_pty::open(std::move(simulated), options.link);
    if (!linked) return fail(error, linked.error());
    served = std::make_shared<sim::background_pty>(*std::move(linked));
  }
  made = std::make_shared<simulation>(scene, seed, std::move(served));
  made->set_simulated(model_named(wanted.device.model));
  return succeed(error);
}

}  // namespace g4lidar::c

using namespace g4lidar;
using namespace g4lidar::c;

namespace {

constexpr g4lidar_simulator_options simulator_defaults{
    sizeof(g4lidar_simulator_options), nullptr, nullptr, nullptr, nullptr, false, {}};

template <class Change>
int changed(g4lidar_simulator* simulator, Change change) noexcept {
  return guarded(
      nullptr,
      [&] {
        simulator->made->with(change);
        return G4LIDAR_OK + 0;
      },
      simulator);
}

}  // namespace

void g4lidar_simulator_options_init(g4lidar_simulator_options* options, size_t size) {
  set_defaults(options, size, simulator_defaults);
}

int g4lidar_simulator_create(const g4lidar_simulator_options* options,
                             g4lidar_simulator** simulator, g4lidar_error* error) {
  return created(simulator, error, [&] {
    g4lidar_simulator_options taken = simulator_defaults;
    if (!take_options(options, taken)) return refuse(error, bad_options);
    auto handle = std::make_unique<g4lidar_simulator>();
    const int code = simulate(taken, handle->made, error);
    if (code != G4LIDAR_OK) return code;
    handle->path = handle->made->path();
    *simulator = handle.release();
    return code;
  });
}

void g4lidar_simulator_free(g4lidar_simulator* simulator) { delete simulator; }

const char* g4lidar_simulator_path(const g4lidar_simulator* simulator) {
  return simulator == nullptr ? nullptr : simulator->path.c_str();
}

int g4lidar_simulator_unplug(g4lidar_simulator* simulator) {
  return changed(simulator, [](sim::device& it, std::int64_t now_ns) { it.unplug(now_ns); });
}

int g4lidar_simulator_replug(g4lidar_simulator* simulator) {
  return changed(simulator, [](sim::device& it, std::int64_t now_ns) { it.replug(now_ns); });
}

int g4lidar_simulator_advance(g4lidar_simulator* simulator, int64_t duration_ns) {
  if (simulator == nullptr || !simulator->made->is_virtual() || duration_ns < 0) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  sim::virtual_clock& clock = simulator->made->clock();
  constexpr std::int64_t most_ns = std::int64_t{1} << 60;
  clock.advance_to(clock.now_ns() + std::min(duration_ns, most_ns - clock.now_ns()));
  return G4LIDAR_OK;
}

const g4lidar_simulator_state* g4lidar_simulator_get_state(g4lidar_simulator* simulator) {
  const int code = changed(simulator, [&](sim::device& it, std::int64_t now_ns) {
    g4lidar_simulator_state& state = simulator->state;
    state.time_ns = now_ns;
    state.is_plugged = it.is_plugged(now_ns);
    state.is_scanning = it.is_scanning();
    state.motor_turns = it.motor_turns();
    state.motor_hz = static_cast<float>(it.motor_mhz(now_ns)) / 1000.0F;
    state.bytes_delivered = it.bytes_delivered();
    state.replugs = it.replugs();
  });
  return code == G4LIDAR_OK ? &simulator->state : nullptr;
}

int g4lidar_simulator_take_truth(g4lidar_simulator* simulator, g4lidar_truth* truth, size_t room,
                                 size_t* count) {
  if (count == nullptr || (room > 0 && truth == nullptr)) return G4LIDAR_BAD_ARGUMENT;
  std::size_t taken = 0;
  const int code = changed(simulator, [&](sim::device& it, std::int64_t) {
    std::array<sim::sent_sample, 64> part;
    while (taken < room) {
      const auto piece = std::span(part).first(std::min(part.size(), room - taken));
      const std::size_t got = it.take_truth(piece);
      for (const sim::sent_sample& each : piece.first(got)) {
        const sim::sample_truth& of = each.truth;
        truth[taken++] = {of.time_ns,   of.first_level_deg, of.bearing_deg,       of.range_mm,
                          of.lidar.x_m, of.lidar.y_m,       of.lidar.heading_deg, of.revolution};
      }
      if (got < piece.size()) break;
    }
  });
  if (code == G4LIDAR_OK) *count = taken;
  return code;
}

int g4lidar_simulator_next_odometry(g4lidar_simulator* simulator, g4lidar_odometry* odometry) {
  if (simulator == nullptr || odometry == nullptr) return G4LIDAR_BAD_ARGUMENT;
  const auto next = simulator->made->next_odometry();
  if (!next) return G4LIDAR_NOTHING;
  *odometry = {next->time_ns,
               {next->x_m, next->y_m, next->yaw_rad},
               {next->forward_m_per_s, next->left_m_per_s, next->yaw_rad_per_s}};
  return G4LIDAR_OK;
}
