// SPDX-License-Identifier: MIT
#include "source.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <variant>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/transport/forwarding.hpp"
#include "interrupt.hpp"
#include "output.hpp"

namespace g4_tool {
namespace {

class tapped_connector final : public forwarding_connector {
 public:
  tapped_connector(std::unique_ptr<connector> inner, transport_tap tap)
      : forwarding_connector(std::move(inner)), tap_(std::move(tap)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (port) port = tap_(std::move(*port));
    return port;
  }

 private:
  transport_tap tap_;
};

}  // namespace

std::function<result<std::unique_ptr<connector>>(std::unique_ptr<connector>)> for_each_connection(
    transport_tap tap) {
  return [each = std::move(tap)](std::unique_ptr<connector> from) {
    return result<std::unique_ptr<connector>>(
        std::make_unique<tapped_connector>(std::move(from), each));
  };
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

namespace {

/// Whether a name at which nothing is was to be a file's.
bool is_file_name(std::string_view name) {
  return name.ends_with(".mcap") || name.ends_with(".bin") || name.ends_with(".raw");
}

}  // namespace

namespace {

std::string_view words_for(sample_layout layout) {
  switch (layout) {
    case sample_layout::flagged_mm:
      return "2-byte samples with flags";
    case sample_layout::half_mm:
      return "2-byte samples in half millimeters";
    case sample_layout::whole_mm:
      return "2-byte samples in millimeters";
    case sample_layout::intensity_8:
    case sample_layout::intensity_10:
      return "3-byte samples with intensity";
    case sample_layout::intensity_16:
      return "4-byte samples with intensity";
    case sample_layout::quarter_mm:
      break;
  }
  return "2-byte samples";
}

}  // namespace

const g4lidar::model& model_of(const common_options& options) {
  const source_kind kind = kind_of_source(options.source);
  if (options.expected.model != nullptr && kind != source_kind::recording)
    return *options.expected.model;
  const auto shown = model_of_source(options.source, [] { return interrupt() != 0; });
  if (interrupt() != 0) throw interrupted();
  const g4lidar::model& found = *value_of(shown);
  if (options.expected.model != nullptr && options.expected.model->word != found.word) {
    throw bad_value(fmt::format("--model: {}, and {} states {}", options.expected.model->word,
                                in_quotes(options.source), found.word));
  }
  if (kind == source_kind::raw_bytes && found.word != g4_model.word) {
    logger::info(fmt::format("read as {}: {}; give --model for another one\n", found.name,
                             words_for(found.samples.layout)));
  }
  return found;
}

lidar_options options_for(const common_options& options, lidar_options how) {
  how.device = options.source;
  how.model = options.expected.model;
  if (kind_of_source(options.source) == source_kind::raw_bytes) how.model = &model_of(options);
  if (options.expected.baud != 0) how.baud = options.expected.baud;
  how.reconnect = options.on_loss != loss_rule::exit;
  // A file that is missing is not waited for.
  if (options.on_loss == loss_rule::wait && !is_file_name(options.source))
    how.device_wait = std::chrono::milliseconds::max();
  if (!how.is_cancelled) how.is_cancelled = [] { return interrupt() != 0; };
  return how;
}

failure failure_of(const common_options& options, const g4lidar::error& why) {
  const std::string_view name = options.source;
  if (why.code() != g4lidar::problem::no_port || name.empty() || name.starts_with("/dev/") ||
      name.starts_with("serial:") || name.starts_with("usb:")) {
    return failure(why, why.doing() == task::reading);
  }
  // Neither a port nor a file: the message depends on what it looks like.
  const bool is_file = is_file_name(name);
  return failure(
      is_file ? exit_code::bad_file : exit_code::no_device,
      fmt::format("there is no {} {}. Check the name; g4-dump list shows the serial ports.",
                  is_file ? "file" : "port or file", in_quotes(options.source)),
      name_of(why.code()));
}

opened_source::opened_source(const common_options& options, lidar_options how) {
  how = options_for(options, std::move(how));
  how.wrap = [this, wrap = std::move(how.wrap)](std::unique_ptr<connector> from) {
    played_ = replay::reader_of(*from);
    simulation_ = simulation_of(*from);
    return wrap ? wrap(std::move(from)) : result<std::unique_ptr<connector>>(std::move(from));
  };
  auto opened = g4lidar::lidar::open(how);
  if (!opened) {
    if (interrupt() != 0 || opened.error() == problem::cancelled) throw interrupted();
    throw failure_of(options, opened.error());
  }
  lidar_.emplace(std::move(*opened));
  logger::verbose(fmt::format("opened {}\n", lidar_->name()));
}

}  // namespace g4_tool
