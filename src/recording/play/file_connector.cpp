// SPDX-License-Identifier: MIT
// The transport and the connector of a file that is played.
#include <cerrno>
#include <cstddef>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "g4lidar/recording/reader.hpp"
#include "played_file.hpp"

namespace g4lidar {
namespace {

class file_transport final : public transport {
 public:
  explicit file_transport(std::shared_ptr<played_file> of) noexcept : of_(std::move(of)) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    return of_->read(out, deadline_ns);
  }
  /// No device receives it.
  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override {
    if (of_->take_wake()) return failure(task::writing, problem::cancelled, name());
    return {};
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return of_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return of_->items().path(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return of_->baud(); }

 private:
  std::shared_ptr<played_file> of_;
};

}  // namespace

std::vector<const model*> candidates_of(const recorded_device& device) {
  std::vector<const model*> all;
  if (device.read_as() == nullptr || device.candidates.none()) return all;
  all.push_back(device.read_as());
  for (std::size_t at = 0; at < models.size(); ++at) {
    if (device.candidates[at] && &models[at] != all.front()) all.push_back(&models[at]);
  }
  return all;
}

namespace {

class file_connector final : public connector, public recording_hook {
 public:
  explicit file_connector(std::shared_ptr<played_file> of)
      : of_(std::move(of)), candidates_(candidates_of(of_->device())) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (!of_->take_connection()) {
      return failure(task::reading, problem::end_of_input, of_->items().path());
    }
    auto* const made = new (std::nothrow) file_transport(of_);
    if (made == nullptr)
      return failure(task::opening, problem::system, of_->items().path(), ENOMEM);
    return std::unique_ptr<transport>(made);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns).has_value();
  }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] recorded_event_source* events() noexcept override {
    return of_->items().source().recording() == nullptr ? nullptr : of_.get();
  }
  [[nodiscard]] connector_traits traits() const noexcept override {
    const bool is_counted = of_->items().source().recording() == nullptr && of_->clock().is_free();
    return {.answers = false,
            .counts_time = is_counted,
            .wall_ahead_ns = of_->wall_ahead_ns(),
            .recognised = read_as(),
            .begun_as = begun_as()};
  }
  [[nodiscard]] played_file* file() const noexcept { return of_.get(); }

 private:
  /// What contradicted the model when it was recorded, or was not known then, is the same now.
  [[nodiscard]] recognition read_as() const noexcept {
    const item_source& source = of_->items().source();
    recognition known = of_->device().recognised.value_or(recognition{.by = known_by::recording});
    const bool is_guessed = known.by == known_by::samples || known.by == known_by::nothing;
    if (known.model == nullptr) known.model = &source.model();
    if (source.recording() != nullptr && !is_guessed) known.by = known_by::recording;
    known.candidates = candidates_;
    return known;
  }

  [[nodiscard]] const model* begun_as() const noexcept {
    const model& first = of_->items().source().begun_as();
    return *read_as().model != first ? &first : nullptr;
  }

  std::shared_ptr<played_file> of_;
  std::vector<const model*> candidates_;
};

}  // namespace

result<std::unique_ptr<connector>> connect_to(std::shared_ptr<played_file> file) {
  if (!file->is_open()) return failure(task::opening, problem::system, "timerfd", errno);
  return std::make_unique<file_connector>(std::move(file));
}

played_file* file_of(connector& from) noexcept {
  for (connector* each = &from; each != nullptr; each = each->wrapped()) {
    if (auto* const found = dynamic_cast<file_connector*>(each)) return found->file();
  }
  return nullptr;
}
const recording_reader* replay::reader_of(connector& from) noexcept {
  const played_file* const played = file_of(from);
  return played == nullptr ? nullptr : played->items().source().recording();
}

}  // namespace g4lidar
