// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/tools/cameras/find_cameras.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/map_products/dense_cloud.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The recording that a map of one session was made of, with where its sensor was.
class DenseRecording {
 public:
  /// Opens what the map was made of, or what --recording names. Throws InputError: the map holds
  /// several sessions, or the recording cannot be read or is another one.
  explicit DenseRecording(const ExportJob& job);

  const SensorPath& path() const { return path_; }
  std::size_t sweeps() const { return sweeps_.size(); }  ///< of the map

  /// The cameras of --camera and --calibration, or all that the recording has, with their
  /// mountings. Throws InputError: there is none, or one whose mounting is not known.
  std::vector<CameraSource> cameras() const;

  using TakeSweep = std::function<void(const Sweep& sweep, const SensorPath::Stretch& path,
                                       const MapSweep& in_map)>;
  /// Each sweep that the map has a pose for. Returns what there was, for people. Throws InputError:
  /// none is in the map.
  std::string visit(const TakeSweep& take) const;

 private:
  const ExportJob* job_;
  Config settings_;
  std::vector<std::filesystem::path> paths_;
  std::unique_ptr<Recording> recording_;
  bool same_ = false;  ///< by content, as what the map was made of
  std::size_t topic_ = 0;
  std::vector<MapSweep> sweeps_;  ///< in the order of stamps
  SensorPath path_;
};

}  // namespace adit
