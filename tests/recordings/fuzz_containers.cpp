// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a recording in one file: reading must end,
// with events or InputErrors. test_container_mutations.cpp calls it with damaged files. For
// libFuzzer, with clang from the root of the tree, after `./dev build asan`:
//   clang++ -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -I. -I/usr/include/eigen3
//     -DADIT_VERSION='""' tests/recordings/fuzz_containers.cpp tools/recordings/*.cpp
//     tools/input_*.cpp tools/output_file.cpp tools/version.cpp -llz4 -lzstd -lbz2 -lsqlite3
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tools/recordings/recording.hpp"

namespace {

/// A file that lives in memory alone.
class MemoryFile {
 public:
  MemoryFile(const uint8_t* data, std::size_t size) : descriptor_(::memfd_create("input", 0)) {
    if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
      std::abort();
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// What every sweep promises to those that use it.
void require_valid(const adit::Event& event) {
  const auto* sweep = std::get_if<adit::Sweep>(&event.value);
  if (sweep == nullptr) {
    return;
  }
  const std::size_t n = sweep->points.size();
  bool valid = (sweep->times.empty() || sweep->times.size() == n) &&
               (sweep->rings.empty() || sweep->rings.size() == n);
  for (const float time : sweep->times) {
    valid = valid && time >= 0.0F && time <= 10.0F;
  }
  if (!valid) {
    std::abort();
  }
}

/// Reads to the end. An error must bring the stream on: more of them than bytes are a hang.
void read_all(const adit::Recording& recording, std::size_t size) {
  const auto events = recording.events({});
  std::size_t errors = 0;
  while (errors <= size) {
    try {
      const auto event = events->next();
      if (!event) {
        return;
      }
      require_valid(*event);
    } catch (const adit::InputError&) {
      ++errors;
    }
  }
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  try {
    const auto recording = adit::open_recording(file.path());
    read_all(*recording, size);
  } catch (const adit::InputError&) {
    // the other right answer
  }
  return 0;
}
