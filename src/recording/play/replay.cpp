// SPDX-License-Identifier: MIT
// A recording that is played.
#include "g4lidar/recording/reader.hpp"

#include <cerrno>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "g4lidar/core/stream_parser.hpp"
#include "played_file.hpp"
#include "recording/mcap/file_reader.hpp"

namespace g4lidar {
namespace {

/// What is known at its begin, where the recording was cut off; and the first device information in the bytes.
std::optional<recorded_device> device_in(std::string_view path,
                                         const std::function<bool()>& is_cancelled) {
  constexpr std::uint64_t far_enough = std::uint64_t{64} << 10U;
  auto reader = recording_reader::open(path, {.is_cancelled = is_cancelled});
  if (!reader) return std::nullopt;
  stream_parser parser(reader->model().samples);
  std::optional<device_information> found;
  std::uint64_t read = 0;
  static_cast<void>(reader->for_each([&](const recorded_item& item) {
    read += item.data.size() + 1;
    if (item.what != recorded_item::kind::from_device) return true;
    parser.feed(item.data, [&](const event& what) {
      const auto* const response = std::get_if<response_view>(&what);
      if (response == nullptr || found) return;
      if (const auto who = response->as_device_info()) found = *who;
    });
    return read < far_enough;
  }));
  std::optional<recorded_device> known = reader->device();
  if (found && !known) known.emplace();
  if (found && !known->information.is_known()) known->information = *found;
  return known;
}

class recorded_items final : public item_source {
 public:
  recorded_items(recording_reader opened, std::string_view path, reading_options options)
      : reader_(std::move(opened)), path_(path), how_(std::move(options)) {}

  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept override {
    return reader_.next();
  }
  [[nodiscard]] result<void> seek(std::int64_t from_ns) noexcept override {
    try {
      how_.from_ns = from_ns;
      auto again = recording_reader::open(path_, how_);
      if (!again) return tl::unexpected(again.error());
      reader_ = std::move(*again);
    } catch (const std::bad_alloc&) {
      return failure(task::reading, problem::system, path_, ENOMEM);
    }
    return {};
  }
  [[nodiscard]] std::int64_t first_ns() const noexcept override { return reader_.first_ns(); }
  [[nodiscard]] std::int64_t last_ns() noexcept override { return reader_.last_ns(); }
  [[nodiscard]] const g4lidar::model& model() const noexcept override { return reader_.model(); }
  [[nodiscard]] const g4lidar::model& begun_as() const noexcept override {
    return recording_access::begun_as(reader_);
  }
  [[nodiscard]] const recording_reader* recording() const noexcept override { return &reader_; }

 private:
  recording_reader reader_;
  std::string path_;
  reading_options how_;
};

}  // namespace

result<std::unique_ptr<connector>> replay::open(std::string_view path,
                                                const playback_options& options,
                                                const std::function<bool()>& is_cancelled) {
  if (const auto wrong = problem_with(options)) return tl::unexpected(*wrong);
  auto waits = std::make_shared<waker>(real_system_calls());
  const reading_options range{
      .from_ns = options.from_ns, .to_ns = options.to_ns, .is_cancelled = [waits, is_cancelled] {
        return waits->is_woken() || (is_cancelled && is_cancelled());
      }};
  auto reader = recording_reader::open(path, range);
  if (!reader) return tl::unexpected(reader.error());
  auto device = reader->device();
  const bool is_cut_off = !reader->digest();
  if (is_cut_off || !device || !device->information.is_known()) {
    if (const auto shown = device_in(path, range.is_cancelled)) device = shown;
  }
  auto items = std::make_unique<recorded_items>(std::move(*reader), path, range);
  return connect_to(std::make_shared<played_file>(
      std::move(items), path, options, device.value_or(recorded_device{}), std::move(waits)));
}

}  // namespace g4lidar
