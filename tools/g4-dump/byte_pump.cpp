// SPDX-License-Identifier: MIT
#include "byte_pump.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "progress.hpp"
#include "source.hpp"

namespace g4_dump {
namespace {

using clock = std::chrono::steady_clock;

/// Until when a pipe is waited for, by the two ends that are times.
class patience {
 public:
  explicit patience(const byte_sink& sink) : sink_(sink) {}

  void came() { last_ = clock::now(); }
  [[nodiscard]] bool is_over() const { return left_ms() == 0; }
  /// -1: for ever.
  [[nodiscard]] int left_ms() const {
    if (sink_.duration.count() == 0 && sink_.idle.count() == 0) return -1;
    const auto now = clock::now();
    auto left = std::chrono::nanoseconds(std::chrono::hours(1));
    if (sink_.duration.count() > 0) left = std::min(left, begin_ + sink_.duration - now);
    if (sink_.idle.count() > 0) left = std::min(left, last_ + sink_.idle - now);
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
    return static_cast<int>(std::max<std::int64_t>(ms, 0));
  }

 private:
  const byte_sink& sink_;
  clock::time_point begin_ = clock::now();
  clock::time_point last_ = begin_;
};

/// Waits for more of a pipe; false where the end has come.
bool wait_for_more(const input& in, output& out, const patience& left) {
  out.flush();
  while (!out.is_closed()) {
    switch (wait_for_input(in.descriptor(), out.descriptor(), left.left_ms())) {
      case wake::input:
        return true;
      case wake::timeout:
        if (left.is_over()) return false;
        break;
      case wake::interrupt:
      case wake::output_closed:
        return false;
    }
  }
  return false;
}

[[noreturn]] void refuse_recording(const std::string& title) {
  throw failure(exit_code::bad_file,
                title +
                    " is a recording, not raw bytes. Give the file's name to g4-dump dump, scan "
                    "or packets; a recording is not read from a pipe.");
}

}  // namespace

void pump(input& in, output& out, const byte_sink& sink) {
  constexpr std::size_t first_piece = 16'384;
  progress_bar bar(sink.with_bar && !out.is_terminal(), in.size());
  std::vector<std::uint8_t> buffer(std::size_t{256} * 1024);
  patience left(sink);
  std::uint64_t bytes = 0;
  while (!out.is_closed() && !(sink.is_done && sink.is_done())) {
    if (in.would_wait() && !wait_for_more(in, out, left)) return;
    if (!in.id() && left.is_over()) return;
    const std::size_t most = bytes == 0 ? first_piece : buffer.size();
    const std::span<const std::uint8_t> got(buffer.data(), in.read(std::span(buffer).first(most)));
    if (got.empty()) return;
    left.came();
    if (bytes == 0 && begins_as_recording(got)) refuse_recording(in.title());
    sink.take(got);
    if (bytes == 0) out.flush();
    bytes += got.size();
    bar.show(bytes);
  }
}

}  // namespace g4_dump
