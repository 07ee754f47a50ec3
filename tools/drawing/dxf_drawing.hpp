// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Drawings for CAD programs: DXF as text, of AutoCAD 2000 (AC1015), the oldest that states its
// units. Decision 0044 says why no library writes it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace adit {

/// Of AutoCAD's colour index: 7 is black on white and white on black.
struct DxfLayer {
  std::string name{};  ///< letters, digits, '_' and '-'
  int color = 7;
};

/// Lines, open or closed polylines and points in metres, z = 0 by default.
class DxfDrawing {
 public:
  /// `remark` stands at the head of the file, for people.
  DxfDrawing(std::vector<DxfLayer> layers, std::string remark);

  void line(const std::string& layer, const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void point(const std::string& layer, const Eigen::Vector2d& at);
  /// `height`: of all corners, m.
  void polyline(const std::string& layer, std::span<const Eigen::Vector2d> corners, bool closed,
                double height = 0.0);

  /// The whole file. Same drawing, same bytes.
  std::string str() const;

 private:
  /// What all entities begin with.
  std::string begin(const char* type, const std::string& layer, const char* subclass);

  std::vector<DxfLayer> layers_;
  std::string remark_;
  std::string entities_;
  Eigen::AlignedBox3d box_;
  unsigned next_handle_ = 0;
};

}  // namespace adit
