// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/cloud_columns.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/point_times.hpp"

namespace adit {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PointTimes interpret(const std::vector<double>& times, bool single_precision = false) {
  return interpret_times("cloud.pcd", times, std::vector<uint8_t>(times.size(), 1),
                         single_precision);
}
PointTimes interpret_integers(const std::vector<int64_t>& times) {
  return interpret_times("cloud.pcd", times, std::vector<uint8_t>(times.size(), 1));
}

void expect_offsets(const PointTimes& times, const std::vector<float>& expected) {
  ASSERT_EQ(times.offsets.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(times.offsets[i], expected[i], 1e-8F) << i;
  }
}

// The drivers of algorithms.md, section 5.2.

TEST(PointTimes, VelodyneSecondsBeforeTheLastPacket) {
  const PointTimes times = interpret({-0.1, -0.05, 0.0}, true);
  EXPECT_EQ(times.start, Nanoseconds(-100000000));
  EXPECT_FALSE(times.absolute);
  expect_offsets(times, {0.0F, 0.05F, 0.1F});
}

TEST(PointTimes, OusterNanosecondsOfAnUnsortedSweep) {
  const PointTimes times = interpret_integers({99000000, 0, 50000000});
  EXPECT_EQ(times.start, Nanoseconds(0));
  EXPECT_FALSE(times.absolute);
  expect_offsets(times, {0.099F, 0.0F, 0.05F});
}

TEST(PointTimes, LivoxAbsoluteNanosecondsInDoubles) {
  const PointTimes times = interpret({1.7e18, 1.7e18 + 1e8});
  EXPECT_TRUE(times.absolute);
  EXPECT_NEAR(static_cast<double>(times.start.count()), 1.7e18, 300.0);
  expect_offsets(times, {0.0F, 0.1F});
}

TEST(PointTimes, AbsoluteNanosecondsInIntegersAreExact) {
  const PointTimes times = interpret_integers({1700000000100000007, 1700000000000000001});
  EXPECT_TRUE(times.absolute);
  EXPECT_EQ(times.start, Nanoseconds(1700000000000000001));
  expect_offsets(times, {0.100000006F, 0.0F});
}

TEST(PointTimes, HesaiAbsoluteSeconds) {
  const PointTimes times = interpret({1.7e9 + 0.1, 1.7e9});
  EXPECT_TRUE(times.absolute);
  EXPECT_EQ(times.start, Nanoseconds(1700000000000000000));
  EXPECT_NEAR(times.offsets[0], 0.1F, 3e-7F);
}

TEST(PointTimes, MillisecondsAndMicroseconds) {
  expect_offsets(interpret({0.0, 99.5}), {0.0F, 0.0995F});
  expect_offsets(interpret({0.0, 99500.0}), {0.0F, 0.0995F});
  expect_offsets(interpret_integers({10, 109}), {0.0F, 0.099F});
}

TEST(PointTimes, OneTimeForAllPointsIsReadByItsSize) {
  EXPECT_EQ(interpret({1.7e9, 1.7e9}).start, Nanoseconds(1700000000000000000));
  EXPECT_EQ(interpret_integers({1700000000000000000}).start, Nanoseconds(1700000000000000000));
  EXPECT_EQ(interpret_integers({0, 0}).start, Nanoseconds(0));
  EXPECT_FALSE(interpret({0.0}).absolute);
}

TEST(PointTimes, PointsWithoutReturnDoNotCount) {
  const std::vector<double> values = {0.0, 1.7e9, 1.7e9 + 0.1, kNan};
  const PointTimes times = interpret_times("a", values, std::vector<uint8_t>{0, 1, 1, 0}, false);
  EXPECT_EQ(times.start, Nanoseconds(1700000000000000000));
  EXPECT_EQ(times.offsets[0], 0.0F);
  EXPECT_EQ(times.offsets[3], 0.0F);
}

TEST(PointTimes, SweepWithoutAnyReturnHasNoStart) {
  const PointTimes times =
      interpret_times("a", std::vector<double>{kNan, 1e300}, std::vector<uint8_t>{0, 0}, false);
  EXPECT_EQ(times.start, Nanoseconds(0));
  EXPECT_FALSE(times.absolute);
  expect_offsets(times, {0.0F, 0.0F});
}

TEST(PointTimes, TimesThatCannotBeOneSweepAreErrors) {
  EXPECT_THROW(interpret({0.0, 2e10}), InputError);      // 20 s in nanoseconds
  EXPECT_THROW(interpret({-1e308, 1e308}), InputError);  // the difference overflows
  EXPECT_THROW(interpret({0.0, kNan}), InputError);
  EXPECT_THROW(interpret_integers(
                   {std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()}),
               InputError);
  EXPECT_THROW(interpret({1e40, 1e40}), InputError);
}

TEST(PointTimes, AbsoluteTimesInSinglePrecisionAreAnError) {
  const auto value = static_cast<double>(1.7e9F);
  try {
    interpret({value, value}, true);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("float32"), std::string::npos);
  }
  EXPECT_NO_THROW(interpret({2.0, 2.1}, true));
}

