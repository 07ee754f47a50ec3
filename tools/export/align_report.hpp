// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit align` calls its methods, and prints of its results.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/registration/cloud_aligner.hpp"
#include "adit/tools/recordings/cloud_pairs.hpp"

namespace adit {

/// How clouds can be compared, by name.
std::vector<std::pair<std::string, RegistrationMethod>> alignment_methods();

/// A pair and what became of it.
struct AlignedPair {
  NamedPair named;
  std::string unreadable{};  ///< why a cloud could not be read; empty: both were
  double r_input = 0.0;      ///< m, down-sampling of b
  CloudAlignment alignment{};
  /// m. What is subtracted from the coordinates of each cloud, where they are large: T_a_b maps
  /// what is left of b's to what is left of a's. Where both are large both have a's.
  Eigen::Vector3d offset_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset_b = Eigen::Vector3d::Zero();

  bool usable() const { return unreadable.empty() && alignment.refusal == AlignmentRefusal::none; }
};

/// Why the pose is not to be used, a sentence without its full stop; empty where it may be.
std::string reason_of(const AlignedPair& pair, const CloudAlignerSettings& settings);

/// Of one pair, some lines.
std::string text_of(const AlignedPair& pair, const CloudAlignerSettings& settings);

/// Of many: a line each, and how many may be used.
std::string table_of(const std::vector<AlignedPair>& pairs, const CloudAlignerSettings& settings);

nlohmann::ordered_json to_json(const AlignedPair& pair, const CloudAlignerSettings& settings);

}  // namespace adit
