// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/faults.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>

#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr std::array<std::pair<std::string_view, Fault>, 10> kFaults{
    {{"clock-offset", Fault::clock_offset},
     {"clock-drift", Fault::clock_drift},
     {"gap", Fault::gap},
     {"duplicates", Fault::duplicates},
     {"reordering", Fault::reordering},
     {"nan", Fault::nan},
     {"wrong-units", Fault::wrong_units},
     {"swapped-axes", Fault::swapped_axes},
     {"blocked-sector", Fault::blocked_sector},
     {"truncated", Fault::truncated}}};

constexpr double kOneIn50 = 0.02;

/// Each purpose of a topic's messages has its own numbers.
uint64_t counter(uint64_t index, uint64_t purpose) {
  return index * 16U + purpose;
}

}  // namespace

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (const auto& [name, fault] : kFaults) {
    names.emplace_back(name);
  }
  return names;
}

Fault fault_named(std::string_view name) {
  for (const auto& [known, fault] : kFaults) {
    if (known == name) {
      return fault;
    }
  }
  throw UsageError("there is no fault '" + std::string(name) + "'. " +
                   suggestion(std::string(name), fault_names()) + ".");
}

FaultMaker::FaultMaker(std::vector<Fault> faults, double duration, uint64_t seed)
    : faults_(std::move(faults)), duration_(duration), seed_(seed) {}

bool FaultMaker::has(Fault fault) const {
  return std::ranges::count(faults_, fault) > 0;
}

void FaultMaker::distort(RangeSweep& sweep) const {
  const CounterRandom random(seed_, RandomStream::fault);
  if (has(Fault::nan)) {
    const uint64_t first = static_cast<uint64_t>(sweep.start);
    for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
      if (sweep.returns[i].range > 0.0 && random.uniform(counter(first + i, 15)) < 0.05) {
        sweep.returns[i].range = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  if (has(Fault::blocked_sector)) {
    for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
      // From 120 to 180 degrees.
      const Eigen::Vector3d& direction = sweep.firings[i].direction;
      if (direction.y() > 0.0 && -direction.x() > direction.y() / std::numbers::sqrt3) {
        sweep.returns[i] = {};
      }
    }
  }
}

void FaultMaker::distort(ImuSample& sample) const {
  if (has(Fault::clock_offset)) {
    sample.stamp += std::chrono::milliseconds(50);
  }
  if (has(Fault::clock_drift)) {
    sample.stamp += sample.stamp / 5000;
  }
  if (has(Fault::wrong_units)) {
    sample.linear_acceleration /= kStandardGravity;
    sample.angular_velocity *= 180.0 / std::numbers::pi;
  }
  if (has(Fault::swapped_axes)) {
    const auto turned = [](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v.y(), -v.x(), v.z());
    };
    sample.linear_acceleration = turned(sample.linear_acceleration);
    sample.angular_velocity = turned(sample.angular_velocity);
  }
}

int FaultMaker::copies(uint64_t topic, uint64_t index, Nanoseconds time) const {
  const double seconds = 1e-9 * static_cast<double>(time.count());
  if (has(Fault::gap) && seconds >= 0.4 * duration_ && seconds < 0.4 * duration_ + 2.0) {
    return 0;
  }
  const CounterRandom random(seed_, RandomStream::fault);
  return has(Fault::duplicates) && random.uniform(counter(index, topic)) < kOneIn50 ? 2 : 1;
}

bool FaultMaker::comes_late(uint64_t index) const {
  return has(Fault::reordering) &&
         CounterRandom(seed_, RandomStream::fault).uniform(counter(index, 14)) < kOneIn50;
}

}  // namespace adit
