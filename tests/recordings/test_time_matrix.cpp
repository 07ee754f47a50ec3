// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Every way in which a driver could write the times of a sweep's points: all types of the field,
// all units, all zeros, sweeps of every usual length, points in any order and points without
// return. Each is understood, or refused where the numbers cannot tell the times.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kStart{1700000000'400000000};

enum class Zero { start, end, epoch };
constexpr Zero kZeros[] = {Zero::start, Zero::end, Zero::epoch};
constexpr double kUnits[] = {1.0, 1e-3, 1e-6, 1e-9};         // s
constexpr double kLengths[] = {0.01, 0.02, 0.05, 0.1, 1.0};  // s
constexpr int kPoints = 5;

struct Convention {
  double unit = 1.0;
  Zero zero = Zero::start;
  double length = 0.1;
  bool shuffled = false;
  bool invalid_points = false;  ///< one without coordinates, whose time is nonsense

  std::string text() const {
    return "unit " + std::to_string(unit) + ", zero " + std::to_string(static_cast<int>(zero)) +
           ", length " + std::to_string(length) + (shuffled ? ", shuffled" : "") +
           (invalid_points ? ", with invalid points" : "");
  }
};

/// s from the start of the sweep, of the point with this index.
double after_start(const Convention& convention, int i) {
  const int place = convention.shuffled ? (3 * i + 2) % kPoints : i;
  return convention.length * place / (kPoints - 1);
}

/// The number that a driver writes; long double, since absolute nanoseconds need 61 bits.
long double written(const Convention& c, int i) {
  const long double per_unit = std::llround(1e9 * c.unit);
  const long double after = std::llround(1e9 * after_start(c, i));
  const long double zero = c.zero == Zero::start ? 0
                           : c.zero == Zero::end ? -std::llround(1e9 * c.length)
                                                 : static_cast<long double>(kStart.count());
  return (zero + after) / per_unit;
}

/// True where the type can hold these numbers at all.
template <class T>
bool can_hold(const Convention& c) {
  for (int i = 0; i < kPoints; ++i) {
    const long double value = written(c, i);
    if (value < static_cast<long double>(std::numeric_limits<T>::lowest()) ||
        value > static_cast<long double>(std::numeric_limits<T>::max()) ||
        (std::is_integral_v<T> && std::abs(value - std::round(value)) > 1e-6L)) {
      return false;
    }
  }
  return true;
}

template <class T>
constexpr ScalarType scalar() {
  if constexpr (std::is_same_v<T, int32_t>) {
    return ScalarType::i32;
  } else if constexpr (std::is_same_v<T, uint32_t>) {
    return ScalarType::u32;
  } else if constexpr (std::is_same_v<T, int64_t>) {
    return ScalarType::i64;
  } else if constexpr (std::is_same_v<T, uint64_t>) {
    return ScalarType::u64;
  } else if constexpr (std::is_same_v<T, float>) {
    return ScalarType::f32;
  } else {
    static_assert(std::is_same_v<T, double>);
    return ScalarType::f64;
  }
}

template <class T>
CloudFile decode(const Convention& c, std::optional<double> time_unit = {}) {
  struct Row {
    float xyz[3];
    T time;
  };
  std::vector<Row> rows;
  for (int i = 0; i < kPoints; ++i) {
    rows.push_back({{1.0F, 2.0F, 3.0F}, static_cast<T>(written(c, i))});
  }
  if (c.invalid_points) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    rows.push_back({{nan, nan, nan}, T{}});
    rows.push_back({{0.0F, 0.0F, 0.0F}, T{7}});
  }
  CloudColumns columns;
  columns.points = rows.size();
  columns.time_field = "t";
  columns.reading.time_unit = time_unit;
  const auto* data = reinterpret_cast<const std::byte*>(rows.data());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns.columns[axis] = Column{data, axis * sizeof(float), sizeof(Row), ScalarType::f32, false};
  }
  columns[FieldRole::time] = Column{data, offsetof(Row, time), sizeof(Row), scalar<T>(), false};
  return decode_cloud("driver.pcd", columns);
}

