// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/live_status.hpp"

#include <array>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tools/cli/json_log.hpp"
#include "adit/tools/live/source_watch.hpp"
#include "adit/tools/publishing/duration_sample.hpp"
#include "adit/tools/publishing/status_server.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

std::vector<SourceCounts> one_source() {
  return {{.name = "/po\"ints", .messages = 7, .bytes = 700, .lost = 2}};
}

SweepResult sweep_in(OdometryState state) {
  SweepResult result;
  result.state = state;
  return result;
}

TEST(LiveStatus, HealthFollowsTheSweeps) {
  LiveStatus status(one_source);
  status.begin_session();
  EXPECT_EQ(status.health(), "starting");
  status.add(sweep_in(OdometryState::tracking), 20.0);
  EXPECT_EQ(status.health(), "ok");
  EXPECT_EQ(status.health(LiveStatus::Clock::now() + std::chrono::seconds(4)), "no data");
  status.add(sweep_in(OdometryState::coasting), std::nullopt);
  EXPECT_EQ(status.health(), "not aligned");
  status.begin_session();
  EXPECT_EQ(status.health(), "starting");
}

TEST(LiveStatus, JsonHasTheFigures) {
  LiveStatus status(one_source);
  status.begin_session();
  const auto before = nlohmann::json::parse(status.health_json());
  EXPECT_TRUE(before["last_sweep_age_s"].is_null());
  for (int i = 1; i <= 100; ++i) {
    status.add(sweep_in(OdometryState::tracking), i);
  }
  const auto json = nlohmann::json::parse(status.health_json());
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["sweeps"], 100);
  EXPECT_EQ(json["map_behind_sweeps"], 100);
  EXPECT_EQ(json["latency_p50_ms"], 50.0);
  EXPECT_EQ(json["latency_p99_ms"], 99.0);
}

TEST(LiveStatus, MetricsAreInPrometheusFormat) {
  LiveStatus status(one_source);
  status.begin_session();
  status.add(sweep_in(OdometryState::tracking), 20.0);
  const std::string text = status.metrics();
  EXPECT_NE(text.find("adit_received_messages_total{source=\"/po\\\"ints\"} 7\n"),
            std::string::npos);
  EXPECT_NE(text.find("adit_lost_messages_total{source=\"/po\\\"ints\"} 2\n"), std::string::npos);
  EXPECT_NE(text.find("adit_latency_seconds{quantile=\"0.5\"} 0.02\n"), std::string::npos);
  const std::regex line(R"((# (HELP|TYPE) \w+ .+|\w+(\{\w+="([^"\\]|\\.)*"\})? [-+.e\d]+))");
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    EXPECT_TRUE(std::regex_match(text.substr(begin, end - begin), line))
        << text.substr(begin, end - begin);
  }
  EXPECT_EQ(begin, text.size()) << "the last line has an end";
}

