// SPDX-License-Identifier: MIT
// Recordings: written, played, read.
#include <g4lidar/c/recording.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "border.hpp"
#include "g4lidar/recording/reader.hpp"
#include "handles.hpp"
#include "motion_values.hpp"
#include "ranges.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_reader {
  std::string path;
  reading_options how;
  std::unique_ptr<recording_reader> made;
  std::string event_name;
  g4lidar_item item{};
  g4lidar_recording_info info{};
};

namespace {

constexpr g4lidar_recorder_options recorder_defaults{sizeof(g4lidar_recorder_options),
                                                     nullptr,
                                                     nullptr,
                                                     nullptr,
                                                     nullptr,
                                                     0,
                                                     0,
                                                     0,
                                                     0,
                                                     false,
                                                     false,
                                                     false,
                                                     {},
                                                     G4LIDAR_NO_RETURN_AS_INFINITY,
                                                     0,
                                                     nullptr,
                                                     nullptr};

constexpr g4lidar_reader_options reader_defaults{
    sizeof(g4lidar_reader_options), nullptr, nullptr, {}};

static_assert(static_cast<int>(recorded_item::kind::odometry) + 1 == G4LIDAR_ITEM_ODOMETRY);

/// The options of a LaserScan; false if they cannot be used.
bool take_grid(const g4lidar_recorder_options& given, recording_options& into) {
  g4lidar_grid_options grid = grid_defaults;
  grid.no_return = given.no_return;
  grid.near_is_minus_infinity = given.near_is_minus_infinity;
  const auto taken = grid_of(grid);
  if (taken) into.grid = *taken;
  into.grid.longest_mm = 0.0F;  // that of the model
  if (given.near_options != nullptr) into.near = near_of(given.near_options);
  return taken && (given.near_options == nullptr || into.near.has_value());
}

recording_options options_of(const g4lidar_recorder_options& given) {
  recording_options made;
  made.packed = given.compressed ? packing::zstd : packing::none;
  made.overwrite = given.overwrite;
  made.rotate_bytes = given.rotate_bytes;
  made.rotate_time = std::chrono::seconds(given.rotate_s);
  if (given.chunk_ms != 0) made.chunk_time = std::chrono::milliseconds(given.chunk_ms);
  if (given.topic != nullptr) made.topic = given.topic;
  if (given.frame_id != nullptr) made.frame_id = given.frame_id;
  if (given.points_topic != nullptr) made.points_topic = given.points_topic;
  if (given.mount != nullptr) made.mount = mounting_of(*given.mount);
  if (given.scan_bins != 0) made.scan_bins = given.scan_bins;
  made.scans = !given.without_scans;
  return made;
}

void fill(g4lidar_item& out, const recorded_item& item, std::string& event_name) {
  out.kind = static_cast<std::int32_t>(item.what) + 1;
  out.time_ns = item.time_ns;
  out.wall_ns = item.wall_ns;
  out.data = item.data.data();
  out.size = item.data.size();
  event_name = item.what == recorded_item::kind::other ? name_of(item.other.what) : "";
  out.event_name = event_name.c_str();
  out.odometry = odometry_of(item.odometry);
}

}  // namespace

g4lidar_recording_info g4lidar::c::info_of(const recording_reader& from) noexcept {
  g4lidar_recording_info made{};
  made.first_ns = from.first_ns();
  made.last_ns = from.last_ns();
  made.size = from.size();
  made.position = from.position();
  made.bytes_skipped = from.damage().bytes_skipped;
  made.chunks_lost = from.damage().chunks_lost;
  made.is_cut_off = from.damage().is_cut_off;
  const auto& device = from.device();
  made.has_identity = device.has_value();
  if (device) made.identity = identity_of(device->information);
  made.model = literal(from.model().word);
  return made;
}

void g4lidar_recorder_options_init(g4lidar_recorder_options* options, size_t size) {
  set_defaults(options, size, recorder_defaults);
}

int g4lidar_recorder_create(const char* path, const g4lidar_recorder_options* options,
                            g4lidar_recorder** recorder, g4lidar_error* error) {
  return created(
      recorder, error,
      [&]() -> int {
        g4lidar_recorder_options taken = recorder_defaults;
        if (!take_options(options, taken)) return refuse(error, bad_options);
        if (taken.mount != nullptr && !has_known_members(*taken.mount)) {
          return refuse(error, "mount: its reserved bytes are not 0");
        }
        recording_options how = options_of(taken);
        if (!take_model(taken.model, how.model)) return refuse_model(error, taken.model);
        if (!take_grid(taken, how)) return refuse(error, "no_return or near_options");
        auto made = recording_writer::create(path, how);
        if (!made) return fail(error, made.error());
        auto handle = std::make_unique<g4lidar_recorder>();
        handle->made = std::make_shared<recording_writer>(std::move(*made));
        *recorder = handle.release();
        return succeed(error);
      },
      path);
}

