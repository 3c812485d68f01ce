// SPDX-License-Identifier: MIT
// Responses on the wire: every header of the protocol, every limit of their contents, their
// meaning.
#include "g4lidar/core/response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "support/packet_bytes.hpp"

namespace g4lidar {
namespace {

using test::append;
using test::buffer;
using test::response_bytes;

constexpr std::array<std::uint8_t, 7> scan_header{0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
constexpr std::array<std::uint8_t, 27> device_info{
    0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04, 0x05, 0x02, 0x03, 0x03, 0x02, 0x00, 0x02,
    0x01, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x07, 0x03};
constexpr std::array<std::uint8_t, 10> healthy{0xA5, 0x5A, 0x03, 0x00, 0x00,
                                               0x00, 0x06, 0x00, 0x00, 0x00};
constexpr std::array<std::uint8_t, 8> one_byte{0xA5, 0x5A, 0x01, 0x00, 0x00, 0x00, 0x04, 0x02};
constexpr std::array<std::uint8_t, 11> seven_hz{0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00,
                                                0x04, 0xBC, 0x02, 0x00, 0x00};

constexpr wire_check valid(std::size_t size) { return {wire_state::valid, size}; }
constexpr wire_check incomplete(std::size_t size) { return {wire_state::incomplete, size}; }
constexpr wire_check bad_header(std::size_t size) { return {wire_state::bad_header, size}; }

static_assert(std::is_trivially_copyable_v<response_view>);

// ---- The protocol's examples at compile time ---------------------------------------------------
static_assert(check_response(scan_header) == valid(7), "its length field is 5: to be ignored");
static_assert(response_view::from(scan_header)->kind() == response_kind::scan_started);
static_assert(response_view::from(scan_header)->mode() == response_mode::continuous);
static_assert(response_view::from(scan_header)->type_code() == 0x81);
static_assert(response_view::from(scan_header)->content().empty());

static_assert(check_response(device_info) == valid(27));
static_assert(response_view::from(device_info)->kind() == response_kind::device_info);
static_assert(response_view::from(device_info)->mode() == response_mode::single);
static_assert(response_view::from(device_info)->type_code() == 0x04);
static_assert(response_view::from(device_info)->content().size() == 0x14);

constexpr device_information info = *response_view::from(device_info)->as_device_info();
static_assert(info.model == model_g4);
static_assert(info.firmware_major == 3 && info.firmware_minor == 2);
static_assert(info.hardware == 3);
static_assert(info.serial_number() == "2021101000070073");

static_assert(response_view::from(healthy)->kind() == response_kind::health);
static_assert(response_view::from(healthy)->type_code() == 0x06);
static_assert(response_view::from(healthy)->as_health() == health{health_status::ok, 0});
static_assert(response_view::from(one_byte)->kind() == response_kind::byte);
static_assert(response_view::from(one_byte)->as_byte() == 2);
static_assert(response_view::from(seven_hz)->kind() == response_kind::frequency);
static_assert(response_view::from(seven_hz)->as_frequency_chz() == 700);

TEST(Response, TheManualsHeaders) {
  struct example {
    const char* what;
    buffer reply;
    std::uint8_t length, type;
    response_mode mode;
    response_kind kind;
  };
  const example examples[] = {
      {"scan",
       {scan_header.begin(), scan_header.end()},
       0x05,
       0x81,
       response_mode::continuous,
       response_kind::scan_started},
      {"device information",
       {device_info.begin(), device_info.end()},
       0x14,
       0x04,
       response_mode::single,
       response_kind::device_info},
      {"health",
       {healthy.begin(), healthy.end()},
       3,
       0x06,
       response_mode::single,
       response_kind::health},
      {"one byte",
       {one_byte.begin(), one_byte.end()},
       1,
       0x04,
       response_mode::single,
       response_kind::byte},
      {"frequency",
       {seven_hz.begin(), seven_hz.end()},
       4,
       0x04,
       response_mode::single,
       response_kind::frequency},
  };
  for (const example& e : examples) {
    const auto reply = response_view::from(e.reply);
    ASSERT_TRUE(reply) << e.what;
    EXPECT_EQ(reply->kind(), e.kind) << e.what;
    EXPECT_EQ(reply->mode(), e.mode) << e.what;
    EXPECT_EQ(reply->type_code(), e.type) << e.what;
    EXPECT_EQ(e.reply[2], e.length) << e.what;
    EXPECT_EQ(reply->data().data(), e.reply.data()) << "seen where it lies";
    EXPECT_EQ(reply->content().size(), e.reply.size() - 7) << e.what;
    // Each query is answered by one kind of response only.
    EXPECT_EQ(reply->as_device_info().has_value(), e.kind == response_kind::device_info) << e.what;
    EXPECT_EQ(reply->as_health().has_value(), e.kind == response_kind::health) << e.what;
    EXPECT_EQ(reply->as_byte().has_value(), e.kind == response_kind::byte) << e.what;
    EXPECT_EQ(reply->as_frequency_chz().has_value(), e.kind == response_kind::frequency) << e.what;
  }
}

TEST(Response, TheDeviceInformationOfTheProtocol) {
  const auto reply = response_view::from(device_info);
  ASSERT_TRUE(reply);
  const auto found = reply->as_device_info();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->model, 5);
  EXPECT_EQ(found->firmware_major, 3) << "the third byte on the wire, not the second";
  EXPECT_EQ(found->firmware_minor, 2);
  EXPECT_EQ(found->hardware, 3);
  EXPECT_EQ(found->serial_number(), "2021101000070073");
  EXPECT_EQ(*found, info);
}

TEST(Response, EveryPrefix_IsIncomplete) {
  for (const bytes whole :
       {bytes(scan_header), bytes(device_info), bytes(healthy), bytes(one_byte), bytes(seven_hz)}) {
    for (std::size_t have = 0; have < whole.size(); ++have) {
      EXPECT_EQ(check_response(whole.first(have)), incomplete(have + 1)) << have;
      EXPECT_FALSE(response_view::from(whole.first(have)));
    }
    buffer longer(whole.begin(), whole.end());
    longer.push_back(0xA5);
    EXPECT_EQ(check_response(longer), valid(whole.size())) << "what follows changes nothing";
    EXPECT_FALSE(response_view::from(longer)) << "a view is of one reply, no more";
  }
}

TEST(Response, EachByteOfAHeader_IsChecked) {
  // Every value of every byte of every header: only the five are valid.
  const bytes replies[] = {scan_header, device_info, healthy, one_byte, seven_hz};
  for (const bytes whole : replies) {
    for (std::size_t at = 0; at < 7; ++at) {
      for (unsigned value = 0; value < 256; ++value) {
        buffer data(whole.begin(), whole.end());
        data[at] = static_cast<std::uint8_t>(value);
        // The content of another response may follow by chance: check the header alone.
        const bytes header = bytes(data).first(7);
        bool exists = false;
        for (const bytes other : replies) {
          exists = exists || std::equal(header.begin(), header.end(), other.begin());
        }
        const wire_check check = check_response(header);
        EXPECT_EQ(check.state != wire_state::bad_header, exists) << at << " " << value;
        if (!exists) {
          EXPECT_EQ(check_response(data), check);
          EXPECT_FALSE(response_view::from(data));
        }
      }
    }
  }
}

TEST(Response, Header_IsRefusedAtTheFirstImpossibleByte) {
  EXPECT_EQ(check_response(buffer{0xA4}), bad_header(1));
  EXPECT_EQ(check_response(buffer{0xA5, 0xA5}), bad_header(2));
  EXPECT_EQ(check_response(buffer{0xA5, 0x5A, 0x02}), bad_header(3));
  EXPECT_EQ(check_response(buffer{0xA5, 0x5A, 0x14, 0x01}), bad_header(4));
  EXPECT_EQ(check_response(buffer{0xA5, 0x5A, 0x14, 0x00, 0x01}), bad_header(5));
  for (const int top : {0x40, 0x80, 0xC0, 0x01}) {
    EXPECT_EQ(check_response(buffer{0xA5, 0x5A, 0x14, 0, 0, static_cast<std::uint8_t>(top)}),
              bad_header(6))
        << top;
  }
  for (const int top : {0x00, 0x80, 0xC0, 0x41}) {
    EXPECT_EQ(check_response(buffer{0xA5, 0x5A, 0x05, 0, 0, static_cast<std::uint8_t>(top)}),
              bad_header(6))
        << top;
  }
  EXPECT_EQ(check_response(response_bytes(0x14, 0, 0x06, {})), bad_header(7));
  EXPECT_EQ(check_response(response_bytes(0x03, 0, 0x04, {})), bad_header(7));
  EXPECT_EQ(check_response(response_bytes(0x01, 0, 0x06, {})), bad_header(7));
  EXPECT_EQ(check_response(response_bytes(0x05, 0x40, 0x04, {})), bad_header(7));
}

TEST(Response, ByteContent_Is0To2) {
  for (unsigned value = 0; value < 256; ++value) {
    const auto data = response_bytes(1, 0, 4, {static_cast<std::uint8_t>(value)});
    EXPECT_EQ(check_response(data), value <= 2 ? valid(8) : bad_header(8)) << value;
    EXPECT_EQ(check_response(data, false, 4), value <= 4 ? valid(8) : bad_header(8)) << value;
    if (value <= 2) {
      EXPECT_EQ(response_view::from(data)->as_byte(), value);
    }
  }
}

TEST(Response, Frequency_IsAtMost2000) {
  for (unsigned value = 0; value < 65536; ++value) {
    const auto low = static_cast<std::uint8_t>(value % 256);
    const auto high = static_cast<std::uint8_t>(value / 256);
    const auto data = response_bytes(4, 0, 4, {low, high, 0, 0});
    ASSERT_EQ(check_response(data), value <= 2000 ? valid(11) : bad_header(9)) << value;
    if (value <= 2000) {
      ASSERT_EQ(response_view::from(data)->as_frequency_chz(), value);
    }
  }
  EXPECT_EQ(check_response(response_bytes(4, 0, 4, {0, 0, 1, 0})), bad_header(10));
  EXPECT_EQ(check_response(response_bytes(4, 0, 4, {0, 0, 0, 1})), bad_header(11));
}

TEST(Response, HealthStatus_Is0To2_AnyErrorCode) {
  for (unsigned status = 0; status < 256; ++status) {
    const auto data = response_bytes(3, 0, 6, {static_cast<std::uint8_t>(status), 0xCD, 0xAB});
    EXPECT_EQ(check_response(data), status <= 2 ? valid(10) : bad_header(8)) << status;
    if (status <= 2) {
      const health wanted{static_cast<health_status>(status), 0xABCD};
      EXPECT_EQ(response_view::from(data)->as_health(), wanted);
    }
  }
}

TEST(Response, SerialNumber_IsDigits_OtherInformationIsAnything) {
  for (std::size_t at = 0; at < 20; ++at) {
    for (unsigned value = 0; value < 256; ++value) {
      buffer data(device_info.begin(), device_info.end());
      data[7 + at] = static_cast<std::uint8_t>(value);
      const bool possible = at < 4 || value <= 9;
      EXPECT_EQ(check_response(data), possible ? valid(27) : bad_header(8 + at)) << at;
    }
  }
}

TEST(Response, ImpossibleContent_IsRefusedAtItsFirstByte) {
  buffer data(device_info.begin(), device_info.end());
  data[20] = 10;
  for (std::size_t have = 0; have <= data.size(); ++have) {
    EXPECT_EQ(check_response(bytes(data).first(have)),
              have <= 20 ? incomplete(have + 1) : bad_header(21))
        << have;
  }
}

}  // namespace
}  // namespace g4lidar
