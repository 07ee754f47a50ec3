// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Odometry on your own points: here each argument is a file of float32 x, y, z, intensity, one
// sweep each, 0.1 s apart. Points may come from anywhere.
#include <chrono>
#include <fstream>
#include <iostream>
#include <utility>
#include <variant>

#include "adit/engine/context.hpp"
#include "adit/slam/executor/slam.hpp"

int main(int argc, char** argv) {
  adit::engine::Context context({});
  const auto slam = adit::make_slam(context, adit::Config{}, {.inertial = false});
  for (int i = 1; i < argc; ++i) {
    adit::Sweep sweep;
    sweep.stamp = i * std::chrono::milliseconds(100);
    std::ifstream file(argv[i], std::ios::binary);
    for (adit::Point point; file.read(reinterpret_cast<char*>(&point), sizeof point);) {
      sweep.points.push_back(point);
    }
    slam->add(std::move(sweep));
    while (const auto result = slam->next()) {
      if (const auto* placed = std::get_if<adit::SweepPlaced>(&*result)) {
        std::cout << argv[i] << ": " << placed->result.T_map_lidar.translation().transpose()
                  << " m, from " << placed->sweep.points.size() << " points\n";
      }
    }
  }
}
