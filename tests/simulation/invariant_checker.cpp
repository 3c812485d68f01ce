// SPDX-License-Identifier: MIT
#include "invariant_checker.hpp"

#include <algorithm>
#include <cstdlib>

#include "text.hpp"

namespace g4lidar::simulation {
namespace {

/// More than the ring and a scan hold together.
constexpr std::size_t longest_history = 50'000;
/// Where the sensor clock has restarted, times that must grow may be ahead by a packet at a quarter of
/// the distance of its samples, and a little more: 2.5 ms at 9 kHz, 5.5 ms at 4 kHz.
std::int64_t healthy_ahead_ns(sample_rate rate) {
  return static_cast<std::int64_t>(1.1 * max_samples / 4.0 * 1e9 / to_hz(rate));
}
/// More where it restarts within what has gathered while the program slept.
constexpr std::int64_t most_ahead_ns = 500 * ms;
/// What the application reads later than that it has slept over.
constexpr std::int64_t longest_batch_ns = 200 * ms;

}  // namespace

void invariant_checker::begin(lidar& opened) {
  lidar_ = &opened;
  reader_ = opened.points().make_reader();
  last_ = {};
  read_ = missed_ = 0;
  last_time_ns_ = -second;  // what is measured before a port is opened has a time before 0
  history_.clear();
  is_broken_ = true;
  is_breaking_ = false;
}

void invariant_checker::end() {
  if (lidar_ == nullptr) return;
  look();
  settle(true);
  scans_before_ += last_.scans;
  last_ = {};
  lidar_ = nullptr;
  reader_.reset();
}

void invariant_checker::fail(const std::string& what) {
  if (failure_.empty()) failure_ = what;
}

void invariant_checker::look() {
  take_truth();
  if (lidar_ != nullptr) {
    take_points();
    check_counts();
  }
  check_calls();
}

void invariant_checker::take_truth() {
  while (const std::size_t count = environment_->device.take_truth(samples_)) {
    matcher_.add(std::span(samples_).first(count));
  }
  if (environment_->device.truth_missed() > 0) fail("this test was too slow to take the truth");
}

void invariant_checker::take_points() {
  while (true) {
    const ring_read read = reader_->read(points_);
    missed_ += read.missed;
    read_ += read.points;
    if (read.missed > 0) {  // more came in one reading than the ring holds
      is_broken_ = true;
      history_.clear();
      matcher_.cut();
    }
    if (read.points == 0) break;
    matcher_.add(std::span<const point>(points_).first(read.points));
    settle(false);
  }
  if (!matcher_.problem().empty()) fail(matcher_.problem());
}

void invariant_checker::settle(bool all) {
  for (const known_point& found : matcher_.settle(all)) check(found);
}

void invariant_checker::check(const known_point& found) {
  if (found.seen.time_ns <= last_time_ns_) fail("the times of points do not grow");
  last_time_ns_ = found.seen.time_ns;
  const std::int64_t ahead_ns = found.seen.time_ns - environment_->clock.now_ns();
  times_.ahead += ahead_ns > 0;
  const sample_rate rate = environment_->device.settings().sample_rate;
  if (ahead_ns > (parameters_->healthy ? healthy_ahead_ns(rate) : most_ahead_ns)) {
    fail(text_of("a point is %.6f s in the future", in_seconds(ahead_ns)));
  }
  history_.push_back(found);
  if (history_.size() > longest_history) history_.pop_front();

  const std::uint64_t passed_over = matcher_.counts().passed_over;
  if (passed_over != passed_over_ && !is_broken_ && parameters_->healthy) {
    fail("undamaged packets of a healthy device were not delivered");
  }
  passed_over_ = passed_over;
  if (found.index < 0) return;
  const bool is_struck =
      std::any_of(parameters_->faults.begin(), parameters_->faults.end(), [&](const sim::fault& f) {
        return found.time_ns >= f.begin_ns - second &&
               found.time_ns <= f.begin_ns + f.duration_ns + second;
      });
  const bool slept = environment_->clock.now_ns() - found.time_ns > longest_batch_ns;
  const bool goes_on = !is_broken_ && !is_struck && !slept && found.index == last_index_ + 1;
  if (!goes_on) steady_since_ns_ = found.time_ns;
  is_broken_ = is_breaking_ || (is_broken_ && found.time_ns < broke_ns_);
  last_index_ = found.index;
  check_time(found);
}

void invariant_checker::check_time(const known_point& found) {
  if (found.time_ns - steady_since_ns_ < 5 * second) return;
  if (parameters_->healthy && (found.seen.flags & point_flags::unlikely) != point_flags::none) {
    fail("a point of a healthy device is flagged unlikely");
  }
  const std::int64_t off_ns = std::abs(found.seen.time_ns - found.time_ns);
  ++times_.settled;
  times_.late += off_ns > ms;
  times_.sum_of_squares += static_cast<double>(off_ns) * static_cast<double>(off_ns);
  times_.worst_ns = std::max(times_.worst_ns, off_ns);
}

void invariant_checker::check_counts() {
  const lidar_counts now = lidar_->counts();
  if (now.bytes != now.stream.parsed_bytes + now.stream.skipped_bytes() + now.held) {
    fail("bytes are not those of packets and responses, skipped and held");
  }
  const auto fell = [&](auto member) { return now.*member < last_.*member; };
  bool falls = fell(&lidar_counts::bytes) || fell(&lidar_counts::samples_lost) ||
               fell(&lidar_counts::scans) || fell(&lidar_counts::partial_scans) ||
               fell(&lidar_counts::scans_missed) || fell(&lidar_counts::points_missed) ||
               fell(&lidar_counts::command_retries) || fell(&lidar_counts::reconnects) ||
               fell(&lidar_counts::largest_gap_ns);
  falls = falls || now.stream.parsed_bytes < last_.stream.parsed_bytes ||
          now.stream.packets < last_.stream.packets ||
          now.stream.responses < last_.stream.responses ||
          now.stream.points < last_.stream.points || now.stream.suspect < last_.stream.suspect;
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    falls = falls || now.stream.skipped_by_reason[i] < last_.stream.skipped_by_reason[i];
  }
  if (falls) fail("a counter has fallen");
  if (read_ + missed_ != lidar_->points().written()) fail("points were written and not read");
  if (lidar_->points().written() != now.stream.points) fail("points that are only counted");
  if (now.scans_missed > now.scans + now.partial_scans) fail("more scans missed than there were");
  if (parameters_->healthy && now.samples_lost > 0) {
    fail(text_of("%llu samples were lost without a fault",
                 static_cast<unsigned long long>(now.samples_lost)));
  }
  if (parameters_->healthy && now.stream.suspect > 0) fail("a suspect packet without a fault");
  if (parameters_->healthy && now.stream.crc_mismatches > 0) fail("a CRC misfits without a fault");
  last_ = now;
}

