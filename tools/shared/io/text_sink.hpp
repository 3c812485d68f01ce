// SPDX-License-Identifier: MIT
// The output of a writer: a buffer that is passed to the caller when it is full.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>

namespace g4_tool {

/// Output for a file, a socket or a string. A derived class defines the destination. *Single
/// thread, allocates on construction.* take() may throw: the writers pass exceptions on.
class text_sink {
 public:
  text_sink() = default;
  text_sink(const text_sink&) = delete;
  text_sink& operator=(const text_sink&) = delete;
  virtual ~text_sink() = default;

  /// The maximum argument of room(), in bytes.
  static constexpr std::size_t max_room = 65'536;

  /// Memory for up to `count` bytes, valid until the next call; then call wrote().
  [[nodiscard]] char* room(std::size_t count) {
    assert(count <= max_room);
    if (capacity - used_ < count) flush();
    return buffer_.get() + used_;
  }
  /// Everything before `end` in the memory of the last room() has been written.
  void wrote(const char* end) noexcept { used_ = static_cast<std::size_t>(end - buffer_.get()); }

  /// Appends `text`.
  void write(std::string_view text) {
    for (; !text.empty(); text.remove_prefix(std::min(text.size(), max_room))) {
      const std::string_view part = text.substr(0, max_room);
      wrote(std::ranges::copy(part, room(part.size())).out);
    }
  }
  /// Passes everything written so far to take().
  void flush() { take({buffer_.get(), std::exchange(used_, 0)}); }
  /// Whether flush() has anything to pass.
  [[nodiscard]] bool has_unwritten() const noexcept { return used_ > 0; }

 protected:
  /// Receives the output in order, in pieces of up to 262,144 bytes, valid during the call. The
  /// destructor does not call it: call flush() at the end.
  virtual void take(std::string_view text) = 0;

 private:
  static constexpr std::size_t capacity = 4 * max_room;

  std::unique_ptr<char[]> buffer_ = std::make_unique_for_overwrite<char[]>(capacity);
  std::size_t used_ = 0;
};

/// A sink that calls `Take` with each piece of output as a std::string_view:
/// `callback_sink sink([&](std::string_view text) { all += text; });`
template <class Take>
class callback_sink final : public text_sink {
 public:
  /// Keeps a copy of `take`.
  explicit callback_sink(Take take) : take_(std::move(take)) {}

 private:
  void take(std::string_view text) override { take_(text); }

  Take take_;
};

}  // namespace g4_tool
