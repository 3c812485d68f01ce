// SPDX-License-Identifier: MIT
// Bytes that are no packet and no answer: the errors state how many arrived, and how they begin.
#include "survey/unrecognised_bytes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;
using octets = std::vector<std::uint8_t>;

/// Answers the command 90 with these bytes, or everything with itself; in virtual time.
class answering_port : public transport {
 public:
  using clock = std::shared_ptr<std::int64_t>;
  explicit answering_port(octets answer, clock now = std::make_shared<std::int64_t>(1))
      : answer_(std::move(answer)), now_ns_(std::move(now)) {}

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    const std::size_t count = std::min(out.size(), waiting_.size());
    if (count == 0) *now_ns_ = std::max(*now_ns_, deadline_ns);
    if (count == 0) return received{0, *now_ns_};
    *now_ns_ += 1'000'000;
    std::copy_n(waiting_.begin(), count, out.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    return received{count, *now_ns_};
  }
  result<void> write(bytes data, std::int64_t /*deadline_ns*/) noexcept override {
    const bool is_question = std::ranges::find(data, 0x90) != data.end();
    if (answer_.empty()) waiting_.insert(waiting_.end(), data.begin(), data.end());
    if (is_question) waiting_.insert(waiting_.end(), answer_.begin(), answer_.end());
    return {};
  }
  result<bool> set_baud(std::uint32_t baud) noexcept override {
    baud_ = baud;
    return true;
  }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    *now_ns_ = std::max(*now_ns_, deadline_ns);
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return *now_ns_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return "port"; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }

 private:
  octets answer_;
  octets waiting_;
  clock now_ns_;
  std::uint32_t baud_ = 230'400;
};

class answering_connector final : public connector {
 public:
  explicit answering_connector(octets answer) : answer_(std::move(answer)) {}
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    return std::make_unique<answering_port>(answer_, now_ns_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return *now_ns_; }
  [[nodiscard]] bool pause(std::int64_t) noexcept override { return true; }
  void wake() noexcept override {}

 private:
  octets answer_;
  answering_port::clock now_ns_ = std::make_shared<std::int64_t>(1);
};

struct sample {
  const char* name;
  octets answer;  ///< To the question for the device information; empty: an echo.
  const char* like;
  const char* begin;
  const char* known = "";  ///< What the search and the doctor know about them.
};

octets answer_of_21_bytes() {
  octets all{0xA5, 0x5A, 0x12, 0x00, 0x00, 0x00, 0x04};
  all.resize(7 + 18, 0x01);
  return all;
}

octets text(std::string_view of) { return {of.begin(), of.end()}; }

const std::vector<sample>& samples() {
  static const std::vector<sample> all{
      {"AnotherLength", answer_of_21_bytes(), " like an answer of another length",
       "(A5 5A 12 00 00 00)"},
      {"Echo", {}, ", an echo of what was sent", "(A5 ", "Nothing arrives but what was sent"},
      {"Text", text("unknown command\r\n"), " of text", "(75 6E 6B 6E 6F 77)",
       "This is text, not the packets of a lidar"},
      {"OneByte", {0x15}, " byte", "(15"},
      {"Packet", {0xAA, 0x55, 0x00, 0x01, 0x02, 0x03}, " like damaged packets", "(AA 55 00"}};
  return all;
}

class BytesWithoutMeaning : public testing::TestWithParam<sample> {};

TEST_P(BytesWithoutMeaning, SearchReportsThem) {
  answering_port port(GetParam().answer);
  const auto found = search(port, 3'000'000'000);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error(), problem::garbage) << found.error().message();
  const std::string known = GetParam().known;
  EXPECT_EQ(found.error().detail() == error_detail::known_bytes, !known.empty());
  EXPECT_THAT(found.error().message(), HasSubstr(known));
  if (!known.empty()) return;
  EXPECT_THAT(found.error().message(), HasSubstr(GetParam().like));
  EXPECT_THAT(found.error().message(), HasSubstr(GetParam().begin));
  EXPECT_THAT(found.error().message(), HasSubstr("rates from 115200 to "));
}

TEST_P(BytesWithoutMeaning, NamedModelReportsThem) {
  const auto opened =
      lidar::open(std::make_unique<answering_connector>(GetParam().answer), {.model = &g4_model});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), problem::garbage) << opened.error().message();
  EXPECT_THAT(opened.error().message(), HasSubstr(GetParam().like));
  EXPECT_THAT(opened.error().message(), HasSubstr(GetParam().begin));
}

TEST_P(BytesWithoutMeaning, DoctorReportsThem) {
  const auto stages = diagnose(std::make_unique<answering_port>(GetParam().answer), {});
  std::string remarks;
  for (const stage_report& each : stages) remarks += each.remark + '\n';
  const std::string known = GetParam().known;
  EXPECT_THAT(remarks, HasSubstr(known));
  if (!known.empty()) return;
  EXPECT_THAT(remarks, HasSubstr(GetParam().like));
  EXPECT_THAT(remarks, HasSubstr(GetParam().begin));
}

INSTANTIATE_TEST_SUITE_P(Kinds, BytesWithoutMeaning, testing::ValuesIn(samples()),
                         [](const auto& of) { return std::string(of.param.name); });

/// Sends text at 115200 baud, which is noise at any other rate.
class text_port final : public answering_port {
 public:
  text_port() : answering_port(octets{0}) {}

  result<received> read(std::span<std::uint8_t> out,
                        std::int64_t /*deadline_ns*/) noexcept override {
    constexpr std::string_view text = "temperature 21.5\r\n";
    for (std::uint8_t& each : out.first(32)) {
      const std::size_t at = sent_++;
      each = baud() == 115'200 ? static_cast<std::uint8_t>(text[at % text.size()])
                               : static_cast<std::uint8_t>(0x80U | at * 37U);
    }
    static_cast<void>(pause(now_ns() + 3'000'000));
    return received{32, now_ns()};
  }

 private:
  std::size_t sent_ = 0;
};

TEST(UnrecognisedBytes, OfText_AreNamed) {
  text_port port;
  const auto found = search(port, port.now_ns() + 3'000'000'000, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error(), problem::garbage) << found.error().message();
  EXPECT_THAT(found.error().message(), HasSubstr("This is text, not the packets of a lidar"));
}

TEST(UnrecognisedBytes, AreCountedAndShownShortly) {
  unrecognised_bytes heard;
  EXPECT_EQ(std::string_view(heard.text()), "");
  heard.received(octets{0xC0});
  EXPECT_EQ(std::string_view(heard.text()), ", 1 byte (C0)");
  heard.received(octets(1'000'000, 0xF8));
  EXPECT_EQ(std::string_view(heard.text()), ", 1000001 bytes (C0 F8 F8 F8 F8 F8)");
  EXPECT_EQ(heard.count(), 1'000'001U);
}

}  // namespace
}  // namespace g4lidar::test
