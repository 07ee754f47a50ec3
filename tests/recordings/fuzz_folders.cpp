// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a file of a folder: the first byte tells
// which file of which layout (the letters below), the rest is its content. Reading must end, with
// events or InputErrors.
#include <fstream>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tests/support/depth_images.hpp"
#include "adit/tools/containers/mcap_writer.hpp"

namespace {

namespace fs = std::filesystem;

/// A layout with one file whose content is the input.
struct Layout {
  char letter;
  fs::path folder;
  fs::path file;  // in it
};

/// Folders of their own, made once and deleted at the end.
class Layouts {
 public:
  Layouts() {
    add('i', "imu0/data.csv");
    add('p', "vicon0/data.csv");
    folder_.write("p/imu0/data.csv", "1403715273262142976,-0.25,0.5,0.75,9.0,0.125,-3.5\n");
    add('t', "times.txt");
    folder_.write("t/1.bin", std::string(16, '\0'));
    folder_.write("t/2.bin", std::string(16, '\0'));
    for (const char letter : {'o', 's', 'k'}) {
      const std::string drive = std::string(1, letter) + "/";
      folder_.write(drive + "velodyne_points/data/0.bin", std::string(16, '\0'));
      folder_.write(drive + "velodyne_points/timestamps.txt", "2011-09-26 13:02:25.5\n");
      folder_.write(drive + "oxts/timestamps.txt", "2011-09-26 13:02:25.5\n");
      folder_.write(drive + "oxts/data/0.txt", "");
    }
    add('o', "oxts/data/0.txt");
    add('s', "oxts/timestamps.txt");
    add('k', "calib_imu_to_velo.txt");
    for (const char letter : {'d', 'g', 'a', 'c'}) {
      const std::string folder = std::string(1, letter) + "/";
      folder_.write(folder + "1.png", adit::test::depth_png(3, {0, 5000, 10000}));
      folder_.write(folder + "depth.txt", "1305031102.160407 1.png\n");
    }
    add('d', "depth.txt");
    add('g', "groundtruth.txt");
    add('a', "accelerometer.txt");
    add('c', "calibration.txt");
    folder_.write("m/drive_0.mcap", small_mcap());
    add('m', "metadata.yaml");
  }

  const Layout* find(char letter) const {
    for (const Layout& layout : layouts_) {
      if (layout.letter == letter) {
        return &layout;
      }
    }
    return nullptr;
  }

 private:
  static std::string small_mcap() {
    const adit::test::TemporaryFolder folder;
    adit::McapWriter writer(folder / "seed", {});
    adit::test::write_sample(writer, adit::Encoding::cdr, 1, false);
    writer.close();
    return adit::test::content_of(folder / "seed");
  }

  void add(char letter, const std::string& file) {
    const fs::path path = folder_.write(std::string(1, letter) + "/" + file, "");
    layouts_.push_back({letter, folder_ / std::string(1, letter), path});
  }

  adit::test::TemporaryFolder folder_;
  std::vector<Layout> layouts_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  static const Layouts layouts;
  const Layout* layout = size == 0 ? nullptr : layouts.find(static_cast<char>(data[0]));
  if (layout == nullptr) {
    return 0;
  }
  std::ofstream(layout->file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data) + 1, static_cast<std::streamsize>(size - 1));
  try {
    const auto recording = adit::open_recording(layout->folder);
    adit::test::require_readable(*recording, size + 64);
  } catch (const adit::InputError&) {
    // the other right answer
  }
  return 0;
}