TEST(DurationSample, QuantilesHoldHoweverManyThereAre) {
  DurationSample sample;
  EXPECT_EQ(sample.quantile_ms(0.5), 0.0);
  for (int i = 0; i < 100'000; ++i) {
    sample.add((i * 7919) % 1000);
  }
  EXPECT_EQ(sample.count(), 100'000U);
  EXPECT_NEAR(sample.quantile_ms(0.5), 500.0, 15.0);
  EXPECT_NEAR(sample.quantile_ms(0.99), 990.0, 15.0);
  EXPECT_NEAR(sample.sum_ms(), 499.5 * 100'000, 1.0);
}

TEST(SourceChanges, SilenceReturnAndLossesAreReportedOnce) {
  SourceChanges changes;
  auto now = SourceChanges::Clock::now();
  std::vector<SourceCounts> sources = {{.name = "/imu", .messages = 1},
                                       {.name = "/tf_static", .messages = 1, .steady = false}};
  const auto after = [&](double seconds) {
    now += std::chrono::milliseconds(static_cast<int>(1e3 * seconds));
    return changes.look(sources, now);
  };
  EXPECT_TRUE(after(0.0).empty());
  EXPECT_TRUE(after(2.0).empty());
  EXPECT_EQ(after(2.0), std::vector<std::string>{"nothing has arrived from /imu for 4 s"});
  EXPECT_TRUE(after(10.0).empty());
  sources[0].messages = 2;
  EXPECT_EQ(after(1.0), std::vector<std::string>{"/imu is back after 15 s"});
  sources[0].lost = 3;
  EXPECT_EQ(after(1.0), std::vector<std::string>{"3 messages of /imu were lost on the way"});
  sources[0].lost = 5;
  EXPECT_TRUE(after(1.0).empty());
  sources[0].messages = 3;
  sources[0].incompatible = 1;
  ASSERT_EQ(after(1.0).size(), 1U);
  EXPECT_TRUE(after(1.0).empty());
}

TEST(JsonLog, LinesKeepTheirLevelAndAnyBytes) {
  std::ostringstream out;
  {
    JsonLog log(out);
    std::ostream lines(&log);
    lines << "note: 37 s lie between \"a\" and b\nadit live: /x: no\n"
          << "adit run: warning: slow\nplain\xff" << std::flush << " end";
  }
  std::istringstream in(out.str());
  std::vector<nlohmann::json> found;
  for (std::string line; std::getline(in, line);) {
    found.push_back(nlohmann::json::parse(line));
  }
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0]["level"], "info");
  EXPECT_EQ(found[0]["message"], "37 s lie between \"a\" and b");
  EXPECT_EQ(found[1]["level"], "error");
  EXPECT_EQ(found[1]["message"], "/x: no");
  EXPECT_EQ(found[2]["level"], "warning");
  EXPECT_EQ(found[3]["message"], "plain\xEF\xBF\xBD end");
  EXPECT_TRUE(std::regex_match(found[0]["time"].get<std::string>(),
                               std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z)")));
}

/// Sends the bytes and returns what comes back until the other side closes.
std::string ask(uint16_t port, const std::string& bytes) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    ::shutdown(descriptor, SHUT_WR);
    std::array<char, 4096> part{};
    for (ssize_t size = 0; (size = ::recv(descriptor, part.data(), part.size(), 0)) > 0;) {
      answer.append(part.data(), static_cast<std::size_t>(size));
    }
  }
  ::close(descriptor);
  return answer;
}

TEST(StatusServer, AnswersGetAloneAndSurvivesAnyBytes) {
  StatusServer server(0, [](const std::string& path) {
    return StatusAnswer{
        .code = path == "/health" ? 503U : 404U, .type = "text/plain", .body = "asked for " + path};
  });
  const std::string health = ask(server.port(), "GET /health?x=1 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(health.starts_with("HTTP/1.1 503 ")) << health;
  EXPECT_TRUE(health.ends_with("asked for /health")) << health;
  EXPECT_TRUE(ask(server.port(), "POST / HTTP/1.1\r\nHost: a\r\n\r\n").starts_with("HTTP/1.1 405"));
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = i % 2 == 0 ? "GET /health HTTP/1.1\r\n" : "";
    const std::size_t size = random() % 20'000;
    while (bytes.size() < size) {
      bytes += static_cast<char>(random());
    }
    ask(server.port(), bytes);
  }
  EXPECT_TRUE(ask(server.port(), "GET / HTTP/1.0\r\n\r\n").starts_with("HTTP/1.0 404") ||
              ask(server.port(), "GET / HTTP/1.0\r\n\r\n").starts_with("HTTP/1.1 404"));
}

TEST(StatusServer, APortThatIsTakenIsRefused) {
  const StatusServer::Answer nothing = [](const std::string&) { return StatusAnswer{}; };
  StatusServer first(0, nothing);
  EXPECT_THROW(StatusServer(first.port(), nothing), UsageError);
}

}  // namespace
}  // namespace adit
