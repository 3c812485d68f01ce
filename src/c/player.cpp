// SPDX-License-Identifier: MIT
// How a file is played, and a lidar that is read in a thread.
#include <g4lidar/c/player.h>

#include <chrono>
#include <memory>
#include <utility>

#include "border.hpp"
#include "g4lidar/background_reader.hpp"
#include "handles.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

static_assert(static_cast<int>(reader_state::running) + 1 == G4LIDAR_RUNNING);
static_assert(static_cast<int>(reader_state::ended) + 1 == G4LIDAR_ENDED);

struct g4lidar_background {
  g4lidar::c::opening from;  // outlives the reader
  background_reader made;
  g4lidar_scan scan{};
  g4lidar_counts counts{};
  g4lidar_playback playback{};
};

namespace {

/// `call(player)` of a lidar that plays a file: a result<void>.
template <class Call>
int with_player(g4lidar_lidar* lidar, g4lidar_error* error, Call call) noexcept {
  return guarded(
      error,
      [&]() -> int {
        player* const played = lidar->made->player();
        if (played == nullptr) return refuse(error, "this lidar plays no file");
        const result<void> done = call(*played);
        return done ? succeed(error) : fail(error, done.error());
      },
      lidar);
}

template <class Call>
int request_of(g4lidar_background* reader, Call call) noexcept {
  return guarded(
      nullptr,
      [&] {
        call(reader->made);
        return G4LIDAR_OK + 0;
      },
      reader);
}

}  // namespace

const g4lidar_playback* g4lidar_get_playback(g4lidar_lidar* lidar) {
  player* const of = lidar == nullptr ? nullptr : lidar->made->player();
  if (of == nullptr) return nullptr;
  lidar->playback = {of->length_ns(), of->position_ns(), of->begin_ns(), of->speed(),
                     of->is_paused()};
  return &lidar->playback;
}

int g4lidar_pause(g4lidar_lidar* lidar, bool pauses, g4lidar_error* error) {
  return with_player(lidar, error, [pauses](player& of) {
    of.pause(pauses);
    return result<void>();
  });
}

int g4lidar_set_speed(g4lidar_lidar* lidar, double speed, g4lidar_error* error) {
  return with_player(lidar, error, [speed](player& of) { return of.set_speed(speed); });
}

int g4lidar_set_loop(g4lidar_lidar* lidar, bool loops, g4lidar_error* error) {
  return with_player(lidar, error, [loops](player& of) {
    of.set_loop(loops);
    return result<void>();
  });
}

int g4lidar_seek(g4lidar_lidar* lidar, int64_t from_ns, g4lidar_error* error) {
  return with_player(lidar, error, [from_ns](player& of) { return of.seek(from_ns); });
}

int g4lidar_background_start(g4lidar_lidar* lidar, bool newest_only, g4lidar_background** reader,
                             g4lidar_error* error) {
  return created(
      reader, error,
      [&]() -> int {
        if (lidar->from.recorder) return refuse(error, "this lidar is recorded");
        if (lidar->from.simulated && lidar->from.simulated->is_virtual()) {
          return refuse(error, "this simulated lidar has virtual time");
        }
        lidar->connector = nullptr;
        auto started =
            background_reader::start(std::move(*lidar->made), {.newest_only = newest_only});
        if (!started) return fail(error, started.error());
        *reader = new g4lidar_background{.from = lidar->from, .made = *std::move(started)};
        return succeed(error);
      },
      lidar);
}

void g4lidar_background_free(g4lidar_background* reader) { delete reader; }

int g4lidar_background_next_scan(g4lidar_background* reader, int timeout_ms,
                                 const g4lidar_scan** scan, g4lidar_error* error) {
  return guarded(
      error,
      [&]() -> int {
        const auto next = reader->made.next_scan(std::chrono::milliseconds(timeout_ms));
        if (!next) return fail(error, next.error());
        fill(reader->scan, *next);
        *scan = &reader->scan;
        return succeed(error);
      },
      reader, scan);
}

int g4lidar_background_get_state(const g4lidar_background* reader) {
  return reader == nullptr ? 0 : static_cast<int>(reader->made.status().state) + 1;
}

int g4lidar_background_next_event(g4lidar_background* reader, g4lidar_event* event) {
  if (reader == nullptr || event == nullptr) return G4LIDAR_BAD_ARGUMENT;
  const auto next = reader->made.next_event();
  if (next) fill(*event, *next);
  return next ? G4LIDAR_OK : G4LIDAR_NOTHING;
}

const g4lidar_counts* g4lidar_background_get_counts(g4lidar_background* reader) {
  if (reader == nullptr) return nullptr;
  fill(reader->counts, reader->made.counts());
  return &reader->counts;
}

const g4lidar_playback* g4lidar_background_get_playback(g4lidar_background* reader) {
  if (reader == nullptr) return nullptr;
  const auto now = reader->made.status().playback;
  if (!now) return nullptr;
  reader->playback = {now->length_ns, now->position_ns, 0, now->speed, now->is_paused};
  return &reader->playback;
}

int g4lidar_background_rest(g4lidar_background* reader, bool rests) {
  return request_of(reader, [rests](background_reader& of) { of.rest(rests); });
}

int g4lidar_background_pause(g4lidar_background* reader, bool pauses) {
  return request_of(reader, [pauses](background_reader& of) { of.pause(pauses); });
}

int g4lidar_background_set_speed(g4lidar_background* reader, double speed, g4lidar_error* error) {
  return guarded(error, [&] { return reader->made.set_speed(speed); }, reader);
}

int g4lidar_background_seek(g4lidar_background* reader, int64_t from_ns) {
  return request_of(reader, [from_ns](background_reader& of) { of.seek(from_ns); });
}
