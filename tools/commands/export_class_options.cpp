// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/export_class_options.hpp"

#include "adit/tools/support/usage_error.hpp"

namespace adit {

void check_class_options(const ExportCommandOptions& options) {
  const bool cloud = !options.cloud.empty() || !options.dense.empty() || options.tiles;
  if (options.classify && !cloud) {
    throw UsageError("--classify is for clouds: --cloud, --dense, --tiles.");
  }
  if (!options.clean.empty() && !cloud) {
    throw UsageError("--clean is for clouds: --cloud, --dense, --tiles.");
  }
}

void add_class_options(const Command& command, ExportCommandOptions& options) {
  command.flag("--classify", options.classify,
               "Finds the ground, of each storey that the path leads over: class 2 of LAS files, "
               "others 1; PLY and PCD files get the class of each point");
  command
      .option("--clean", options.clean,
              "Finds noise, points that nothing is beside, and what has moved, as --find-moving: "
              "mark (classes 7 below the ground, 18 elsewhere, 64 moving; of --dense also 65 mixed "
              "pixels and 66 the sensor's carrier) or drop")
      .one_of({"mark", "drop"})
      .value_name("HOW");
}

}  // namespace adit
