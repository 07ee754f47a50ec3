// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/sweep_times.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

InputError times_error(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("times.txt", text);
  try {
    read_times(file);
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), file);
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return InputError("", {}, "", "");
}

std::vector<Nanoseconds> times_of(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_times(folder.write("times.txt", text));
}

TEST(RecordingTimes, SecondsOneALine) {
  const std::vector<Nanoseconds> expected = {Nanoseconds(0), Nanoseconds(103736000),
                                             Nanoseconds(210000000)};
  EXPECT_EQ(times_of("0.000000e+00\n1.037360e-01\n0.210\n\n"), expected);
}

TEST(RecordingTimes, DatesAsInKittiRaw) {
  const std::vector<Nanoseconds> times =
      times_of("2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.697690478\n");
  EXPECT_EQ(times[0], Nanoseconds(1317042145594360375));
  EXPECT_EQ(times[1] - times[0], Nanoseconds(103330103));
}

TEST(RecordingTimes, DatesAcrossMidnightIncrease) {
  const std::vector<Nanoseconds> times =
      times_of("2012-02-29 23:59:59.95\n2012-03-01 00:00:00.05\n");
  EXPECT_EQ(times[1] - times[0], Nanoseconds(100000000));
}

TEST(RecordingTimes, TimesThatGoBackNameTheLine) {
  const InputError error = times_error("0.0\n0.2\n0.1\n");
  EXPECT_EQ(error.place(), "line 3");
  EXPECT_NE(error.found().find("goes back"), std::string::npos);
}

TEST(RecordingTimes, EqualTimesNameTheLine) {
  const InputError error = times_error("0.0\n0.2\n0.2\n");
  EXPECT_EQ(error.place(), "line 3");
  EXPECT_NE(error.found().find("the same"), std::string::npos);
}

TEST(RecordingTimes, WhatIsNoTimeIsShown) {
  EXPECT_NE(times_error("0.0\nzero\n").found().find("'zero'"), std::string::npos);
  EXPECT_EQ(times_error("0.0\n0.1 0.2 0.3\n").place(), "line 2");
  EXPECT_EQ(times_error("nan\n").place(), "line 1");
  EXPECT_EQ(times_error("1e300\n").place(), "line 1");
  EXPECT_EQ(times_error("2011-13-26 13:02:25.5\n").place(), "line 1");
  EXPECT_EQ(times_error("2011-02-29 13:02:25.5\n").place(), "line 1");
  EXPECT_EQ(times_error("2011-09-26 24:02:25.5\n").place(), "line 1");
  EXPECT_EQ(times_error("2011-09-26 13:02:-5.5\n").place(), "line 1");
  EXPECT_EQ(times_error("9999-09-26 13:02:25\n").place(), "line 1");
}

TEST(RecordingTimes, BlankLineInTheMiddleIsNamed) {
  EXPECT_EQ(times_error("0.0\n\n0.1\n").place(), "line 2");
}

TEST(RecordingTimes, CountsThatDoNotMatchAreSaid) {
  try {
    require_matching_times("times.txt", 59, 60, "sweeps");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "line 60");
    EXPECT_NE(error.found().find("59 times for 60 sweeps"), std::string::npos);
  }
  EXPECT_THROW(require_matching_times("times.txt", 61, 60, "sweeps"), InputError);
  EXPECT_NO_THROW(require_matching_times("times.txt", 60, 60, "sweeps"));
}

TEST(RecordingTimes, NamesThatTellTheTime) {
  EXPECT_EQ(time_from_name("1623370000.123"), Nanoseconds(1623370000123000000));
  EXPECT_EQ(time_from_name("1623370000123456789"), Nanoseconds(1623370000123456789));
  EXPECT_EQ(time_from_name("1623370000123456"), Nanoseconds(1623370000123456000));
  EXPECT_EQ(time_from_name("cloud_1583836591_182590976"), Nanoseconds(1583836591182590976));
  EXPECT_EQ(time_from_name("scan_3_1623370000123456789"), Nanoseconds(1623370000123456789));
  EXPECT_EQ(time_from_name("0.1"), Nanoseconds(100000000));
}

TEST(RecordingTimes, NamesThatAreIndicesTellNone) {
  for (const char* stem : {"000042", "0000000042", "cloud", "", "_", ".", "sweep_7", "2021-06-11",
                           "0000000000000000042", "99999999999999999999", "12.", "a1_2b"}) {
    EXPECT_FALSE(time_from_name(stem)) << stem;
  }
}

TEST(RecordingTimes, NaturalOrderTakesNumbersAsNumbers) {
  std::vector<std::string> names = {
      "10.pcd", "9.pcd", "a10b2", "a10b10", "a9", "010.pcd", "", "99999999999999999999999", "100"};
  std::sort(names.begin(), names.end(), natural_less);
  const std::vector<std::string> expected = {
      "", "9.pcd", "010.pcd", "10.pcd", "100", "99999999999999999999999", "a9", "a10b2", "a10b10"};
  EXPECT_EQ(names, expected);
}

TEST(RecordingTimes, NaturalOrderIsAnOrder) {
  const std::vector<std::string> names = {"",   "0",   "00",   "1", "01", "a",  "a0",  "a00", "a01",
                                          "a1", "a1b", "a01b", "b", "1a", "1-", "1.0", "1.00"};
  for (const std::string& a : names) {
    EXPECT_FALSE(natural_less(a, a));
    for (const std::string& b : names) {
      EXPECT_EQ(natural_less(a, b) + natural_less(b, a), a == b ? 0 : 1) << a << " " << b;
      for (const std::string& c : names) {
        EXPECT_TRUE(!(natural_less(a, b) && natural_less(b, c)) || natural_less(a, c))
            << a << " " << b << " " << c;
      }
    }
  }
}

}  // namespace
}  // namespace adit
