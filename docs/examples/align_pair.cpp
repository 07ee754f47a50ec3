// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Two clouds to their relative pose, without a guess; what cannot be vouched for is refused.
#include <iostream>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/cloud_aligner.hpp"
#include "clouds.hpp"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: align_pair A B\n";
    return 2;
  }
  adit::engine::Context context({});
  adit::CloudAligner aligner(context);
  const adit::AlignableCloud a = aligner.prepare(first_cloud(argv[1]));
  const adit::AlignableCloud b = aligner.prepare(first_cloud(argv[2]));
  const std::vector<adit::CloudPair> pairs{{.a = &a, .b = &b}};
  const adit::CloudAlignment result = aligner.align(pairs).front();
  if (result.refusal != adit::AlignmentRefusal::none) {
    std::cout << "refused: " << adit::to_string(result.refusal) << "\n";
    return 1;
  }
  std::cout << "T_a_b\n"
            << result.T_a_b.matrix() << "\noverlap " << result.registration.overlap
            << ", standard deviations (m, rad) "
            << result.covariance.diagonal().cwiseSqrt().transpose() << "\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
