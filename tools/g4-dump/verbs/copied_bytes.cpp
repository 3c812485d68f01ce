// SPDX-License-Identifier: MIT
#include "copied_bytes.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/transport.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/source_word.hpp"

namespace g4_tool {
namespace {

void write_bytes(output& out, const std::vector<std::uint8_t>& data) {
  out.write({reinterpret_cast<const char*>(data.data()), data.size()});
}

}  // namespace

std::uint64_t copy_recording(const point_options& options, output& out) {
  const std::string path = path_of_source(options.common->source);
  const std::int64_t from_ns = options.source.playback.from_ns;
  const std::int64_t to_ns = options.source.playback.to_ns;
  const recording_reader about = open_recording(path);
  raw_copy copy(about.model(), about.device().value_or(recorded_device{}).information);
  std::uint64_t count = 0;
  std::vector<std::uint8_t> copied;
  const auto take = [&](const recorded_item& item) {
    const bool is_wanted = from_ns <= 0 || item.time_ns - about.first_ns() >= from_ns;
    copied.clear();
    copy.take(item, is_wanted, copied);
    write_bytes(out, copied);
    if (is_wanted && item.what == recorded_item::kind::from_device) count += item.data.size();
    return !out.is_closed();
  };
  const auto reader =
      read_items(path, {.from_ns = copy.needs_begin() ? 0 : from_ns, .to_ns = to_ns}, take);
  logger::info(
      fmt::format("{} from the lidar\n{}", counted(count, "byte"), describe(reader.damage())));
  return count;
}

std::uint64_t copy_bytes(const point_options& options, output& out) {
  const g4lidar::model* const named = model_of(*options.common);
  const auto from = value_of(open_raw_bytes(path_of_source(options.common->source),
                                            options.source.raw_sample_rate_hz, {}, {}, named));
  const g4lidar::model* const which = named != nullptr ? named : from->traits().recognised.model;
  raw_copy copy(which != nullptr ? *which : g4_model);
  const std::int64_t begin_ns = from->now_ns();
  const auto opened = value_of(from->connect());
  std::array<std::uint8_t, 32'768> memory;
  std::vector<std::uint8_t> copied;
  std::uint64_t count = 0;
  while (interrupt() == 0 && !out.is_closed()) {
    const auto got = opened->read(memory, opened->now_ns() + 50'000'000);
    if (!got && got.error().code() == g4lidar::problem::end_of_input) break;
    if (!got) throw failure(got.error());
    const std::int64_t since_ns = got->arrival_ns - begin_ns;
    if (since_ns >= options.source.playback.to_ns) break;
    copied.clear();
    const bool is_wanted = since_ns >= options.source.playback.from_ns;
    if (is_wanted) count += got->count;
    copy.received(g4lidar::bytes(memory).first(got->count), is_wanted, copied);
    write_bytes(out, copied);
  }
  return count;
}

}  // namespace g4_tool
