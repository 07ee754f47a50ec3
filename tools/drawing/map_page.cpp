// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/map_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "adit/tools/drawing/map_page_script.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/support/base64.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostPoses = 65535;  // what 16 bits number
constexpr float kSteps = 65535.0F;

constexpr std::string_view kMapStyle = R"(
:root { color-scheme: light dark; }
body { margin: 0; font: 14px/1.45 system-ui, "DejaVu Sans", sans-serif; color: #222; background: #fff; overflow: hidden; }
canvas { position: fixed; inset: 0; width: 100vw; height: 100vh; touch-action: none; cursor: grab; }
header, aside { position: fixed; left: 0; max-width: min(30em, calc(100vw - 2em)); padding: 0.5em 0.9em; background: #fffd; border-radius: 0 0 6px 0; }
header { top: 0; } h1 { font-size: 1.05em; margin: 0 0 0.1em; overflow-wrap: anywhere; } p { margin: 0.15em 0; }
label { margin-right: 0.8em; white-space: nowrap; } input[type=range] { width: 6em; vertical-align: middle; }
aside { bottom: 0; border-radius: 0 6px 0 0; } dl { display: grid; grid-template-columns: max-content 1fr; gap: 0 1em; margin: 0.3em 0; }
dl[hidden] { display: none; } dt { color: #666; } dd { margin: 0; } small { color: #666; } #problem { color: #a4262c; }
details { position: fixed; top: 0; right: 0; max-width: min(46em, calc(100vw - 2em)); max-height: 100vh; overflow: auto; box-sizing: border-box; padding: 0.5em 0.9em; background: #fffe; border-radius: 0 0 0 6px; }
summary { cursor: pointer; } details svg { max-width: 100%; height: auto; }
#scale { white-space: nowrap; } #ramp { display: inline-block; width: 6em; height: 0.7em; border-radius: 2px; }
@media (prefers-color-scheme: dark) { body { color: #eceff3; background: #15181c; } header, aside, details { background: #15181cee; } dt, small { color: #a7adb5; } #problem { color: #f2848a; } }
)";

constexpr std::string_view kBody = R"(<canvas id="view"></canvas>
<header><h1>@title@</h1><p>@headline@</p>
<p><label>colour <select id="colour"><option>height</option><option>intensity</option><option>time</option><option>uncertainty</option></select></label> <small id="scale"><span id="least"></span> <i id="ramp"></i> <span id="most"></span></small></p>
<p><label><input type="checkbox" id="points" checked> points</label><label>size <input type="range" id="size" min="1" max="8" step="0.5" value="2"></label>
<button id="above">from above</button> <button id="reset">reset</button></p><p id="problem"></p></header>
@panel@<aside><dl id="told" hidden></dl><p>trajectory: <span id="states"></span></p><small>Drag turns, shift-drag shifts, the wheel zooms; click the trajectory for its sweep.</small></aside>
)";

/// A number that JSON can hold; null else.
ordered_json number(double value, double unit) {
  return std::isfinite(value) ? ordered_json(std::round(value / unit) * unit) : ordered_json();
}

ordered_json json_of(const PagePose& pose) {
  return {{"time", number(pose.time, 1e-3)},
          {"p", {number(pose.p.x(), 1e-3), number(pose.p.y(), 1e-3), number(pose.p.z(), 1e-3)}},
          {"state", pose.state},
          {"registration", pose.registration},
          {"imu", pose.imu},
          {"overlap", number(pose.overlap, 1e-3)},
          {"residual", number(pose.residual_rms, 1e-4)},
          {"sigma", number(pose.sigma, 1e-4)}};
}

/// What 98 of 100 values stay below.
float usual_most(std::vector<float> values) {
  if (values.empty()) {
    return 1.0F;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 98 / 100);
  std::ranges::nth_element(values, at);
  return *at > 0.0F ? *at : 1.0F;
}

ordered_json json_of(std::span<const PagePoint> points, std::size_t stride) {
  Eigen::AlignedBox3f box;
  std::vector<float> intensities;
  for (const PagePoint& point : points) {
    box.extend(point.p);
    intensities.push_back(point.intensity);
  }
  if (box.isEmpty()) {
    box.extend(Eigen::Vector3f::Zero().eval());
  }
  const float step = std::max(box.sizes().maxCoeff(), 1e-3F) / kSteps;
  const float brightest = usual_most(std::move(intensities));
  std::vector<uint16_t> places;
  std::vector<uint16_t> poses;
  std::vector<uint8_t> intensity;
  for (const PagePoint& point : points) {
    const Eigen::Vector3f scaled = (point.p - box.min()) / step;
    for (int k = 0; k < 3; ++k) {
      places.push_back(static_cast<uint16_t>(std::clamp(scaled[k] + 0.5F, 0.0F, kSteps)));
    }
    poses.push_back(static_cast<uint16_t>(point.pose / stride));
    intensity.push_back(
        static_cast<uint8_t>(std::clamp(255.0F * point.intensity / brightest, 0.0F, 255.0F)));
  }
  return {{"low", {box.min().x(), box.min().y(), box.min().z()}},
          {"step", step},
          {"places", base64(std::as_bytes(std::span(places)))},
          {"sweeps", base64(std::as_bytes(std::span(poses)))},
          {"intensity", base64(std::as_bytes(std::span(intensity)))}};
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  const std::size_t at = text.find(what);
  return text.replace(at, what.size(), by);
}

std::string panel_of(const MapPage& page) {
  return page.section.empty() ? ""
                              : "<details id=\"panel\"><summary>" + escape_markup(page.section) +
                                    "</summary>\n" + page.details + "</details>\n";
}

std::string body_of(const MapPage& page) {
  std::string body = replaced(std::string(kBody), "@panel@", panel_of(page));
  body = replaced(std::move(body), "@headline@", escape_markup(page.headline));
  return replaced(std::move(body), "@title@", escape_markup(page.title));
}

}  // namespace

std::string map_page(const MapPage& page) {
  const std::size_t stride =
      std::max<std::size_t>((page.poses.size() + kMostPoses - 1) / kMostPoses, 1);
  ordered_json data = {{"points", json_of(page.points, stride)},
                       {"poses", ordered_json::array()},
                       {"columns",
                        {{"time", "time (s)"},
                         {"p", "x, y, z (m)"},
                         {"state", "state"},
                         {"registration", "alignment"},
                         {"imu", "imu"},
                         {"overlap", "overlap"},
                         {"residual", "residual rms (m)"},
                         {"sigma", "1 sigma (m)"}}}};
  for (std::size_t i = 0; i < page.poses.size(); i += stride) {
    data["poses"].push_back(json_of(page.poses[i]));
  }
  std::string json = data.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
  for (std::size_t at = 0; (at = json.find('<', at)) != json.npos;) {
    json.replace(at, 1, "\\u003c");  // could end the element it stands in
  }
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
         "<meta name=\"generator\" content=\"" +
         std::string(kGenerator) + "\"><title>" + escape_markup(page.title) + "</title><style>" +
         std::string(kMapStyle) + "</style></head><body>\n" + body_of(page) +
         "<script type=\"application/json\" id=\"data\">" + json + "</script>\n<script>\n" +
         std::string(map_page_script()) + "</script></body></html>\n";
}

}  // namespace adit