TEST(FieldRoles, UsualNamesWinOverTheOthers) {
  const FieldRoles roles =
      find_roles({"x", "y", "z", "reflectivity", "intensity", "t", "ring", "range"});
  EXPECT_EQ(roles[FieldRole::intensity], 4);
  EXPECT_EQ(roles[FieldRole::time], 5);
  EXPECT_EQ(roles[FieldRole::ring], 6);
}

TEST(FieldRoles, CaseAndCloudComparePrefixDoNotMatter) {
  const FieldRoles roles = find_roles({"X", "Y", "Z", "scalar_Intensity", "Scalar_Timestamp"});
  EXPECT_EQ(roles[FieldRole::x], 0);
  EXPECT_EQ(roles[FieldRole::intensity], 3);
  EXPECT_EQ(roles[FieldRole::time], 4);
  EXPECT_EQ(roles[FieldRole::ring], -1);
}

/// A cloud of one point from numbers that lie in memory.
template <class T>
CloudFile decode_one(ScalarType type, const std::vector<T>& xyz,
                     std::optional<double> scale = 1.0) {
  CloudColumns columns;
  columns.points = 1;
  columns.reading.coordinate_scale = scale;
  columns.reading.offset = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    columns.columns[i] =
        Column{reinterpret_cast<const std::byte*>(xyz.data() + i), 0, sizeof(T), type, false};
  }
  return decode_cloud("cloud.pcd", columns);
}

TEST(DecodeCloud, CoordinatesOfEveryType) {
  const auto expect = [](const CloudFile& cloud, float x, float y, float z) {
    EXPECT_EQ(cloud.sweep.points.at(0).x, x);
    EXPECT_EQ(cloud.sweep.points.at(0).y, y);
    EXPECT_EQ(cloud.sweep.points.at(0).z, z);
  };
  expect(decode_one<int8_t>(ScalarType::i8, {-128, 0, 127}), -128.0F, 0.0F, 127.0F);
  expect(decode_one<uint8_t>(ScalarType::u8, {0, 1, 255}), 0.0F, 1.0F, 255.0F);
  expect(decode_one<int16_t>(ScalarType::i16, {-32768, 0, 32767}), -32768.0F, 0.0F, 32767.0F);
  expect(decode_one<uint16_t>(ScalarType::u16, {1, 2, 65535}), 1.0F, 2.0F, 65535.0F);
  expect(decode_one<int32_t>(ScalarType::i32, {-7, 8, 1 << 30}), -7.0F, 8.0F, 1073741824.0F);
  expect(decode_one<uint32_t>(ScalarType::u32, {7, 8, 1U << 31U}), 7.0F, 8.0F, 2147483648.0F);
  expect(decode_one<int64_t>(ScalarType::i64, {-7, 8, int64_t{1} << 40U}), -7.0F, 8.0F,
         1099511627776.0F);
  expect(decode_one<uint64_t>(ScalarType::u64, {7, 8, uint64_t{1} << 63U}), 7.0F, 8.0F,
         9223372036854775808.0F);
  expect(decode_one<float>(ScalarType::f32, {0.1F, -2.5F, 3.0F}), 0.1F, -2.5F, 3.0F);
  expect(decode_one<double>(ScalarType::f64, {0.1, -2.5, 1e-300}), 0.1F, -2.5F, 0.0F);
}

TEST(DecodeCloud, IntegersNeedAScale) {
  try {
    decode_one<int16_t>(ScalarType::i16, {1000, -2000, 5}, std::nullopt);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("integers of 16 bits"), std::string::npos) << error.what();
    EXPECT_NE(error.remedy().find("recording.coordinate_scale"), std::string::npos);
  }
  const Point p = decode_one<int16_t>(ScalarType::i16, {1000, -2000, 5}, 0.001).sweep.points.at(0);
  EXPECT_FLOAT_EQ(p.x, 1.0F);
  EXPECT_FLOAT_EQ(p.y, -2.0F);
  EXPECT_FLOAT_EQ(p.z, 0.005F);
  EXPECT_EQ(decode_one<float>(ScalarType::f32, {4.0F, 5.0F, 6.0F}, std::nullopt).sweep.points[0].x,
            4.0F);
  EXPECT_EQ(decode_one<float>(ScalarType::f32, {4000.0F, 0.0F, 0.0F}, 0.001).sweep.points[0].x,
            4.0F);
}

