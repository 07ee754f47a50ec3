// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_access.hpp"

#include <gtest/gtest.h>

#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {
namespace {

using Refusal = std::optional<ViewRefusal>;

Refusal from(const std::string& address, const std::string& host, const std::string& origin = "") {
  return refusal_of({.address = address}, {.host = host, .origin = origin, .target = "/"});
}

TEST(ViewAccess, LoopbackIsCalledByItsOwnNamesAlone) {
  for (const char* host :
       {"127.0.0.1", "127.0.0.1:8080", "localhost:8080", "localhost", "[::1]:80"}) {
    EXPECT_EQ(from("127.0.0.1", host), Refusal()) << host;
  }
  for (const char* host :
       {"", "evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
        "192.168.1.5", "[fe80::1]", "127.evil.example"}) {
    EXPECT_EQ(from("127.0.0.1", host), ViewRefusal::foreign_host) << host;
  }
}

TEST(ViewAccess, OtherAddressesAreCalledByNumbersWhichNoNameLeadsTo) {
  for (const char* host : {"192.168.1.5:8080", "10.0.0.1", "[fe80::1]:8080", "localhost:1"}) {
    EXPECT_EQ(from("0.0.0.0", host), Refusal()) << host;
  }
  EXPECT_EQ(from("0.0.0.0", "robot.example:8080"), ViewRefusal::foreign_host);
}

TEST(ViewAccess, AnOriginIsTheHostsOwn) {
  EXPECT_EQ(from("127.0.0.1", "127.0.0.1:80", "http://127.0.0.1:80"), Refusal());
  EXPECT_EQ(from("127.0.0.1", "localhost:9", "http://localhost:9"), Refusal());
  for (const char* origin : {"http://127.0.0.1:81", "http://evil.example", "null", "127.0.0.1:80",
                             "ftp://127.0.0.1:80", "http://127.0.0.1:80.evil.example"}) {
    EXPECT_EQ(from("127.0.0.1", "127.0.0.1:80", origin), ViewRefusal::foreign_origin) << origin;
  }
}

TEST(ViewAccess, FoxglovesPagesAreLetInByATokenAlone) {
  const auto by = [](const std::string& token, const std::string& target, bool is_foxglove) {
    return refusal_of({.token = "abcd", .foxglove_token = token},
                      {.host = "127.0.0.1:80",
                       .origin = "https://app.foxglove.dev",
                       .target = target,
                       .is_foxglove = is_foxglove});
  };
  EXPECT_EQ(by("0123", "/?token=0123", true), Refusal());
  EXPECT_EQ(by("0123", "/?token=0124", true), ViewRefusal::wrong_token);
  EXPECT_EQ(by("0123", "/", true), ViewRefusal::wrong_token);
  EXPECT_EQ(by("0123", "/?token=0123", false), ViewRefusal::foreign_origin);
  EXPECT_EQ(by("", "/", true), ViewRefusal::foreign_origin);
  EXPECT_EQ(by("", "/?token=", true), ViewRefusal::foreign_origin);
}

TEST(ViewAccess, ATokenIsWholeOrWrong) {
  const ViewAccess access{.address = "0.0.0.0", .token = "0123abcd"};
  const auto by = [&](const std::string& target) {
    return refusal_of(access, {.host = "10.0.0.1", .origin = "", .target = target});
  };
  EXPECT_EQ(by("/?token=0123abcd"), Refusal());
  EXPECT_EQ(by("/socket?a=1&token=0123abcd&b=2"), Refusal());
  for (const char* target :
       {"/", "/?", "/?token=", "/?token=0123abc", "/?token=0123abcde", "/?token", "/token=0123abcd",
        "/?xtoken=0123abcd", "/?&&token=0123abcD"}) {
    EXPECT_EQ(by(target), ViewRefusal::wrong_token) << target;
  }
}

TEST(ViewAccess, TokensAreLongAndNeverTheSame) {
  const std::string one = make_token();
  EXPECT_EQ(one.size(), 32U);
  EXPECT_EQ(one.find_first_not_of("0123456789abcdef"), one.npos) << one;
  EXPECT_NE(one, make_token());
}

TEST(ViewServer, AnAddressOfAnotherMachineIsNamed) {
  try {
    const ViewServer server({}, {.address = "203.0.113.7", .token = "0123abcd"}, 0);
    FAIL() << "listened on";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("--listen takes an address of this machine"),
              std::string::npos)
        << error.what();
  }
}

TEST(ViewAccess, KnowsWhatIsLoopback) {
  EXPECT_TRUE(is_loopback("127.0.0.1") && is_loopback("127.1.2.3") && is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0") || is_loopback("128.0.0.1") || is_loopback("::") ||
               is_loopback("127.evil.a.b"));
}

}  // namespace
}  // namespace adit
