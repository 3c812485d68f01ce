// SPDX-License-Identifier: MIT
#include "page_recorder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <new>
#include <span>
#include <system_error>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/transport/transport.hpp"
#include "io/far_times.hpp"
#include "io/output.hpp"
#include "io/source_word.hpp"

namespace g4_tool {
namespace {

/// Less is no recording.
constexpr std::uint64_t least_bytes = std::uint64_t{1} << 20U;
constexpr std::string_view prefix = "g4-";
constexpr std::string_view suffix = ".mcap";
/// Of the recordings of one second.
constexpr int most_of_a_second = 9;

std::string name_now(const std::string& lidar, int number) {
  std::string more = lidar.empty() ? "" : '-' + lidar;
  if (number > 1) more += fmt::format("-{}", number);
  return fmt::format("{}{:%Y%m%dT%H%M%SZ}{}{}", prefix, fmt::gmtime(std::time(nullptr)), more,
                     suffix);
}

/// Without the path, which clients need not know.
std::string reason_of(const g4lidar::error& why, const std::string& name) {
  const int number = why.system_errno();
  if (number == 0) return in_tool_words(why.message());
  return fmt::format("cannot write {}: {}. {}", name, std::generic_category().message(number),
                     advice_on_writing(number));
}

/// Calls `look` after each read, behind what records its bytes.
class watched_transport final : public g4lidar::forwarding_transport {
 public:
  watched_transport(std::unique_ptr<g4lidar::transport> inner, std::function<void()> look)
      : forwarding_transport(std::move(inner)), look_(std::move(look)) {}

  [[nodiscard]] g4lidar::result<g4lidar::received> read(
      std::span<std::uint8_t> into, std::int64_t deadline_ns) noexcept override {
    auto got = inner().read(into, deadline_ns);
    try {
      look_();
    } catch (const std::bad_alloc&) {  // the next read looks again
    }
    return got;
  }