/// A binary PCD of doubles, whatever their fields.
CloudFile decode_fields(const std::vector<std::string>& fields, const std::vector<double>& rows) {
  std::string names;
  std::string sizes;
  std::string types;
  for (const std::string& field : fields) {
    names += " " + field;
    sizes += " 8";
    types += " F";
  }
  const std::string points = std::to_string(rows.size() / fields.size());
  std::string file = "VERSION .7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types +
                     "\nWIDTH " + points + "\nHEIGHT 1\nPOINTS " + points + "\nDATA binary\n";
  file.append(reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(double));
  return parse_pcd("cloud.pcd", file);
}

TEST(DecodeCloud, IntensityOfOneLetter) {
  EXPECT_EQ(decode_fields({"x", "y", "z", "i"}, {1, 2, 3, 7}).sweep.points.at(0).intensity, 7.0F);
  EXPECT_TRUE(decode_fields({"x", "y", "z", "i"}, {1, 2, 3, 7}).has_intensity);
  EXPECT_FALSE(decode_fields({"x", "y", "z"}, {1, 2, 3}).has_intensity);
}

TEST(DecodeCloud, CurvatureIsATimeWhereItIsNoCurvature) {
  const std::vector<std::string> fields = {"x", "y", "z", "curvature"};
  const CloudFile timed = decode_fields(fields, {1, 2, 3, 0.5, 4, 5, 6, 99.5});
  ASSERT_EQ(timed.sweep.times.size(), 2U);
  EXPECT_FLOAT_EQ(timed.sweep.times[1], 0.099F);
  EXPECT_EQ(timed.sweep.stamp, Nanoseconds(500000));
  EXPECT_EQ(timed.times.value().field, "curvature");
  EXPECT_TRUE(decode_fields(fields, {1, 2, 3, 0.01, 4, 5, 6, 0.33}).sweep.times.empty())
      << "that of a surface";
  const CloudFile both =
      decode_fields({"x", "y", "z", "curvature", "time"}, {1, 2, 3, 0, 0, 4, 5, 6, 9, 0.1});
  EXPECT_FLOAT_EQ(both.sweep.times.at(1), 0.1F) << "a field of that name wins";
}

TEST(DecodeCloud, SecondsAndNanosecondsApartAreOneTime) {
  for (const auto& [sec, nsec] : {std::pair{"sec", "nsec"},
                                  {"t_sec", "t_nsec"},
                                  {"timestamp_sec", "timestamp_nanosec"},
                                  {"time_s", "time_ns"}}) {
    const CloudFile cloud =
        decode_fields({"x", "y", "z", sec, nsec},
                      {1, 2, 3, 1700000000, 999999999, 4, 5, 6, 1700000001, 50000000});
    EXPECT_EQ(cloud.sweep.stamp, Nanoseconds(1700000000999999999)) << sec;
    EXPECT_TRUE(cloud.absolute_stamp);
    EXPECT_FLOAT_EQ(cloud.sweep.times.at(1), 0.050000001F) << sec;
  }
  const CloudFile alone = decode_fields({"x", "y", "z", "t_ns"}, {1, 2, 3, 0, 4, 5, 6, 9e7});
  EXPECT_FLOAT_EQ(alone.sweep.times.at(1), 0.09F);
  EXPECT_TRUE(decode_fields({"x", "y", "z", "sec"}, {1, 2, 3, 17}).sweep.times.empty());
}

TEST(DecodeCloud, DoublesBeyondFloatBecomeInfinite) {
  const CloudFile cloud = decode_one<double>(ScalarType::f64, {1e300, -1e300, kNan});
  EXPECT_EQ(cloud.sweep.points[0].x, std::numeric_limits<float>::infinity());
  EXPECT_EQ(cloud.sweep.points[0].y, -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(cloud.sweep.points[0].z));
}

TEST(DecodeCloud, RingThatIsNoBeamNumberIsAnErrorWithThePoint) {
  const std::vector<float> values = {1, 2, 3, 70000};
  CloudColumns columns;
  columns.points = 1;
  const std::size_t roles[] = {0, 1, 2, static_cast<std::size_t>(FieldRole::ring)};
  for (std::size_t i = 0; i < 4; ++i) {
    columns.columns[roles[i]] = Column{reinterpret_cast<const std::byte*>(values.data() + i), 0, 16,
                                       ScalarType::f32, false};
  }
  try {
    decode_cloud("cloud.pcd", columns);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "point 0");
  }
}

}  // namespace
}  // namespace adit
