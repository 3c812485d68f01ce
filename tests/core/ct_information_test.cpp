// SPDX-License-Identifier: MIT
// What the CT bytes of a revolution contain, and when they are not believed.
#include "g4lidar/core/ct_information.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "support/crc_reference.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar {
namespace {

/// The CT bytes of a revolution, from the scheme of the manual of the X4 Pro: 6.3 Hz, customer 24h, a
/// fault of the sensor, hardware 2, firmware 1.7, model 4, made on 2023-03-15, number 12345. Their CRC
/// is 93h. (The values and the CRC were computed by another program.)
std::vector<std::uint8_t> example() {
  return {0x7F, 0x48, 0x32, 0x02, 0x42, 0x0E, 0x00, 0x48, 0x00, 0x18, 0x30,
          0x78, 0xC0, 0x72, 0x56, 0x5C, 0xE8, 0x00, 0x00, 0x00, 0x00, 0x00};
}
constexpr std::uint8_t example_crc = 0x93;

using reference::crc_8_maxim;

struct stream {
  ct_information_reader reader;

  /// A packet of one sample; a zero packet if bit 0 of `ct` is set.
  bool packet(std::uint8_t ct) {
    const made::packet made(ct, 0, 0, 1);
    return reader.add(made.view());
  }
  void noise(std::uint8_t byte, std::size_t count = 1) {
    reader.add(skipped{.count = count, .reason = skip_reason::noise, .last = byte});
  }
  /// A revolution, the byte behind it, and the next zero packet. Whether it is believed.
  bool revolution(const std::vector<std::uint8_t>& ct, std::uint8_t crc) {
    for (const std::uint8_t each : ct) EXPECT_FALSE(packet(each));
    noise(crc);
    return packet(1);
  }
};

TEST(CtInformation, TheExampleIsRead) {
  stream of;
  ASSERT_EQ(crc_8_maxim(example()), example_crc);
  ASSERT_TRUE(of.revolution(example(), example_crc));
  const ct_information& found = *of.reader.last();
  EXPECT_EQ(found.customer, 0x24);
  EXPECT_EQ(found.faults, ct_faults::sensor);
  EXPECT_EQ(found.hardware, 2);
  EXPECT_EQ(found.firmware_major, 1);
  EXPECT_EQ(found.firmware_minor, 7);
  EXPECT_EQ(found.id_low_bits, 4);
  EXPECT_EQ(std::string(found.serial_digits.begin(), found.serial_digits.end()),
            "2023031500012345");
}

TEST(CtInformation, TheUpperBitsOfTheNumberAreInTheDate) {
  std::vector<std::uint8_t> ct = example();
  ct[9] = static_cast<std::uint8_t>((5U << 2U | 2U) << 1U);  // 2025, bit 20
  ct[10] = static_cast<std::uint8_t>((12U << 3U | 5U) << 1U);
  ct[11] = static_cast<std::uint8_t>((31U << 2U | 1U) << 1U);
  ct[12] = 0;
  ct[13] = 2;
  stream of;
  ASSERT_TRUE(of.revolution(ct, crc_8_maxim(ct)));
  // 2^20 + 5 * 2^16 + 2^14 + 1
  EXPECT_EQ(
      std::string(of.reader.last()->serial_digits.begin(), of.reader.last()->serial_digits.end()),
      "2025123101392641");
}

TEST(CtInformation, WithoutTheRightCrcItIsNotBelieved) {
  stream of;
  EXPECT_FALSE(of.revolution(example(), example_crc ^ 1U));
  EXPECT_FALSE(of.reader.last());
}

TEST(CtInformation, ARevolutionThatWasNotReceivedFromItsBeginIsNotBelieved) {
  const std::vector<std::uint8_t> ct = example();
  stream of;
  EXPECT_FALSE(of.revolution({ct.begin() + 1, ct.end()}, example_crc));
}

TEST(CtInformation, DamageInTheRevolutionIsNotBelieved) {
  std::vector<std::uint8_t> ct = example();
  stream noisy;
  for (std::size_t i = 0; i < ct.size(); ++i) {
    if (i == 5) noisy.noise(0x55);
    EXPECT_FALSE(noisy.packet(ct[i]));
  }
  noisy.noise(example_crc);
  EXPECT_FALSE(noisy.packet(1));

  stream torn;
  for (const std::uint8_t each : ct) EXPECT_FALSE(torn.packet(each));
  torn.reader.add(skipped{.count = 1, .reason = skip_reason::bad_checksum, .last = example_crc});
  EXPECT_FALSE(torn.packet(1));
}

// A G4 has zeros in all CT bytes but that of the zero packet: its stray byte fits by chance.
TEST(CtInformation, ZerosNameNoModel) {
  std::vector<std::uint8_t> ct(30, 0);
  ct[0] = 0x8D;
  stream of;
  EXPECT_FALSE(of.revolution(ct, crc_8_maxim(ct)));
}

// One value in all others, as old devices send 86h, would be model 3, made on 2036-08-16.
TEST(CtInformation, OneValueInAllPacketsNamesNoModel) {
  std::vector<std::uint8_t> ct(30, 0x86);
  ct[0] = 0x8D;
  stream of;
  EXPECT_FALSE(of.revolution(ct, crc_8_maxim(ct)));
}

TEST(CtInformation, AnImpossibleDateIsNotBelieved) {
  for (const unsigned month : {0U, 13U, 15U}) {
    std::vector<std::uint8_t> ct = example();
    ct[10] = static_cast<std::uint8_t>(month << 4U);
    stream of;
    EXPECT_FALSE(of.revolution(ct, crc_8_maxim(ct))) << month;
  }
  std::vector<std::uint8_t> ct = example();
  ct[11] = 0;
  stream of;
  EXPECT_FALSE(of.revolution(ct, crc_8_maxim(ct)));
}

// The places of the fields are those of the manual: the fault in packet 3, hardware and firmware in 4 and 5, the
// number of the model in 7, the date in 9 to 11, the serial number to 13.
TEST(CtInformation, ARevolutionWithFewPackets_HasItsFirstFields) {
  const std::vector<std::uint8_t> all = example();
  for (std::size_t count = 4; count <= all.size(); ++count) {
    SCOPED_TRACE(count);
    const std::vector<std::uint8_t> ct(all.begin(),
                                       all.begin() + static_cast<std::ptrdiff_t>(count));
    const bool has_date = count > 11;
    stream of;
    EXPECT_EQ(of.revolution(ct, crc_8_maxim(ct)), has_date);
    // The zero packet that ended the revolution begins the next one.
    const std::vector<std::uint8_t> next(ct.begin() + 1, ct.end());
    std::vector<std::uint8_t> sent = ct;
    sent[0] = 1;
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(of.reader.last().has_value(), has_date) << i;
      of.revolution(next, crc_8_maxim(sent));
    }
    ASSERT_TRUE(of.reader.last()) << "the third CRC in a row";
    const ct_information& found = *of.reader.last();
    EXPECT_TRUE(found.has_faults);
    EXPECT_EQ(found.faults, ct_faults::sensor);
    EXPECT_EQ(found.has_firmware, count > 5);
    EXPECT_EQ(found.hardware, count > 5 ? 2 : 0);
    EXPECT_EQ(found.firmware_major, count > 5 ? 1 : 0);
    EXPECT_EQ(found.firmware_minor, count > 5 ? 7 : 0);
    EXPECT_EQ(found.id_low_bits, count > 7 ? 4 : 0);
    EXPECT_EQ(found.has_serial, count > 13);
    const device_information who = information_of(found, *model_named("x4-pro"));
    EXPECT_EQ(who.is_known(), count > 7);
    EXPECT_EQ(who.serial_number(), count > 13 ? "2023031500012345" : "0000000000000000");
    EXPECT_EQ(who.has_serial_number(), count > 13);
  }
}

