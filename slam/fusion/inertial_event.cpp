// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_event.hpp"

namespace adit {
namespace {

struct Name {
  std::string_view operator()(const Saturation&) const { return "saturation"; }
  std::string_view operator()(const SensorStarted&) const { return "sensor started"; }
  std::string_view operator()(const NoReadings&) const { return "no readings"; }
  std::string_view operator()(const GapTooLong&) const { return "gap too long"; }
  std::string_view operator()(const StuckAxis&) const { return "stuck axis"; }
  std::string_view operator()(const CheckFailed&) const { return "check failed"; }
  std::string_view operator()(const SensorCorrected&) const { return "sensor corrected"; }
  std::string_view operator()(const GyroscopeDisagrees&) const { return "gyroscope disagrees"; }
  std::string_view operator()(const PredictsWorse&) const { return "predicts worse"; }
};

}  // namespace

std::string_view to_string(StateQuantity quantity) {
  switch (quantity) {
    case StateQuantity::prediction:
      return "prediction";
    case StateQuantity::state:
      return "state";
    case StateQuantity::acceleration:
      return "acceleration";
    case StateQuantity::speed:
      return "speed";
    case StateQuantity::distance:
      return "distance";
    case StateQuantity::gyro_bias:
      return "gyroscope bias";
    case StateQuantity::accel_bias:
      return "accelerometer bias";
  }
  return "unknown";
}

std::string_view to_string(const InertialCause& cause) {
  return std::visit(Name{}, cause);
}

}  // namespace adit
