// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/localization_table.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

LocalizationTableWriter::LocalizationTableWriter(std::filesystem::path path)
    : file_(std::move(path)) {
  file_.write(
      "time_s,state,recognised,path_m,sigma_x_m,sigma_y_m,sigma_z_m,sigma_roll_rad,"
      "sigma_pitch_rad,sigma_yaw_rad\n");
}

// Without a recognised keyframe nothing is known: the cells stay empty.
void LocalizationTableWriter::write(Nanoseconds stamp, const Localization& localization) {
  std::string line;
  append_stamp(line, stamp);
  line += "," + std::string(to_string(localization.state)) + "," +
          std::to_string(localization.recognised) + ",";
  const bool known = localization.covariance.diagonal().minCoeff() > 0.0;
  if (localization.recognised > 0) {
    append_number(line, localization.path);
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    line += ',';
    if (known) {
      append_number(line, std::sqrt(localization.covariance(i, i)));
    }
  }
  line += '\n';
  file_.write(line);
}

}  // namespace adit
