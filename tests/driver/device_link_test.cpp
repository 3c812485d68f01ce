// SPDX-License-Identifier: MIT
// The link to a device: what it reads, which events it passes on, when a packet has ended.
#include "link/device_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "support/packet_maker.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t pause_ns = device_link::usual_cut_off_ns;

/// The answer to 90 of a G4 (protocol: Commands), with an empty content.
std::vector<std::uint8_t> device_information_reply() {
  std::vector<std::uint8_t> reply{0xA5, 0x5A, 0x14, 0, 0, 0, 0x04};
  reply.resize(reply.size() + 20);
  return reply;
}

/// Delivers bytes at the times that a test states.
class scripted_transport final : public transport {
 public:
  void add(std::int64_t time_ns, bytes data) {
    left_.emplace_back(time_ns, std::vector<std::uint8_t>(data.begin(), data.end()));
  }

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    if (left_.empty() || left_.front().first > deadline_ns) {
      now_ns_ = std::max(now_ns_, deadline_ns);
      return received{};
    }
    const auto [time_ns, data] = std::exchange(left_.front(), {});
    left_.pop_front();
    now_ns_ = std::max(now_ns_, time_ns);
    std::ranges::copy(data, out.begin());
    return received{data.size(), time_ns};
  }
  result<void> write(bytes, std::int64_t) noexcept override { return {}; }
  result<void> pause(std::int64_t) noexcept override { return {}; }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  void set_name(std::string_view name) noexcept { name_ = name; }

 private:
  std::deque<std::pair<std::int64_t, std::vector<std::uint8_t>>> left_;
  std::int64_t now_ns_ = 1'000'000;
  std::string_view name_ = "script";
};

/// A link, and what its sink gets: "p" a packet, "r" a response, "-" a skipped byte.
struct bench {
  explicit bench(const model& which = g4_model)
      : input(which.samples), link(input, &port, {}, pause_ns, which) {}

  auto sink() {
    return [this](const event& found) -> std::string& {
      const auto* const gone = std::get_if<skipped>(&found);
      if (gone != nullptr) return got.append(gone->count, '-');
      return got.append(std::holds_alternative<packet_view>(found) ? "p" : "r");
    };
  }
  std::string receive(std::int64_t deadline_ns) {
    got.clear();
    EXPECT_TRUE(link.receive(buffer, deadline_ns));
    link.events(sink());
    return got;
  }

  scripted_transport port;
  event_reader input;
  std::array<std::uint8_t, 256> buffer{};
  std::string got;
  device_link link;
};

const made::packet whole(0, 6400, 7680, 40);

TEST(DeviceLink, EventsGoToTheSessionAndToTheSink) {
  bench on;
  on.port.add(5'000'000, whole.data());
  EXPECT_EQ(on.receive(never_ns), "p");
  EXPECT_EQ(on.link.heard_ns(), 5'000'000);
  EXPECT_EQ(on.link.talk().noticed(), notice::found_scanning);
}

TEST(DeviceLink, TheSessionOfAOneWayLidarGetsNone) {
  const model& which = *model_named("x2");
  bench on(which);
  on.port.add(5'000'000, whole.data());
  EXPECT_EQ(on.receive(never_ns), "p");
  EXPECT_EQ(on.link.talk().noticed(), notice::none);
  on.port.add(6'000'000, whole.data().first(4));
  EXPECT_EQ(on.receive(never_ns), "");
  EXPECT_EQ(on.link.due_ns(), never_ns);  // packets come later or never: there is no answer to lose
  EXPECT_EQ(on.receive(6'000'000 + 10 * pause_ns), "");
}

// TCP delays the rest of an answer by 40 ms, if it was written in parts.
TEST(DeviceLink, AnAnswerInTwoPartsFromANetworkBridgeIsOne) {
  const auto reply = device_information_reply();
  bench on;
  on.port.set_name("tcp:192.0.2.1:4000");
  on.link.follow(on.port);
  on.port.add(5'000'000, bytes(reply).first(15));
  EXPECT_EQ(on.receive(never_ns), "");
  EXPECT_EQ(on.receive(50'000'000), "");
  on.port.add(50'000'000, bytes(reply).subspan(15));
  EXPECT_EQ(on.receive(never_ns), "r");
  // The rest may also be lost.
  on.port.add(60'000'000, bytes(reply).first(15));
  EXPECT_EQ(on.receive(never_ns), "");
  EXPECT_EQ(on.link.due_ns(), 60'000'000 + 8 * pause_ns);
  EXPECT_EQ(on.receive(on.link.due_ns()), "---------------");
}

// The header of a packet claims 80 more bytes, of which an answer would be a part.
TEST(DeviceLink, APacketThatDoesNotContinueEndsAfterThePause) {
  const auto reply = device_information_reply();
  const bytes header = whole.data().first(10);
  bench late;
  late.port.add(5'000'000, header);
  EXPECT_EQ(late.receive(never_ns), "");
  EXPECT_EQ(late.link.due_ns(), 5'000'000 + pause_ns);
  EXPECT_EQ(late.receive(late.link.due_ns() - 1), "");
  EXPECT_EQ(late.receive(late.link.due_ns()), "----------");
  late.port.add(5'000'000 + pause_ns, reply);
  EXPECT_EQ(late.receive(never_ns), "r");
  bench early;
  early.port.add(5'000'000, header);
  early.port.add(5'000'000 + pause_ns - 1, reply);
  EXPECT_EQ(early.receive(never_ns), "");
  EXPECT_EQ(early.receive(early.link.due_ns()), "");
  EXPECT_EQ(early.link.due_ns(), 5'000'000 + 2 * pause_ns - 1);
}

TEST(DeviceLink, FinishParsesTheHeldBytesAgain) {
  bench on;
  auto data = device_information_reply();
  const bytes header = whole.data().first(10);
  data.insert(data.begin(), header.begin(), header.end());
  on.port.add(5'000'000, data);
  EXPECT_EQ(on.receive(never_ns), "");
  on.link.finish(on.sink());
  EXPECT_EQ(on.got, "----------r");
}

// A request begins with the commands of a stop, 00 and 65 (protocol: Commands).
TEST(DeviceLink, CommandsAreSentUntilOneFails) {
  bench on;
  ASSERT_FALSE(on.link.talk().begin(requests::stop(), on.port.now_ns()));
  std::vector<std::uint8_t> sent;
  const auto write = [&](bytes command) {
    sent.insert(sent.end(), command.begin(), command.end());
    return sent.size() > 2 ? result<void>() : failure(task::writing, problem::gone, "script");
  };
  const auto failed = on.link.send(write);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error(), problem::gone);
  EXPECT_EQ(sent, (std::vector<std::uint8_t>{0xA5, 0x00}));
  EXPECT_TRUE(on.link.send(write));
  EXPECT_EQ(sent, (std::vector<std::uint8_t>{0xA5, 0x00, 0xA5, 0x65}));
}

TEST(DeviceLink, OfAnotherTransportNothingIsKnown) {
  bench on;
  ASSERT_FALSE(on.link.talk().begin(requests::stop(), on.port.now_ns()));
  scripted_transport other;
  other.add(9'000'000, whole.data());
  on.link.follow(other);
  EXPECT_FALSE(on.link.talk().is_busy());
  EXPECT_EQ(on.link.heard_ns(), other.now_ns());
  EXPECT_EQ(on.receive(never_ns), "p");
}

}  // namespace
}  // namespace g4lidar
