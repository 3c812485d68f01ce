// SPDX-License-Identifier: MIT
// Opening the lidar behind the word SOURCE.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/transport/transport.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "source_word.hpp"

namespace g4_tool {
namespace {

/// Throws a bad_value for --zero-angle and raw bytes of a model that has no such offset.
void refuse_without_offset(const g4lidar::model* model) {
  if (model == nullptr || model->zero_angle_divisor != 0) return;
  throw bad_value(
      fmt::format("--zero-angle: {} {} has no such offset", article_of(*model), model->name));
}

/// Keeps the first bytes that are read.
class observed_beginning final : public forwarding_transport {
 public:
  observed_beginning(std::unique_ptr<transport> inner, std::vector<std::uint8_t>& into)
      : forwarding_transport(std::move(inner)), into_(into) {
    into_.reserve(beginning_bytes);
  }

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    auto got = inner().read(out, deadline_ns);
    if (!got || into_.size() == beginning_bytes) return got;
    const auto more = out.first(std::min(got->count, beginning_bytes - into_.size()));
    into_.insert(into_.end(), more.begin(), more.end());
    return got;
  }

 private:
  std::vector<std::uint8_t>& into_;
};

}  // namespace

opened_source::opened_source(const common_options& options, lidar_options wanted) {
  const source_kind kind = kind_of_source(options.source);
  const std::string path = path_of_source(options.source);
  const bool is_raw = kind == source_kind::raw_bytes;
  if (is_raw && path == "-" && ::isatty(0) != 0) {
    throw failure(exit_code::usage,
                  std::string("standard input is a terminal. ") + raw_bytes_advice);
  }
  wanted = options_for(options, std::move(wanted));
  wanted.wrap = [this, is_raw, zero = wanted.zero_angle,
                 wrap = std::move(wanted.wrap)](std::unique_ptr<connector> from) {
    if (is_raw && zero) refuse_without_offset(from->traits().recognised.model);
    played_ = replay::reader_of(*from);
    simulation_ = simulation_of(*from);
    auto wrapped =
        wrap ? wrap(std::move(from)) : result<std::unique_ptr<connector>>(std::move(from));
    if (!wrapped || !is_raw) return wrapped;
    return for_each_connection([this](std::unique_ptr<transport> port) {
      return std::make_unique<observed_beginning>(std::move(port), beginning_);
    })(*std::move(wrapped));
  };
  const auto wait = std::exchange(wanted.device_wait, std::chrono::milliseconds(0));
  auto opened = g4lidar::lidar::open(wanted);
  if (!opened && wait > wanted.device_wait && opened.error().may_pass()) {
    logger::info(fmt::format("{}\nIt is tried again until a lidar answers.\n",
                             failure_of(options, opened.error()).what()));
    wanted.device_wait = wait;
    opened = g4lidar::lidar::open(wanted);
  }
  if (!opened) {
    const bool is_cancelled = opened.error() == problem::cancelled;
    // -d or --idle has ended the wait for the first bytes of a pipe.
    if (is_raw && is_cancelled && interrupt() == 0)
      throw without_packets({}, 0, {}, title_of_input(options.source));
    if (interrupt() != 0 || is_cancelled) throw interrupted();
    throw failure_of(options, opened.error());
  }
  lidar_.emplace(std::move(*opened));
  if (played_ != nullptr) size_ = played_->size();
  if (is_raw) size_ = size_of_file(path).value_or(0);
  report_contradictions(*lidar_);
  logger::verbose(fmt::format("opened {}\n", lidar_->name()));
}

}  // namespace g4_tool
