// SPDX-License-Identifier: MIT
// The udev rules have the syntax of udev. If an udevadm that can verify them is installed, it
// verifies them, too.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

const std::filesystem::path rules = std::filesystem::path(G4LIDAR_SOURCE_DIR) / "packaging/udev";

struct term {
  std::string key;
  std::string how;
  std::string value;
};

std::vector<std::filesystem::path> files() {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(rules)) {
    if (entry.path().extension() == ".rules") found.push_back(entry.path());
  }
  return found;
}

/// The terms of a line, which must contain nothing else.
std::vector<term> terms_of(const std::string& line) {
  static const std::regex one(R"re(([A-Z]+(?:\{[A-Za-z_]+\})?)(==|!=|\+=|:=|=)"([^"]*)"(, |$))re");
  std::vector<term> terms;
  std::string rest = line;
  std::smatch match;
  while (std::regex_search(rest, match, one, std::regex_constants::match_continuous)) {
    terms.push_back({match[1], match[2], match[3]});
    rest = match.suffix();
  }
  EXPECT_EQ(rest, "") << line;
  return terms;
}

void expect_known(const term& one) {
  static const std::regex matched(R"((ACTION|KERNEL|SUBSYSTEM|ATTRS?\{.*\}|ENV\{.*\}))");
  static const std::regex assigned(R"((GROUP|MODE|TAG|SYMLINK|ENV\{.*\}|GOTO|LABEL))");
  const bool is_match = one.how == "==" || one.how == "!=";
  EXPECT_TRUE(std::regex_match(one.key, is_match ? matched : assigned)) << one.key;
  if (one.key == "TAG" || one.key == "SYMLINK") {
    EXPECT_EQ(one.how, "+=") << "the others' must stay";
  }
}

TEST(UdevRules, EveryLine_IsARule) {
  ASSERT_EQ(files().size(), 3U);
  for (const auto& path : files()) {
    SCOPED_TRACE(path.filename());
    std::ifstream file(path);
    std::set<std::string> wanted;
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line.starts_with('#')) continue;
      for (const term& one : terms_of(line)) {
        expect_known(one);
        if (one.key == "GOTO") wanted.insert(one.value);
        if (one.key == "LABEL") wanted.erase(one.value);
      }
    }
    EXPECT_TRUE(wanted.empty()) << "no label behind GOTO " << *wanted.begin();
  }
}

TEST(UdevRules, HaveWorkingNumbers) {
  // The rules of others between which they must be, sorted by name like udev does.
  EXPECT_TRUE(std::filesystem::exists(rules / "72-g4lidar.rules"));
  EXPECT_LT(std::string("72-g4lidar.rules"), "73-seat-late.rules");
  EXPECT_GT(std::string("72-g4lidar.rules"), "50-udev-default.rules");
  EXPECT_TRUE(std::filesystem::exists(rules / "91-g4lidar-no-brltty.rules"));
  EXPECT_GT(std::string("91-g4lidar-no-brltty.rules"), "90-brltty-usb-generic.rules");
}

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// They belong to many devices, so `cp packaging/udev/*.rules` and an installation must not take them.
TEST(UdevRules, OtherBridges_AreInAFileThatIsNotInstalled) {
  const std::string name = "72-g4lidar-other-bridges.rules";
  const std::string all = contents_of(rules / "examples" / name);
  for (const std::string_view part :
       {R"(ATTRS{idVendor}=="067b", ATTRS{idProduct}=="2303", GROUP="dialout", MODE="0660")",
        R"(ATTRS{idVendor}=="0483", ATTRS{idProduct}=="5740", GROUP="dialout", MODE="0660")"}) {
    EXPECT_NE(all.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(all.find("10c4"), std::string::npos);
  EXPECT_LT(name, "73-seat-late.rules");
  EXPECT_FALSE(std::filesystem::exists(rules / name));
  const auto source = std::filesystem::path(G4LIDAR_SOURCE_DIR);
  EXPECT_EQ(contents_of(rules / "72-g4lidar.rules").find("067b"), std::string::npos);
  EXPECT_EQ(contents_of(source / "cmake/install.cmake").find("rules.d/" + name), std::string::npos);
}

TEST(UdevRules, ContainThePromisedRules) {
  const std::string all = contents_of(rules / "72-g4lidar.rules");
  for (const std::string_view part :
       {R"(ATTRS{idVendor}=="10c4", ATTRS{idProduct}=="ea60")", R"(GROUP="dialout")",
        R"(MODE="0660")", R"(TAG+="uaccess")", R"(SYMLINK+="g4lidar-$id")",
        R"(ENV{ID_MM_DEVICE_IGNORE}="1")", R"(ENV{ID_MM_PORT_IGNORE}="1")"}) {
    EXPECT_NE(all.find(part), std::string::npos) << part;
  }
}

TEST(UdevRules, UdevadmVerifies) {
  if (std::system("udevadm verify --help >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "no udevadm that can verify (systemd 254 or later)";
  }
  for (const auto& path : files()) {
    EXPECT_EQ(std::system(("udevadm verify '" + path.string() + "'").c_str()), 0) << path;
  }
}

}  // namespace
