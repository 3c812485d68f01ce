// SPDX-License-Identifier: MIT
// What a device, a file or a name brings along must not reach a terminal or a log unescaped, whichever verb
// shows it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "escapes.hpp"
#include "program.hpp"
#include "recorded.hpp"
#include "recording.hpp"
#include "simulator.hpp"
#include "stubborn_device.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using words = std::vector<std::string>;

// ESC [ 2 J clears a screen; 0x9B is the same begin in one byte, and C2 9B in UTF-8. 16 bytes.
const std::string evil = "\x1b[2J\x9b\x31m\xc2\x9b\x33m\a\r\x7f\xff\xfe";

class Escaping : public cli::scratch {
 protected:
  static outcome expect_plain(const words& arguments) {
    const outcome done = run(arguments);
    EXPECT_EQ(cli::unescaped_in(done.out), "") << arguments[0] << " writes " << done.out;
    EXPECT_EQ(cli::unescaped_in(done.err), "") << arguments[0] << " writes " << done.err;
    EXPECT_FALSE((done.out + done.err).empty()) << arguments[0];
    EXPECT_NE(done.code, 11) << done.err;
    return done;
  }
  /// Everything that shows something of a recording.
  void expect_plain_recording(const std::string& name) {
    for (const words& arguments :
         {words{"dump", name, "-n", "10", "-v"},
          {"dump", name, "-n", "10", "-f", "csv"},
          {"scan", name, "-f", "jsonl"},
          {"scan", name, "-f", "csv"},
          {"packets", name},
          {"info", name},
          {"info", name, "--json"},
          {"stats", name},
          {"stats", name, "--json"},
          {"doctor", name},
          {"doctor", name, "--json"},
          {"replay", name, "--playback-speed", "max", "-v"},
          {"replay", "--verify", name},
          {"convert", name, path("out.csv"), "-v"},
          {"record", name, "-o", path("again" + evil + ".mcap"), "--force"},
          {"health", name, "--json-errors"}}) {
      expect_plain(arguments);
    }
  }
};

TEST_F(Escaping, NamesAndBytesOfAFile) {
  const std::string raw = path("a" + evil + ".bin");
  cli::write_file(raw, "boot " + evil + " text " + cli::zero(0) + cli::turn() + cli::zero(0));
  expect_plain({"dump", raw});
  expect_plain({"scan", raw, "--partial"});
  expect_plain({"packets", raw});
  expect_plain({"packets", raw, "--hex"});
  expect_plain({"packets", raw, "--errors"});
  expect_plain({"stats", raw});
  expect_plain({"doctor", raw});
  expect_plain({"doctor", raw, "--json"});
  expect_plain({"dump", path("none" + evil)});
  expect_plain({"dump", "sim:?" + evil + "=1"});
  expect_plain({"dump", "sim:?world=" + path("none" + evil)});
  expect_plain({"--json-errors", "dump", path("none" + evil)});
  expect_plain({"convert", raw, path("out" + evil)});
  expect_plain({"sim", "--seconds", "1", "-o", path("no" + evil + "/x")});
  expect_plain({evil});
  expect_plain({"dump", "--" + evil});
  expect_plain({"set", "sim:", evil + "=1"});
  const std::string recording = path("b" + evil + ".mcap");
  expect_plain({"record", raw, "-o", recording});
  expect_plain_recording(recording);
  // The name is in the recording, too, and seen when another file plays it.
  std::filesystem::rename(recording, path("plain.mcap"));
  expect_plain_recording(path("plain.mcap"));
  EXPECT_THAT(run({"packets", path("plain.mcap")}).out, HasSubstr(R"(\x1B[2J)"));
}

