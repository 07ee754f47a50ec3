// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/export_color_options.hpp"

#include "adit/tools/support/usage_error.hpp"

namespace adit {

void check_color_options(const ExportCommandOptions& options) {
  const bool cloud = !options.cloud.empty() || !options.dense.empty() || options.tiles;
  if (options.color && !cloud && options.raster != "color") {
    throw UsageError(
        "--colorize is for clouds: --cloud, --dense, --tiles; --raster color needs no such "
        "option.");
  }
  if (!options.color &&
      (!options.cameras.empty() || options.calibration || options.as_calibrated)) {
    throw UsageError(
        "--camera, --calibration and --as-calibrated need --colorize or --raster color.");
  }
}

void add_color_options(const Command& command, ExportCommandOptions& options) {
  command.flag("--colorize", options.color,
               "Points get the colours of the recording's camera images; black where none sees "
               "them");
  command
      .option("--camera", options.cameras,
              "A topic of images to use, again for more; otherwise all that have a calibration")
      .value_name("TOPIC");
  command
      .option("--calibration", options.calibration,
              "A file of cameras: where they are mounted, their lenses, folders of images (TOML, "
              "Kalibr's camchain, OpenCV's YAML)")
      .value_name("FILE");
  command.flag("--as-calibrated", options.as_calibrated,
               "Cameras are mounted and their clocks are as the recording or the file says; "
               "otherwise small errors are found and corrected where images agree better then");
}

}  // namespace adit