/// s: how finely the type resolves the written numbers.
template <class T>
double resolution(const Convention& c) {
  const auto largest =
      static_cast<double>(std::max(std::abs(written(c, 0)), std::abs(written(c, kPoints - 1))));
  return std::is_integral_v<T> ? 0.0 : largest * c.unit * std::numeric_limits<T>::epsilon();
}

template <class T>
void expect_understood(const Convention& c) {
  const CloudFile cloud = decode<T>(c);
  ASSERT_TRUE(cloud.times);
  EXPECT_EQ(cloud.times->field, "t");
  EXPECT_EQ(cloud.times->unit, c.unit);
  EXPECT_EQ(cloud.times->absolute, c.zero == Zero::epoch);
  EXPECT_EQ(cloud.absolute_stamp, c.zero == Zero::epoch);
  const double tolerance = resolution<T>(c) + 2e-9;
  const Nanoseconds start = c.zero == Zero::start ? Nanoseconds(0)
                            : c.zero == Zero::end ? Nanoseconds(-std::llround(1e9 * c.length))
                                                  : kStart;
  const Nanoseconds error = cloud.sweep.stamp - start;
  EXPECT_LE(std::abs(1e-9 * static_cast<double>(error.count())), tolerance);
  for (int i = 0; i < kPoints; ++i) {
    EXPECT_NEAR(cloud.sweep.times.at(static_cast<std::size_t>(i)), after_start(c, i),
                2.0 * tolerance + 1e-7 * c.length);
  }
}

template <class T>
class TimeMatrix : public testing::Test {};
using Types = testing::Types<int32_t, uint32_t, int64_t, uint64_t, float, double>;
TYPED_TEST_SUITE(TimeMatrix, Types);

TYPED_TEST(TimeMatrix, EachConventionIsUnderstoodOrRefused) {
  int understood = 0;
  for (const double unit : kUnits) {
    for (const Zero zero : kZeros) {
      for (const double length : kLengths) {
        for (const int variant : {0, 1, 2, 3}) {
          const Convention c{unit, zero, length, variant % 2 == 1, variant / 2 == 1};
          if (!can_hold<TypeParam>(c)) {
            continue;
          }
          SCOPED_TRACE(c.text());
          if (std::is_same_v<TypeParam, float> && zero == Zero::epoch) {
            EXPECT_THROW(decode<TypeParam>(c), InputError) << "float32 cannot hold these times";
          } else {
            expect_understood<TypeParam>(c);
            ++understood;
          }
        }
      }
    }
  }
  EXPECT_GE(understood, 40);
}

TYPED_TEST(TimeMatrix, UnitThatIsConfiguredIsTaken) {
  // Two seconds in microseconds look like two milliseconds in nanoseconds.
  const Convention slow{1e-6, Zero::start, 2.0, false, false};
  EXPECT_EQ(decode<TypeParam>(slow).times->unit, 1e-9);
  const CloudFile cloud = decode<TypeParam>(slow, 1e-6);
  EXPECT_EQ(cloud.times->unit, 1e-6);
  EXPECT_NEAR(cloud.sweep.times.at(kPoints - 1), 2.0, 1e-6);
}

TEST(TimeMatrixLimits, SweepLongerThanAnyIsRefusedAndSaysWhatToSet) {
  const Convention hour{1e-9, Zero::start, 3600.0, false, false};
  for (const auto& read : {+[](const Convention& c) { decode<double>(c); },
                           +[](const Convention& c) { decode<int64_t>(c); }}) {
    try {
      read(hour);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(error.remedy().find("recording.point_time_unit"), std::string::npos)
          << error.remedy();
    }
  }
}

}  // namespace
}  // namespace adit