TEST_F(Escaping, WordsOfTheCommandLine_AreOneShortLine) {
  const std::string long_word(100'000, 'x');
  for (const words& arguments : {words{"scan", "sim:", "--model"},
                                 {"scan", "sim:", "--baud"},
                                 {"scan", "sim:", "-f"},
                                 {"scan"},
                                 {"dump", "sim:", "--fov"},
                                 {"sim", "--device"},
                                 {"sim", "--fault"},
                                 {}}) {
    for (const std::string& word :
         std::vector<std::string>{"a\nb=" + long_word, "a\nb", "sim:?model=a\nb" + long_word,
                                  "tcp:a\nb" + long_word + ":1"}) {
      words all = arguments;
      all.push_back(word);
      const outcome done = run(all);
      EXPECT_EQ(cli::unescaped_in(done.err), "") << done.err;
      EXPECT_LT(done.err.size(), 3000U) << done.err.substr(0, 500);
      EXPECT_EQ(std::ranges::count(done.err, '\n'), 1) << done.err.substr(0, 500);
      EXPECT_NE(done.code, 0);
    }
  }
}

TEST_F(Escaping, TextsOfPoints) {
  cli::write_file(path("p.csv"), "angle_deg,range_mm," + evil + "\n1,1000," + evil + "\n" + evil +
                                     "\n2,2000,\"" + evil + "\"\n");
  cli::write_file(path("p.jsonl"),
                  "{\"angle_deg\":1,\"range_mm\":1000,\"name\":\"" + evil + "\"}\n" + evil + "\n");
  for (const std::string name : {"p.csv", "p.jsonl"}) {
    for (const std::string to : {"csv", "jsonl"}) {
      const outcome done = expect_plain({"convert", path(name), "-", "--to-format", to});
      EXPECT_THAT(done.out, HasSubstr("1000"));
    }
  }
}

// The settings and the serial number in the metadata of a recording: 16 bytes for 16 digits.
TEST_F(Escaping, TheSerialNumberOfARecording) {
  ASSERT_EQ(evil.size(), 16U);
  ASSERT_EQ(cli::record_scans(path("walk.mcap"), 1).code, 0);
  std::string file = cli::read_file(path("walk.mcap"));
  const std::string digits = "2021101000070073";
  std::size_t places = 0;
  for (std::size_t at = 0; (at = file.find(digits, at)) != std::string::npos; ++places) {
    file.replace(at, digits.size(), evil);
  }
  ASSERT_GE(places, 1U);
  cli::write_file(path("evil.mcap"), file);
  expect_plain_recording(path("evil.mcap"));
}

// A byte of the serial number is a digit, 0 to 9; '0' and this byte would be a control character.
TEST_F(Escaping, TheSerialNumberOfADevice) {
  std::string answer = cli::device_information();
  for (std::size_t i = 0; i < evil.size(); ++i) answer[11 + i] = static_cast<char>(evil[i] - '0');
  const cli::stubborn_device device(answer);
  for (const words& arguments :
       {words{"info", device.path()}, {"packets", device.path(), "--json-errors"}}) {
    EXPECT_NE(expect_plain(arguments).code, 0) << arguments[0] << " takes it for a G4";
  }
}

TEST_F(Escaping, TheModelOfADevice) {
  std::string answer = cli::device_information();
  answer[7] = '\x1b';
  const cli::stubborn_device device(answer);
  // A number that no model has is no error; it is printed as a number.
  EXPECT_EQ(expect_plain({"info", device.path()}).code, 0);
  EXPECT_NE(expect_plain({"packets", device.path()}).code, 0) << "it sends none";
}

TEST_F(Escaping, TheBootTextOfADevice) {
  const cli::stubborn_device device(evil + "\r\n\x1b]0;title\a" + cli::device_information());
  const outcome info = expect_plain({"info", device.path()});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("2021101000070073"));
  const outcome packets = expect_plain({"packets", device.path(), "-n", "7"});
  EXPECT_THAT(packets.out, HasSubstr("1B 5B 32 4A")) << "its bytes are shown in digits";
}

TEST_F(Escaping, TheNameOfAPort) {
  const std::string port = path("g4" + evil);
  cli::simulator simulator(port);
  for (const words& arguments : {words{"info", port},
                                 {"info", port, "--json"},
                                 {"health", port, "-v"},
                                 {"set", port, "frequency=8"},
                                 {"start", port},
                                 {"stop", port},
                                 {"restart", port},
                                 {"stats", port, "-n", "1"},
                                 {"dump", port, "-n", "1", "-v"},
                                 {"scan", port, "-n", "1", "-f", "csv"},
                                 {"packets", port, "-d", "300ms"},
                                 {"doctor", port, "-d", "100ms", "--json"},
                                 {"record", port, "-n", "1", "-o", path("walk.mcap"), "-v"}}) {
    EXPECT_EQ(expect_plain(arguments).code, 0) << arguments[0];
  }
  cli::program holder({"dump", port});
  holder.read_until("\n");
  EXPECT_EQ(expect_plain({"info", port}).code, 5);
  EXPECT_EQ(expect_plain({"info", port, "--json-errors"}).code, 5);
  expect_plain({"doctor", port, "--json"});
  expect_plain({"sim", "--link", port});
  EXPECT_EQ(cli::unescaped_in(simulator.log()), "") << "what the simulator prints";
}

}  // namespace