TEST(CtInformation, ZeroPacketsOneAfterTheOther_AreNotBelieved) {
  stream of;
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(of.revolution({}, 1)) << i;
  EXPECT_FALSE(of.reader.last());
}

// A long revolution had the serial number, shorter ones do not.
TEST(CtInformation, WhatWasStatedStays) {
  stream of;
  ASSERT_TRUE(of.revolution(example(), example_crc));
  std::vector<std::uint8_t> ct = example();
  ct.resize(12);
  ct[0] = 1;
  ct[3] = 0;
  ct[5] = 2 * 8;
  EXPECT_TRUE(of.revolution({ct.begin() + 1, ct.end()}, crc_8_maxim(ct)));
  const ct_information& found = *of.reader.last();
  EXPECT_EQ(found.faults, ct_faults::none);
  EXPECT_EQ(found.firmware_minor, 8);
  const device_information who = information_of(found, *model_named("x2"));
  EXPECT_EQ(who.serial_number(), "2023031500012345");
}

// The date of a device that does not state it is not possible; everything else is.
TEST(CtInformation, WithoutADate_TheOtherFieldsNeedThreeRevolutions) {
  std::vector<std::uint8_t> ct = example();
  ct[9] = ct[10] = ct[11] = 0;
  ct[0] = 1;
  stream of;
  EXPECT_FALSE(of.revolution(ct, crc_8_maxim(ct)));
  const std::vector<std::uint8_t> next(ct.begin() + 1, ct.end());
  EXPECT_FALSE(of.revolution(next, crc_8_maxim(ct)));
  EXPECT_FALSE(of.revolution(next, crc_8_maxim(ct) ^ 1U)) << "from here on they count again";
  EXPECT_FALSE(of.revolution(next, crc_8_maxim(ct)));
  EXPECT_FALSE(of.revolution(next, crc_8_maxim(ct)));
  EXPECT_TRUE(of.revolution(next, crc_8_maxim(ct)));
  EXPECT_EQ(of.reader.last()->id_low_bits, 4);
  EXPECT_FALSE(of.reader.last()->has_serial);
}

TEST(CtInformation, TheLastOneStays) {
  stream of;
  ASSERT_TRUE(of.revolution(example(), example_crc));
  const ct_information first = *of.reader.last();
  // The zero packet that ended the first revolution begins the second one.
  std::vector<std::uint8_t> ct = example();
  EXPECT_FALSE(of.revolution(ct, 0));
  EXPECT_EQ(*of.reader.last(), first);
}

}  // namespace
}  // namespace g4lidar
