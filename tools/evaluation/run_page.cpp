// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "adit/slam/core/units.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/time_panels.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"

namespace adit {
namespace {

constexpr std::array<std::string_view, 3> kAxisNames = {"x", "y", "z"};

using Sweeps = std::vector<SweepRecord>;

std::vector<double> values_of(const Sweeps& sweeps,
                              const std::function<double(const SweepRecord&)>& value) {
  std::vector<double> values;
  std::ranges::transform(sweeps, std::back_inserter(values), value);
  return values;
}

/// Three curves with their bands of a standard deviation, where there are any.
std::vector<Curve> axes_of(const Sweeps& sweeps, double unit,
                           const Eigen::Vector3d SweepRecord::*vector,
                           const Eigen::Vector3d SweepRecord::*sigma = nullptr) {
  std::vector<Curve> curves;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    Curve curve{.name = std::string(kAxisNames[k]), .color = kAxisColors[k], .values = {}};
    curve.values = values_of(sweeps, [&](const SweepRecord& s) { return unit * (s.*vector)[at]; });
    if (sigma != nullptr) {
      curve.sigma = values_of(sweeps, [&](const SweepRecord& s) { return unit * (s.*sigma)[at]; });
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

Band band_of(const Sweeps& sweeps, const std::string& name, const std::vector<BandClass>& classes,
             const std::function<std::string(const SweepRecord&)>& word) {
  Band band{.name = name, .values = {}};
  for (const SweepRecord& sweep : sweeps) {
    const auto found = std::ranges::find(classes, word(sweep), &BandClass::name);
    band.values.push_back(found == classes.end() ? -1 : static_cast<int>(found - classes.begin()));
  }
  return band;
}

TimePanel states(const Sweeps& sweeps) {
  const std::vector<BandClass> classes = {{"tracking", kGoodColor},
                                          {"coasting", kMiddlingColor},
                                          {"restarted", kBadColor},
                                          {"initializing", kUnknownColor}};
  return {.title = "Odometry",
          .bands = {band_of(sweeps, "sweep", classes, [](const auto& s) { return s.state; })},
          .classes = classes};
}

TimePanel inertial_states(const Sweeps& sweeps) {
  const std::vector<BandClass> classes = {{"fused", kGoodColor},
                                          {"starting", kUnknownColor},
                                          {"lost", kMiddlingColor},
                                          {"refused", kBadColor}};
  return {.title = "Inertial sensor",
          .bands = {band_of(sweeps, "IMU", classes, [](const auto& s) { return s.imu; })},
          .classes = classes};
}

TimePanel directions(const Sweeps& sweeps) {
  const std::vector<BandClass> classes = {
      {"full", kGoodColor}, {"partial", kMiddlingColor}, {"none", kBadColor}};
  TimePanel panel{.title = "Directions held by matches, weakest first", .classes = classes};
  constexpr std::array<std::string_view, 3> kRanks = {"weakest", "second", "third"};
  for (const bool rotation : {false, true}) {
    for (std::size_t k = 0; k < 3; ++k) {
      panel.bands.push_back(
          band_of(sweeps, (rotation ? "turn, " : "move, ") + std::string(kRanks[k]), classes,
                  [&](const SweepRecord& s) {
                    return (rotation ? s.rotation : s.translation)[k].localizability;
                  }));
    }
  }
  return panel;
}

/// Where the weakest direction of translation points.
TimePanel weakest_axis(const Sweeps& sweeps) {
  TimePanel panel{
      .title = "Weakest direction of movement, axes of the map", .low = 0.0, .high = 1.0};
  for (std::size_t k = 0; k < 3; ++k) {
    panel.curves.push_back(
        {.name = "|" + std::string(kAxisNames[k]) + "|",
         .color = kAxisColors[k],
         .values = values_of(sweeps,
                             [&](const SweepRecord& s) {
                               return std::abs(s.translation[0].axis[static_cast<Eigen::Index>(k)]);
                             }),
         .dots = true});
  }
  return panel;
}

TimePanel overlap(const RunReview& review) {
  TimePanel panel{.title = "Share of points with a match", .low = 0.0, .high = 1.05};
  panel.curves = {
      {.name = "", .values = values_of(review.sweeps, [](const auto& s) { return s.overlap; })}};
  if (review.min_overlap) {
    panel.gates = {{"registration.min_overlap", *review.min_overlap}};
  }
  return panel;
}

TimePanel residual(const Sweeps& sweeps) {
  return {.title = "Distance of matches (rms, cm)",
          .curves = {{.name = "",
                      .values =
                          values_of(sweeps, [](const auto& s) { return 100.0 * s.residual_rms; })}},
          .low = 0.0};
}

TimePanel innovations(const Sweeps& sweeps) {
  TimePanel panel{.title = "Innovation, squared and normalised", .logarithmic = true};
  panel.curves = {
      {.name = "alignment against the IMU's prediction",
       .values = values_of(sweeps, [](const auto& s) { return s.innovation_squared; }),
       .dots = true},
      {.name = "95 % of chi squared",
       .color = kSeriesColors[2],
       .values = values_of(sweeps,
                           [](const SweepRecord& s) {
                             return s.innovation_degrees > 0.0
                                        ? chi_squared_95(static_cast<int>(s.innovation_degrees))
                                        : kUnknown;
                           })},
      {.name = "gate",
       .color = kGateColor,
       .values = values_of(sweeps, [](const auto& s) { return s.innovation_gate; }),
       .dash = "7 4"}};
  return panel;
}

TimePanel tilt(const Sweeps& sweeps) {
  const auto towards = [&](int axis, std::string_view color, const std::string& name) {
    return Curve{.name = name,
                 .color = color,
                 .values = values_of(sweeps,
                                     [axis](const SweepRecord& s) {
                                       return kDegreesPerRadian *
                                              std::atan2(s.gravity[axis], -s.gravity.z());
                                     }),
                 .sigma = values_of(
                     sweeps, [](const auto& s) { return kDegreesPerRadian * s.gravity_sigma; })};
  };
  return {
      .title = "Gravity off the map's -z (degrees, band of one sigma)",
      .curves = {towards(0, kAxisColors[0], "towards x"), towards(1, kAxisColors[1], "towards y")}};
}

/// Roots of the traces of the covariances: `at` 0 of the position, 3 of the attitude.
TimePanel uncertainty(const Sweeps& sweeps, const std::string& title, double unit,
                      Eigen::Index at) {
  const auto sigma = [unit, at](const Matrix6d& covariance) {
    const double trace = covariance.diagonal().segment<3>(at).sum();
    return trace > 0.0 ? unit * std::sqrt(trace) : kUnknown;
  };
  return {.title = title,
          .curves = {{.name = "relative to the submap",
                      .color = kSeriesColors[1],
                      .values = values_of(
                          sweeps, [&](const auto& s) { return sigma(s.uncertainty.local); })},
                     {.name = "in the map",
                      .values = values_of(
                          sweeps, [&](const auto& s) { return sigma(s.uncertainty.in_map()); })}},
          .low = 0.0};
}

/// One of the six errors, in the bounds that three sigma of it make.
TimePanel bounded_error(const PoseConsistency& found, Eigen::Index at) {
  const bool turn = at >= 3;
  const double unit = turn ? 1e3 : 100.0;
  const auto axis = static_cast<std::size_t>(at % 3);
  Curve error{.name = "error", .color = kAxisColors[axis], .values = {}};
  Curve bound{.name = "3 sigma", .color = kSeriesColors[4], .values = {}};
  double largest = 0.0;
  for (std::size_t i = 0; i < found.errors.size(); ++i) {
    error.values.push_back(unit * found.errors[i][at]);
    bound.sigma.push_back(unit * 3.0 * found.sigmas[i][at]);
    bound.values.push_back(0.0 * bound.sigma.back());  // unknown where that is
    largest = std::fmax(largest, std::fmax(std::abs(error.values.back()), bound.sigma.back()));
  }
  return {
      .title = std::string(turn ? "Error of the attitude about " : "Error of the position along ") +
               std::string(kAxisNames[axis]) + (turn ? " (mrad" : " (cm") + ", axes of the lidar)",
      .curves = {std::move(bound), std::move(error)},
      .low = -1.08 * std::fmax(largest, 1e-6),
      .high = 1.08 * std::fmax(largest, 1e-6)};
}

}  // namespace

std::string draw_run(const RunReview& review, double width) {
  const Sweeps& sweeps = review.sweeps;
  const std::vector<TimePanel> panels = {
      states(sweeps),
      inertial_states(sweeps),
      directions(sweeps),
      weakest_axis(sweeps),
      overlap(review),
      residual(sweeps),
      innovations(sweeps),
      {.title = "Innovation of the position (cm, axes of the IMU)",
       .curves = axes_of(sweeps, 100.0, &SweepRecord::innovation_translation)},
      {.title = "Innovation of the attitude (mrad, axes of the IMU)",
       .curves = axes_of(sweeps, 1e3, &SweepRecord::innovation_rotation)},
      {.title = "Bias of the gyroscope (mrad/s, band of one sigma)",
       .curves = axes_of(sweeps, 1e3, &SweepRecord::gyro_bias, &SweepRecord::gyro_bias_sigma)},
      {.title = "Bias of the accelerometer (m/s^2, band of one sigma)",
       .curves = axes_of(sweeps, 1.0, &SweepRecord::accel_bias, &SweepRecord::accel_bias_sigma)},
      tilt(sweeps),
      {.title = "Velocity (m/s, axes of the map)",
       .curves = axes_of(sweeps, 1.0, &SweepRecord::velocity)},
      uncertainty(sweeps, "How well the position is known (cm, one sigma of all axes)", 100.0, 0),
      uncertainty(sweeps, "How well the attitude is known (mrad, one sigma of all axes)", 1e3, 3)};
  return draw_time_panels(review.times, panels, width);
}

std::string draw_consistency(const RunReview& review, const PoseConsistency& consistency,
                             double width) {
  std::vector<TimePanel> panels;
  for (Eigen::Index at = 0; at < 6; ++at) {
    panels.push_back(bounded_error(consistency, at));
  }
  return draw_time_panels(review.times, panels, width);
}

std::string run_page(const std::string& title, const std::string& report, const RunReview& review,
                     const RunTruth* truth, const std::string& more) {
  std::string body = "<h1>" + escape_markup(title) + "</h1>\n" + html_text(report);
  if (truth != nullptr) {
    body += "<h2>Against the truth</h2>\n" + html_drawing([&](double width) {
              return plot_evaluation(truth->evaluation, title, width);
            });
    if (truth->consistency) {
      body += "<h2>Errors since the first sweep, and what the run said of them</h2>\n" +
              html_drawing([&](double width) {
                return draw_consistency(review, *truth->consistency, width);
              });
    }
  }
  return html_page(title, body + more + "<h2>Over time</h2>\n" +
                              html_drawing([&](double width) { return draw_run(review, width); }));
}

}  // namespace adit