void g4lidar_recorder_free(g4lidar_recorder* recorder) {
  if (recorder != nullptr) static_cast<void>(recorder->made->close());
  delete recorder;
}

int g4lidar_recorder_odometry(g4lidar_recorder* recorder, const g4lidar_odometry* odometry) {
  if (recorder == nullptr || odometry == nullptr || !is_usable(*odometry)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  recorder->made->odometry({odometry->time_ns, pose_of(odometry->pose), twist_of(odometry->twist)});
  return G4LIDAR_OK;
}

int g4lidar_recorder_bytes(g4lidar_recorder* recorder, bool to_device, const uint8_t* data,
                           size_t size, int64_t time_ns) {
  if (recorder == nullptr || (size > 0 && data == nullptr)) return G4LIDAR_BAD_ARGUMENT;
  if (to_device) {
    recorder->made->to_device({data, size}, time_ns);
  } else {
    recorder->made->from_device({data, size}, time_ns);
  }
  return G4LIDAR_OK;
}

int g4lidar_recorder_flush(g4lidar_recorder* recorder, g4lidar_error* error) {
  return guarded(error, [&] { return recorder->made->flush(); }, recorder);
}

int g4lidar_recorder_close(g4lidar_recorder* recorder, g4lidar_error* error) {
  return guarded(error, [&] { return recorder->made->close(); }, recorder);
}

int g4lidar_recorder_take_error(g4lidar_recorder* recorder, g4lidar_error* error) {
  return guarded(
      error,
      [&]() -> int {
        const auto why = recorder->made->take_error();
        if (why) return fail(error, *why);
        succeed(error);
        return G4LIDAR_NOTHING;
      },
      recorder);
}

const g4lidar_recorder_counts* g4lidar_recorder_get_counts(g4lidar_recorder* recorder) {
  if (recorder == nullptr) return nullptr;
  const recording_counts all = recorder->made->counts();
  recorder->counts = {.bytes_from_device = all.bytes_from_device,
                      .bytes_to_device = all.bytes_to_device,
                      .scans = all.scans,
                      .odometry = all.odometry,
                      .files = all.files,
                      .file_bytes = all.file_bytes,
                      .bytes_lost = all.bytes_lost};
  return &recorder->counts;
}

const g4lidar_recording_info* g4lidar_playback_info(g4lidar_lidar* lidar) {
  if (lidar == nullptr || lidar->connector == nullptr) return nullptr;
  const recording_reader* const reader = replay::reader_of(*lidar->connector);
  if (reader == nullptr) return nullptr;
  lidar->info = info_of(*reader);
  return &lidar->info;
}

bool g4lidar_is_recording(const char* path) { return path != nullptr && is_recording(path); }

void g4lidar_reader_options_init(g4lidar_reader_options* options, size_t size) {
  set_defaults(options, size, reader_defaults);
}

int g4lidar_reader_open(const char* path, g4lidar_reader** reader, g4lidar_error* error) {
  return g4lidar_reader_open_with(path, nullptr, reader, error);
}

int g4lidar_reader_open_with(const char* path, const g4lidar_reader_options* options,
                             g4lidar_reader** reader, g4lidar_error* error) {
  return created(
      reader, error,
      [&]() -> int {
        g4lidar_reader_options taken = reader_defaults;
        if (!take_options(options, taken)) return refuse(error, bad_options);
        auto handle = std::make_unique<g4lidar_reader>();
        handle->how.is_cancelled = question_of(taken);
        auto made = recording_reader::open(path, handle->how);
        if (!made) return fail(error, made.error());
        handle->path = path;
        handle->made = std::make_unique<recording_reader>(std::move(*made));
        *reader = handle.release();
        return succeed(error);
      },
      path);
}

void g4lidar_reader_free(g4lidar_reader* reader) { delete reader; }

int g4lidar_reader_next(g4lidar_reader* reader, const g4lidar_item** item, g4lidar_error* error) {
  return guarded(
      error,
      [&]() -> int {
        const auto next = reader->made->next();
        if (!next) return fail(error, next.error());
        if (!*next) {
          return fail(error, g4lidar::error(task::reading, problem::end_of_input, reader->path));
        }
        fill(reader->item, **next, reader->event_name);
        *item = &reader->item;
        return succeed(error);
      },
      reader, item);
}

int g4lidar_reader_seek(g4lidar_reader* reader, int64_t from_ns, g4lidar_error* error) {
  return guarded(
      error,
      [&]() -> int {
        reading_options how = reader->how;
        how.from_ns = from_ns;
        auto made = recording_reader::open(reader->path, how);
        if (!made) return fail(error, made.error());
        *reader->made = std::move(*made);
        return succeed(error);
      },
      reader);
}

const g4lidar_recording_info* g4lidar_reader_info(g4lidar_reader* reader) {
  if (reader == nullptr) return nullptr;
  reader->info = info_of(*reader->made);
  return &reader->info;
}
