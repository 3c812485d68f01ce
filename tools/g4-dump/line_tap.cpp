// SPDX-License-Identifier: MIT
#include "line_tap.hpp"

#include <utility>

namespace g4_dump {
namespace {

class tapped_line final : public g4lidar::transport {
 public:
  tapped_line(std::unique_ptr<g4lidar::transport> line, heard_items& heard) noexcept
      : line_(std::move(line)), heard_(heard) {
    heard_.push_back({heard_item::kind::opened, line_->now_ns(), {}, std::string(line_->name())});
  }
  tapped_line(const tapped_line&) = delete;
  tapped_line& operator=(const tapped_line&) = delete;
  ~tapped_line() override { heard_.push_back({heard_item::kind::closed, line_->now_ns()}); }

  [[nodiscard]] g4lidar::result<g4lidar::received> read(
      std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    auto got = line_->read(out, deadline_ns);
    if (got && got->count > 0) {
      hear(heard_item::kind::from_device, out.first(got->count), got->arrival_ns);
    }
    return got;
  }
  [[nodiscard]] g4lidar::result<void> write(g4lidar::bytes data,
                                            std::int64_t deadline_ns) noexcept override {
    auto done = line_->write(data, deadline_ns);
    if (done) hear(heard_item::kind::to_device, data, line_->now_ns());
    return done;
  }
  [[nodiscard]] g4lidar::result<void> pause(std::int64_t deadline_ns) noexcept override {
    return line_->pause(deadline_ns);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return line_->now_ns(); }
  void wake() noexcept override { line_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return line_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return line_->name(); }
  [[nodiscard]] bool answers() const noexcept override { return line_->answers(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return line_->baud(); }

 private:
  void hear(heard_item::kind what, g4lidar::bytes data, std::int64_t time_ns) noexcept {
    heard_.push_back({what, time_ns, {data.begin(), data.end()}});
  }

  std::unique_ptr<g4lidar::transport> line_;
  heard_items& heard_;
};

class tap final : public g4lidar::connector {
 public:
  tap(std::unique_ptr<g4lidar::connector> lines, heard_items& heard) noexcept
      : lines_(std::move(lines)), heard_(heard) {}

  [[nodiscard]] g4lidar::result<std::unique_ptr<g4lidar::transport>> connect() noexcept override {
    auto line = lines_->connect();
    if (!line) return line;
    return std::make_unique<tapped_line>(std::move(*line), heard_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return lines_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return lines_->pause(deadline_ns);
  }
  void wake() noexcept override { lines_->wake(); }

 private:
  std::unique_ptr<g4lidar::connector> lines_;
  heard_items& heard_;
};

}  // namespace

std::unique_ptr<g4lidar::connector> tapped(std::unique_ptr<g4lidar::connector> lines,
                                           heard_items& heard) {
  return std::make_unique<tap>(std::move(lines), heard);
}

}  // namespace g4_dump
