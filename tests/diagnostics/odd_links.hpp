// SPDX-License-Identifier: MIT
// Transports with faults that the simulated device does not have.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/transport/connector.hpp"
#include "g4lidar/transport/forwarding.hpp"

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

/// Once, from a given time on, the program is suspended: nothing is read, and bytes accumulate.
class paused_host final : public forwarding_transport {
 public:
  paused_host(std::unique_ptr<transport> inner, sim::virtual_clock* clock, std::int64_t from_ns,
              std::int64_t pause_ns)
      : forwarding_transport(std::move(inner)),
        clock_(clock),
        from_ns_(from_ns),
        pause_ns_(pause_ns) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (now_ns() >= from_ns_) {
      from_ns_ = never_ns;
      clock_->advance_to(now_ns() + pause_ns_);
    }
    return inner().read(out, deadline_ns);
  }

 private:
  sim::virtual_clock* clock_;
  std::int64_t from_ns_;
  std::int64_t pause_ns_;
};

}  // namespace g4lidar::test
