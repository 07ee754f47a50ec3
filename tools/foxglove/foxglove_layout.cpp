// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_layout.hpp"

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr double kNearest = 30.0;  // m, from the camera to what it looks at
constexpr double kPixelsOfPoint = 2.0;

/// Panels one after the other, `direction` "row" or "column", each as large as the others.
ordered_json side_by_side(const std::string& direction, const std::vector<ordered_json>& panels) {
  ordered_json all = panels.back();
  for (std::size_t i = panels.size() - 1; i-- > 0;) {
    all = {{"first", panels[i]},
           {"second", all},
           {"direction", direction},
           {"splitPercentage", 100.0 / static_cast<double>(panels.size() - i)}};
  }
  return all;
}

ordered_json plotted(std::string_view title, std::initializer_list<std::string_view> fields) {
  ordered_json paths = ordered_json::array();
  for (const std::string_view field : fields) {
    paths.push_back({{"value", "/sweep." + std::string(field)},
                     {"label", field},
                     {"enabled", true},
                     {"timestampMethod", "receiveTime"}});
  }
  return {{"foxglovePanelTitle", title},    {"paths", paths},     {"showXAxisLabels", true},
          {"showYAxisLabels", true},        {"showLegend", true}, {"legendDisplay", "floating"},
          {"showPlotValuesInLegend", true}, {"isSynced", true},   {"xAxisVal", "timestamp"}};
}

ordered_json scene_panel(const LayoutSubject& subject) {
  const bool known = !subject.way.isEmpty();
  const Eigen::Vector3d middle = known ? subject.way.center() : Eigen::Vector3d::Zero().eval();
  const double across = known ? subject.way.sizes().norm() : 0.0;
  ordered_json topics = {{"/map/points",
                          {{"visible", true},
                           {"colorMode", "colormap"},
                           {"colorField", "z"},
                           {"colorMap", "turbo"},
                           {"pointSize", kPixelsOfPoint}}},
                         {"/keyframe/points",
                          {{"visible", true},
                           {"colorMode", "flat"},
                           {"flatColor", "#ffffff"},
                           {"pointSize", kPixelsOfPoint}}},
                         {"/pose", {{"visible", false}}}};
  for (const char* part :
       {"trajectory", "odometry", "keyframes", "constraints", "loops", "uncertainty"}) {
    topics["/graph/" + std::string(part)] = {{"visible", true}};
  }
  return {{"cameraState",
           {{"perspective", true},
            {"distance", std::max(kNearest, 1.2 * across)},
            {"phi", 45.0},
            {"thetaOffset", 30.0},
            {"targetOffset", {middle.x(), middle.y(), middle.z()}},
            {"target", {0.0, 0.0, 0.0}},
            {"targetOrientation", {0.0, 0.0, 0.0, 1.0}},
            {"fovy", 45.0},
            {"near", 0.1},
            {"far", 20000.0}}},
          {"followMode", "follow-none"},
          {"followTf", "map"},
          {"scene", ordered_json::object()},
          {"transforms", {{"frame:world", {{"visible", false}}}}},
          {"topics", topics},
          {"layers", ordered_json::object()}};
}

ordered_json states_panel() {
  ordered_json paths = ordered_json::array();
  for (const char* field : {"state", "registration", "imu"}) {
    paths.push_back(
        {{"value", "/sweep." + std::string(field)}, {"timestampMethod", "receiveTime"}});
  }
  return {{"foxglovePanelTitle", "states"}, {"paths", paths}, {"isSynced", true}};
}

}  // namespace

std::string foxglove_layout(const LayoutSubject& subject) {
  ordered_json panels = {
      {"3D!scene", scene_panel(subject)},
      {"RosOut!log",
       {{"searchTerms", ordered_json::array()}, {"minLogLevel", 2}, {"topicToRender", "/log"}}}};
  std::vector<ordered_json> left = {"3D!scene"};
  std::vector<ordered_json> right;
  if (subject.has_places) {
    panels["map!places"] = {{"layer", "map"},
                            {"followTopic", ""},
                            {"disabledTopics", ordered_json::array()},
                            {"zoomLevel", 16}};
    right.emplace_back("map!places");
  }
  if (subject.has_sweeps) {
    panels["Plot!alignment"] = plotted("alignment", {"overlap", "residual_rms_m"});
    panels["Plot!certainty"] =
        plotted("one sigma in the map", {"position_sigma_m", "attitude_sigma_rad"});
    panels["Plot!velocity"] = plotted(
        "velocity in the map", {"velocity_x_m_per_s", "velocity_y_m_per_s", "velocity_z_m_per_s"});
    panels["StateTransitions!states"] = states_panel();
    right.insert(right.end(),
                 {"Plot!alignment", "Plot!certainty", "Plot!velocity", "StateTransitions!states"});
  }
  right.emplace_back("RosOut!log");
  const ordered_json layout = {{"configById", panels},
                               {"globalVariables", ordered_json::object()},
                               {"userNodes", ordered_json::object()},
                               {"playbackConfig", {{"speed", 1.0}}},
                               {"layout",
                                {{"first", side_by_side("column", left)},
                                 {"second", side_by_side("column", right)},
                                 {"direction", "row"},
                                 {"splitPercentage", 62.0}}}};
  return layout.dump(2) + "\n";
}

}  // namespace adit
