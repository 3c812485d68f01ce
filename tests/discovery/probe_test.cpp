// SPDX-License-Identifier: MIT
// The probe with a G4, with other devices, and without an answer.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/discovery.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "support/patience.hpp"
#include "support/virtual_transport.hpp"
#include "transport/port_io.hpp"
#include "transport/pty.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using sim::fault_kind;

result<device_information> probe_at(const std::string& path,
                                    std::chrono::milliseconds time = patience) {
  auto port = serial_port::open(path);
  if (!port) return tl::unexpected(port.error());
  return probe(**port, in(**port, time));
}

/// In virtual time.
result<device_information> probe_device(const sim::device_options& options,
                                        const std::vector<sim::fault>& faults = {}) {
  virtual_bench bench(options, faults);
  virtual_transport to_device(bench);
  return probe(to_device, in(to_device, patience));
}

/// A device that sends the same text again and again, in virtual time.
class text_sender final : public transport {
 public:
  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    constexpr std::string_view text =
        "$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76\r\n";
    if (now_ns_ + period_ns > deadline_ns) {
      now_ns_ = std::max(now_ns_, deadline_ns);
      return received{0, now_ns_};
    }
    now_ns_ += period_ns;
    const std::size_t count = std::min(text.size(), out.size());
    std::copy_n(text.begin(), count, out.begin());
    return received{count, now_ns_};
  }
  result<void> write(bytes /*data*/, std::int64_t /*deadline_ns*/) noexcept override { return {}; }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    now_ns_ = std::max(now_ns_, deadline_ns);
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return "text_sender"; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return 230'400; }

 private:
  static constexpr std::int64_t period_ns = 10'000'000;
  std::int64_t now_ns_ = 0;
};

TEST(Probe, G4_ReturnsItsSerialNumber) {
  const auto found = probe_device({});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(*found, sim::device_options{}.info);
}

TEST(Probe, G4_IsLeftIdle) {
  auto served = sim::background_pty::open(
      sim::device(sim::built_in_world(), {}, std::vector{sim::make_fault(fault_kind::scanning)}));
  ASSERT_TRUE(served);
  const auto found = probe_at(served->path());
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(found->serial_number(), "2021101000070073");
  served->with([](sim::device& simulated, std::int64_t) { EXPECT_FALSE(simulated.is_scanning()); });
}

TEST(Probe, SendsOnlyStopsAndQueries) {
  auto served = sim::background_pty::open(sim::device(sim::built_in_world()));
  ASSERT_TRUE(served);
  ASSERT_TRUE(probe_at(served->path()));
  served->with([](sim::device& simulated, std::int64_t) {
    EXPECT_FALSE(simulated.log().empty());
    for (const sim::asked& one : simulated.log()) {
      EXPECT_TRUE(one.code == 0x00 || one.code == 0x65 || one.code == 0x90) << int{one.code};
    }
  });
}

TEST(Probe, OtherDevice_ErrorNamesTheModel) {
  sim::device_options other;
  other.info.model = 4;
  const auto found = probe_device(other);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::other_device);
  EXPECT_TRUE(found.error().subject().ends_with(", model 4"));
}

TEST(Probe, NoAnswer_Silence) {
  const auto found = probe_device({}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::silence);
  EXPECT_EQ(found.error().doing(), task::asking);
}

TEST(Probe, ScansAndReceivesNothing_DoesNotStop) {
  const auto found =
      probe_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::does_not_stop);
}

TEST(Probe, WrongBaudRate_Garbage) {
  const auto found =
      probe_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::baud)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::garbage);
}

TEST(Probe, AnotherKindOfDevice_Garbage) {
  text_sender device;
  const auto found = probe(device, in(device, 3s));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::garbage);
}

TEST(Probe, DeadlinesAreKept) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  const std::int64_t deadline_ns = in(**port, 20ms);
  EXPECT_EQ(probe(**port, deadline_ns).error().code(), problem::silence);
  EXPECT_LT((*port)->now_ns(), deadline_ns + std::chrono::nanoseconds(patience).count());
}

TEST(Probe, Unplugged_Gone) {
  pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  device.unplug();
  EXPECT_EQ(probe(**port, in(**port, patience)).error().code(), problem::gone);
}

TEST(Probe, Woken_Cancelled) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  (*port)->wake();
  EXPECT_EQ(probe(**port, in(**port, patience)).error().code(), problem::cancelled);
}

TEST(SelectPort, Path_IsUsedUnchanged) {
  const auto port = select_port("/dev/no-such-port");
  ASSERT_TRUE(port);
  EXPECT_EQ(port->path, "/dev/no-such-port");
}

TEST(SelectPort, WrongForms_AreRefused) {
  for (const std::string_view wrong :
       {"serial:", "serial:123", "serial:20211010000700733", "serial:202110100007007x", "usb:"}) {
    const auto port = select_port(wrong);
    ASSERT_FALSE(port) << wrong;
    EXPECT_EQ(port.error().code(), problem::bad_option) << wrong;
    EXPECT_TRUE(port.error().subject().starts_with(wrong)) << port.error().subject();
  }
}

}  // namespace
}  // namespace g4lidar::test
