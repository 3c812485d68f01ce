// SPDX-License-Identifier: MIT
// Transports with faults that the simulated device does not have.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

template <class Link, class... Arguments>
wrapper wrap_in(Arguments... arguments) {
  return [=](std::unique_ptr<transport> inner) -> std::unique_ptr<transport> {
    return std::make_unique<Link>(std::move(inner), arguments...);
  };
}

/// Every attempt to connect fails.
class failing_connector final : public connector {
 public:
  explicit failing_connector(problem what, error_detail detail = error_detail::usual)
      : what_(what), detail_(detail) {}
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    return failure(task::opening, what_, "a port", 0, detail_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return 0; }
  [[nodiscard]] bool pause(std::int64_t) noexcept override { return true; }
  void wake() noexcept override {}

 private:
  problem what_;
  error_detail detail_;
};

/// Reading fails from a time on.
class broken_link final : public forwarding_transport {
 public:
  broken_link(std::unique_ptr<transport> inner, std::int64_t from_ns, problem what)
      : forwarding_transport(std::move(inner)), from_ns_(from_ns), what_(what) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (now_ns() < from_ns_) return inner().read(out, deadline_ns);
    return failure(task::reading, what_, name());
  }

 private:
  std::int64_t from_ns_;
  problem what_;
};

/// The start command does not reach the device.
class link_without_start final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const auto start = encode(command::start);
    if (std::equal(data.begin(), data.end(), start.begin(), start.end())) return {};
    return inner().write(data, deadline_ns);
  }
};

/// Another program stops the device 2 s after each start.
class link_that_stops final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const auto start = encode(command::start);
    if (std::equal(data.begin(), data.end(), start.begin(), start.end())) {
      stop_ns_ = now_ns() + 2'000'000'000;
    }
    return inner().write(data, deadline_ns);
  }
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (now_ns() >= stop_ns_) {
      stop_ns_ = never_ns;
      static_cast<void>(inner().write(encode(command::stop), deadline_ns));
    }
    return inner().read(out, deadline_ns);
  }

 private:
  std::int64_t stop_ns_ = never_ns;
};

/// The beginning of a packet arrives 40 ms after each stop, as from a bridge that holds bytes back.
class link_with_a_late_rest final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const auto stop = encode(command::stop);
    if (std::search(data.begin(), data.end(), stop.begin(), stop.end()) != data.end()) {
      rest_ns_ = now_ns() + 40'000'000;
    }
    return inner().write(data, deadline_ns);
  }
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    const auto got = inner().read(out, std::min(deadline_ns, rest_ns_));
    if (!got || got->count > 0 || now_ns() < rest_ns_) return got;
    rest_ns_ = never_ns;
    const std::array<std::uint8_t, 4> begin{0xAA, 0x55, 0x00, 0x28};
    std::copy(begin.begin(), begin.end(), out.begin());
    return received{begin.size(), now_ns()};
  }

 private:
  std::int64_t rest_ns_ = never_ns;
};

/// What is sent comes back, with a text behind it: from a console, or, without a text, from a wire between both
/// directions. No lidar is there.
class echoing_link final : public forwarding_transport {
 public:
  echoing_link(std::unique_ptr<transport> inner, std::string prompt)
      : forwarding_transport(std::move(inner)), prompt_(std::move(prompt)) {}
  [[nodiscard]] result<void> write(bytes data, std::int64_t) noexcept override {
    waiting_.insert(waiting_.end(), data.begin(), data.end());
    waiting_.insert(waiting_.end(), prompt_.begin(), prompt_.end());
    return {};
  }
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    const auto got = inner().read(out, waiting_.empty() ? deadline_ns : now_ns());
    if (!got) return got;
    const std::size_t count = std::min(out.size(), waiting_.size());
    std::copy_n(waiting_.begin(), count, out.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    return received{count, now_ns()};
  }

 private:
  std::string prompt_;
  std::vector<std::uint8_t> waiting_;
};

