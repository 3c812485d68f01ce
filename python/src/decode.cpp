// SPDX-License-Identifier: MIT
// Raw bytes to arrays of points, in bulk.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "errors.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "gil.hpp"
#include "kept_scan.hpp"
#include "setting_keywords.hpp"

namespace g4lidar::python {

void bind_decode(nb::module_& module);

namespace {

using namespace nb::literals;

bulk_decoder decoder_for(const std::optional<std::string>& model,
                         std::optional<double> zero_angle) {
  const g4lidar::model& which = model_or_g4(model);
  bulk_decoder made(which);
  if (zero_angle)
    made.zero().set(zero_angle_from(*zero_angle, &which), zero_offset::stated_by::user);
  return made;
}

/// Python's class Decoder.
class decoder {
 public:
  /// The decoder, while this exists: it is used without the GIL, by one call at a time.
  class use {
   public:
    explicit use(decoder& of) : of_(of) {
      if (std::exchange(of.is_busy_, true)) {
        PyErr_SetString(PyExc_RuntimeError,
                        "another thread is decoding with this Decoder: use one for each thread");
        throw nb::python_error();
      }
    }
    use(const use&) = delete;
    use& operator=(const use&) = delete;
    ~use() { of_.is_busy_ = false; }
    bulk_decoder* operator->() const noexcept { return &of_.made_; }

   private:
    decoder& of_;
  };

  decoder(const std::optional<std::string>& model, std::optional<double> zero_angle)
      : made_(decoder_for(model, zero_angle)) {}

 private:
  bulk_decoder made_;
  bool is_busy_ = false;  // guarded by the GIL
};

/// Room for the points of so many bytes, of which `held` are in the decoder: a sample has two bytes.
std::size_t room_for(std::size_t bytes_given, std::size_t held) {
  return (bytes_given + held) / 2 + max_samples;
}

/// The room for no bytes, with the longest beginning of a packet in the decoder.
constexpr std::size_t spare_points = max_samples + max_packet_size / 2;

/// Without the GIL for long data: the memory of both arrays is held by their buffers.
array<point> decode(decoder& with, nb::handle data, const std::optional<array<point>>& out) {
  const decoder::use used(with);
  const buffer from(data);
  bytes input = from.read();
  const auto run = [&](std::span<point> to) {
    const without_gil free;
    return used->decode(input, to).size();
  };
  if (!out) return make_array<point>(room_for(input.size(), used->held()), run);
  const nb::object target = contiguous(out->object, element::point);
  if (!target.is(out->object)) {
    throw nb::value_error("out is not contiguous, or its address is no multiple of 8");
  }
  std::size_t count = 0;
  {
    const buffer memory(target, true);
    if (memory.as<point>().size() < input.size() / 2 + spare_points) {
      throw nb::value_error(
          "out is too short: it needs half as many points as there are bytes, and 165 more");
    }
    count = run(memory.as<point>());
  }
  return {target[nb::slice(nb::int_(0), nb::int_(count), nb::int_(1))]};
}

array<point> finish(decoder& with) {
  const decoder::use used(with);
  return make_array<point>(room_for(0, used->held()),
                           [&](std::span<point> out) { return used->finish(out).size(); });
}

nb::dict counts(decoder& with) {
  const decoder::use used(with);
  nb::dict all;
  const stream_counts& now = used->counts();
  all["parsed_bytes"] = now.parsed_bytes;
  all["held"] = used->held();
  all["packets"] = now.packets;
  all["responses"] = now.responses;
  all["points"] = now.points;
  all["suspect_packets"] = now.suspect;
  all["time_packets"] = now.time_packets;
  all["empty_packets"] = now.empty_packets;
  all["crc_matches"] = now.crc_matches;
  all["crc_mismatches"] = now.crc_mismatches;
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    const std::string name = std::string("skipped_") + name_of(static_cast<skip_reason>(i));
    all[nb::str(name.c_str())] = now.skipped_by_reason[i];
  }
  return all;
}

}  // namespace

void bind_decode(nb::module_& module) {
  nb::class_<decoder>(
      module, "Decoder",
      "Bytes of a lidar to points, at the full speed of the processor. Keeps the beginning of an "
      "unfinished packet for "
      "the next call. One thread at a time: else RuntimeError is raised. Times are 0: a recording "
      "has them, see open().")
      .def(nb::init<std::optional<std::string>, std::optional<double>>(), "model"_a = nb::none(),
           "zero_angle"_a = nb::none(),
           "For the bytes of this model: 'x4'; None: a G4. `zero_angle`: as of open().")
      .def_prop_ro(
          "zero_angle",
          [](decoder& with) -> std::optional<double> {
            const decoder::use used(with);
            const auto& known = used->zero().angle();
            return known ? std::optional(known->deg()) : std::nullopt;
          },
          "What is added to each angle, in degrees: as given, or as the bytes state it. None: not "
          "known; then the angles are those of the device.")
      .def("decode", &decode, "data"_a, "out"_a = nb::none(),
           nb::sig("def decode(self, data: bytes | bytearray | memoryview | "
                   "numpy.typing.NDArray[numpy.uint8], out: numpy.typing.NDArray[numpy.void] | "
                   "None = None) "
                   "-> numpy.typing.NDArray[numpy.void]"),
           "The points of these bytes, as Scan.points; without the GIL. With `out`, an array of at "
           "least len(data) / 2 + "
           "165 points, they are written to its front, and the result is a view of it: this saves "
           "new memory for each "
           "call.")
      .def("finish", &finish,
           "The points of the valid packets among the held bytes: call it when no more bytes "
           "follow.")
      .def("counts", &counts, nb::sig("def counts(self) -> dict[str, int]"),
           "Counts of everything found so far: 'packets', 'points', 'skipped_bad_checksum', ... "
           "Bytes given = "
           "'parsed_bytes' + all 'skipped_...' + 'held'.");
  module.def(
      "decode",
      [](nb::handle data, const std::optional<std::string>& model,
         std::optional<double> zero_angle) {
        const buffer from(data);
        bulk_decoder decoder = decoder_for(model, zero_angle);
        return make_array<point>(room_for(from.read().size(), 0), [&](std::span<point> out) {
          const without_gil free;
          bytes input = from.read();
          const std::size_t count = decoder.decode(input, out).size();
          return count + decoder.finish(out.subspan(count)).size();
        });
      },
      "data"_a, "model"_a = nb::none(), "zero_angle"_a = nb::none(),
      nb::sig("def decode(data: bytes | bytearray | memoryview | "
              "numpy.typing.NDArray[numpy.uint8], model: str | None = None, "
              "zero_angle: float | None = None) "
              "-> numpy.typing.NDArray[numpy.void]"),
      "The points of all packets in these bytes, as Scan.points, with times 0. `model` and "
      "`zero_angle` as "
      "for Decoder. The memory of the "
      "result is reserved for as "
      "many points as the bytes can contain; copy() gives it back.");
}

}  // namespace g4lidar::python
