// SPDX-License-Identifier: MIT
// What a survey of bytes finds in text, and that the commands which it names make the bytes again. The texts are made
// by the programs that people use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/command.hpp"
#include "survey/stream_survey.hpp"
#include "survey/streams.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Finding : public ::testing::Test {
 protected:
  Finding() {
    std::string name = ::testing::TempDir() + "finding-XXXXXX";
    directory_ = ::mkdtemp(name.data());
  }
  ~Finding() override { std::filesystem::remove_all(directory_); }

  void write(const std::string& name, const byte_list& content) const {
    std::ofstream(directory_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()),
               static_cast<std::streamsize>(content.size()));
  }
  [[nodiscard]] byte_list read(const std::string& name) const {
    std::ifstream in(directory_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] bool run(const std::string& command) const {
    const std::string line = "cd '" + directory_.string() + "' && " + command;
    return std::system(line.c_str()) == 0;
  }
  [[nodiscard]] static bool has(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
  }

  std::filesystem::path directory_;
};

std::string finding_of(const byte_list& all) {
  stream_survey seen;
  seen.received(all);
  seen.finish();
  return seen.finding();
}

/// What is between the backquotes.
std::string command_in(const std::string& text) {
  const std::size_t begin = text.find('`');
  return begin == std::string::npos ? ""
                                    : text.substr(begin + 1, text.find('`', begin + 1) - begin - 1);
}

struct text_form {
  std::string_view program;
  std::string_view command;  // makes FILE of BYTES
  std::string_view words;    // in the finding
  bool is_convertible;
};

constexpr std::string_view python =
    "python3 -c 'import json, sys; data = open(\"BYTES\", \"rb\").read(); ";