/// An XV-11 at 115200 baud: frames with a checksum. Other bytes at other rates. It reads nothing.
class other_makers_link final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override { return {}; }
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    const std::int64_t until_ns = std::min(deadline_ns, now_ns() + 2'000'000);
    const auto got = inner().read(out, until_ns);
    if (!got) return got;
    std::array<std::uint8_t, 22> frame{
        0xFA, static_cast<std::uint8_t>(0xA0 + number_++ % 90), 0x00, 0x4B, 0xE8, 0x03, 0xC8, 0x00};
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < 20; i += 2) sum = 2 * sum + frame[i] + 256U * frame[i + 1];
    sum = (sum % 32'768 + sum / 32'768) % 32'768;
    frame[20] = static_cast<std::uint8_t>(sum % 256);
    frame[21] = static_cast<std::uint8_t>(sum / 256);
    if (baud() != 115'200) frame.fill(0xF8);
    const std::size_t count = std::min(out.size(), frame.size());
    std::copy_n(frame.begin(), count, out.begin());
    return received{count, now_ns()};
  }

 private:
  unsigned number_ = 0;
};

/// Some bytes precede the begin of each revolution.
class noisy_link final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    const auto got = inner().read(out.first(out.size() / 2), deadline_ns);
    if (!got || got->count < 4) return got;
    const auto end = out.begin() + static_cast<std::ptrdiff_t>(got->count);
    const std::array<std::uint8_t, 2> begin{0xAA, 0x55};
    for (auto at = out.begin(); (at = std::search(at, end, begin.begin(), begin.end())) != end;
         ++at) {
      if (end - at < 4 || (at[2] & 1) == 0 || at[3] != 1) continue;
      std::copy_backward(at, end, end + 3);
      std::fill(at, at + 3, std::uint8_t{0x33});
      return received{got->count + 3, got->arrival_ns};
    }
    return got;
  }
};

/// A setting is reported wrongly: the sample rate as 4 kHz, or the scan frequency as 10 Hz.
class lying_link final : public forwarding_transport {
 public:
  lying_link(std::unique_ptr<transport> inner, response_kind about)
      : forwarding_transport(std::move(inner)), about_(about) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    const auto got = inner().read(out, deadline_ns);
    if (!got) return got;
    // 9 kHz; 7.00 Hz.
    const std::vector<std::uint8_t> rate{0xA5, 0x5A, 1, 0, 0, 0, 4, 2};
    const std::vector<std::uint8_t> frequency{0xA5, 0x5A, 4, 0, 0, 0, 4, 0xBC, 0x02};
    const auto& wanted = about_ == response_kind::byte ? rate : frequency;
    const auto end = out.begin() + static_cast<std::ptrdiff_t>(got->count);
    const auto at = std::search(out.begin(), end, wanted.begin(), wanted.end());
    if (at == end) return got;
    at[7] = about_ == response_kind::byte ? 0 : 0xE8;
    if (about_ == response_kind::frequency) at[8] = 0x03;
    return got;
  }

 private:
  response_kind about_;
};

/// Once, from a given time on, the program is suspended: nothing is read, and as many bytes accumulate as
/// there is room for. With little room they come in portions, as those of a pseudo-terminal.
class paused_host final : public forwarding_transport {
 public:
  paused_host(std::unique_ptr<transport> inner, sim::virtual_clock* clock, std::int64_t from_ns,
              std::int64_t pause_ns, std::size_t room = 1'000'000)
      : forwarding_transport(std::move(inner)),
        clock_(clock),
        from_ns_(from_ns),
        pause_ns_(pause_ns),
        room_(room),
        portion_ns_(room < 1'000'000 ? 4'000'000 : 0) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (now_ns() >= from_ns_) {
      from_ns_ = never_ns;
      clock_->advance_to(now_ns() + pause_ns_);
      keep();
    }
    if (kept_.empty()) return inner().read(out, deadline_ns);
    constexpr std::size_t portion = 256;
    const std::size_t count = std::min({out.size(), kept_.size(), portion});
    clock_->advance_to(now_ns() + portion_ns_);
    std::copy_n(kept_.begin(), count, out.begin());
    kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(count));
    return received{count, now_ns()};
  }

 private:
  /// What has accumulated: what there was no room for is lost.
  void keep() {
    std::array<std::uint8_t, 512> some{};
    for (;;) {
      const result<received> got = inner().read(some, now_ns());
      if (!got || got->count == 0) break;
      const std::size_t count = std::min(got->count, room_ - kept_.size());
      kept_.insert(kept_.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }

  sim::virtual_clock* clock_;
  std::int64_t from_ns_;
  std::int64_t pause_ns_;
  std::size_t room_;
  std::int64_t portion_ns_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace g4lidar::test
