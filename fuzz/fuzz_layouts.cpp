// SPDX-License-Identifier: MIT
// Streams of every layout of samples: the parser in pieces, and the points of both decoders against
// the formulas in double precision.
//
// The input: one byte that selects the format, one byte of flags (bit 0: correct the checksum of each
// possible header, which a fuzzer hardly ever does by itself; bits 1 to 7: the size of the pieces,
// minus 1), and then the stream.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "support/decode_as.hpp"
#include "support/family_reference.hpp"

namespace {

using namespace g4lidar;
using reference::wire_format;
using buffer = std::vector<std::uint8_t>;

void expect(bool holds, const char* otherwise) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", otherwise);
  std::abort();
}

unsigned word_at(bytes data, std::size_t at) { return data[at] + 256U * data[at + 1]; }

reference::wire_sample sample_at(const wire_format& how, bytes packet, std::size_t i) {
  const auto size = static_cast<std::size_t>(how.sample_bytes);
  const std::size_t at = 10 + size * i;
  const unsigned before = size == 2 ? 0U : size == 3 ? packet[at] : word_at(packet, at);
  return {before, word_at(packet, at + size - 2)};
}

void seal_packets(const wire_format& how, buffer& stream) {
  for (std::size_t at = 0; at + 12 <= stream.size(); ++at) {
    if (stream[at] != 0xAA || stream[at + 1] != 0x55) continue;
    const auto count = std::size_t{stream[at + 3]};
    const std::size_t size = 10 + static_cast<std::size_t>(how.sample_bytes) * count;
    if (count == 0 || at + size > stream.size()) continue;
    const bytes packet = bytes(stream).subspan(at, size);
    unsigned sum = 0;
    for (std::size_t i = 0; i < 8; i += 2) sum ^= word_at(packet, i);
    for (std::size_t i = 0; i < count; ++i) {
      const reference::wire_sample sample = sample_at(how, packet, i);
      sum ^= sample.before ^ sample.word;
    }
    stream[at + 8] = static_cast<std::uint8_t>(sum % 256);
    stream[at + 9] = static_cast<std::uint8_t>(sum / 256);
  }
}

struct seen_event {
  std::size_t kind;
  std::size_t reason;
  buffer data;

  friend bool operator==(const seen_event&, const seen_event&) = default;
};

/// The events; skipped bytes one by one, as they may be reported in pieces.
std::vector<seen_event> events_of(const buffer& stream, const sample_format& format,
                                  std::size_t piece) {
  std::vector<seen_event> all;
  std::size_t taken = 0;
  const auto take = [&](const event& found) {
    if (const auto* const gone = std::get_if<skipped>(&found)) {
      expect(gone->count > 0 && taken + gone->count <= stream.size(), "skipped what is not there");
      taken += gone->count;
      expect(gone->last == stream[taken - 1], "another last byte");
      all.insert(all.end(), gone->count,
                 {found.index(), static_cast<std::size_t>(gone->reason), {}});
      return;
    }
    const bytes data = std::visit(
        [](const auto& each) {
          if constexpr (requires { each.data(); }) {
            return bytes(each.data());
          } else {
            return bytes();
          }
        },
        found);
    expect(
        std::equal(data.begin(), data.end(), stream.begin() + static_cast<std::ptrdiff_t>(taken)),
        "bytes that were not given");
    taken += data.size();
    all.push_back({found.index(), 0, buffer(data.begin(), data.end())});
  };
  stream_parser parser(format);
  for (std::size_t from = 0; from < stream.size(); from += piece) {
    const std::size_t count = std::min(piece, stream.size() - from);
    parser.feed(bytes(stream).subspan(from, count), take);
    expect(taken + parser.held() == from + count, "the bytes do not add up");
  }
  while (const auto last = parser.finish()) take(*last);
  expect(taken == stream.size(), "bytes are left");
  return all;
}

void check_points(const wire_format& how, bytes packet, std::span<const point> points) {
  const double first = word_at(packet, 4) / 2 / 64.0;
  const double last = word_at(packet, 6) / 2 / 64.0;
  const std::size_t count = packet[3];
  double way = last - first;
  if (way < 0.0 && first > 270.0 && last < 90.0) way += 360.0;
  if (way < 0.0) return expect(points.empty(), "points of a suspect packet");
  expect(points.size() == count, "a wrong number of points");
  for (std::size_t i = 0; i < count; ++i) {
    const double part =
        count == 1 ? 0.0 : way / static_cast<double>(count - 1) * static_cast<double>(i);
    const auto wanted = reference::point_of(how, first + part, sample_at(how, packet, i));
    const point& got = points[i];
    expect(static_cast<double>(got.range_mm) == wanted.range_mm, "a wrong range");
    expect(got.is_no_return() == (wanted.range_mm == 0.0), "a wrong mark of no return");
    expect(got.intensity == wanted.intensity, "a wrong intensity");
    expect(got.sample_flags == wanted.flags, "wrong flags");
    expect(got.angle_deg >= 0.0F && got.angle_deg < 360.0F, "an angle outside [0, 360)");
    expect(reference::apart_deg(static_cast<double>(got.angle_deg), wanted.angle_deg) < 1e-4,
           "an angle that the formula does not give");
  }
}

/// The points of all packets with the template, which are checked.
std::vector<point> points_of(const wire_format& how, const model& which, const buffer& stream) {
  std::vector<point> all;
  stream_parser parser(which.samples);
  const auto take = [&](const event& found) {
    const auto* const packet = std::get_if<packet_view>(&found);
    if (packet == nullptr) return;
    std::array<point, max_samples> memory;
    const decoded result = test::decode_as(*packet, which, memory);
    check_points(how, packet->data(), result.points);
    all.insert(all.end(), result.points.begin(), result.points.end());
  };
  parser.feed(stream, take);
  while (const auto last = parser.finish()) take(*last);
  return all;
}

void check_bulk(const model& which, const buffer& stream, const std::vector<point>& wanted) {
  for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
    bulk_decoder decoder(which, set);
    std::vector<point> out(wanted.size() + 2 * max_samples);
    bytes input(stream);
    std::size_t count = decoder.decode(input, out).size();
    expect(input.empty(), "the decoder stops");
    count += decoder.finish(std::span(out).subspan(count)).size();
    expect(count == wanted.size(), "another number of points");
    expect(decoder.counts().parsed_bytes + decoder.counts().skipped_bytes() == stream.size(),
           "the counts do not add up");
    for (std::size_t i = 0; i < count; ++i) {
      expect(out[i].range_mm == wanted[i].range_mm && out[i].intensity == wanted[i].intensity &&
                 out[i].sample_flags == wanted[i].sample_flags && out[i].flags == wanted[i].flags,
             "another point");
      expect(reference::apart_deg(static_cast<double>(out[i].angle_deg),
                                  static_cast<double>(wanted[i].angle_deg)) < 1e-4,
             "another angle");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 20'000) return 0;
  const wire_format& how = reference::wire_formats[data[0] % reference::wire_formats.size()];
  const model& which = *model_named(how.model);
  buffer stream(data + 2, data + size);
  if ((data[1] & 1U) != 0) seal_packets(how, stream);

  const auto wanted = events_of(stream, which.samples, stream.size() + 1);
  expect(events_of(stream, which.samples, std::size_t{1} + data[1] / 2U) == wanted,
         "other events in pieces");
  expect(events_of(stream, which.samples, 1) == wanted, "other events byte by byte");
  check_bulk(which, stream, points_of(how, which, stream));
  return 0;
}
