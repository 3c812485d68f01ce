// SPDX-License-Identifier: MIT
// The calls of an open lidar.
#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <type_traits>
#include <variant>

#include "border.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/options/option_table.hpp"
#include "handles.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

namespace {

static_assert(static_cast<int>(lidar_event::kind::other_number) + 1 == G4LIDAR_EVENT_OTHER_NUMBER);
static_assert(static_cast<int>(lidar_event::kind::health_warning) + 1 ==
              G4LIDAR_EVENT_HEALTH_WARNING);

static_assert(G4LIDAR_SAMPLE_RATE == 1 && G4LIDAR_SCAN_FREQUENCY == 2 &&
              G4LIDAR_MOTOR_DIRECTION == 3 && G4LIDAR_CONSTANT_FREQUENCY == 4 &&
              G4LIDAR_LOW_POWER == 5 && G4LIDAR_POWER_DOWN_PROTECTION == 6);

/// The row of a setting; null if there is none.
const setting_info* row_of(int setting) noexcept {
  const auto all = all_settings();
  const bool is_known = setting >= 1 && static_cast<std::size_t>(setting) <= all.size();
  return is_known ? &all[static_cast<std::size_t>(setting) - 1] : nullptr;
}

std::optional<request> query_of(int setting) noexcept {
  const setting_info* const row = row_of(setting);
  return row == nullptr ? std::nullopt : row->query;
}

/// The request that sets `wanted`; a value that is none of the setting's becomes one that the session
/// refuses.
std::optional<request> change_of(int setting, std::int32_t wanted) noexcept {
  const setting_info* const row = row_of(setting);
  if (row == nullptr) return std::nullopt;
  const auto value = value_of(*row, wanted);
  if (value) return change_to(*value);
  constexpr std::int32_t none = 0xFFFF;
  const bool is_reported = row->type == setting_type::decimal && wanted >= 0 && wanted < none;
  return request{row->change, static_cast<std::uint16_t>(is_reported ? wanted : none)};
}

std::optional<request> step_of(std::int32_t step_chz) noexcept {
  switch (step_chz) {
    case -100:
      return requests::step(frequency_step::down_1_hz);
    case -10:
      return requests::step(frequency_step::down_0_1_hz);
    case 10:
      return requests::step(frequency_step::up_0_1_hz);
    case 100:
      return requests::step(frequency_step::up_1_hz);
    default:
      return std::nullopt;
  }
}

/// Sends a request; `take` gets the answer, and returns whether it is one of the request.
template <class Take>
int send(g4lidar_lidar* lidar, const std::optional<request>& wanted, int if_scanning,
         g4lidar_error* error, Take take) noexcept {
  return guarded(
      error,
      [&]() -> int {
        if (!wanted) return refuse(error, "there is no such request");
        if (if_scanning != G4LIDAR_REFUSE && if_scanning != G4LIDAR_STOP_AND_RESUME) {
          return refuse(error, "how: a g4lidar_while_scanning");
        }
        const auto given = lidar->made->ask(*wanted, static_cast<while_scanning>(if_scanning));
        if (!given) return fail(error, given.error());
        if (take(*given)) return succeed(error);
        return fail(error, g4lidar::error(task::asking, problem::wrong_answer));
      },
      lidar);
}

int ask_value(g4lidar_lidar* lidar, const std::optional<request>& wanted, int if_scanning,
              std::int32_t* value, g4lidar_error* error) noexcept {
  return send(lidar, wanted, if_scanning, error, [value](const answer& from) {
    const auto got = number_of(from);
    if (got && value != nullptr) *value = *got;
    return got.has_value();
  });
}

using scan_call = view_result<scan> (lidar::*)(lidar::milliseconds);

int take_scan(g4lidar_lidar* lidar, scan_call call, int timeout_ms, const g4lidar_scan** scan,
              g4lidar_error* error) noexcept {
  return guarded(
      error,
      [&]() -> int {
        const auto next = (*lidar->made.*call)(std::chrono::milliseconds(timeout_ms));
        if (!next) return fail(error, next.error());
        if (lidar->from.recorder && !next->is_piece()) lidar->from.recorder->scan(*next);
        fill(lidar->scan, *next);
        *scan = &lidar->scan;
        return succeed(error);
      },
      lidar, scan);
}

}  // namespace

