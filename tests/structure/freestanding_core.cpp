// SPDX-License-Identifier: MIT
// The whole core, instantiated: the external symbols of this translation unit are those of the
// core. clang-tidy also uses it to check the headers of the core.
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <variant>

#include "core/sample_clock.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/core/session.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/plausibility.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/version.hpp"

namespace freestanding {

using namespace g4lidar;

using any_point_ring = point_ring<1024>;
using narrow_point_ring = point_ring<512, std::uint32_t>;

// ---- bytes and packets -----------------------------------------------------------------------
angle add(angle a, angle b) { return -(a + b - angle::from_radians(a.radians())); }
float apart(angle a, angle b) { return a.apart_from(b) + a.forward_to(b) + b.signed_degrees(); }
double wrap(double degrees) { return wrap_deg(degrees); }

wire_check check(bytes data) { return check_packet(data); }
wire_check check_reply(bytes data) { return check_response(data); }
std::optional<packet_view> view_packet(bytes data) { return packet_view::from(data); }
std::optional<response_view> view_reply(bytes data) { return response_view::from(data); }
std::uint32_t load(bytes data) {
  return load_u32(data, 0) + load_u16(data, 0) + static_cast<std::uint32_t>(load_u64(data, 0));
}
void store(std::span<std::uint8_t> data, std::uint16_t value) { store_u16(data, 0, value); }

std::optional<device_information> read_information(response_view reply) {
  return reply.as_device_info();
}
std::optional<health> read_health(response_view reply) { return reply.as_health(); }
std::optional<std::uint8_t> read_byte(response_view reply) { return reply.as_byte(); }
std::optional<std::uint16_t> read_frequency(response_view reply) {
  return reply.as_frequency_chz();
}
std::optional<command_traits> look_up(command code) { return traits_of(code); }
const model* find_model(device_information who) {
  const model* const found = model_with_id(who.model, link_kind::two_way);
  return found != nullptr ? found : model_named({"g4", 2});
}
std::uint16_t shortest(const model& which) { return shortest_range_mm(which, 9000); }
std::array<std::uint8_t, 2> command_bytes(command code) { return encode(code); }
std::optional<sample_rate> read_sample_rate(std::uint8_t value) {
  return reply_byte<sample_rate>(value);
}
std::optional<motor_direction> read_direction(std::uint8_t value) {
  return reply_byte<motor_direction>(value);
}

// ---- stream ----------------------------------------------------------------------------------
front look(bytes data) { return what_stands_at_front(data); }
std::optional<event> pull(stream_parser& parser, bytes& data) { return parser.next(data); }
std::optional<event> end(stream_parser& parser) { return parser.finish(); }
void push(stream_parser& parser, bytes data, stream_counter& counts) {
  parser.feed(data, [&](const event& found) { counts.add(found); });
}
std::uint64_t skipped_for(const stream_counts& counts, skip_reason reason) {
  return counts.skipped(reason) + counts.skipped_bytes() +
         static_cast<std::uint64_t>(name_of(reason)[0]);
}

double correct_exactly(std::uint16_t raw) { return exact_correction{}(raw); }
float correct_compactly(std::uint16_t raw) { return compact_correction{}(raw); }
float correct_by_table(const table_correction& table, std::uint16_t raw) { return table(raw); }
const table_correction& make_table() {
  // Constructed in place, as in static memory of a program: no guard, no destructor.
  static constinit std::array<std::byte, sizeof(table_correction)> memory alignas(
      table_correction){};
  return *::new (memory.data()) table_correction;
}

// ---- points ----------------------------------------------------------------------------------
using room = std::span<point, max_samples>;
decoded decode_exactly(packet_view packet, room out) {
  return decode(packet, exact_correction{}, 0, out);
}
decoded decode_compactly(packet_view packet, room out) {
  return decode(packet, compact_correction{}, 0, out);
}
decoded decode_by_table(packet_view packet, const table_correction& table, room out) {
  return decode(packet, table, 0, out);
}
std::uint32_t count(revolution_counter& counter, packet_view packet) {
  return counter.count(packet);
}
polar turn(const point& p, frame to) { return to_polar(p, to); }
std::span<xy_point> project(std::span<const point> points, std::span<xy_point> out) {
  return to_xy(points, frame::robot, out);
}

// ---- ring, scans, grid -----------------------------------------------------------------------
template <class Ring>
std::uint64_t hand_over(Ring& ring, std::span<const point> in, std::span<point> out) {
  auto reader = ring.make_reader();
  ring.push(in);
  if (!in.empty()) ring.push(in.front());
  const ring_read got = reader.read(out);
  return got.missed + got.points + reader.ahead() + ring.written();
}
std::uint64_t use_ring(any_point_ring& ring, std::span<const point> in, std::span<point> out) {
  return hand_over(ring, in, out);
}
// On a processor with words of 32 bits this is the same ring.
std::uint64_t use_narrow_ring(narrow_point_ring& ring, std::span<const point> in,
                              std::span<point> out) {
  return hand_over(ring, in, out);
}

std::optional<scan> assemble(scan_assembler& assembler, decoded& packet) {
  return assembler.next(packet);
}
std::optional<scan> end(scan_assembler& assembler) {
  assembler.lost();
  return assembler.finish();
}
float measure(const scan& whole) { return whole.measured_frequency_hz(); }
void fill(std::span<const point> points, std::span<float> ranges_m, const grid_options& options) {
  fill_grid(points, ranges_m, options);
}

std::span<point> keep(std::span<point> points, const point_filter& filter) {
  const std::span<point> kept = filter_points(points, filter);
  return filter_for_grid(kept, filter, kept);
}
std::size_t deskew_by_twist(std::span<point> points, const twist_2d& twist, const mounting& mount) {
  return deskew(points, twist, 1, mount).outside;
}
std::size_t deskew_by_path(std::span<point> points, std::span<const stamped_pose> path) {
  return deskew(points, path, 1).outside;
}
merged merge(std::span<const mounted_scan> lidars, const twist_2d& twist, std::span<point> out) {
  return merge_scans(lidars, twist, 1, out);
}
std::size_t mark(std::span<point> points, const speckle_limits& speckle, const edge_limits& edges) {
  return mark_isolated(points, speckle) + mark_veiling(points, edges, scan_ends::open);
}
std::size_t mark_too_near(std::span<point> points, near_history& history) {
  return mark_near(points, history);
}
bool judge(angle_check& check, packet_view packet, std::span<point> points) {
  if (check.fits(packet)) return mark_bit_errors(points) > 0;
  check.lost();
  mark_unlikely(points);
  return true;
}
void count_time(sample_clock& clock, point& p, std::size_t samples) {
  p.time_ns = clock.now_ns();
  clock.tick(samples);
}

packet_times stamp(sensor_clock& clock, const decoded& packet, std::span<point> points,
                   std::int64_t now_ns) {
  clock.seen(packet_header_size, now_ns);
  const packet_times times = clock.stamp(packet, now_ns);
  times.write_to(points);
  return times;
}
double restart(sensor_clock& clock, std::int64_t& bound_ns) {
  clock.lost(90);
  clock.reset();
  clock.reset({4000.0, 0.04});
  bound_ns = clock.bound_ns();
  return clock.sample_rate_hz();
}

// ---- session ---------------------------------------------------------------------------------
std::optional<refusal> ask_device(session& talk, const request& wanted, std::int64_t now_ns) {
  if (wanted.what == request_kind::restart) talk.reset();
  return talk.begin(wanted, now_ns, while_scanning::stop_and_resume);
}
std::optional<outcome> hear(session& talk, const event& found, std::int64_t now_ns) {
  talk.take(found, now_ns);
  return talk.finished();
}
std::optional<std::array<std::uint8_t, 2>> wait(session& talk, std::int64_t& now_ns) {
  now_ns = talk.next_look_ns();
  talk.look(now_ns);
  return talk.to_send();
}
std::uint64_t watch(session& talk, notice& reported) {
  reported = talk.noticed();
  return talk.retries() + (talk.is_busy() ? 1 : 0) + (talk.is_scanning() ? 1 : 0) +
         (talk.protection() ? 1 : 0);
}

int major_version() { return header_version.major_number; }

}  // namespace freestanding
