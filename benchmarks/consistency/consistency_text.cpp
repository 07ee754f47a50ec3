// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <ostream>

#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/consistency/consistency.hpp"

namespace adit::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "bench-consistency/2";
constexpr int kPoseDegrees = 6;
// What a covariance may be wrong by: the squared error is half to twice what it says.
constexpr double kFactor = 2.0;

Json to_json(const Consistency& found) {
  const MeanBounds bounds = chi_squared_bounds(found.runs, kPoseDegrees);
  Json motions = Json::array();
  for (std::size_t k = 0; k < kHorizons.size(); ++k) {
    Json motion = {{"seconds", 1e-3 * static_cast<double>(kHorizons[k].count())}};
    motion.update(to_json(found.motions[k]));
    motions.push_back(std::move(motion));
  }
  return {{"runs", found.runs},
          {"fused_sweeps", found.sweeps},
          {"bridged_sweeps", found.bridged},
          {"path_m", found.path},
          {"last_position_rms_m", found.error},
          {"last_attitude_rms_rad", found.turn},
          {"nees_a_degree",
           {{"last_pose_in_map", to_json(found.last)},
            {"bounds_of_last_pose", {bounds.low, bounds.high}},
            {"every_pose_in_map", to_json(found.all)},
            {"motions", std::move(motions)}}},
          {"innovations",
           {{"count", found.innovations},
            {"nis_a_degree", found.nis},
            {"correlation_1_to_5_sweeps_apart", found.correlation},
            {"bound_of_white", white_bound(found)}}}};
}

Json to_json(const Setting& s) {
  return {{"version", s.version},
          {"commit", s.commit},
          {"date", s.date},
          {"device", s.device},
          {"host", s.host}};
}

}  // namespace

nlohmann::ordered_json to_json(const ConsistencyReport& report) {
  Json cases = Json::array();
  for (const ConsistencyRow& row : report.rows) {
    Json one = {{"name", row.what.name},
                {"scene", row.what.scene},
                {"sensor", row.what.sensor},
                {"trajectory", row.what.trajectory},
                {"duration_s", row.what.duration}};
    one.update(to_json(row.found));
    cases.push_back(std::move(one));
  }
  return {{"schema", kSchema},
          {"setting", to_json(report.setting)},
          {"settings", report.settings},
          {"cases", cases},
          {"all", to_json(report.all)}};
}

void print_consistency_head(const ConsistencyReport& report, std::ostream& out) {
  out << "device   " << report.setting.device << "\n"
      << "adit     " << report.setting.version << " (" << report.setting.commit << "), "
      << (report.settings.empty() ? "default settings"
                                  : fmt::format("{}", fmt::join(report.settings, ", ")))
      << "\n"
      << "NEES     squared errors over what the covariance says, a degree of freedom: of the last "
         "pose in the map\n"
         "         (with 95 % bounds for independent runs; translation, rotation), of every pose, "
         "of motions over 0.1, 1 and 10 s\n"
         "NIS      of innovations, a degree; rho: their correlation 1 to 5 sweeps apart, and the "
         "bound of white ones\n\n"
      << "case      runs   path m     mm   mrad   last NEES  (   95 %   )  trans    rot   every  "
         "0.1 s    1 s   10 s    NIS   rho                              bound\n";
}

void print_consistency_row(const std::string& name, const Consistency& found, std::ostream& out) {
  const MeanBounds bounds = chi_squared_bounds(found.runs, kPoseDegrees);
  const auto& rho = found.correlation;
  out << fmt::format(
             "{:<9} {:4} {:>8.1f} {:>6.1f} {:>6.2f} {:>11.2f}  ({:.2f}-{:.2f}) {:>6.2f} {:>6.2f} "
             "{:>7.2f} {:>6.2f} {:>6.2f} {:>6} {:>6.2f}",
             name, found.runs, found.path, 1e3 * found.error, 1e3 * found.turn, found.last.pose,
             bounds.low, bounds.high, found.last.translation, found.last.rotation, found.all.pose,
             found.motions[0].pose, found.motions[1].pose,
             found.motions[2].samples > 0 ? fmt::format("{:.2f}", found.motions[2].pose) : "-",
             found.nis)
      << fmt::format("  {:>5.2f} {:>5.2f} {:>5.2f} {:>5.2f} {:>5.2f}  {:>6.3f}", rho[0], rho[1],
                     rho[2], rho[3], rho[4], white_bound(found));
  if (found.bridged > 0) {
    out << fmt::format("  {} sweeps bridged", found.bridged);
  }
  out << "\n";
}

void print_consistency_verdict(const Consistency& all, std::ostream& out) {
  const bool honest = all.last.pose >= 1.0 / kFactor && all.last.pose <= kFactor;
  const double largest = std::abs(
      *std::ranges::max_element(all.correlation, {}, [](double rho) { return std::abs(rho); }));
  out << "\npose     NEES " << fmt::format("{:.2f}", kPoseDegrees * all.last.pose) << " for "
      << kPoseDegrees << " degrees of freedom over " << all.runs
      << " runs: " << (honest ? "within" : "outside") << " [0.5, 2] times that\n"
      << "white    " << (largest <= white_bound(all) ? "innovations are" : "innovations are not")
      << fmt::format(": they correlate by up to {:.2f}, white ones by less than {:.3f}", largest,
                     white_bound(all))
      << "\n";
}

}  // namespace adit::bench
