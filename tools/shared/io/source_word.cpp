// SPDX-License-Identifier: MIT
#include "source_word.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "command_files.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/transport.hpp"
#include "input.hpp"
#include "interrupt.hpp"

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
std::string name_of_text(const std::string& name) {
  add_input(name);
  return name == "-" ? "/dev/stdin" : name;
}

[[noreturn]] void refuse(const std::string& file, const sim::world_error& error,
                         std::string_view advice) {
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", in_quotes(file),
                            error.line > 0 ? fmt::format(", line {}", error.line) : "",
                            error.message, advice));
}

}  // namespace

sim::world load_scene(const sim::setup& setup) {
  const std::string file = name_of_text(setup.world_file);
  auto read = sim::load_world(file);
  if (interrupt() != 0) throw interrupted();
  if (const auto* error = std::get_if<sim::world_error>(&read)) {
    refuse(
        file, *error,
        "Give a text file of walls (docs/sim.md has the format), or none for the built-in rooms.");
  }
  auto scene = std::get<sim::world>(std::move(read));
  if (setup.path_file.empty()) return scene;
  const std::string path_file = name_of_text(setup.path_file);
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

/// Whether points of both are made from the same bytes in the same way.
bool are_alike(const g4lidar::model& a, const g4lidar::model& b) {
  return a.samples.layout == b.samples.layout && a.samples.correction == b.samples.correction &&
         a.turn_deg == b.turn_deg && first_rate_hz(a) == first_rate_hz(b);
}

/// The first model of each kind whose bytes are recognised as `found`, joined by commas: with samples of
/// this size, and with flags if samples of 2 bytes have shown them.
std::string alternatives_to(const g4lidar::model& found) {
  const sample_layout layout = found.samples.layout;
  const bool has_shown_flags = layout == sample_layout::flagged_mm;
  std::vector<const g4lidar::model*> kinds{&found};
  std::string words;
  for (const g4lidar::model& each : models) {
    if (!may_send(each, sample_size(layout), has_shown_flags)) continue;
    if (std::ranges::any_of(kinds, [&](const auto* kind) { return are_alike(*kind, each); }))
      continue;
    kinds.push_back(&each);
    words += (words.empty() ? "" : ", ") + std::string(each.word);
  }
  return words;
}

/// That of --model, or of the name; null: none is named.
const g4lidar::model* named_model(const common_options& options) {
  const g4lidar::model* const named = value_of(model_in_source(options.source));
  const g4lidar::model* const given = options.expected.model;
  if (named != nullptr && given != nullptr && named != given) {
    throw bad_value(fmt::format("--model: {}, and {} states {}", given->word,
                                in_quotes(options.source), named->word));
  }
  return named != nullptr ? named : given;
}

}  // namespace

void report_model(const g4lidar::model& found, bool is_usual) {
  const std::string_view samples = words_for(found.samples.layout);
  if (!is_usual) {
    if (found != g4_model)
      logger::info(fmt::format("read as {}, which these bytes name\n", found.name));
    return;
  }
  const std::string others = alternatives_to(found);
  if (others.empty()) return logger::info(fmt::format("read as {}: {}\n", found.name, samples));
  logger::info(
      fmt::format("read as {}: {} do not name their model; --model names another one: {}\n",
                  found.name, samples, others));
}

void report_candidates(std::span<const g4lidar::model* const> candidates) {
  if (candidates.size() < 2) return;
  logger::info(
      fmt::format("read as {}: its bytes do not name their model; --model names another one: {}\n",
                  candidates.front()->name, model_words(candidates.subspan(1))));
}

void report_missing_zero(const g4lidar::model& model) {
  logger::info(
      fmt::format("the offset of zero of this {} is not known: its answer to command 93 is "
                  "missing, and the angles are those of "
                  "the device; --zero-angle gives it\n",
                  model.name));
}

void report_contradictions(const recognition& found) {
  report_contradictions(contradictions_of(found));
}

void report_contradictions(const std::string& now) {
  static std::string last;
  if (!now.empty() && now != last) logger::info(now + "\n");
  last = now;
}

void report_contradictions(const g4lidar::lidar& from) {
  const recognition found = from.recognition();
  const auto has_it = [&](const g4lidar::model& row) { return row.has_number(found.number); };
  const bool is_guessed = found.by == known_by::samples || found.by == known_by::nothing;
  const bool may_change = is_guessed && found.number != 0 && std::ranges::none_of(models, has_it) &&
                          !found.was_stopped && from.counts().stream.packets <= certain_packets;
  if (!may_change) report_contradictions(found);
}

void report_model(const recognised_model& found) { report_model(*found.which, found.is_usual()); }

