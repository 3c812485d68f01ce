// SPDX-License-Identifier: MIT
#include "source.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <chrono>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/forwarding.hpp"
#include "interrupt.hpp"
#include "output.hpp"

namespace g4_tool {
namespace {

constexpr std::string_view file_prefix = "file:";

bool may_still_come(const g4lidar::error& why) {
  using enum g4lidar::problem;
  return why.code() == no_port || why.code() == silence || why.code() == gone ||
         why.code() == cannot_connect || why.code() == garbage || why.code() == busy;
}

class tapped_connector final : public forwarding_connector {
 public:
  tapped_connector(std::unique_ptr<connector> inner, const transport_tap& tap)
      : forwarding_connector(std::move(inner)), tap_(tap) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (port) port = tap_(std::move(*port));
    return port;
  }

 private:
  transport_tap tap_;
};

/// A name that is neither a port nor a file: the message depends on what it looks like.
void refuse_unknown_name(const std::string& source, const g4lidar::error& why) {
  const std::string_view name = source;
  if (why.code() != g4lidar::problem::no_port || name.empty() || name.starts_with("/dev/") ||
      name.starts_with("serial:") || name.starts_with("usb:")) {
    return;
  }
  const bool is_file = name.ends_with(".mcap") || name.ends_with(".bin") || name.ends_with(".raw");
  throw failure(
      is_file ? exit_code::bad_file : exit_code::no_device,
      fmt::format("there is no {} {}. Check the name; g4-dump list shows the serial ports.",
                  is_file ? "file" : "port or file", in_quotes(source)),
      name_of(why.code()));
}

}  // namespace

source_kind kind_of(const std::string& source) {
  const std::string_view name = source;
  if (name == "-") return source_kind::bytes;
  if (sim::is_simulated(name)) return source_kind::simulated;
  const std::string path = path_of(source);
  struct stat status{};
  if (path.empty() || ::stat(path.c_str(), &status) != 0 || S_ISCHR(status.st_mode)) {
    return name.starts_with(file_prefix) ? source_kind::bytes : source_kind::device;
  }
  if (S_ISREG(status.st_mode) && is_recording(path)) return source_kind::recording;
  return source_kind::bytes;
}

std::string path_of(const std::string& source) {
  return source.starts_with(file_prefix) ? source.substr(file_prefix.size()) : source;
}

namespace {

/// "-" is standard input.
std::string name_of_text(const std::string& name, const output* out) {
  std::string file = name == "-" ? "/dev/stdin" : name;
  if (out != nullptr && !file.empty()) refuse_same_file(id_of_name(file), *out);
  return file;
}

[[noreturn]] void refuse(const std::string& file, const sim::world_error& error,
                         std::string_view advice) {
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", in_quotes(file),
                            error.line > 0 ? fmt::format(", line {}", error.line) : "",
                            error.message, advice));
}

}  // namespace

sim::world load_scene(const sim::setup& setup, const output* out) {
  const std::string file = name_of_text(setup.world_file, out);
  auto read = sim::load_world(file);
  if (interrupt() != 0) throw interrupted();
  if (const auto* error = std::get_if<sim::world_error>(&read)) {
    refuse(
        file, *error,
        "Give a text file of walls (docs/sim.md has the format), or none for the built-in rooms.");
  }
  auto scene = std::get<sim::world>(std::move(read));
  if (setup.path_file.empty()) return scene;
  const std::string path_file = name_of_text(setup.path_file, out);
  const auto wrong = sim::load_path(scene, path_file);
  if (interrupt() != 0) throw interrupted();
  if (wrong) {
    refuse(path_file, *wrong,
           "Give a text file of poses or commands (docs/sim.md has the format).");
  }
  return scene;
}

simulated_port serve_simulated(const std::string& source, std::optional<simulated_robot>* robot) {
  const auto read = sim::parse_setup(source);
  if (const auto* error = std::get_if<sim::setup_error>(&read)) throw bad_value(error->message);
  const auto& wish = std::get<sim::setup>(read);
  const sim::world scene = load_scene(wish);
  auto served = sim::serve_alone(sim::device(scene, wish.device, wish.faults));
  if (served && robot != nullptr && !scene.path.empty()) {
    (*served)->with([&](const sim::device&, std::int64_t now_ns) {
      const auto steady_ns = std::chrono::steady_clock::now().time_since_epoch();
      *robot = simulated_robot{sim::odometry(scene, {.seed = wish.device.scanner.seed}),
                               std::chrono::nanoseconds(steady_ns).count() - now_ns};
    });
  }
  if (served) return *std::move(served);
  throw failure(exit_code::bad_file,
                in_tool_words(served.error().message()) + " TMPDIR can name another directory.");
}

opened_source::opened_source(const common_options& options, const opening& wish) {
  lidar_options how = wish.how;
  how.device = options.source;
  how.baud = options.baud;
  how.reconnect = options.on_loss != loss_rule::exit;
  const source_kind kind = kind_of(options.source);
  if (kind == source_kind::simulated) {
    simulation_ = serve_simulated(options.source, &robot_);
    how.device = simulation_->path();
  }
  while (true) {
    const std::string path = path_of(how.device);
    auto from = kind == source_kind::recording ? replay::open(path, wish.played)
                : kind == source_kind::bytes   ? open_raw_bytes(path, wish.bytes_rate_hz)
                                               : connector_for(how);
    if (from) played_ = replay::reader_of(**from);
    if (from && wish.tap) from = wish.tap(std::move(*from));
    if (from && wish.each) from = std::make_unique<tapped_connector>(std::move(*from), wish.each);
    auto opened = from ? g4lidar::lidar::open(std::move(*from), how) : tl::unexpected(from.error());
    if (opened) {
      lidar_.emplace(std::move(*opened));
      logger::verbose(fmt::format("opened {}\n", lidar_->name()));
      return;
    }
    if (options.on_loss != loss_rule::wait || !may_still_come(opened.error())) {
      refuse_unknown_name(options.source, opened.error());
      throw failure(opened.error());
    }
    logger::verbose(in_tool_words(opened.error().message()) + "\n");
    const auto next = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
    if (wait_for_input(-1, -1, next) == wake::interrupt) throw interrupted();
  }
}

}  // namespace g4_tool
