// SPDX-License-Identifier: MIT
// Lines and connectors that are recorded.
#include <cerrno>
#include <new>
#include <utility>

#include "file_writer.hpp"

namespace g4lidar {
namespace {

/// A line, and where what goes over it is kept.
template <class Writer>
class recorded_transport final : public transport {
 public:
  recorded_transport(std::unique_ptr<transport> line, Writer& into) noexcept
      : line_(std::move(line)), into_(&into) {
    follow_wall_clock();
    if (const recorded_device* const known = line_->recorded()) {
      into_->device(*known);
      return;
    }
    line_note opened{.what = line_note::kind::opened, .time_ns = line_->now_ns()};
    opened.baud = line_->baud();
    opened.line = line_->name();
    into_->note(opened);
  }
  ~recorded_transport() override {
    if (line_->recorded() != nullptr) return;  // it tells by itself
    into_->note({.what = line_note::kind::closed, .reason = reason_, .time_ns = line_->now_ns()});
  }

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    auto got = line_->read(out, deadline_ns);
    if (!got) {
      remember(got.error());
    } else if (got->count > 0) {
      follow_wall_clock();
      into_->line_bytes(direction::from_device, bytes(out).first(got->count), got->arrival_ns);
    }
    return got;
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const std::int64_t begun_ns = line_->now_ns();
    auto sent = line_->write(data, deadline_ns);
    if (!sent) {
      remember(sent.error());
    } else if (line_->answers()) {
      into_->line_bytes(direction::to_device, data, begun_ns);
    }
    return sent;
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    auto paused = line_->pause(deadline_ns);
    if (!paused) remember(paused.error());
    return paused;
  }
  void note(const line_note& what) noexcept override {
    line_->note(what);
    into_->note(what);
  }
  [[nodiscard]] std::optional<line_note> noted() noexcept override {
    const auto what = line_->noted();
    if (what) {
      follow_wall_clock();
      into_->note(*what);
    }
    return what;
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return line_->now_ns(); }
  void wake() noexcept override { line_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return line_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return line_->name(); }
  [[nodiscard]] bool answers() const noexcept override { return line_->answers(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return line_->baud(); }
  [[nodiscard]] const recorded_device* recorded() const noexcept override {
    return line_->recorded();
  }
  [[nodiscard]] std::optional<std::int64_t> wall_ahead_ns() const noexcept override {
    return line_->wall_ahead_ns();
  }

 private:
  void remember(const error& why) noexcept {
    if (why.what() != problem::cancelled && why.what() != problem::timeout) reason_ = why.what();
  }
  void follow_wall_clock() noexcept {
    if (const auto ahead_ns = line_->wall_ahead_ns()) into_->set_wall_clock(*ahead_ns);
  }

  std::unique_ptr<transport> line_;
  Writer* into_;
  problem reason_ = problem::cancelled;  // it was given free
};

template <class Writer>
class recorded_connector final : public connector {
 public:
  recorded_connector(std::unique_ptr<connector> lines, Writer& into) noexcept
      : lines_(std::move(lines)), into_(&into) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto line = lines_->connect();
    if (!line) return line;
    auto* const made = new (std::nothrow) recorded_transport<Writer>(std::move(*line), *into_);
    if (made == nullptr) return failure(task::opening, problem::system, {}, ENOMEM);
    return std::unique_ptr<transport>(made);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return lines_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return lines_->pause(deadline_ns);
  }
  void wake() noexcept override { lines_->wake(); }

 private:
  std::unique_ptr<connector> lines_;
  Writer* into_;
};

}  // namespace

result<std::unique_ptr<connector>> recorded(std::unique_ptr<connector> line,
                                            recording_writer& into) {
  using writer = recording_writer::file_writer;
  return std::make_unique<recorded_connector<writer>>(std::move(line), *into.made_);
}

}  // namespace g4lidar
