// SPDX-License-Identifier: MIT
// A file of raw bytes as a recording.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "played_file.hpp"
#include "recording/mcap/format.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

/// The bytes of a file: their times are counted from samples.
class counted_items final : public item_source {
 public:
  /// The longest piece of bytes that belong to no packet, and of bytes of a pipe: its points fit into a ring.
  static constexpr std::size_t longest_piece = 16'384;

  /// Of the file behind `fd` from `begin` on, whose first sample was measured at `wall_ns`.
  counted_items(std::shared_ptr<const owned_fd> fd, off_t begin, std::string name,
                std::uint32_t sample_rate_hz, std::int64_t wall_ns, std::int64_t to_ns,
                std::function<bool()> is_cancelled, const g4lidar::model& sender)
      : fd_(std::move(fd)),
        file_begin_(begin),
        name_(std::move(name)),
        rate_hz_(sample_rate_hz),
        wall_ahead_ns_(wall_ns - file_begin_ns),
        to_ns_(detail::saturating_add(file_begin_ns, to_ns)),
        is_cancelled_(std::move(is_cancelled)),
        model_(&sender) {}

  [[nodiscard]] std::uint32_t counted_hz() const noexcept override {
    return static_cast<std::uint32_t>(rate_hz_);
  }
  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept override {
    while (true) {
      auto piece = find_piece();
      if (!piece) return tl::unexpected(piece.error());
      if (piece->empty() || now_ns_ >= to_ns_) return std::nullopt;
      if (now_ns_ < from_ns_) continue;
      return recorded_item{recorded_item::kind::from_device,
                           now_ns_,
                           detail::saturating_add(now_ns_, wall_ahead_ns_),
                           *piece,
                           {}};
    }
  }
  [[nodiscard]] result<void> seek(std::int64_t from_ns) noexcept override {
    from_ns_ = detail::saturating_add(file_begin_ns, from_ns);
    now_ns_ = file_begin_ns;
    read_ = 0;
    begin_ = parsed_ = end_ = 0;
    samples_ = 0;
    parser_ = stream_parser(model_->samples);
    return {};
  }
  [[nodiscard]] std::int64_t first_ns() const noexcept override { return file_begin_ns; }
  [[nodiscard]] std::int64_t last_ns() noexcept override {
    if (!last_ns_) {
      counted_items all(fd_, file_begin_, name_, static_cast<std::uint32_t>(rate_hz_), 0, never_ns,
                        is_cancelled_, *model_);
      for (auto piece = all.find_piece(); piece && !piece->empty();) piece = all.find_piece();
      last_ns_ = all.now_ns_;
    }
    return *last_ns_;
  }
  [[nodiscard]] const g4lidar::model& model() const noexcept override { return *model_; }

 private:
  /// Up to the end of the next packet, whose samples have been measured by then: no part of it arrives
  /// before. Empty at the end. Valid until the next call.
  [[nodiscard]] result<bytes> find_piece() noexcept {
    while (!parse() && end_ - begin_ < longest_piece) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      end_ = parsed_ = end_ - begin_;
      begin_ = 0;
      if (is_cancelled_ && is_cancelled_())
        return failure(task::reading, problem::cancelled, name_);
      const ssize_t count = uninterrupted([&] {
        return ::pread(fd_->get(), buffer_.data() + end_, buffer_.size() - end_,
                       file_begin_ + read_);
      });
      if (count < 0) return failure(task::reading, problem::system, name_, errno);
      if (count == 0) break;
      end_ += static_cast<std::size_t>(count);
      read_ += count;
    }
    const std::size_t from = std::exchange(begin_, parsed_);
    return bytes(buffer_).subspan(from, parsed_ - from);
  }
  /// Whether there was a packet; then everything up to its end is parsed.
  [[nodiscard]] bool parse() noexcept {
    bytes rest = bytes(buffer_).subspan(parsed_, end_ - parsed_);
    while (const auto found = parser_.next(rest)) {
      const auto* const packet = std::get_if<packet_view>(&*found);
      if (packet == nullptr) continue;
      if (samples_ > 0 || !packet->is_suspect()) count(packet->sample_count());  // from a point on
      parsed_ = end_ - rest.size();
      return true;
    }
    parsed_ = end_;
    return false;
  }
  void count(std::size_t samples) noexcept {
    samples_ += static_cast<std::int64_t>(samples);
    now_ns_ = file_begin_ns + samples_ / rate_hz_ * second_ns +
              samples_ % rate_hz_ * second_ns / rate_hz_;
  }

  /// The time of the first bytes of a file; 0 would mean that it is not known.
  static constexpr std::int64_t file_begin_ns = second_ns;

  std::shared_ptr<const owned_fd> fd_;
  off_t file_begin_;
  std::string name_;
  std::int64_t rate_hz_;
  std::int64_t wall_ahead_ns_;
  std::int64_t from_ns_ = 0;
  std::int64_t to_ns_;
  std::function<bool()> is_cancelled_;
  std::int64_t now_ns_ = file_begin_ns;
  std::optional<std::int64_t> last_ns_;
  std::int64_t samples_ = 0;
  const g4lidar::model* model_;
  stream_parser parser_{model_->samples};
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65'536);
  off_t read_ = 0;          // of the file
  std::size_t begin_ = 0;   // of the bytes that were not returned yet
  std::size_t parsed_ = 0;  // up to here
  std::size_t end_ = 0;
};

}  // namespace g4lidar
