// SPDX-License-Identifier: MIT
// The bytes of a file, why they cannot be read, and whether reading is to end.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar::mcap {

/// Bytes of a file, or of a test.
class byte_source {
 public:
  virtual ~byte_source() = default;
  byte_source(const byte_source&) = delete;
  byte_source& operator=(const byte_source&) = delete;

  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  /// Reads up to out.size() bytes from `offset` on; fewer only at the end and after a failure.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::uint8_t> out) noexcept {
    if (trouble_) return 0;
    const auto count = read_some(offset, out);
    if (!count) fail(count.error());
    return count.value_or(0);
  }
  /// Why nothing can be read any more.
  [[nodiscard]] const std::optional<error>& trouble() const noexcept { return trouble_; }
  void fail(const error& why) noexcept { trouble_ = why; }

  /// `asked` is called often while much is read; it returns true to end that.
  void cancel_when(std::function<bool()> asked) { asked_ = std::move(asked); }
  /// Whether reading is to end now. Once true it is true until resume().
  [[nodiscard]] bool is_cancelled() {
    is_cancelled_ = is_cancelled_ || (asked_ && asked_());
    return is_cancelled_;
  }
  void resume() noexcept { is_cancelled_ = false; }

 protected:
  byte_source() = default;

 private:
  [[nodiscard]] virtual result<std::size_t> read_some(std::uint64_t offset,
                                                      std::span<std::uint8_t> out) noexcept = 0;

  std::optional<error> trouble_;
  std::function<bool()> asked_;
  bool is_cancelled_ = false;
};

[[nodiscard]] result<std::shared_ptr<byte_source>> open_file_source(std::string_view path);
/// Whether it begins like an MCAP file.
[[nodiscard]] bool has_magic(byte_source& file) noexcept;

}  // namespace g4lidar::mcap