 private:
  std::function<void()> look_;
};

}  // namespace

page_recorder::page_recorder(std::string directory, std::uint64_t most_bytes,
                             const recorded_lidar& lidar)
    : directory_(std::move(directory)), most_bytes_(most_bytes), lidar_(lidar) {
  if (directory_.empty()) return;
  std::error_code why;
  const bool is_directory = std::filesystem::is_directory(directory_, why);
  if (!is_directory && !why) why = std::make_error_code(std::errc::not_a_directory);
  if (is_directory && ::access(directory_.c_str(), R_OK | W_OK | X_OK) != 0)
    why = std::error_code(errno, std::generic_category());
  if (!why) return;
  throw failure(exit_code::usage,
                fmt::format("--allow-record: cannot write to {}: {}. {}", in_quotes(directory_),
                            why.message(), advice_on_writing(why.value())));
}

page_recorder::~page_recorder() { end(); }

std::unique_ptr<g4lidar::connector> page_recorder::observe(
    std::unique_ptr<g4lidar::connector> source) {
  if (!is_allowed()) return source;
  const auto watched = for_each_connection([this](std::unique_ptr<g4lidar::transport> port) {
    return std::make_unique<watched_transport>(std::move(port), [this] { check(); });
  });
  return *watched(switch_.observe(std::move(source)));
}

void page_recorder::opened(g4lidar::lidar& device) {
  if (!is_allowed()) return;
  known_ = {.information = device.information()};
  if (const auto got = device.ask(requests::get_sample_rate())) known_.sample_rate = *got;
  if (const auto got = device.ask(requests::get_scan_frequency())) known_.frequency = *got;
  if (writer_) writer_->device(known_);
}

std::string page_recorder::measure(std::uint64_t& free_bytes) const {
  std::error_code why;
  std::uint64_t bytes = 0;
  std::size_t files = 0;
  for (auto each = std::filesystem::directory_iterator(directory_, why);
       !why && each != std::filesystem::directory_iterator(); each.increment(why)) {
    const std::string name = each->path().filename().string();
    std::error_code unimportant;
    if (!name.starts_with(prefix) || !name.ends_with(suffix) ||
        !each->is_regular_file(unimportant)) {
      continue;
    }
    ++files;
    const auto size = each->file_size(unimportant);
    if (!unimportant) bytes += size;
  }
  if (why) return "cannot read the directory of --allow-record: " + why.message();
  if (files >= most_files) return fmt::format("there are {} recordings: remove some", files);
  if (bytes + least_bytes > most_bytes_) {
    return fmt::format(
        "the recordings have {} MB, and --record-limit allows {} MB: remove some, or raise it",
        bytes >> 20U, most_bytes_ >> 20U);
  }
  free_bytes = (most_bytes_ - bytes) / lidar_.count;
  return {};
}

std::string page_recorder::set(bool is_on) {
  if (!is_allowed()) {
    return "nobody may record here: start g4-serve with --allow-record DIRECTORY";
  }
  if (!is_on) {
    end();
    return {};
  }
  if (writer_) return fmt::format("{} is being recorded already", shown_.file);
  if (!switch_.latest_ns()) return "the lidar is not connected";
  if (model_ == nullptr) return "no scan has come yet";
  return begin();
}

std::string page_recorder::begin() {
  if (std::string why = measure(free_bytes_); !why.empty()) return why;
  for (int number = 1; number <= most_of_a_second; ++number) {
    const std::string name = name_now(lidar_.name, number);
    auto made = g4lidar::recording_writer::create(directory_ + '/' + name, {.model = model_});
    if (!made && made.error().system_errno() == EEXIST) continue;
    if (!made) return reason_of(made.error(), name);
    writer_.emplace(std::move(*made));
    writer_->device(known_);
    static_cast<void>(switch_.on(*writer_));  // set() has looked for the connection
    begin_ns_ = switch_.latest_ns().value_or(0);
    const std::lock_guard lock(mutex_);
    shown_ = {.file = name};
    logger::info(fmt::format("recording {}/{}\n", directory_, name));
    return {};
  }
  return "too many recordings were begun in this second: try again";
}

void page_recorder::add(const g4lidar::scan& found) {
  model_ = found.model;
  if (writer_ && !found.is_piece()) writer_->scan(found);
}

void page_recorder::add(const g4lidar::stamped_odometry& odometry) {
  if (writer_) writer_->odometry(odometry);
}

void page_recorder::check() {
  if (!writer_) return;
  if (const auto why = writer_->take_error()) return end(reason_of(*why, shown_.file));
  const auto counts = writer_->counts();
  if (counts.file_bytes >= free_bytes_) {
    return end(fmt::format("the recordings have the {} MB that --record-limit allows",
                           most_bytes_ >> 20U));
  }
  const std::lock_guard lock(mutex_);
  shown_.bytes = counts.file_bytes;
  if (const auto now_ns = switch_.latest_ns())
    shown_.seconds = static_cast<double>(way_ns(begin_ns_, *now_ns)) * 1e-9;
}

void page_recorder::end(const std::string& why, bool discards) {
  if (!writer_) return;
  switch_.off();
  const auto closed = writer_->close();
  auto failed = writer_->take_error();
  if (!failed && !closed) failed = closed.error();
  const std::uint64_t bytes = writer_->counts().file_bytes;
  if (discards) writer_->discard();
  writer_.reset();
  const std::lock_guard lock(mutex_);
  if (discards) {
    shown_ = {};
    return;
  }
  shown_.last = std::exchange(shown_.file, "");
  shown_.bytes = bytes;
  shown_.why = why.empty() && failed ? reason_of(*failed, shown_.last) : why;
  std::error_code unimportant;
  if (shown_.why.empty() && !std::filesystem::exists(directory_ + '/' + shown_.last, unimportant))
    shown_.why = "it was removed while it was written";
  logger::info(fmt::format("recorded {}/{}: {} bytes{}{}\n", directory_, shown_.last, bytes,
                           shown_.why.empty() ? "" : "; ", shown_.why));
}

std::optional<page_recording> page_recorder::status() const {
  if (!is_allowed()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  return shown_;
}

}  // namespace g4_tool
