// SPDX-License-Identifier: MIT
// Which models are the same, and which of them report a number.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "g4lidar/core/model.hpp"

namespace g4lidar {
namespace {

TEST(ModelNumber, AnIdNamesAModelOnlyIfNoOtherOfItsKindUsesIt) {
  const auto word = [](std::uint8_t id, link_kind link) {
    const model* found = model_with_id(id, link);
    return found == nullptr ? std::string("none") : std::string(found->word);
  };
  using enum link_kind;
  EXPECT_EQ(word(5, two_way), "g4");
  EXPECT_EQ(word(151, two_way), "t-mini-plus");
  EXPECT_EQ(word(6, two_way), "x4");    // X4 Pro, X2, X3 use it, too, but they answer nothing
  EXPECT_EQ(word(6, one_way), "none");  // X4 Pro, X2, X3
  EXPECT_EQ(word(4, two_way), "none");  // F4 Pro, S4, S4B
  EXPECT_EQ(word(8, two_way), "f4-pro");
  EXPECT_EQ(word(11, two_way), "s4b");   // its second id
  EXPECT_EQ(word(12, one_way), "none");  // S2, S2 Pro
  EXPECT_EQ(word(22, one_way), "scl");
  EXPECT_EQ(word(22, two_way), "none");
  EXPECT_EQ(word(100, two_way), "tg15");
  EXPECT_EQ(word(100, one_way), "none");  // TX8, TX20
  EXPECT_EQ(word(0, two_way), "none");
  EXPECT_EQ(word(200, two_way), "none");
}

TEST(ModelNumber, IsTheSameByItsWord_AlsoWithOldFirmware) {
  const model& plus = *model_named("t-mini-plus");
  EXPECT_TRUE(plus == *model_named("t-mini-plus"));
  EXPECT_FALSE(plus == g4_model);
  for (const model& each : detail::old_models) EXPECT_TRUE(each == *model_named(each.word));
}

TEST(ModelNumber, HasTheNumbersOfItsDevices) {
  const model& f4_pro = *model_named("f4-pro");
  EXPECT_TRUE(f4_pro.has_number(8));
  EXPECT_TRUE(f4_pro.has_number(4));  // by its manual
  EXPECT_FALSE(f4_pro.has_number(5));
  EXPECT_FALSE(g4_model.has_number(0)) << "it has no other number";
}

}  // namespace
}  // namespace g4lidar
