// SPDX-License-Identifier: MIT
// The HTTP of g4-serve: its requests, and what it refuses before anything else sees it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "server.hpp"
#include "support/test_scale.hpp"

namespace {

using serve::page;
using serve::raw_client;
using serve::Server;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::vector<std::string> malformed{
    "PRI * HTTP/2.0\r\n\r\n",
    "GET / HTTP/2.0\r\nHost: localhost\r\n\r\n",
    "GET / HTTP/1.10\r\nHost: localhost\r\n\r\n",
    "GET /\r\nHost: localhost\r\n\r\n",
    "GET  / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "GET / x HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "GET https://localhost/ HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "GET /\x01 HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "G@T / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    " / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
    "GET / HTTP/1.1\r\nHost: localhost\r\nnothing\r\n\r\n",
    "GET / HTTP/1.1\r\nHost: localhost\r\nHost : localhost\r\n\r\n",
    "GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nOrigin: null\r\n\r\n",
    "GET / HTTP/1.1\r\n folded: x\r\nHost: localhost\r\n\r\n",
    "GET / HTTP/1.1\r\nHost: local\nhost\r\n\r\n",
    "\r\n\r\n\r\n"};

class Http : public Server {
 protected:
  std::string answer_to(const std::string& request) const {
    raw_client client(port_);
    client.send(request);
    return client.read_to_end().value_or("no end");
  }
};

// RFC 9112, 3.2.2: its host counts, and not that of the header.
TEST_F(Http, AbsoluteForm_IsAPath) {
  begin();
  const auto ask = [&](const std::string& target, const std::string& host = "localhost") {
    return answer_to("GET " + target + " HTTP/1.1\r\nHost: " + host +
                     "\r\nConnection: close\r\n\r\n");
  };
  EXPECT_THAT(ask("http://localhost/"), HasSubstr("<title>"));
  EXPECT_THAT(ask("HTTP://localhost:8765/status.json?a=/b"), HasSubstr("{\"op\":\"status\""));
  EXPECT_THAT(ask("http://localhost"), HasSubstr("<title>"));
  EXPECT_THAT(ask("http://localhost?x"), HasSubstr("<title>"));
  EXPECT_THAT(ask("http://localhost/nothing"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(ask("http://localhost/", "evil.example"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask("http://evil.example/"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("http:///"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("http://localhost@evil.example/"), StartsWith("HTTP/1.1 403"));
}

// RFC 9112, 2.2.
TEST_F(Http, EmptyLineBeforeARequest_IsSkipped) {
  begin();
  raw_client client(port_);
  for (int i = 0; i < 2; ++i) {
    client.send("\r\nGET /status.json HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_THAT(client.read_until("}\n"), StartsWith("HTTP/1.1 200")) << i;
  }
  client.send("\r\n");
  EXPECT_THAT(client.get("/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(Http, WhatKeepsAConnectionOpen) {
  begin();
  const auto keeps_open = [&](const std::string& version, const std::string& more) {
    raw_client client(port_);
    client.send("GET / HTTP/" + version + "\r\nHost: localhost\r\n" + more + "\r\n");
    const std::string head = client.read_until("\r\n\r\n");
    EXPECT_THAT(head, StartsWith("HTTP/1.1 200")) << version << more;
    EXPECT_THAT(head, ContainsRegex("connection: (keep-alive|close)\r\n"));
    return head.find("connection: keep-alive") != std::string::npos;
  };
  EXPECT_TRUE(keeps_open("1.1", ""));
  EXPECT_TRUE(keeps_open("1.1", "Content-Length: 0\r\n"));
  EXPECT_FALSE(keeps_open("1.0", ""));
  EXPECT_FALSE(keeps_open("1.0", "Connection: keep-alive\r\n"));
  EXPECT_FALSE(keeps_open("1.1", "Connection: Close\r\n"));
  EXPECT_FALSE(keeps_open("1.1", "Connection: x\r\nConnection: close\r\n"));
  EXPECT_FALSE(keeps_open("1.1", "Content-Length: 1\r\n"));
  EXPECT_FALSE(keeps_open("1.1", "Transfer-Encoding: chunked\r\n"));
}

TEST_F(Http, OnlyWebSocketsAreAnUpgrade) {
  begin();
  const auto wants = [&](const std::string& more) {
    const std::string answer =
        answer_to("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + more + "\r\n");
    EXPECT_THAT(answer, ContainsRegex("^HTTP/1.1 (200|426)")) << more;
    return answer.starts_with("HTTP/1.1 426");
  };
  EXPECT_TRUE(wants("Upgrade: websocket\r\nConnection: Upgrade\r\n"));
  EXPECT_TRUE(wants("Upgrade: h2c, WebSocket\r\nConnection: keep-alive, Upgrade\r\n"));
  EXPECT_FALSE(wants("Upgrade: websocket\r\n"));
  EXPECT_FALSE(wants("Upgrade: websockets\r\nConnection: Upgrade\r\n"));
  EXPECT_FALSE(wants("Upgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings\r\n"));
}

TEST_F(Http, SlowHeads_AreEnded) {
  begin();
  raw_client slow(port_);
  slow.send("GET / HTTP/1.1\r\nHost: localhost\r\nX: ");
  EXPECT_TRUE(g4lidar::test::comes_true([&] {
    slow.send("x");
    return slow.has_ended();
  }));
  EXPECT_THAT(raw_client(port_).get("/"), StartsWith("HTTP/1.1 200"));
}

const std::string h2c =
    "GET /status.json HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\n"
    "Upgrade: h2c\r\nHTTP2-Settings: AAMAAABkAAQCAAAAAAIAAAAA\r\n\r\n";
const std::string preface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

TEST_F(Http, MalformedRequests_AreAnswered) {
  begin();
  for (const std::string& head : malformed) {
    EXPECT_THAT(answer_to(head), StartsWith("HTTP/1.1 400")) << head;
  }
  EXPECT_THAT(answer_to("GET / HTTP/1.1\r\nX: " + std::string(5'000, 'x') + "\r\n\r\n"),
              StartsWith("HTTP/1.1 431"));
}

TEST_F(Http, UpgradeToHttp2_IsIgnored) {
  begin();
  raw_client client(port_);
  for (int i = 0; i < 2; ++i) {
    client.send(h2c);
    EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(client.read_until("}\n"), StartsWith("{\"op\":\"status\""));
  }
  raw_client second(port_);
  second.send("GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n" + h2c + preface);
  EXPECT_THAT(second.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 404"));
  const std::string rest = second.read_to_end().value_or("no end");
  EXPECT_THAT(rest, HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(rest, HasSubstr("HTTP/1.1 400"));
  // Host and Origin are read before.
  EXPECT_THAT(
      answer_to("GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: Upgrade, HTTP2-Settings,"
                " close\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABk\r\n\r\n"),
      StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(end().code, 128 + SIGTERM) << cli::read_file(path("err"));
}

/// Plausible enough for a parser to go on: few streams, usual flags, and bytes that header compression uses.
std::string random_frames(std::mt19937& random) {
  const std::string flags{0, 1, 4, 5, 8, 0x24};
  const std::string fields{0, '\x82', '\x84', '\x86', 0x41};
  std::string made;
  for (auto left = 1 + random() % 8; left > 0; --left) {
    const auto size = random() % 60;
    const auto kind = static_cast<char>(random() % 10);
    const auto stream = static_cast<char>(random() % 3 * 2 + random() % 2);
    made += {0, 0, static_cast<char>(size), kind, flags[random() % flags.size()], 0, 0, 0, stream};
    for (auto i = size; i > 0; --i) {
      const auto which = random() % (fields.size() + 1);
      made += which < fields.size() ? fields[which] : static_cast<char>(random());
    }
  }
  return made;
}

TEST_F(Http, RandomHttp2Frames_EndOnlyTheirConnection) {
  begin();
  const auto good = open_page();
  const int seed = g4lidar::test::seeds(1).front();
  std::mt19937 random(static_cast<unsigned>(seed));
  std::vector<raw_client> all;
  for (int i = 0; i < g4lidar::test::scaled(200); ++i) {
    raw_client bad(port_);
    const std::string before = i % 4 == 0 ? "" : h2c;
    const std::string settings{0, 0, 0, 4, 0, 0, 0, 0, 0};
    bad.send(before + (i % 2 == 0 ? preface : "") + settings + random_frames(random));
    bad.send(random_frames(random));
    if (i % 8 == 1) {
      EXPECT_THAT(bad.read_until("\r\n\r\n"), Not(HasSubstr(" 101 "))) << "seed " << seed;
    }
    if (i % 3 == 0) all.push_back(std::move(bad));
  }
  EXPECT_TRUE(gets_scans(*good)) << "seed " << seed;
  EXPECT_TRUE(gets_scans(*open_page())) << "seed " << seed;
  EXPECT_EQ(end().code, 128 + SIGTERM) << "seed " << seed << '\n' << cli::read_file(path("err"));
}

TEST_F(Http, SeveralRequestsAtOnce_AreAnsweredInTheirOrder) {
  begin();
  const std::string host = " HTTP/1.1\r\nHost: localhost\r\n";
  const std::string all =
      answer_to("HEAD /" + host + "\r\nGET /nothing" + host + "\r\nDELETE /" + host + "\r\nGET /" +
                host + "Connection: close\r\n\r\nGET /" + host + "\r\n");
  std::string codes;
  for (std::size_t at = all.find("HTTP/1.1 "); at != std::string::npos;
       at = all.find("HTTP/1.1 ", at + 1)) {
    codes += all.substr(at + 9, 4);
  }
  EXPECT_EQ(codes, "200 404 405 200 ");
}

TEST_F(Http, Handshakes_LearnWhatIsWrong) {
  begin();
  const std::string good = raw_client::upgrade_request(page);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    changed.replace(changed.find(from), from.size(), to);
    raw_client client(port_);
    client.send(changed);
    return client.read_until("\r\n\r\n");
  };
  const std::string old = with("Version: 13", "Version: 8");
  EXPECT_THAT(old, StartsWith("HTTP/1.1 426"));
  EXPECT_THAT(old, HasSubstr("sec-websocket-version: 13\r\n"));
  EXPECT_THAT(with("dGhl", "dGh"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with("dGhl", "dG l"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with("HTTP/1.1", "HTTP/1.0"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with("GET", "HEAD"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with(page, "chat"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with("GET /", "GET /status.json"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(with("GET /", "GET /?x"), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(with("GET /", "GET http://localhost/"), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(with("websocket", "h2c, WebSocket"), StartsWith("HTTP/1.1 101"));
  const std::string key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  EXPECT_THAT(with(key, key + key), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(with(key, ""), StartsWith("HTTP/1.1 400"));
}

// RFC 9110, 5.3.
TEST_F(Http, ListsInTwoLines_AreOneList) {
  begin();
  const std::string good = raw_client::upgrade_request(page);
  for (const std::string line : {"Upgrade: websocket", "Connection: Upgrade",
                                 "Sec-WebSocket-Version: 13", "Sec-WebSocket-Protocol: "}) {
    const std::string name = line.substr(0, line.find(' '));
    for (const bool is_first : {true, false}) {
      std::string changed = good;
      const std::size_t at = good.find(line);
      ASSERT_NE(at, std::string::npos) << line;
      changed.insert(is_first ? at : good.find("\r\n", at) + 2, name + " other\r\n");
      raw_client client(port_);
      client.send(changed);
      EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101")) << changed;
      EXPECT_TRUE(gets_scans(client, 1)) << changed;
    }
  }
}

TEST_F(Http, FramesRightBehindTheHandshake_AreRead) {
  begin();
  raw_client client(port_);
  client.send(raw_client::upgrade_request(page) +
              raw_client::frame(1, R"({"op":"set","name":"frequency","value":10})"));
  EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(next(client, "error")["message"].get<std::string>(), HasSubstr("--allow-set"));
}

TEST_F(Http, TooFewFiles_AreNotTheAddress) {
  for (int most = 4; most < 24; ++most) {
    const std::string line = "exec 2> " + path("err") + "; ulimit -n " + std::to_string(most) +
                             "; exec " + G4_DUMP + " serve sim: --port 0 -d 10ms";
    const int code = WEXITSTATUS(std::system(line.c_str()));
    const std::string words = cli::read_file(path("err"));
    EXPECT_THAT(words, Not(HasSubstr("--address"))) << most;
    // The sanitizer of clang looks at an object through a pipe, for which there is no descriptor.
    const bool is_of_sanitizer = words.find("object has invalid vptr") != std::string::npos;
    if (code != 0 && !is_of_sanitizer) {
      EXPECT_THAT(words, ContainsRegex("open files|files are open|shared libraries"))
          << most << ": " << code;
    }
  }
}

}  // namespace
