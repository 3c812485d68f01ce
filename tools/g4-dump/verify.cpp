// SPDX-License-Identifier: MIT
#include "verify.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording_digest.hpp"
#include "g4lidar/recording_reader.hpp"
#include "g4lidar/replay.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "played_points.hpp"
#include "progress.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;

[[noreturn]] void refuse(const std::string& sentences) {
  throw failure(exit_code::bad_file, sentences);
}

/// All bytes both ways, and what the file says of them.
struct bytes_found {
  std::uint64_t digest = 0;
  std::uint64_t count = 0;
  std::optional<g4lidar::recorded_digest> wanted;
  g4lidar::recording_damage damage;
};

bytes_found read_bytes(const std::string& path) {
  auto reader = g4lidar::recording_reader::open(path);
  if (!reader) throw failure(reader.error());
  progress_bar bar(!our_manners().quiet, reader->size());
  g4lidar::payload_digest digest;
  bytes_found found;
  while (interrupt() == 0) {
    const auto got = reader->next();
    if (!got) throw failure(got.error());
    const std::optional<g4lidar::recorded_item>& next = *got;
    if (!next) break;
    const g4lidar::recorded_item& item = *next;
    if (item.what == g4lidar::recorded_item::kind::note) continue;
    const bool is_sent = item.what == g4lidar::recorded_item::kind::to_device;
    digest.add(is_sent ? g4lidar::direction::to_device : g4lidar::direction::from_device,
               item.data);
    found.count += item.data.size();
    bar.show(reader->position());
  }
  found.digest = digest.value();
  found.wanted = reader->digest();
  found.damage = reader->damage();
  return found;
}

/// The points that come of it, as fast as they can.
g4lidar::point_digest play(const std::string& path) {
  auto line = g4lidar::replay::open(path);
  if (!line) throw failure(line.error());
  g4lidar::lidar_options how;
  how.partial_scans = true;
  auto lidar = g4lidar::lidar::open(std::move(*line), how);
  if (!lidar) throw failure(lidar.error());
  auto reader = lidar->points().make_reader();
  g4lidar::point_digest digest;
  std::array<g4lidar::point, 512> memory{};
  const auto take = [&] {
    while (const std::size_t count = reader.read(memory).points) {
      digest.add(std::span(memory).first(count));
    }
  };
  if (const auto started = lidar->start(); !started) throw failure(started.error());
  while (interrupt() == 0) {
    const auto got = lidar->next_scan(50ms);
    take();
    if (got) continue;
    if (got.error().what() == g4lidar::problem::end_of_input) break;
    if (got.error().is_fatal()) throw failure(got.error());
  }
  static_cast<void>(lidar->close());
  take();
  return digest;
}

}  // namespace

void verify(const std::string& path) {
  const std::string title = in_quotes(path);
  const bytes_found found = read_bytes(path);
  if (interrupt() != 0) return;
  if (found.damage.any()) {
    tell(words_about(found.damage));
    refuse(title + " is not whole. What is whole can be played all the same.");
  }
  if (!found.wanted) refuse(title + " does not say what it should hold: it has no digest.");
  const g4lidar::recorded_digest& wanted = *found.wanted;
  if (found.digest != wanted.payload) {
    refuse(
        fmt::format("{} holds other bytes than were recorded: their digest is {:016x}, not "
                    "{:016x}. Do not rely on it.",
                    title, found.digest, wanted.payload));
  }
  tell(fmt::format("{} bytes both ways as recorded: {:016x}\n", found.count, found.digest));
  if (wanted.point_count == 0) return tell("of points it has no digest\n");
  const g4lidar::point_digest points = play(path);
  if (interrupt() != 0) return;
  const bool same_count = points.count() == wanted.point_count;
  if (same_count && !wanted.is_comparable) {
    return tell(
        fmt::format("{} points as recorded; their digest is that of another processor, "
                    "which rounds otherwise\n",
                    points.count()));
  }
  if (!same_count || points.value() != wanted.points) {
    refuse(
        fmt::format("{} gives {} points with the digest {:016x}, and gave {} with {:016x} when "
                    "it was recorded. Its bytes are as they were: was it made by another "
                    "version of g4-dump?",
                    title, points.count(), points.value(), wanted.point_count, wanted.points));
  }
  tell(fmt::format("{} points as recorded: {:016x}\n", points.count(), points.value()));
}

}  // namespace g4_dump
