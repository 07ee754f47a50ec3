// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/cloud_painter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/coloring/map_coloring.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {

/// The colouring, with the device that it works on.
struct CloudPainter::Parts {
  Parts(const ExportJob& job, const DenseRecording& recording);

  std::vector<CameraSource> cameras;
  DeviceSession device;
  MapColoring coloring;
  std::map<NodeId, Eigen::Vector3d> sensors;  ///< m, map frame: where keyframes are
};

namespace {

DeviceOptions with_notes(const ExportJob& job) {
  DeviceOptions wanted = job.options->device;
  wanted.notes = job.err;
  return wanted;
}

/// "camera /front/image_raw: turned by 0.97 degrees, images 2 ms late: corrected".
std::string text_of(const CameraFinding& finding) {
  if (!finding.determined) {
    return fmt::format("camera {}: its views share too few surfaces to check its mounting\n",
                       finding.camera);
  }
  return fmt::format(
      "camera {}: turned by {:.2f} degrees, images {:.0f} ms {}: {}\n", finding.camera,
      finding.turned() / kDegree, 1e3 * std::abs(finding.late()),
      finding.late() < 0.0 ? "early" : "late",
      finding.corrected ? "corrected" : "its images do not agree better then; left as it is");
}

/// Looks into the cameras' errors and the brightness of their images.
void prepare(MapColoring& coloring, const ExportJob& job) {
  std::optional<Progress> progress;
  const auto update = [&](std::size_t done, std::size_t total) {
    if (!progress) {
      progress.emplace(*job.err, progress_style_of_stderr(), "images", total,
                       Progress::Clock::now(), "views");
    }
    progress->update(done, 0);
    require_within(job);
  };
  const bool corrects = !job.options->as_calibrated;
  for (const CameraFinding& finding : coloring.prepare(corrects, update)) {
    *job.out << text_of(finding);
  }
  if (progress) {
    progress->finish();
  }
}

std::string text_of(const ColoringCounts& counts, std::size_t cameras, const std::string& things) {
  std::string text = fmt::format("; {:.0f} % of the {} have a colour, by {} of {} images of {}",
                                 100.0 * static_cast<double>(counts.colored) /
                                     static_cast<double>(std::max<uint64_t>(1, counts.points)),
                                 things, counts.views, counts.images,
                                 cameras == 1 ? "1 camera" : fmt::format("{} cameras", cameras));
  if (counts.damaged > 0) {
    text += fmt::format("; {} images are damaged", counts.damaged);
  }
  if (counts.other_size > 0) {
    text += fmt::format("; {} images have another size than their calibration", counts.other_size);
  }
  return text;
}

}  // namespace

CloudPainter::Parts::Parts(const ExportJob& job, const DenseRecording& recording)
    : cameras(recording.cameras()),
      device(with_notes(job)),
      coloring(*job.map, device.context(), cameras, recording.path(), job.moved,
               job.memory->submap_bytes()) {
  for (const MapKeyframe& keyframe : job.map->keyframes()) {
    sensors.emplace(keyframe.id, keyframe.T_map_keyframe.translation());
  }
  prepare(coloring, job);
}

CloudPainter::CloudPainter(const ExportJob& job) {
  if (job.options->color) {
    parts_ = std::make_unique<Parts>(job, DenseRecording(job));
  }
}

CloudPainter::CloudPainter(const ExportJob& job, const DenseRecording& recording)
    : parts_(job.options->color ? std::make_unique<Parts>(job, recording) : nullptr) {}

CloudPainter::~CloudPainter() = default;

void CloudPainter::paint(std::span<CloudPoint> points, const Eigen::Vector3d& sensor) {
  if (parts_) {
    parts_->coloring.color(points, sensor);
  }
}

std::span<const CloudPoint> CloudPainter::painted(std::span<const CloudPoint> points) {
  if (!parts_) {
    return points;
  }
  painted_.assign(points.begin(), points.end());
  for (auto first = painted_.begin(); first != painted_.end();) {
    const NodeId keyframe = first->keyframe;
    const auto end = std::find_if(
        first, painted_.end(), [&](const CloudPoint& point) { return point.keyframe != keyframe; });
    parts_->coloring.color({first, end}, parts_->sensors.at(keyframe));
    first = end;
  }
  return painted_;
}

std::string CloudPainter::finish(const std::string& things) {
  if (!parts_) {
    return "";
  }
  parts_->device.require_no_complaints();
  return text_of(parts_->coloring.counts(), parts_->cameras.size(), things);
}

}  // namespace adit