namespace g4lidar::c {

void fill(g4lidar_scan& out, const scan& scan) noexcept {
  out.points = reinterpret_cast<const g4lidar_point*>(scan.data());
  out.point_count = scan.size();
  out.time_ns = scan.time_ns();
  out.end_ns = scan.end_ns();
  out.duration_ns = scan.duration_ns;
  out.revolution = scan.revolution;
  out.flags = static_cast<std::uint32_t>(scan.flags);
  out.suspect_packets = scan.suspect_packets;
  out.suspect_samples = scan.suspect_samples;
  out.sample_rate_hz = scan.sample_rate_hz;
  out.measured_sample_rate_hz = scan.measured_sample_rate_hz();
  out.frequency_hz = scan.measured_frequency_hz();
  out.reported_frequency_hz = static_cast<float>(scan.reported_frequency_chz) / 100.0F;
  out.turned_deg = scan.turned_deg;
  out.is_whole = scan.is_whole();
  out.is_piece = scan.is_piece();
  out.turn_deg = scan.model->turn_deg;
  out.longest_range_mm = scan.model->range.max_mm;
  out.default_bins = default_bins(*scan.model);
  out.model = literal(scan.model->word);
}

void fill(g4lidar_event& out, const lidar_event& event) noexcept {
  const bool is_lost = event.what == lidar_event::kind::lost;
  out = {static_cast<std::int32_t>(event.what) + 1, is_lost ? result_of(event.reason) : 0,
         event.time_ns};
}

void fill(g4lidar_counts& out, const lidar_counts& counts) noexcept {
  const auto skipped = [&](skip_reason why) { return counts.stream.skipped(why); };
  out = {.bytes = counts.bytes,
         .held = counts.held,
         .parsed_bytes = counts.stream.parsed_bytes,
         .skipped_noise = skipped(skip_reason::noise),
         .skipped_bad_header = skipped(skip_reason::bad_header),
         .skipped_bad_checksum = skipped(skip_reason::bad_checksum),
         .skipped_truncated = skipped(skip_reason::truncated),
         .packets = counts.stream.packets,
         .responses = counts.stream.responses,
         .points = counts.stream.points,
         .suspect_packets = counts.stream.suspect,
         .samples_lost = counts.samples_lost,
         .scans = counts.scans,
         .partial_scans = counts.partial_scans,
         .scans_missed = counts.scans_missed,
         .points_missed = counts.points_missed,
         .command_retries = counts.command_retries,
         .reconnects = counts.reconnects,
         .largest_gap_ns = counts.largest_gap_ns,
         .extras = {.time_packets = counts.stream.time_packets,
                    .crc_matches = counts.stream.crc_matches,
                    .crc_mismatches = counts.stream.crc_mismatches,
                    .empty_packets = counts.stream.empty_packets}};
}

}  // namespace g4lidar::c

int g4lidar_start(g4lidar_lidar* lidar, g4lidar_error* error) {
  return guarded(error, [&] { return lidar->made->start(); }, lidar);
}

int g4lidar_stop(g4lidar_lidar* lidar, g4lidar_error* error) {
  return guarded(error, [&] { return lidar->made->stop(); }, lidar);
}

int g4lidar_close(g4lidar_lidar* lidar, g4lidar_error* error) {
  return guarded(error, [&] { return lidar->made->close(); }, lidar);
}

void g4lidar_release(g4lidar_lidar* lidar) {
  if (lidar != nullptr) lidar->made->release();
}

int g4lidar_try_scan(g4lidar_lidar* lidar, int timeout_ms, const g4lidar_scan** scan,
                     g4lidar_error* error) {
  return take_scan(lidar, &lidar::try_scan, timeout_ms, scan, error);
}

int g4lidar_wait_scan(g4lidar_lidar* lidar, int timeout_ms, const g4lidar_scan** scan,
                      g4lidar_error* error) {
  return take_scan(lidar, &lidar::wait_scan, timeout_ms, scan, error);
}

int g4lidar_next_points(g4lidar_lidar* lidar, int timeout_ms, const g4lidar_point** points,
                        size_t* count, g4lidar_error* error) {
  return guarded(
      error,
      [&]() -> int {
        const auto next = lidar->made->next_points(std::chrono::milliseconds(timeout_ms));
        if (!next) return fail(error, next.error());
        *points = reinterpret_cast<const g4lidar_point*>(next->data());
        *count = next->size();
        return succeed(error);
      },
      lidar, points, count);
}

int g4lidar_descriptor(const g4lidar_lidar* lidar) {
  return lidar == nullptr ? -1 : lidar->made->event_loop().native_handle();
}

int64_t g4lidar_deadline_ns(const g4lidar_lidar* lidar) {
  return lidar == nullptr ? std::numeric_limits<std::int64_t>::max()
                          : lidar->made->event_loop().next_deadline_ns();
}

