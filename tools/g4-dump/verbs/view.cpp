// SPDX-License-Identifier: MIT
// The verb view: a radar in the terminal.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/named_sources.hpp"
#include "g4lidar/lidar.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/service_source.hpp"
#include "verbs/dump_verbs.hpp"
#include "view/newest_scan.hpp"
#include "view/picture.hpp"
#include "view/screen.hpp"
#include "view/trails.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

/// The shortest time between two pictures, and between two queries of slow facts.
constexpr auto least_pause = 66ms;
constexpr auto facts_pause = 500ms;
/// How long --once waits for a revolution.
constexpr std::chrono::nanoseconds longest_wait = 20s;

/// The least and the greatest intensity of the returns; nothing if the model does not measure it.
std::optional<std::pair<int, int>> intensities_of(const scan& now) {
  if (!has_intensity(*now.model)) return std::nullopt;
  std::optional<std::pair<int, int>> found;
  for (const point& each : now) {
    if (each.is_no_return()) continue;
    const int here = each.intensity;
    if (!found) found.emplace(here, here);
    found = {std::min(found->first, here), std::max(found->second, here)};
  }
  return found;
}

struct view_job {
  shared_options common = std::make_shared<common_options>();
  std::vector<std::string> sources{};  ///< "SOURCE", or "NAME=SOURCE".
  std::vector<named_mounting> mounts{};
  bool merges = false;
  lidar_options source{.playback = {.speed = 1}};
  view_settings settings{};
  std::optional<glyphs> how{};
  bool once = false;
  int columns = 80;
  int rows = 24;
};

class viewer {
 public:
  explicit viewer(const view_job& job) : job_(job), settings_(job.settings) {
    std::vector<service_lidar> read;
    for (const named_source& each : shown_sources(job.sources, job.mounts, job.merges)) {
      common_options& options = options_.emplace_back(*job.common);
      options.source = each.source;
      options.mount = each.mount;
      read.push_back(service_lidar_of(options, job.source));
      read.back().name = each.name;
      name_ +=
          (name_.empty() ? "" : ", ") + (each.name.empty() ? "" : each.name + '=') + each.source;
    }
    service_options how = service_options_of(*job.common);
    how.merges = job.merges;
    how.follows_motion = true;
    service_ = make_service(std::move(read), std::move(how), {{&newest_, delivery::in_reader}});
    const blocked_signals handled_by_this_thread;
    value_of(service_->start());
  }

  int run() {
    {
      screen terminal(wants_color(STDOUT_FILENO));
      while (!is_over_ && interrupt() == 0 && !failure_of_all() && !limits_.is_over()) {
        update();
        terminal.show(picture(terminal.columns(), terminal.rows()));
        wait(terminal);
      }
    }
    service_->stop();
    if (const auto why = failure_of_all()) throw failure(*why);
    return exit_code_now();
  }

  int run_once() {
    output out(job_.common->output);
    const auto until =
        clock::now() + (job_.common->duration > 0ns ? job_.common->duration : longest_wait);
    while (!newest_.is_steady() && interrupt() == 0 && clock::now() < until &&
           !service_->has_ended()) {
      newest_.wait(std::min(until, clock::now() + 100ms), interrupt_handle());
    }
    update();
    service_->stop();
    if (const auto why = failure_of_all()) throw failure(*why);
    for (std::size_t i = 0; i < options_.size(); ++i) {
      if (const auto why = final_failure_of(options_[i], *service_, i))
        logger::info(std::string(why->what()) + '\n');
    }
    if (interrupt() != 0) return exit_code_now();
    if (scan_.view().empty()) throw failure(exit_code::lost, "no revolution has come.");
    const canvas shown = picture(job_.columns, job_.rows);
    for (int row = 0; row < shown.rows(); ++row) out.write(shown.text(row) + "\n");
    out.commit();
    return 0;
  }

