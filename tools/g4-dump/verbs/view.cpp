// SPDX-License-Identifier: MIT
// The verb view: a radar in the terminal.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/common_options.hpp"
#include "g4lidar/owned_scan.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/source_reader.hpp"
#include "verbs/verbs.hpp"
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
  lidar_options source{.playback = {.speed = 1}};
  view_settings settings{};
  std::optional<glyphs> how{};
  bool once = false;
  int columns = 80;
  int rows = 24;
};

class viewer {
 public:
  explicit viewer(const view_job& job)
      : job_(job), settings_(job.settings), reader_(*job.common, job.source, newest_) {
    newest_.attach(reader_);
    const blocked_signals handled_by_this_thread;
    reader_.start();
  }

  int run() {
    {
      screen terminal(wants_color(STDOUT_FILENO));
      while (!is_over_ && interrupt() == 0 && !reader_.failure() && !limits_.is_over()) {
        update();
        terminal.show(picture(terminal.columns(), terminal.rows()));
        wait(terminal);
      }
    }
    reader_.stop();
    if (const auto failure = reader_.failure()) std::rethrow_exception(failure);
    return exit_code_now();
  }

  int run_once() {
    output out(job_.common->output);
    const auto until =
        clock::now() + (job_.common->duration > 0ns ? job_.common->duration : longest_wait);
    while (!newest_.is_steady() && interrupt() == 0 && clock::now() < until && !reader_.failure() &&
           reader_.state() != reader_state::ended) {
      newest_.wait(std::min(until, clock::now() + 100ms), interrupt_handle());
    }
    update();
    reader_.stop();
    if (const auto failure = reader_.failure()) std::rethrow_exception(failure);
    if (interrupt() != 0) return exit_code_now();
    if (scan_.view().empty()) throw failure(exit_code::lost, "no revolution has come.");
    const canvas shown = picture(job_.columns, job_.rows);
    for (int row = 0; row < shown.rows(); ++row) out.write(shown.text(row) + "\n");
    out.commit();
    return 0;
  }

 private:
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
      facts_.stages = reader_.stages();
    }
    trails_.show(settings_.radar, settings_.wants_map);
    const lidar_counts counts = reader_.reader().counts();
    const auto all = static_cast<double>(counts.stream.points + counts.samples_lost);
    facts_.lost_percent = all > 0 ? 100.0 * static_cast<double>(counts.samples_lost) / all : -1;
    facts_.checksum_errors =
        static_cast<std::int64_t>(counts.stream.skipped(skip_reason::bad_checksum));
    facts_.scans = static_cast<std::int64_t>(counts.scans);
    const reader_status status = reader_.reader().status();
    facts_.name = job_.common->source.empty() ? status.name : job_.common->source;
    facts_.state = name_of(status.state);
    facts_.why = reader_.why();
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
        if (const auto where = reader_.reader().status().playback) {
          reader_.reader().pause(!where->is_paused);
        }
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
  newest_scan newest_{*job_.common, job_.once};
  source_reader reader_;
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
      .arguments = {source_argument(common)},
      .options = joined(
          zoom,
          frame_row("--frame", "What is up: ahead, or 0 degrees (robot)", settings.radar.frame),
          flag_row("--map", "The frame of the map, where the motion is known", settings.wants_map),
          rows_of("Motion of the robot", {"deskew"}, common.deskew), mount_row(common),
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
                   {"g4-dump view --once sim: --glyphs ascii", "One picture as text"}},
      .run = [job] { return view(*job); }};
}

}  // namespace g4_tool