int g4lidar_poll_timeout_ms(const g4lidar_lidar* lidar) {
  const std::int64_t due_ns = g4lidar_deadline_ns(lidar);
  if (due_ns == std::numeric_limits<std::int64_t>::max()) return -1;
  constexpr std::int64_t most_ms = 3'600'000;
  const std::int64_t left_ns = std::max<std::int64_t>(due_ns - g4lidar_now_ns(), 0);
  return static_cast<int>(std::min((left_ns + 999'999) / 1'000'000, most_ms));
}

int g4lidar_process(g4lidar_lidar* lidar, g4lidar_error* error) {
  return guarded(error, [&] { return lidar->made->event_loop().process(); }, lidar);
}

void g4lidar_wake(g4lidar_lidar* lidar) {
  if (lidar != nullptr) lidar->made->wake();
}

int g4lidar_get(g4lidar_lidar* lidar, int setting, int if_scanning, int32_t* value,
                g4lidar_error* error) {
  if (value == nullptr) return refuse(error, "a required argument is NULL");
  return ask_value(lidar, query_of(setting), if_scanning, value, error);
}

int g4lidar_set(g4lidar_lidar* lidar, int setting, int32_t wanted, int if_scanning,
                int32_t* reached, g4lidar_error* error) {
  return ask_value(lidar, change_of(setting, wanted), if_scanning, reached, error);
}

int g4lidar_step_frequency(g4lidar_lidar* lidar, int32_t step_chz, int if_scanning,
                           int32_t* reached, g4lidar_error* error) {
  return ask_value(lidar, step_of(step_chz), if_scanning, reached, error);
}

int g4lidar_restart(g4lidar_lidar* lidar, int if_scanning, g4lidar_error* error) {
  return send(lidar, requests::restart(), if_scanning, error, [](const answer&) { return true; });
}

int g4lidar_get_health(g4lidar_lidar* lidar, int if_scanning, g4lidar_health* health,
                       g4lidar_error* error) {
  if (health == nullptr) return refuse(error, "a required argument is NULL");
  return send(lidar, requests::health(), if_scanning, error, [health](const answer& from) {
    const auto* got = std::get_if<g4lidar::health>(&from);
    if (got != nullptr) *health = {static_cast<std::int32_t>(got->status), got->error_code};
    return got != nullptr;
  });
}

const g4lidar_identity* g4lidar_get_identity(const g4lidar_lidar* lidar) {
  return lidar == nullptr ? nullptr : &lidar->identity;
}

const g4lidar_recognition* g4lidar_get_recognition(g4lidar_lidar* lidar) {
  const int code = guarded(
      nullptr,
      [&] {
        const recognition now = lidar->made->recognition();
        lidar->candidates = model_words(now.candidates);
        lidar->contradictions = contradictions_of(now);
        // NOLINTBEGIN(bugprone-suspicious-stringview-data-usage): of literals, which end with a 0
        lidar->recognised = {.model = now.model->word.data(),
                             .candidates = lidar->candidates.c_str(),
                             .known_by = name_of(now.by).data(),
                             .contradictions = lidar->contradictions.c_str(),
                             .baud = now.baud,
                             .number = now.number,
                             .is_silent = now.is_silent,
                             .was_stopped = now.was_stopped,
                             .reserved = 0};
        // NOLINTEND(bugprone-suspicious-stringview-data-usage)
        return G4LIDAR_OK + 0;
      },
      lidar);
  return code == G4LIDAR_OK ? &lidar->recognised : nullptr;
}

const char* g4lidar_name(g4lidar_lidar* lidar) {
  const int code = guarded(
      nullptr,
      [&] {
        lidar->name = lidar->made->name();
        return G4LIDAR_OK + 0;
      },
      lidar);
  return code == G4LIDAR_OK ? lidar->name.c_str() : nullptr;
}

bool g4lidar_is_scanning(const g4lidar_lidar* lidar) {
  return lidar != nullptr && lidar->made->is_scanning();
}

int g4lidar_next_event(g4lidar_lidar* lidar, g4lidar_event* event) {
  if (lidar == nullptr || event == nullptr) return G4LIDAR_BAD_ARGUMENT;
  const auto next = lidar->made->next_event();
  if (next) fill(*event, *next);
  return next ? G4LIDAR_OK : G4LIDAR_NOTHING;
}

const char* g4lidar_event_name(int kind) {
  if (kind < G4LIDAR_EVENT_LOST || kind > G4LIDAR_EVENT_OTHER_NUMBER) return "unknown";
  return literal(name_of(static_cast<lidar_event::kind>(kind - 1)));
}

const g4lidar_counts* g4lidar_get_counts(g4lidar_lidar* lidar) {
  if (lidar == nullptr) return nullptr;
  fill(lidar->counts, lidar->made->counts());
  return &lidar->counts;
}

int64_t g4lidar_wall_ns(const g4lidar_lidar* lidar, int64_t time_ns) {
  if (lidar == nullptr) return 0;
  if (player* const of = lidar->made->player()) return of->wall_ns(time_ns);
  if (lidar->wall_ahead_ns != 0) return detail::saturating_add(time_ns, lidar->wall_ahead_ns);
  const auto* const from = lidar->connector;
  const auto ahead_ns = from == nullptr ? std::nullopt : from->traits().wall_ahead_ns;
  return detail::saturating_add(time_ns, ahead_ns.value_or(wall_clock().ahead().count()));
}
