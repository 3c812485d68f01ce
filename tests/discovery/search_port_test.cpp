// SPDX-License-Identifier: MIT
// The search at a port with a G4, with other devices, and without an answer.
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

result<recognised_lidar> search_path(const std::string& path) {
  auto port = serial_port::open(path);
  if (!port) return tl::unexpected(port.error());
  return search(**port, in(**port, patience));
}

/// In virtual time.
result<recognised_lidar> search_device(const sim::device_options& options,
                                       const std::vector<sim::fault>& faults = {}) {
  virtual_bench bench(options, faults);
  virtual_transport to_device(bench);
  return search(to_device, in(to_device, 3s));
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

TEST(SearchAtAPort, G4_ReturnsItsSerialNumber) {
  const auto found = search_device({});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(found->device, sim::device_options{}.info);
  EXPECT_EQ(found->model, &models.front());
  EXPECT_EQ(found->candidates, std::vector<const model*>{&models.front()});
}

TEST(SearchAtAPort, G4_IsLeftIdle) {
  auto served = sim::background_pty::open(
      sim::device(sim::built_in_world(), {}, std::vector{sim::make_fault(fault_kind::scanning)}));
  ASSERT_TRUE(served);
  const auto found = search_path(served->path());
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(found->device.serial_number(), "2021101000070073");
  served->with([](sim::device& simulated, std::int64_t) { EXPECT_FALSE(simulated.is_scanning()); });
}

TEST(SearchAtAPort, SendsOnlyStopsAndQueries) {
  auto served = sim::background_pty::open(sim::device(sim::built_in_world()));
  ASSERT_TRUE(served);
  ASSERT_TRUE(search_path(served->path()));
  served->with([](sim::device& simulated, std::int64_t) {
    EXPECT_FALSE(simulated.log().empty());
    for (const sim::asked& one : simulated.log()) {
      EXPECT_TRUE(one.code == 0x00 || one.code == 0x65 || one.code == 0x90) << int{one.code};
    }
  });
}

TEST(SearchAtAPort, NumberThatNoModelHas_IsReadAsItsBytesShow) {
  sim::device_options other;
  other.info.model = 77;
  const auto found = search_device(other);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->model->word, "g4");
  EXPECT_EQ(found->by, known_by::nothing) << "it has sent no packet";
  EXPECT_EQ(found->device.model, 77);
}

TEST(SearchAtAPort, NoAnswer_Silence) {
  const auto found = search_device({}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::silence);
  EXPECT_EQ(found.error().doing(), task::asking);
}

TEST(SearchAtAPort, ScansAndReceivesNothing_CanOnlyBeRead) {
  const auto found =
      search_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::deaf)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->model->word, "g4");
  EXPECT_TRUE(found->is_silent);
}

TEST(SearchAtAPort, OtherProtocol_IsRefusedByName) {
  struct product {
    std::uint8_t id;
    std::string_view name;
  };
  constexpr product all[] = {{23, "R3"}, {52, "GS2"}, {110, "TEA"}, {160, "SDM15"}, {211, "TIA"}};
  for (const auto& [id, name] : all) {
    sim::device_options other;
    other.info.model = id;
    const auto found = search_device(other);
    ASSERT_FALSE(found) << name;
    EXPECT_EQ(found.error().code(), problem::other_device);
    EXPECT_EQ(found.error().detail(), error_detail::unsupported_product);
    EXPECT_TRUE(found.error().subject().ends_with(", a " + std::string(name)));
  }
}

TEST(SearchAtAPort, WrongBaudRate_Garbage) {
  const auto found =
      search_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::baud)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::garbage);
}

TEST(SearchAtAPort, AnotherKindOfDevice_IsNamed) {
  text_sender device;
  const auto found = search(device, in(device, 3s));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), problem::other_device);
  EXPECT_EQ(found.error().detail(), error_detail::other_maker);
  EXPECT_NE(found.error().subject().find("NMEA"), std::string_view::npos);
}

TEST(SearchAtAPort, DeadlinesAreKept) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  const std::int64_t deadline_ns = in(**port, 20ms);
  EXPECT_EQ(search(**port, deadline_ns).error().code(), problem::silence);
  EXPECT_LT((*port)->now_ns(), deadline_ns + std::chrono::nanoseconds(patience).count());
}

TEST(SearchAtAPort, Unplugged_Gone) {
  pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  device.unplug();
  EXPECT_EQ(search(**port, in(**port, patience)).error().code(), problem::gone);
}

TEST(SearchAtAPort, Woken_Cancelled) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  (*port)->wake();
  EXPECT_EQ(search(**port, in(**port, patience)).error().code(), problem::cancelled);
}

}  // namespace
}  // namespace g4lidar::test
