// SPDX-License-Identifier: MIT
// Each problem is produced, and the error has the expected contents.
#include "g4lidar/error.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <iterator>
#include <set>
#include <string>
#include <type_traits>

#include "core/printable_text.hpp"
#include "scenario.hpp"

namespace g4lidar::test {

std::vector<scenario> all_scenarios() {
  std::vector<scenario> all = device_scenarios();
  for (auto more : {port_scenarios(), place_scenarios()}) {
    std::ranges::move(more, std::back_inserter(all));
  }
  return all;
}

namespace {

class Trouble : public testing::TestWithParam<scenario> {};

TEST_P(Trouble, HasTheExpectedContents) {
  const scenario& of = GetParam();
  const auto reported = of.bring_about();
  ASSERT_TRUE(reported) << "nothing went wrong";
  const std::string message = reported->message();
  SCOPED_TRACE(message);
  EXPECT_EQ(name_of(reported->code()), name_of(of.what));
  EXPECT_EQ(name_of(reported->doing()), name_of(of.doing));
  EXPECT_EQ(reported->is_fatal(), of.fatal);
  EXPECT_NE(reported->subject().find(of.subject), std::string_view::npos) << reported->subject();
  EXPECT_NE(message.find(reported->subject()), std::string::npos);
  EXPECT_TRUE(message.ends_with(reported->advice()));
  EXPECT_TRUE(message.starts_with(name_of(of.doing)));
  RecordProperty("message", message);
}

INSTANTIATE_TEST_SUITE_P(All, Trouble, testing::ValuesIn(all_scenarios()),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Error, EachProblemHasAScenario) {
  std::set<problem> brought_about;
  for (const scenario& of : all_scenarios()) brought_about.insert(of.what);
  for (std::size_t i = 0; i < problem_count; ++i) {
    const auto what = static_cast<problem>(i);
    EXPECT_TRUE(brought_about.contains(what)) << name_of(what);
  }
}

/// The message of a scenario.
std::string message_of(std::string_view name) {
  for (const scenario& of : all_scenarios()) {
    if (of.name == name) return of.bring_about().value().message();
  }
  return "no such scenario";
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

TEST(Text, OfATimeout_NamesWhatIsAwaited) {
  const std::string spins_up = message_of("NoScanYet");
  EXPECT_TRUE(has(spins_up, "the motor spins up")) << spins_up;
  EXPECT_TRUE(has(spins_up, "wait longer")) << spins_up;
  const std::string lost = message_of("LostAndLookedFor");
  EXPECT_TRUE(has(lost, "lost") && has(lost, "looking for it")) << lost;
  EXPECT_TRUE(has(lost, "Check the plug")) << lost;
  for (const std::string_view unplugged :
       {"LostAndLookedFor", "LostWhileWaitingForAScan", "UnpluggedWhileScanning"}) {
    EXPECT_FALSE(has(message_of(unplugged), "unplug the lidar")) << message_of(unplugged);
    EXPECT_FALSE(has(message_of(unplugged), "Unplug it")) << message_of(unplugged);
  }
}

TEST(Text, OfANameThatIsNone_ShowsWhatNamesLookLike) {
  for (const std::string_view name : {"NoSerialNumber", "NoAddress"}) {
    const std::string text = message_of(name);
    EXPECT_TRUE(has(text, "this does not name a lidar")) << text;
    for (const std::string_view form :
         {"/dev/ttyUSB0", "serial:", "usb:", "tcp:", "file:", "sim:"}) {
      EXPECT_TRUE(has(text, form)) << text;
    }
  }
  const std::string simulated = message_of("SimulatedWrongly");
  EXPECT_TRUE(has(simulated, "describes no simulated lidar")) << simulated;
  EXPECT_TRUE(has(simulated, "docs/sim.md")) << simulated;
}

TEST(Text, OfANamedPort_StatesThatItDoesNotExist_AndWhichDo) {
  const std::string port = message_of("AnotherPortExists");
  EXPECT_TRUE(has(port, "opening /dev/ttyNothing (ports: /dev/null): this port does not exist"))
      << port;
  EXPECT_FALSE(has(port, "no serial port with a lidar was found")) << port;
  const std::string file = message_of("NoSuchFile");
  EXPECT_TRUE(has(file, "opening no-such-walk.mcap: there is no port and no file of this name"))
      << file;
  EXPECT_TRUE(has(file, "ENOENT")) << file;
}

TEST(Text, OfANumberOrUsbPath_StatesThatNothingHasIt_AndWhichPortsExist) {
  for (const char* name : {"NothingAtThatPlace", "AnotherLidar"}) {
    const std::string all = message_of(name);
    EXPECT_TRUE(has(all, "): nothing that is attached has this number or USB path.")) << all;
    EXPECT_TRUE(has(all, " (ports: /dev/")) << all;
    EXPECT_FALSE(has(all, "no serial port with a lidar was found")) << all;
    EXPECT_FALSE(has(all, "name the port")) << all;
  }
}

TEST(Text, OfSilenceAndGarbage_NamesTheModelWhileItIsNotKnown) {
  for (const char* name :
       {"MuteDevice", "WrongBaudRateOfAnIdleDevice", "WrongBaudRateOfAScanningDevice"}) {
    const std::string text = message_of(name);
    EXPECT_TRUE(has(text, "virtual:g4, G4 (230400 baud)")) << text;
    EXPECT_TRUE(has(text, "--model") && has(text, "option")) << text;
  }
  const std::string known = message_of("DiesBeforeStart");
  EXPECT_TRUE(has(known, "no byte was received. The lidar answered before")) << known;
  EXPECT_FALSE(has(known, "--model") || has(known, "baud)")) << known;
}

TEST(Text, OfAValueThatTheModelDoesNotHave_NamesTheModelAndItsValues) {
  EXPECT_TRUE(has(message_of("FrequencyOutOfRange"), "15 Hz (5 Hz to 12 Hz of a G4): "));
}

TEST(Text, OfAnySubject_IsOneLineWithoutControls) {
  const error of(task::opening, problem::no_port, "/dev/a\nb\x1b[2J\x9b\xc2\x9b\x7f\xc3\xa4");
  EXPECT_EQ(of.subject(), "/dev/a\\x0Ab\\x1B[2J\\x9B\\xC2\\x9B\\x7F\xc3\xa4");
  // Nothing of an escape or a character is cut off.
  for (std::size_t size = 150; size < 170; ++size) {
    for (const std::string last : {"\n", "\xc3\xa4", "x"}) {
      const error cut(task::opening, problem::no_port, std::string(size, 'x') + last + "\n");
      const std::string text(cut.subject());
      EXPECT_LE(text.size(), 159U);
      const std::string rest = text.substr(std::min(size, text.size()));
      EXPECT_TRUE(rest.empty() || rest.starts_with("\\x0A") || rest.starts_with("\xc3\xa4") ||
                  rest.starts_with('x'))
          << size << rest;
    }
  }
}

TEST(Text, OfAWordForAModel_IsShort) {
  const auto given = lidar::open("/dev/ttyUSB0?model=a\nb" + std::string(300'000, 'x'));
  ASSERT_FALSE(given);
  EXPECT_EQ(given.error(), problem::bad_option);
  EXPECT_TRUE(has(std::string(given.error().subject()), R"(model: 'a\x0Abxxxxx)"))
      << given.error().subject();
  EXPECT_TRUE(has(std::string(given.error().subject()), "...' is not one of g4, g4-pro"))
      << given.error().subject();
}

TEST(Text, OfTooManyFiles_NamesTheLimit) {
  const error full(task::opening, problem::system, "/dev/ttyUSB0", EMFILE);
  EXPECT_TRUE(has(full.message(), "ulimit -n")) << full.message();
}

TEST(Text, OfAnErrorNumber_HasItsName_WhereTheCLibraryKnowsIt) {
  const errno_word name = [](int number) { return number == 2 ? "ENOENT" : nullptr; };
  const errno_word description = [](int number) {
    return number == 2 ? "No such file or directory" : nullptr;
  };
  EXPECT_EQ(errno_text(2, name, description), " (ENOENT, No such file or directory)");
  EXPECT_EQ(errno_text(3, name, description), "");
  EXPECT_EQ(errno_text(2, nullptr, nullptr), " (errno 2, No such file or directory)");
}

/// A message of the C interface has 255 characters for the cause and for the advice.
TEST(Text, OfEachDetail_FitsIntoTheCInterface) {
  for (auto detail = error_detail::usual; detail <= last_error_detail;
       detail = static_cast<error_detail>(static_cast<int>(detail) + 1)) {
    const error longest(task::configuring, problem::no_port, std::string(127, 'x'), 0, detail);
    EXPECT_LT(longest.advice().size(), 256U);
    EXPECT_LT(longest.message().size() - longest.advice().size(), 256U);
  }
}

}  // namespace
}  // namespace g4lidar::test