 private:
  [[nodiscard]] std::optional<failure> failure_of_all() const {
    return g4_tool::failure_of_all(*service_, [this](std::size_t i) { return options_[i]; });
  }
  /// Takes the changes since the last call.
  void update() {
    std::string event;
    if (!settings_.is_frozen && newest_.take(scan_, place_, event)) {
      const scan now = scan_.view();
      trails_.add(now, place_);
      facts_.intensity = intensities_of(now);
      facts_.frequency_hz = static_cast<double>(now.measured_frequency_hz());
      facts_.sample_rate_hz = static_cast<double>(now.measured_sample_rate_hz());
      settings_.radar.turn_deg = now.model->turn_deg;
      if (!settings_.is_zoomed) update_range(now);
    }
    if (!event.empty()) facts_.event = event;
    if (const auto now = clock::now(); now >= facts_due_) {
      facts_due_ = now + facts_pause;
      facts_.stages = service_->stages(0);
    }
    trails_.show(settings_.radar, settings_.wants_map);
    const lidar_counts counts = service_->counts(0);
    const auto all = static_cast<double>(counts.stream.points + counts.samples_lost);
    facts_.lost_percent = all > 0 ? 100.0 * static_cast<double>(counts.samples_lost) / all : -1;
    facts_.checksum_errors =
        static_cast<std::int64_t>(counts.stream.skipped(skip_reason::bad_checksum));
    facts_.scans = static_cast<std::int64_t>(counts.scans);
    const reader_status status = service_->status(0);
    facts_.name = name_.empty() ? status.name : name_;
    facts_.state = name_of(status.state);
    facts_.why = why_of(options_.front(), status.why, counts);
    if (const auto& who = status.information) {
      facts_.serial.assign(who->serial_digits.begin(), who->serial_digits.end());
    }
    if (const auto& where = status.playback) {
      facts_.position_s = static_cast<double>(where->position_ns) * 1e-9;
      facts_.length_s = static_cast<double>(where->length_ns) * 1e-9;
    }
  }

  /// Zooms out at once, and in only after several revolutions, because a picture that often changes its
  /// scale is hard to read.
  void update_range(const scan& now) {
    const double wanted_m = range_for(now.points);
    double& range_m = settings_.radar.range_m;
    nearer_ = wanted_m < range_m ? nearer_ + 1 : 0;
    if (wanted_m > range_m || nearer_ > 10 || !std::exchange(has_range_, true)) range_m = wanted_m;
  }

  void wait(screen& terminal) {
    const auto begin = clock::now();
    const auto until = std::min({begin + facts_pause, limits_.end()});
    newest_.wait(until, STDIN_FILENO);
    bool is_pressed = false;
    while (const int key = terminal.key()) {
      press(key);
      is_pressed = true;
    }
    if (terminal.is_gone()) is_over_ = true;
    if (is_pressed || is_over_ || interrupt() != 0) return;
    const auto rest = begin + least_pause - clock::now();
    if (rest > 0ns) newest_.wait(clock::now() + rest, interrupt_handle());
  }

  [[nodiscard]] canvas picture(int width, int height) const {
    canvas made(width, height, glyphs_);
    draw_view(made, scan_.view().points, facts_, settings_);
    return made;
  }

  /// Robot, vendor, and the map where the motion is known.
  void change_frame() {
    radar_view& radar = settings_.radar;
    const bool is_robot = radar.frame == frame::robot;
    const bool was_map = std::exchange(settings_.wants_map, !is_robot && trails_.has_map());
    radar.frame = is_robot && !was_map ? frame::vendor : frame::robot;
  }

  void press(int key) {
    radar_view& radar = settings_.radar;
    switch (key) {
      case '+':
      case '=':
      case '-':
      case '_':
        settings_.is_zoomed = true;
        radar.range_m = next_range(radar.range_m, key == '-' || key == '_');
        break;
      case '0':
        settings_.is_zoomed = false;
        has_range_ = false;
        break;
      case 'p':
        settings_.is_frozen = !settings_.is_frozen;
        break;
      case ' ':
        if (const auto where = service_->status(0).playback) service_->pause(!where->is_paused);
        break;
      case 'f':
        change_frame();
        break;
      case 't':
        trails_.change_length();
        break;
      case 'g':
        radar.grid = !radar.grid;
        break;
      case 'h':
      case '?':
        settings_.shows_help = !settings_.shows_help;
        break;
      case 'q':
        is_over_ = true;
        break;
      default:
        break;
    }
  }

