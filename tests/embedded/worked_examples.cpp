// SPDX-License-Identifier: MIT
// The worked examples of docs/protocol.md, from bytes to numbers.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "check.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"

namespace self_test {
namespace {

using namespace g4lidar;

constexpr std::array<std::uint8_t, 12> zero_packet{0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE,
                                                   0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00};

void test_zero_packet() {
  const bytes data = unknown(bytes(zero_packet));
  check(check_packet(data) == wire_check{wire_state::valid, 12});
  check(packet_checksum(data) == 0x54AB);
  const auto packet = packet_view::from(data);
  if (!check(packet.has_value())) return;
  check(packet->is_zero());
  check(packet->reported_frequency_chz() == 0);
  check(packet->sample_count() == 1);
  check(packet->first_angle_64ths() == 0xAE53 / 2);
  check(packet->sample(0) == 0);

  // Each of its bits matters, except those of the sample and the checksum that no header rules out.
  for (std::size_t bit = 0; bit < 8 * zero_packet.size(); ++bit) {
    std::array<std::uint8_t, 12> damaged = zero_packet;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << bit % 8));
    check(!packet_view::from(unknown(bytes(damaged))).has_value());
  }
}

void test_forty_samples() {
  std::array<std::uint16_t, 40> samples{};
  samples.front() = 4000;
  samples.back() = 32000;
  samples[1] = 0x6FE5;
  const made_packet made(0x86, {0x6FE5 / 2, 0x79BD / 2}, samples);
  const auto packet = packet_view::from(made.data());
  if (!check(packet.has_value())) return;
  check(!packet->is_zero());
  check(packet->reported_frequency_chz() == 0);
  check(packet->first_angle_64ths() * 100000LL == 22378125LL * 64);
  check(packet->last_angle_64ths() * 100000LL == 24346875LL * 64);
  check(packet->span_64ths() * 10000 == 196875 * 64);

  const packet_room& exact = room;
  const packet_room& compact = other_room;
  check(decode(*packet, exact_correction{}, 0, room).points.size() == 40);
  check(decode(*packet, compact_correction{}, 0, other_room).points.size() == 40);
  check(near(exact[0].angle_deg, 217.019064, 1e-5));
  check(near(exact[39].angle_deg, 235.631325, 1e-5));
  check(near(exact[0].angle_deg, 217.0178, 0.0014));  // as printed in the manual
  check(near(exact[39].angle_deg, 235.6326, 0.0014));
  check(near(compact[0].angle_deg, 217.019064, 1e-4));
  check(near(compact[39].angle_deg, 235.631325, 1e-4));
  check(exact[0].range_mm == 1000.0F && exact[39].range_mm == 8000.0F);
  check(exact[1].range_mm == 7161.25F && compact[1].range_mm == 7161.25F);
}

void test_corrections() {
  struct example {
    std::uint16_t raw;
    double correction_deg;
  };
  constexpr std::array<example, 10> examples{{{0, -7.990596267964586},
                                              {3, -7.990596267964586},
                                              {4, 87.35659700425808},
                                              {40, 63.8819410867888},
                                              {621, 0.0025902761421393683},
                                              {1120, -3.5772662504988793},
                                              {4000, -6.762186021592019},
                                              {32000, -7.837425240967011},
                                              {64000, -7.914024984941798},
                                              {65535, -7.915818809882673}}};
  for (const auto& [raw, expected] : examples) {
    check(near(exact_correction{}(unknown(raw)), expected, 1e-9));
    check(near(compact_correction{}(unknown(raw)), expected, 2e-5));
  }
}

void test_frequency() {
  const std::array<std::uint16_t, 1> nothing{};
  const made_packet made(0x8F, {0, 0}, nothing);
  const auto packet = packet_view::from(made.data());
  if (!check(packet.has_value())) return;
  check(packet->is_zero());
  check(packet->reported_frequency_chz() == 710);  // 7.1 Hz
}

template <std::size_t Size>
std::optional<response_view> reply(const std::array<std::uint8_t, Size>& data) {
  return response_view::from(unknown(bytes(data)));
}

void test_replies() {
  constexpr std::array<std::uint8_t, 7> scan{0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
  const auto started = reply(scan);
  check(started && started->kind() == response_kind::scan_started);
  check(started && started->mode() == response_mode::continuous);

  constexpr std::array<std::uint8_t, 27> info_data{
      0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5, 2, 3, 3, 2, 0, 2, 1, 1, 0, 1, 0, 0, 0, 0, 7, 0, 0, 7, 3};
  const auto info_reply = reply(info_data);
  const auto info = info_reply ? info_reply->as_device_info() : std::nullopt;
  check(info && info->model == model_g4);
  check(info && info->firmware_major == 3 && info->firmware_minor == 2 && info->hardware == 3);
  check(info && info->serial_number() == std::string_view("2021101000070073"));
  check(info_reply && info_reply->mode() == response_mode::single);

  constexpr std::array<std::uint8_t, 10> health_data{0xA5, 0x5A, 3, 0, 0, 0, 6, 2, 0x34, 0x12};
  const auto health_reply = reply(health_data);
  const auto state = health_reply ? health_reply->as_health() : std::nullopt;
  check(state == health{health_status::error, 0x1234});

  constexpr std::array<std::uint8_t, 8> byte_data{0xA5, 0x5A, 1, 0, 0, 0, 4, 2};
  const auto byte_reply = reply(byte_data);
  check(byte_reply && byte_reply->as_byte() == 2);
  check(reply_byte<sample_rate>(unknown(std::uint8_t{2})) == sample_rate::khz_9);

  constexpr std::array<std::uint8_t, 11> frequency_data{0xA5, 0x5A, 4, 0,    0, 0,
                                                        4,    0xBC, 2, 0x00, 0};
  const auto frequency_reply = reply(frequency_data);
  check(frequency_reply && frequency_reply->as_frequency_chz() == 700);
}

void test_commands() {
  check(encode(unknown(command::start)) == std::array<std::uint8_t, 2>{0xA5, 0x60});
  const auto toggle = traits_of(unknown(command::protection_toggle));
  check(toggle && toggle->moves_state && toggle->answered_by == g4lidar::reply::byte);
  check(!traits_of(static_cast<command>(unknown(std::uint8_t{0x77}))).has_value());
}

}  // namespace

void test_worked_examples() {
  test_zero_packet();
  test_forty_samples();
  test_corrections();
  test_frequency();
  test_replies();
  test_commands();
}

}  // namespace self_test