/// Calls without an effect are rare.
void invariant_checker::check_calls() {
  const std::int64_t now_ns = environment_->clock.now_ns();
  const transport_calls& now = environment_->calls;
  const std::uint64_t idle =
      now.empty + now.pauses + now.connects + now.writes -
      (calls_then_.empty + calls_then_.pauses + calls_then_.connects + calls_then_.writes);
  const std::uint64_t of_use = now.reads - calls_then_.reads + app_calls_ - app_calls_then_;
  const auto batch_ns = std::chrono::nanoseconds(parameters_->options.tuning.batch).count();
  const auto for_batches = static_cast<std::uint64_t>(batch_ns == 0 ? 0 : second / batch_ns);
  const auto attempts =
      static_cast<std::uint64_t>(1000 / parameters_->options.tuning.longest_backoff.count());
  if (idle > 300 + 3 * of_use + 2 * for_batches + 2 * attempts) {
    fail("spins: " + std::to_string(idle) + " calls without effect in a second, and " +
         std::to_string(of_use) + " of use");
  }
  if (now_ns - second_began_ns_ < second) return;
  second_began_ns_ = now_ns;
  calls_then_ = now;
  app_calls_then_ = app_calls_;
}

void invariant_checker::check_stretch(std::span<const point> points, const char* whose) {
  if (points.empty() || history_.empty()) return;
  if (points.front().time_ns < history_.front().seen.time_ns) return;  // forgotten
  const auto earlier = [](const known_point& known, std::int64_t time_ns) {
    return known.seen.time_ns < time_ns;
  };
  auto at = std::lower_bound(history_.begin(), history_.end(), points.front().time_ns, earlier);
  for (const point& p : points) {
    if (at == history_.end()) return;  // not settled yet
    if (at->seen != p) return fail(std::string(whose) + " gives a point that the ring did not");
    ++at;
  }
}

void invariant_checker::check_scan(const scan& found) {
  if (found.points.empty()) return;
  for (const point& p : found.points) {
    if (p.revolution != found.revolution) fail("a scan with points of another revolution");
  }
  check_stretch(found.points, "try_scan()");
  if (!found.is_whole() || history_.empty()) return;
  if (!found.points.front().is_revolution_start()) fail("a whole scan begins somewhere");
  const auto earlier = [](const known_point& known, std::int64_t time_ns) {
    return known.seen.time_ns < time_ns;
  };
  const auto first =
      std::lower_bound(history_.begin(), history_.end(), found.points.front().time_ns, earlier);
  const auto last = std::lower_bound(first, history_.end(), found.points.back().time_ns, earlier);
  if (first == history_.end() || last == history_.end() || first->index < 0 || last->index < 0)
    return;
  if (first->seen != found.points.front()) return;
  holes_ += last->index - first->index + 1 != static_cast<std::int64_t>(found.points.size());
}

void invariant_checker::check_recognition() {
  if (lidar_ == nullptr) return;
  const sim::device_options& device = parameters_->device;
  const recognition known = lidar_->recognition();
  if (known.model->word != device.model) fail("read as " + std::string(known.model->word));
  if (device.one_way) return;
  if (known.number != device.info.model) fail("the number is not known");
  const bool is_reported = contradictions_of(known).find("reports the number") != std::string::npos;
  if (is_reported != has_other_number(*parameters_)) fail("the number is reported wrongly");
}

/// `taken` points were read by next_points(); `all`: no more are there.
void invariant_checker::check_taken(std::uint64_t taken, bool all) {
  const std::uint64_t known = taken + lidar_->counts().points_missed;
  const std::uint64_t written = lidar_->points().written();
  if (known > written || (all && known != written)) {
    fail("points read and missed are not those written");
  }
}

}  // namespace g4lidar::simulation