  const view_job& job_;
  glyphs glyphs_ = job_.how.value_or(screen::has_utf8() ? glyphs::braille : glyphs::ascii);
  view_settings settings_;
  newest_scan newest_{job_.once};
  std::vector<common_options> options_;  // of each lidar
  std::string name_;                     // of the source
  std::unique_ptr<lidar_service> service_;
  owned_scan scan_;
  std::optional<lidar_place> place_;
  trails trails_;
  view_facts facts_;
  time_limits limits_{job_.once ? 0ns : job_.common->duration, 0ns};
  clock::time_point facts_due_{};
  int nearer_ = 0;
  bool has_range_ = false;
  bool is_over_ = false;
};

int view(const view_job& job) {
  viewer shown(job);
  return job.once ? shown.run_once() : shown.run();
}

/// "80x24".
void take_size(view_job& job, const std::string& word) {
  const std::size_t cross = word.find('x');
  if (cross == std::string::npos) throw bad_value("'" + word + "' is no size such as 80x24");
  job.columns = number_of(word.substr(0, cross), 1, 1000);
  job.rows = number_of(word.substr(cross + 1), 1, 1000);
}

constexpr const char* view_details =
    R"(A radar in the terminal, of any size: each revolution from above, rings with their ranges, and
beside it frequency, sample rate, losses, health, the last event and what is wrong, as doctor
judges it. In a terminal of less than 60 columns or 12 rows the numbers stand in the last line.

Up is ahead, or with --frame vendor the direction 0. Keys:
  + -        nearer, farther
  0          the range follows the returns
  p          freeze the picture, or go on
  space      a recording: pause, play
  f          the frame: robot, vendor, and the map where the motion is known
  t          trails: off, 2 s, 10 s, where the motion is known
  g          rings on, off
  h ?        help
  q, ^C      quit; ^Z puts it in the background

The motion is known with --deskew, of a recording with odometry with --mount, and of a simulated
robot. Then earlier returns stay at the walls, and the way driven is shown.

Several lidars on one robot have names, and are joined with --merge; the numbers are those of the
first one.

The motor stops at the end. A lidar that is unplugged is awaited (--on-loss reconnect). With --once
one revolution is printed as text, of the size that --size names, to any output.)";

}  // namespace

verb make_view_verb() {
  const auto job = std::make_shared<view_job>();
  common_options& common = *job->common;
  common.on_loss.usual = loss_rule::reconnect;
  view_settings& settings = job->settings;
  option_row zoom =
      value_row("--zoom", "METERS", "From the middle to the edge (as far as the returns)",
                settings.radar.range_m, [&settings](const std::string& word) {
                  settings.is_zoomed = true;
                  return number_of(word, 0.5, 50.0);
                });
  option_row size{"--size", "COLUMNSxROWS", "Size of the picture of --once (80x24)",
                  [target = job.get()](const std::string& word) { take_size(*target, word); }};
  option_rows device = device_rows(common);
  return {
      .name = "view",
      .summary = "A radar in the terminal",
      .arguments = {named_source_arguments(
          job->sources,
          "The lidar, a recording, raw bytes, or sim:; NAME=SOURCE (the only lidar)")},
      .options = joined(
          zoom,
          frame_row("--frame", "What is up: ahead, or 0 degrees (robot)", settings.radar.frame),
          flag_row("--map", "The frame of the map, where the motion is known", settings.wants_map),
          rows_of("Motion of the robot", {"deskew"}, common.deskew), merge_row(job->merges),
          named_mount_row(job->mounts),
          choice_row("--glyphs", "What dots are made of (braille where the locale is UTF-8)",
                     job->how,
                     choices<glyphs>{{"braille", glyphs::braille}, {"ascii", glyphs::ascii}}),
          flag_row("--once", "Print one revolution and end", job->once), size, output_rows(common),
          duration_row(common), row_of("loop", job->source.playback.loop),
          row_of("raw_sample_rate_hz", job->source.raw_sample_rate_hz), device),
      .details = view_details,
      .examples = {{"g4-dump view", "The only lidar"},
                   {"g4-dump view sim:", "A simulated one"},
                   {"g4-dump view walk.mcap --loop", "A recording, again and again"},
                   {"g4-dump view front=/dev/ttyUSB0 rear=/dev/ttyUSB1 --merge "
                    "--mount front=0.2,0,0 --mount rear=-0.2,0,180",
                    "Two lidars as one scan"},
                   {"g4-dump view --once sim: --glyphs ascii", "One picture as text"}},
      .run = [job] { return view(*job); }};
}

}  // namespace g4_tool
