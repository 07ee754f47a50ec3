// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps a recording of any format through the facade, and prints where each sweep was taken.
#include <iostream>
#include <utility>
#include <variant>

#include "adit/engine/context.hpp"
#include "adit/slam/executor/slam.hpp"
#include "adit/tools/recordings/recording.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: map_recording RECORDING\n";
    return 2;
  }
  const auto recording = adit::open_recording(argv[1]);
  adit::engine::Context context({});
  const auto slam = adit::make_slam(context, adit::Config{});
  const auto print_results = [&] {
    while (const auto result = slam->next()) {
      if (const auto* placed = std::get_if<adit::SweepPlaced>(&*result)) {
        std::cout << placed->result.stamp.count() << " "
                  << placed->result.T_map_lidar.translation().transpose() << "\n";
      }
    }
  };
  const auto events = recording->events({});
  while (auto event = events->next()) {
    if (auto* sweep = std::get_if<adit::Sweep>(&event->value)) {
      slam->add(std::move(*sweep), event->frame);
    } else if (const auto* reading = std::get_if<adit::ImuSample>(&event->value)) {
      slam->add(*reading, event->frame);
    } else if (const auto* transform = std::get_if<adit::StaticTransform>(&event->value)) {
      slam->add(*transform);
    }
    print_results();
  }
  slam->flush();  // the last sweeps wait for readings no longer
  print_results();
}
