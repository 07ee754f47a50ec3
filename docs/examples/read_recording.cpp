// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is in a recording of any format: its topics, with how many events each has and when.
#include <cstddef>
#include <iostream>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: read_recording RECORDING\n";
    return 2;
  }
  struct Seen {
    std::size_t events = 0;
    adit::Nanoseconds first{0};
    adit::Nanoseconds last{0};
  };
  const auto recording = adit::open_recording(argv[1]);
  std::vector<Seen> seen(recording->topics().size());
  const auto events = recording->events({});
  while (const auto event = events->next()) {
    Seen& topic = seen[event->topic];
    topic.first = topic.events++ == 0 ? adit::stamp_of(*event) : topic.first;
    topic.last = adit::stamp_of(*event);
  }
  std::cout << recording->description() << "\n";
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const adit::Topic& topic = recording->topics()[i];
    std::cout << topic.name << " (" << adit::to_string(topic.kind) << "): " << seen[i].events
              << " events in " << adit::seconds(seen[i].last - seen[i].first) << " s\n";
  }
} catch (const adit::InputError& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
