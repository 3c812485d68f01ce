// SPDX-License-Identifier: MIT
// Packets of any content, decoded with all forms of the correction and compared with the formulas
// in double precision; and the counts of points.
//
// The input is a sequence of packets: CT, the number of samples (0 to 79, minus 1), the two angles
// and the samples, two bytes each; missing bytes at the end are 0.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "support/packet_bytes.hpp"
#include "support/reference_points.hpp"

namespace {

using g4lidar::test::buffer;

void expect(bool holds, const char* otherwise) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", otherwise);
  std::abort();
}

/// Takes bytes from the front of the input; zeros at its end.
class source {
 public:
  source(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool done() const { return rest_.empty(); }
  unsigned byte() {
    if (rest_.empty()) return 0;
    const unsigned value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  unsigned word() {
    const unsigned low = byte();
    return low | byte() << 8;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

buffer next_packet(source& in) {
  const unsigned ct = in.byte();
  std::vector<std::uint16_t> samples(1 + in.byte() % 80);
  const unsigned first = g4lidar::test::wire_angle(in.word() % 23040);
  const unsigned last = g4lidar::test::wire_angle(in.word() % 23040);
  for (std::uint16_t& sample : samples) sample = static_cast<std::uint16_t>(in.word());
  return g4lidar::test::packet_bytes(ct, first, last, samples);
}

void check_point(const g4lidar::point& got, const reference::sample& wanted, bool starts,
                 std::uint32_t revolution) {
  expect(got.angle_deg >= 0.0F && got.angle_deg < 360.0F, "an angle outside [0, 360)");
  expect(reference::apart_deg(static_cast<double>(got.angle_deg), wanted.angle_deg) < 1e-4,
         "an angle that the formula does not give");
  expect(static_cast<double>(got.range_mm) == wanted.range_mm,
         "a range that is not that of the sample");
  expect(got.is_no_return() == (wanted.range_mm == 0.0), "a wrong mark of no return");
  expect(got.is_too_near() == (wanted.raw > 3 && wanted.raw < 400), "a wrong mark of too near");
  expect(got.is_revolution_start() == starts, "a wrong mark of a revolution's start");
  expect(got.revolution == revolution, "a wrong revolution");
  expect(got.time_ns == 0, "a time out of nowhere");
}

template <class Form>
void check_decoding(g4lidar::packet_view packet, const Form& form, std::uint32_t revolution) {
  std::array<g4lidar::point, g4lidar::max_samples> out;
  const auto untouched = [] {
    g4lidar::point p;
    p.range_mm = -1.0F;
    return p;
  }();
  out.fill(untouched);
  const g4lidar::decoded result = g4lidar::decode(packet, form, revolution, out);
  const auto wanted = reference::samples_of(packet.data());  // none if it is suspect
  expect(result.suspect == wanted.empty(), "suspect or not?");
  expect(result.points.size() == wanted.size(), "a wrong number of points");
  expect(result.sample_count == packet.sample_count(), "a wrong number of samples");
  expect(result.starts_revolution == ((packet.ct() & 1) != 0), "a zero packet or not?");
  expect(wanted.empty() || result.points.data() == out.data(), "points elsewhere");
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    check_point(result.points[i], wanted[i], i == 0 && result.starts_revolution, revolution);
  }
  for (std::size_t i = wanted.size(); i < out.size(); ++i) {
    expect(out[i] == untouched, "written behind the points");
  }
}

const g4lidar::table_correction& table() {
  static const auto made = std::make_unique<g4lidar::table_correction>();
  return *made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  source in(data, size);
  g4lidar::stream_parser parser;
  g4lidar::revolution_counter revolutions;
  std::uint32_t revolution = 0;
  for (bool first = true; !in.done(); first = false) {
    const buffer packet = next_packet(in);
    g4lidar::bytes input(packet);
    const auto found = parser.next(input);
    expect(found && std::holds_alternative<g4lidar::packet_view>(*found) && input.empty(),
           "a valid packet is not seen");
    const auto view = std::get<g4lidar::packet_view>(*found);
    if ((packet[2] & 1U) != 0 && !first) ++revolution;
    expect(revolutions.count(view) == revolution, "a wrong count of revolutions");
    check_decoding(view, g4lidar::exact_correction{}, revolution);
    check_decoding(view, g4lidar::compact_correction{}, revolution);
    check_decoding(view, table(), revolution);
  }
  return 0;
}
