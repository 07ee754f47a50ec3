// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// localization.csv: what a run in an earlier map knew of its place there, sweep by sweep.
#pragma once

#include <filesystem>

#include "adit/slam/core/types.hpp"
#include "adit/slam/mapping/localization.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// Writes the table as sweeps come. Throws OutputError.
class LocalizationTableWriter {
 public:
  explicit LocalizationTableWriter(std::filesystem::path path);
  void write(Nanoseconds stamp, const Localization& localization);
  void flush() { file_.flush(); }
  void close() { file_.close(); }

 private:
  OutputFile file_;
};

}  // namespace adit
