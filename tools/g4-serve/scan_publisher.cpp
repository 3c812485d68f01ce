// SPDX-License-Identifier: MIT
#include "scan_publisher.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>

#include "cli/logger.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"

namespace g4_tool {
namespace {

constexpr double ns_in_s = 1e9;
// Of a playback.
constexpr double least_speed = 0.01;
constexpr double largest_speed = 100.0;
/// The prefix of all diagnostics.
constexpr std::string_view program_name = "g4lidar: ";

std::int64_t wall_now_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Collects the answers of several lidars about a recording, and passes their errors on when all have answered. Either
/// all of them are recorded or none: if one cannot be, what was begun is discarded.
class common_answer {
 public:
  common_answer(std::size_t count, std::function<void(const std::string&)> done)
      : left_(count), done_(std::move(done)) {}

  void add(served_lidar& from, bool has_begun, const std::string& error) {
    {
      const std::lock_guard lock(mutex_);
      const std::string& name = from.name();
      if (!error.empty()) {
        errors_ += (errors_.empty() ? "" : "; ") + (name.empty() ? "" : name + ": ") + error;
      } else if (has_begun) {
        begun_.push_back(&from);
      }
      if (--left_ > 0) return;
    }
    if (!errors_.empty()) {
      for (served_lidar* const each : begun_) each->discard_recording();
    }
    done_(errors_);
  }

 private:
  std::mutex mutex_;
  std::size_t left_;
  std::string errors_;
  std::vector<served_lidar*> begun_;
  std::function<void(const std::string&)> done_;
};

}  // namespace

scan_publisher::scan_publisher(const serve_options& options,
                               const std::vector<named_source>& lidars, client_registry& to)
    : options_(options), registry_(to), sender_(options, to) {
  if (options.merges) {
    maker_ = make_merged_scans(options, lidars, sender_);
  } else {
    maker_ = std::make_unique<single_scans>(options_of(options, lidars.front()), sender_);
  }
  reports_ = maker_->reports();
  for (const named_source& each : lidars) {
    lidars_.push_back(std::make_unique<served_lidar>(options, each, lidars_.size(), lidars.size(),
                                                     to, static_cast<lidar_listener&>(*this)));
  }
}

void scan_publisher::on_lidar_open(served_lidar& from, g4lidar::lidar& device) {
  maker_->open(from, device);
}

void scan_publisher::on_lidar_scan(served_lidar& from, const g4lidar::scan& scan) {
  maker_->add(from, scan);
}

std::vector<page_lidar> scan_publisher::known() const {
  std::vector<page_lidar> all;
  all.reserve(lidars_.size());
  for (const auto& each : lidars_) all.push_back(each->known());
  return all;
}

void scan_publisher::on_lidar_change(bool sends) {
  const served_lidar& first = *lidars_.front();
  const reader_status now = first.reader().status();
  std::string source = first.options().source.empty() ? now.name : first.options().source;
  if (options_.merges) {
    source.clear();
    for (const auto& each : lidars_) {
      source += (source.empty() ? "" : ", ") + each->name() + '=' + each->options().source;
    }
  }
  registry_.send_hello(
      hello_text({.source = source,
                  .lidars = known(),
                  .allows_set = options_.allows_set,
                  .allows_record = !options_.record_directory.empty() && first.is_live(),
                  .recording_s =
                      now.playback
                          ? std::optional(static_cast<double>(now.playback->length_ns) / ns_in_s)
                          : std::nullopt}),
      sends);
}

void scan_publisher::on_lidar_settings() { registry_.settings(settings_text(known())); }

page_status scan_publisher::tick() {
  std::vector<page_status> all;
  all.reserve(lidars_.size());
  for (const auto& each : lidars_) all.push_back(each->status());
  page_status status = options_.merges ? merged_status(std::move(all)) : std::move(all.front());
  registry_.status(status_text(status));
  if (++ticks_ % 2 == 0 && registry_.wanted().wants(channel::diagnostics))
    publish_diagnostics(status);
  return status;
}

void scan_publisher::publish_diagnostics(const page_status& status) {
  const std::span<const page_status> each_lidar =
      options_.merges ? std::span<const page_status>(status.lidars) : std::span(&status, 1);
  std::vector<diagnostic_status> all;
  std::string serial;
  for (std::size_t i = 0; i < each_lidar.size(); ++i) {
    const page_status& here = each_lidar[i];
    const auto known = lidars_[i]->reader().status().information;
    serial = known ? known->serial_number() : "";
    for (diagnostic_status& made : statuses_of(here.stages, here.counts, serial)) {
      if (!here.lidar.empty()) made.name.insert(program_name.size(), here.lidar + ' ');
      all.push_back(std::move(made));
    }
  }
  for (const auto& report : reports_) {
    all.push_back(report());
    if (!options_.merges) all.back().hardware_id = serial;
  }
  const std::int64_t now_ns = wall_now_ns();
  std::vector<std::uint8_t> message;
  put_diagnostic_array(all, now_ns, message);
  registry_.publish(channel::diagnostics, now_ns, std::move(message));
}

void scan_publisher::set(const set_request& wanted, std::function<void(const std::string&)> done) {
  const auto found = std::ranges::find_if(
      lidars_, [&wanted](const auto& each) { return each->name() == wanted.lidar; });
  if (found == lidars_.end()) return done("there is no lidar " + in_quotes(wanted.lidar));
  (*found)->set(wanted.name + '=' + wanted.value, std::move(done));
}

void scan_publisher::record(const record_request& wanted,
                            std::function<void(const std::string&)> done) {
  if (options_.record_directory.empty()) {
    return lidars_.front()->record(wanted.is_on, std::move(done));
  }
  const auto answer = std::make_shared<common_answer>(lidars_.size(), std::move(done));
  for (const auto& each : lidars_) {
    each->record(wanted.is_on, [answer, &from = *each, begins = wanted.is_on](
                                   const std::string& error) { answer->add(from, begins, error); });
  }
}

void scan_publisher::play(const play_request& wanted) {
  background_reader& reader = lidars_.front()->reader();
  if (wanted.paused) reader.pause(*wanted.paused);
  if (wanted.speed) {
    const double speed = std::clamp(*wanted.speed, least_speed, largest_speed);
    static_cast<void>(reader.set_speed(*wanted.speed > 0 ? speed : 0));
  }
  if (wanted.seek_s) {
    constexpr double longest_s = 1e9;
    reader.seek(static_cast<std::int64_t>(std::clamp(*wanted.seek_s, 0.0, longest_s) * ns_in_s));
  }
}

}  // namespace g4_tool
