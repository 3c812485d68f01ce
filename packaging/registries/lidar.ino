// SPDX-License-Identifier: MIT
// Prints the nearest return of each revolution of an @NAME@, which is connected to Serial1. Its motor takes up to 1 A when
// it starts: not from a pin of the board.
#include <g4lidar_core.h>

#include <array>

constexpr const g4lidar::model& lidar = *g4lidar::model_named("@MODEL@");
constexpr bool takes_commands = lidar.link == g4lidar::link_kind::two_way;

constexpr bool has_correction = lidar.samples.correction != g4lidar::correction_kind::none;
constexpr std::conditional_t<has_correction, g4lidar::compact_correction, g4lidar::no_correction> correction;

g4lidar::stream_parser parser{lidar.samples};
g4lidar::session commands{g4lidar::session_times(), lidar};
g4lidar::revolution_counter revolutions;
std::array<g4lidar::point, g4lidar::max_samples> room;
float nearest_mm = 0.0F;
float nearest_deg = 0.0F;

// millis() begins again after 49 days; this does not.
std::int64_t now_ns() {
  static std::int64_t sum_ms = 0;
  sum_ms += static_cast<std::uint32_t>(millis() - static_cast<std::uint32_t>(sum_ms));
  return sum_ms * 1000000;
}

void use(g4lidar::packet_view packet) {
  const auto found =
      g4lidar::decode<lidar.samples.layout>(packet, correction, revolutions.count(packet), room);
  if (found.starts_revolution && nearest_mm > 0.0F) {
    Serial.print(nearest_mm);
    Serial.print(" mm, degrees: ");
    Serial.println(nearest_deg);
    nearest_mm = 0.0F;
  }
  for (const g4lidar::point& p : found.points) {
    if (p.is_no_return() || p.is_too_near()) continue;  // no return is not free space
    if (nearest_mm > 0.0F && p.range_mm >= nearest_mm) continue;
    nearest_mm = p.range_mm;
    nearest_deg = p.angle_deg;
  }
}

void take(const g4lidar::event& found, std::int64_t now) {
  if (takes_commands) commands.take(found, now);
  if (const auto* packet = std::get_if<g4lidar::packet_view>(&found)) use(*packet);
}

// Commands and deadlines; a start without success is repeated.
void talk(std::int64_t now, bool has_heard) {
  static std::int64_t heard_ns = 0;
  if (has_heard) heard_ns = now;
  if (!has_heard && commands.is_busy() && now - heard_ns >= 20000000) {
    while (const auto found = parser.finish()) take(*found, now);  // a packet that was cut off
  }
  if (commands.next_look_ns() <= now) commands.look(now);
  if (const auto outcome = commands.finished()) {
    if (outcome->how != g4lidar::verdict::answered) (void)commands.begin(g4lidar::requests::start(), now);
  }
  while (const auto command = commands.to_send()) Serial1.write(command->data(), command->size());
}

void setup() {
  Serial.begin(115200);
  Serial1.begin(lidar.bauds[0]);
  if (takes_commands) (void)commands.begin(g4lidar::requests::start(), now_ns());
}

void loop() {
  std::array<std::uint8_t, 64> piece;
  std::size_t count = 0;
  while (count < piece.size() && Serial1.available() > 0) {
    piece[count++] = static_cast<std::uint8_t>(Serial1.read());
  }
  const std::int64_t now = now_ns();
  g4lidar::bytes input(piece.data(), count);
  while (const auto found = parser.next(input)) take(*found, now);
  if (takes_commands) talk(now, count > 0);
}
