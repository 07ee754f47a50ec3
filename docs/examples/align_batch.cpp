// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Many pairs at once: each cloud to the one before it, all in one go on the device.
#include <cstddef>
#include <iostream>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/cloud_aligner.hpp"
#include "clouds.hpp"

int main(int argc, char** argv) try {
  adit::engine::Context context({});
  adit::CloudAligner aligner(context);
  std::vector<adit::AlignableCloud> clouds;
  for (int i = 1; i < argc; ++i) {
    clouds.push_back(aligner.prepare(first_cloud(argv[i])));
  }
  std::vector<adit::CloudPair> pairs;
  for (std::size_t i = 1; i < clouds.size(); ++i) {
    pairs.push_back({.a = &clouds[i - 1], .b = &clouds[i], .guess = Eigen::Isometry3d::Identity()});
  }
  const std::vector<adit::CloudAlignment> results = aligner.align(pairs);
  for (std::size_t i = 0; i < results.size(); ++i) {
    std::cout << argv[i + 1] << " " << argv[i + 2] << ": "
              << results[i].T_a_b.translation().transpose() << " m, "
              << adit::to_string(results[i].refusal) << "\n";
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
