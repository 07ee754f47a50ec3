// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The folder that `adit run` writes holds the results of one run: those of an earlier run are
// replaced together, and a file that no run wrote is never replaced.
#pragma once

#include <filesystem>
#include <vector>

namespace adit {

/// Every file that a run can write into its folder.
std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder);

/// Whether the file is a page or a drawing that adit made.
bool drawn_by_us(const std::filesystem::path& file);

/// Whether a run of adit wrote the folder: its summary.json names the program and how it ended.
bool holds_a_run(const std::filesystem::path& folder);

/// Whether it is the folder of a run: one that holds a run, or a table of sweeps.
bool is_run(const std::filesystem::path& folder);

/// Checks, without writing, that a run of the recording may write into the folder. Returns whether
/// an earlier run's results are in it. Throws UsageError where the folder is the recording or lies
/// inside it (links are followed), and where a file of a result's name was written by something
/// else.
bool check_output_folder(const std::filesystem::path& recording,
                         const std::filesystem::path& folder);

/// Throws UsageError where the folder holds results of an earlier run, which a new one would
/// replace: files of result_files() that are not empty, besides the summary.
void require_no_results(const std::filesystem::path& folder);

enum class EarlierMap {
  remove,
  keep,  ///< map.adit and its log
};

/// Removes the files that an earlier run and its evaluation wrote, all but summary.json. Other
/// files stay. Throws OutputError where one cannot be removed.
void remove_earlier_run(const std::filesystem::path& folder, EarlierMap map = EarlierMap::remove);

}  // namespace adit