// What all sources get is left out: the speed 1 of programs that show a recording.
void refuse_options_of_others(const common_options& options, const lidar_options& wanted) {
  constexpr double as_recorded = 1.0;
  lidar_options given = options.expected;
  given.device = options.source;
  given.reconnect = options.on_loss.given.has_value();
  given.playback = wanted.playback;
  given.raw_sample_rate_hz = wanted.raw_sample_rate_hz;
  given.counts_times = wanted.counts_times;
  if (given.playback.speed == as_recorded) given.playback.speed = lidar_options().playback.speed;
  const auto wrong = problem_with_source(given);
  if (!wrong) return;
  std::string text = wrong->message();
  for (const parameter& each : all_parameters()) {
    const std::string words = fmt::format("configuring {},", each.name);
    if (text.starts_with(words)) text.replace(0, words.size(), flag_of(each) + ",");
  }
  throw failure(exit_code::usage, text, name_of(wrong->code()));
}

void refuse_zero_angle(const common_options& options, std::string_view why) {
  if (options.expected.zero_angle)
    throw bad_value(fmt::format("--zero-angle: {}; it is for g4-dump dump, scan and convert", why));
}

const g4lidar::model* model_of(const common_options& options,
                               std::optional<recognised_model>* shown) {
  refuse_options_of_others(options);
  const source_kind kind = kind_of_source(options.source);
  const g4lidar::model* const named = named_model(options);
  if (kind == source_kind::raw_bytes && named == nullptr) {
    const std::string path = path_of_source(options.source);
    if (!size_of_file(path)) return nullptr;
    const recognised_model found = recognised_in(path);
    if (shown == nullptr) report_model(found);
    if (shown != nullptr) *shown = found;
    return found.which;
  }
  const auto found = model_of_source({.device = options.source,
                                      .model = named,
                                      .insist_on_model = options.expected.insist_on_model,
                                      .is_cancelled = [] { return interrupt() != 0; }});
  if (interrupt() != 0) throw interrupted();
  return value_of(found);
}

lidar_options options_for(const common_options& options, lidar_options wanted) {
  wanted.device = options.source;
  wanted.model = named_model(options);
  if (options.expected.baud != 0) wanted.baud = options.expected.baud;
  wanted.listen_only = options.expected.listen_only;
  wanted.leave_dtr = options.expected.leave_dtr;
  refuse_options_of_others(options, wanted);
  wanted.zero_angle = options.expected.zero_angle;
  wanted.probe_all_ports = options.expected.probe_all_ports;
  wanted.insist_on_model = options.expected.insist_on_model;
  const loss_rule at_loss = options.on_loss.given.value_or(options.on_loss.usual);
  wanted.reconnect = at_loss != loss_rule::exit;
  // A file that is missing is not waited for.
  if (at_loss == loss_rule::wait && !is_file_name(options.source))
    wanted.device_wait = std::chrono::milliseconds::max();
  if (!wanted.is_cancelled) wanted.is_cancelled = [] { return interrupt() != 0; };
  wanted = usable_options(std::move(wanted));
  if (wanted.model != nullptr) return wanted;
  const bool is_raw = kind_of_source(options.source) == source_kind::raw_bytes;
  wanted.wrap = [inner = std::move(wanted.wrap), is_raw](std::unique_ptr<connector> from) {
    const connector_traits behind = from->traits();
    const recognition& found = behind.recognised;
    // Of a contradiction they are part, and later.
    const bool is_other =
        found.number != 0 && found.model != nullptr && !found.model->has_number(found.number);
    if (!is_other && !is_raw) report_candidates(found.candidates);
    if (is_raw && found.model != nullptr) report_model(*found.model, found.by == known_by::samples);
    return inner ? inner(std::move(from)) : result<std::unique_ptr<connector>>(std::move(from));
  };
  return wanted;
}

failure failure_of(const common_options& options, const g4lidar::error& why) {
  const bool is_raw = kind_of_source(options.source) == source_kind::raw_bytes;
  const std::string title = title_of_input(options.source);
  if (is_raw && why == problem::bad_file && why.system_errno() == 0) {
    if (why.detail() == error_detail::known_bytes) return not_packets(why.subject());
    return {exit_code::bad_file,
            title +
                " is a recording, not raw bytes. Give the file's name to g4-dump "
                "dump, scan or packets: a recording in a pipe is not read."};
  }
  if (is_raw && why.doing() == task::opening && why.system_errno() != 0)
    return not_opened(title, why.system_errno(), raw_bytes_advice);
  if (why.detail() != error_detail::missing_path || !is_file_name(options.source))
    return failure(why, why.doing() == task::reading && !is_raw);
  return failure(
      exit_code::bad_file,
      fmt::format("there is no file {}. Check the name; g4-dump list shows the serial ports.",
                  in_quotes(options.source)),
      name_of(why.code()));
}

std::optional<std::uint64_t> size_of_file(const std::string& path) {
  struct stat found{};
  const bool is_known = (path == "-" ? ::fstat(0, &found) : ::stat(path.c_str(), &found)) == 0;
  if (!is_known || !S_ISREG(found.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(found.st_size);
}

std::string title_of_input(const std::string& source) {
  const std::string path = path_of_source(source);
  return path == "-" ? "standard input" : in_quotes(path);
}

}  // namespace g4_tool