TEST_F(Finding, NamesFormsOfText_AndACommandThatMakesBytesOfThem) {
  const std::string literal = std::string(python) + "print(data)' > FILE";
  const std::string list = std::string(python) + "print(json.dumps(list(data)))' > FILE";
  const std::string member =
      std::string(python) + "print(json.dumps({\"data\": list(data)}, indent=1))' > FILE";
  const std::string colons = std::string(python) + "print(data.hex(\":\"))' > FILE";
  const std::string hyphens = std::string(python) + "print(data.hex(\"-\").upper())' > FILE";
  const std::string escapes =
      std::string(python) + "print(\"\".join(\"\\\\x%02x\" % b for b in data))' > FILE";
  const std::vector<text_form> forms{
      {"xxd", "xxd BYTES > FILE", "by xxd", true},
      {"xxd", "xxd -g1 BYTES > FILE", "by xxd", true},
      {"xxd", "xxd -p BYTES > FILE", "hexadecimal digits", true},
      {"xxd", "xxd -i BYTES > FILE", "numbers of C", true},
      {"xxd", "xxd -e BYTES > FILE", "in words", false},
      {"hexdump", "hexdump -C -v BYTES > FILE", "hexdump -C or od", true},
      {"hexdump", "hexdump BYTES > FILE", "in words", false},
      {"od", "od BYTES > FILE", "in words", false},
      {"od", "od -c BYTES > FILE", "in words", false},
      {"od", "od -A x -t x2 BYTES > FILE", "in words", false},
      {"od", "od -v -A x -t x1z BYTES > FILE", "hexdump -C or od", true},
      {"od", "od -v -t x1 BYTES > FILE", "hexdump -C or od", true},
      {"od", "od -v -A d -t x1 BYTES > FILE", "hexdump -C or od", true},
      {"od", "od -v -A n -t x1z BYTES > FILE", "hexdump -C or od", true},
      {"od", "od -v -A n -t x1 BYTES > FILE", "hexadecimal digits", true},
      {"python3", literal, "a literal of Python", true},
      {"python3", list, "decimal numbers", true},
      {"python3", member, "decimal numbers", true},
      {"python3", colons, "hexadecimal digits", true},
      {"python3", hyphens, "hexadecimal digits", true},
      {"python3", escapes, "in programs", false},
  };
  const byte_list all = stream_of(*model_named("x4"), sim::built_in_world(), 1, 4'000);
  write("BYTES", all);
  int tried = 0;
  for (const text_form& each : forms) {
    if (!has(std::string(each.program)) || !has("xxd") || !has("python3")) continue;
    ASSERT_TRUE(run(std::string(each.command))) << each.command;
    const std::string finding = finding_of(read("FILE"));
    EXPECT_THAT(finding, HasSubstr("This is text")) << each.command;
    EXPECT_THAT(finding, HasSubstr(std::string(each.words))) << each.command;
    ++tried;
    if (!each.is_convertible) {
      EXPECT_EQ(command_in(finding), "") << each.command;
      EXPECT_THAT(finding, HasSubstr("Record the bytes again")) << each.command;
      continue;
    }
    EXPECT_THAT(finding, Not(HasSubstr("\\"))) << "messages show it as two";
    std::filesystem::remove(directory_ / "NEW");
    EXPECT_TRUE(run(command_in(finding))) << finding;
    EXPECT_EQ(read("NEW"), all) << each.command << ": " << finding;
  }
  if (tried == 0) GTEST_SKIP() << "no program that makes dumps is installed";
}

// "*" stands for lines that are equal to the one before.
TEST_F(Finding, ADumpWithoutEqualLinesIsLost) {
  if (!has("od")) GTEST_SKIP() << "od is not installed";
  byte_list all = stream_of(*model_named("x4"), sim::built_in_world(), 1, 1'600);
  all.resize(3'200);
  write("BYTES", all);
  ASSERT_TRUE(run("od -A x -t x1z BYTES > FILE"));
  const std::string finding = finding_of(read("FILE"));
  EXPECT_THAT(finding, HasSubstr("without equal lines"));
  EXPECT_EQ(command_in(finding), "");
}

TEST_F(Finding, OfLatin1HasACommandThatMakesTheBytesAgain) {
  if (!has("iconv")) GTEST_SKIP() << "iconv is not installed";
  const byte_list all = stream_of(*model_named("x4"), sim::built_in_world(), 1, 8'192);
  write("BYTES", all);
  ASSERT_TRUE(run("iconv -f LATIN1 -t UTF-8 BYTES > FILE"));
  const std::string finding = finding_of(read("FILE"));
  EXPECT_THAT(finding, HasSubstr("Latin-1"));
  ASSERT_TRUE(run(command_in(finding))) << finding;
  EXPECT_EQ(read("NEW"), all);
}

TEST_F(Finding, OfOtherTextHasNoCommand) {
  for (const std::string_view text :
       {"Welcome to the console of this robot, build 2026-11-27.\nlogin: ",
        "time,x,y\n1.5,2.25,3.0\n1.6,2.3,3.1\n", "[2026-11-27 03:00] the lidar was started\n",
        "                    "}) {
    const std::string finding = finding_of({text.begin(), text.end()});
    EXPECT_EQ(finding, "This is text, not the packets of a lidar.") << text;
  }
}

struct conversation {
  stream_survey seen;
  void send(const std::vector<std::uint8_t>& data) { seen.sent(data); }
  void receive(std::string_view text) {
    const byte_list all(text.begin(), text.end());
    seen.received(all);
  }
};

TEST(Echo, OfWhatWasSentIsALoopBack) {
  conversation with;
  with.send({0xA5, 0x65});
  with.receive("\xA5\x65");
  EXPECT_EQ(with.seen.echo(), echo_kind::none) << "two bytes are few";
  with.send({0xA5, 0x90});
  with.receive("\xA5");
  with.receive("\x90");
  EXPECT_EQ(with.seen.echo(), echo_kind::loop_back);
  EXPECT_TRUE(with.seen.is_of_another());
  EXPECT_THAT(with.seen.finding(), HasSubstr("what was sent"));
}

TEST(Echo, OfCommandsOfWhichSomeWereLost) {
  conversation with;
  for (int i = 0; i < 3; ++i) with.send({0xA5, 0x65});
  with.send({0xA5, 0x90});
  with.receive("\xA5\x90");
  with.send({0xA5, 0x91});
  with.receive("\xA5\x91");
  EXPECT_EQ(with.seen.echo(), echo_kind::loop_back);
}

TEST(Echo, WithTextIsAConsole) {
  conversation with;
  with.receive("\r\nDebian GNU/Linux 12 robot ttyS0\r\n\r\nrobot login: ");
  with.send({0xA5, 0x65});
  with.receive("\xA5\x65");
  with.send({0xA5, 0x90});
  with.receive("\xA5\x90\r\nPassword: ");
  EXPECT_EQ(with.seen.echo(), echo_kind::console);
  EXPECT_TRUE(with.seen.is_of_another());
  EXPECT_THAT(with.seen.finding(), HasSubstr("console"));
}

TEST(Echo, IsNotAnAnswer) {
  conversation with;
  for (int i = 0; i < 4; ++i) {
    with.send({0xA5, 0x90});
    with.receive(std::string_view("\xA5\x5A\x14\x00\x00\x00\x04\x05\x02\x03\x03", 11));
    with.receive(std::string_view("\2\0\2\1\1\0\1\0\0\0\0\7\0\0\7\3", 16));
  }
  EXPECT_EQ(with.seen.echo(), echo_kind::none);
  EXPECT_EQ(with.seen.finding(), "");
}

}  // namespace
}  // namespace g4lidar::test
