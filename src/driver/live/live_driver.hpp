// SPDX-License-Identifier: MIT
// The driver of a live device: its stages, and the calls that move it through them.
#pragma once

#include <cstdint>

#include "live_source.hpp"
#include "open_question.hpp"
#include "setup_sequence.hpp"

namespace g4lidar {

/// *Single thread.* live_stage.hpp has the table of the stages.
class live_driver final : public live_source {
 public:
  using live_source::live_source;

  [[nodiscard]] result<void> start() override;
  [[nodiscard]] result<void> stop() override;
  [[nodiscard]] result<answer> ask(const request& wanted, while_scanning if_scanning) override;

 private:
  [[nodiscard]] result<void> connected() override;
  [[nodiscard]] result<void> round(std::int64_t deadline_ns) override;
  [[nodiscard]] std::int64_t due_ns() const noexcept override;
  [[nodiscard]] bool has_work() const noexcept override {
    return !setup_.is_done() || stream_.talk().is_busy();
  }
  void leave() noexcept override;
  [[nodiscard]] bool listens() const noexcept;
  [[nodiscard]] result<bool> serve();
  [[nodiscard]] error silence_error() const;

  // The setup sequence, and the request of the caller.
  [[nodiscard]] bool set_up_again();
  [[nodiscard]] result<bool> go_on_with_setup();
  [[nodiscard]] result<void> take_outcome(const outcome& done);
  [[nodiscard]] result<void> finish_step(const outcome& done);
  [[nodiscard]] result<void> answered(const device_information& who);
  [[nodiscard]] result<void> give_up(const error& why);

  /// The time before the first command. An idle device is silent; the slowest lidar sends a byte in the first time, and
  /// a packet in the second one.
  struct first_listening {
    static constexpr std::int64_t for_byte_ns = 30'000'000;
    static constexpr std::int64_t for_packet_ns = 100'000'000;

    std::int64_t begin_ns = 0;  // 0: it has ended
    std::uint64_t bytes_before = 0;

    [[nodiscard]] std::int64_t until_ns(const event_reader& input) const noexcept {
      if (begin_ns == 0) return 0;
      const bool has_bytes = input.bytes_parsed() != bytes_before;
      return begin_ns + (has_bytes ? for_packet_ns : for_byte_ns);
    }
  };

  first_listening listening_;
  setup_sequence setup_;
  open_question question_;
  std::uint64_t scans_at_begin_ = 0;    // whole revolutions before the start
  std::uint64_t skipped_at_begin_ = 0;  // bytes outside of packets before it
};

}  // namespace g4lidar
