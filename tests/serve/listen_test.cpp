// SPDX-License-Identifier: MIT
// How g4-serve meets requests: many unfinished ones, other methods, foreign pages, and the addresses it names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "host_guard.hpp"
#include "server.hpp"

namespace {

using serve::page;
using serve::raw_client;
using serve::Server;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Listening : public Server {
 protected:
  std::string errors() const { return cli::read_file(path("err")); }
  std::string ask(const std::string& method) const {
    raw_client client(port_);
    client.send(method + " / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    return client.read_to_end().value_or("no end");
  }
};

TEST_F(Listening, UnfinishedRequests_KeepOutNobody) {
  begin();
  std::vector<raw_client> held;
  for (const std::size_t count : {34U, 94U, 154U, 214U, 274U}) {
    while (held.size() < count) {
      held.emplace_back(port_);
      held.back().send("GET / HTTP/1.1\r\nHost: localhost\r\n");
    }
    EXPECT_THAT(raw_client(port_).get("/status.json"), StartsWith("HTTP/1.1 200")) << count;
    EXPECT_TRUE(gets_scans(*open_page(), 1)) << count;
  }
}

TEST_F(Listening, UnfinishedRequests_AreBounded) {
  begin();
  std::vector<raw_client> held;
  while (held.size() < 200) {
    held.emplace_back(port_);
    held.back().send("GET / HTTP/1.1\r\nHost: localhost\r\n");
  }
  EXPECT_THAT(raw_client(port_).get("/status.json"), StartsWith("HTTP/1.1 200"));
  const auto ended = std::ranges::count_if(held, [](raw_client& each) { return each.has_ended(); });
  EXPECT_GE(ended, 200 - 60) << "the server accepts them in their order";
}

TEST_F(Listening, Head_HasTheHeadersOnly) {
  begin();
  const std::string head = ask("HEAD");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK\r\n"));
  const std::string whole = ask("GET");
  const std::size_t size = whole.size() - whole.find("\r\n\r\n") - 4;
  EXPECT_THAT(head, HasSubstr("content-length: " + std::to_string(size) + "\r\n"));
  EXPECT_EQ(head.find("\r\n\r\n") + 4, head.size());
  // The connection stays usable.
  raw_client client(port_);
  client.send("HEAD /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(client.get("/status.json"), StartsWith("HTTP/1.1 200"));
}

TEST_F(Listening, OtherMethods_LearnWhichAreAllowed) {
  begin();
  const std::string answer = ask("DELETE");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(answer, HasSubstr("allow: GET, HEAD\r\n"));
}

TEST_F(Listening, RefusedPages_AreLoggedOnce) {
  begin();
  const std::string foreign = "Host: localhost\r\nOrigin: https://app.foxglove.dev\r\n";
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(raw_client(port_).upgrade("foxglove.sdk.v1", foreign),
                HasSubstr(" 403 Forbidden\r\n"));
    EXPECT_THAT(raw_client(port_).upgrade(page, "Host: robot.example:80\r\n"),
                HasSubstr(" 403 Forbidden\r\n"));
  }
  for (int i = 0; i < 100; ++i) {
    const std::string name = "Host: h" + std::to_string(i) + ".example\r\n";
    EXPECT_THAT(raw_client(port_).upgrade(page, name), HasSubstr(" 403 Forbidden\r\n"));
  }
  end();
  EXPECT_THAT(errors(), HasSubstr("refused a web page of https://app.foxglove.dev; allow it with "
                                  "--allow-origin https://app.foxglove.dev.\n"));
  EXPECT_THAT(errors(), HasSubstr("refused a request to robot.example; allow it with "
                                  "--allow-origin http://robot.example.\n"));
  int lines = 0;
  for (const std::string& line : cli::lines_of(errors())) {
    lines += line.find("refused") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(lines, 2);
  EXPECT_LE(lines, 20);
}

TEST_F(Listening, AllAddresses_AreNamedByTheHost) {
  std::array<char, 256> name{};
  ASSERT_EQ(::gethostname(name.data(), name.size() - 1), 0);
  begin({"--address", "0.0.0.0"}, "sim:", "http://" + std::string(name.data()) + ":");
  EXPECT_THAT(errors(), Not(HasSubstr("http://0.0.0.0")));
  raw_client client(port_);
  client.send("GET / HTTP/1.1\r\nHost: " + std::string(name.data()) +
              "\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(client.read_to_end().value_or(""), StartsWith("HTTP/1.1 200"));
}

TEST(Hosts, OfOneAddress) {
  EXPECT_THAT(g4_tool::hosts_of("127.0.0.1"), ElementsAre("127.0.0.1"));
  EXPECT_THAT(g4_tool::hosts_of("::1"), ElementsAre("[::1]"));
  for (const std::string any : {"0.0.0.0", "::"}) {
    for (const std::string& host : g4_tool::hosts_of(any)) {
      EXPECT_THAT(host, Not(StartsWith("127."))) << any;
      EXPECT_TRUE(g4_tool::host_guard(any, {}).allows(host + ":8765", "http://" + host + ":8765"))
          << host;
    }
  }
}

TEST_F(Listening, Localhost_IsAnAddress) {
  begin({"--address", "localhost"});
  EXPECT_THAT(ask("GET"), StartsWith("HTTP/1.1 200"));
}

// The help of each program names the default of that program.
TEST_F(Listening, Help_HasTheDefaultOfOnLoss) {
  EXPECT_THAT(cli::run({"serve", "--help"}).out, HasSubstr("wait: also at the start (wait)"));
  EXPECT_THAT(cli::run({"view", "--help"}).out, HasSubstr("also at the start (reconnect)"));
  EXPECT_THAT(cli::run({"dump", "--help"}).out, HasSubstr("wait: also at the start (exit)"));
}

}  // namespace
