// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// --colorize: the points of a product get the colours of the recording's cameras.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/export/dense_recording.hpp"
#include "adit/tools/export/export_job.hpp"

namespace adit {

/// Does nothing where the options do not ask for colours.
class CloudPainter {
 public:
  /// Opens the map's recording and the device, finds the cameras' errors and the brightness of
  /// their images, and reports the errors to `job.out`. Throws InputError (no recording, no camera
  /// with a known mounting), engine::Error.
  explicit CloudPainter(const ExportJob& job);
  /// The same of a recording that is open.
  CloudPainter(const ExportJob& job, const DenseRecording& recording);
  ~CloudPainter();
  CloudPainter(const CloudPainter&) = delete;
  CloudPainter& operator=(const CloudPainter&) = delete;

  /// Gives points that were seen from around `sensor` (map frame, m) their colours.
  void paint(std::span<CloudPoint> points, const Eigen::Vector3d& sensor);

  /// The points of submaps with colours, those of a keyframe one after the other; valid until the
  /// next call.
  std::span<const CloudPoint> painted(std::span<const CloudPoint> points);

  /// "; 93 % of the points have a colour, by 214 of 600 images of 1 camera"; `things`: "points".
  /// Empty where nothing was asked for. Throws engine::Error where the validation layers complain.
  std::string finish(const std::string& things = "points");

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  std::vector<CloudPoint> painted_;
};

}  // namespace adit
