// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/image_folder.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool is_image_name(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

/// The images, in the order of their names.
std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (const fs::directory_iterator end; !error && entries != end; entries.increment(error)) {
    if (is_image_name(entries->path())) {
      files.push_back(entries->path());
    }
  }
  if (error || files.empty()) {
    throw InputError(folder, {},
                     error ? "it is no folder of images that can be read: " + error.message()
                           : "it is a folder without images (.jpg, .jpeg, .png)",
                     "Check the path; it counts from the folder of the file that names it");
  }
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

/// The file with the times of the images; none where there is none.
std::optional<fs::path> times_beside(const fs::path& folder) {
  std::vector<fs::path> candidates = {folder / "timestamps.txt", folder / "times.txt"};
  const fs::path plain = fs::absolute(folder / "").lexically_normal().parent_path();
  if (plain.filename() == "data") {
    candidates.push_back(plain.parent_path() / "timestamps.txt");
    candidates.push_back(plain.parent_path() / "times.txt");
  }
  for (const fs::path& file : candidates) {
    std::error_code unknown;
    if (fs::is_regular_file(file, unknown)) {
      return file;
    }
  }
  return std::nullopt;
}

std::vector<Nanoseconds> times_of(const fs::path& folder, const std::vector<fs::path>& files) {
  if (const std::optional<fs::path> times = times_beside(folder)) {
    std::vector<Nanoseconds> stamps = read_times(*times, TimesOrder::any);
    require_matching_times(*times, stamps.size(), files.size(), "images in " + folder.string());
    return stamps;
  }
  std::vector<Nanoseconds> stamps;
  for (const fs::path& file : files) {
    const std::optional<Nanoseconds> stamp = time_from_name(file.stem().string());
    if (!stamp) {
      throw InputError(file, {},
                       "the name of the image is not a time, and the folder has no timestamps.txt",
                       "Name images after their time (1700000000.123456.jpg, or nanoseconds: "
                       "1700000000123456000.jpg), or write one time a line to timestamps.txt");
    }
    stamps.push_back(*stamp);
  }
  return stamps;
}

class FolderImages final : public ImageSeries {
 public:
  explicit FolderImages(const fs::path& folder) {
    std::vector<fs::path> files = list_images(folder);
    const std::vector<Nanoseconds> stamps = times_of(folder, files);
    std::vector<std::pair<Nanoseconds, fs::path>> timed;
    for (std::size_t i = 0; i < files.size(); ++i) {
      timed.emplace_back(stamps[i], std::move(files[i]));
    }
    std::ranges::stable_sort(timed, {}, [](const auto& one) { return one.first; });
    for (auto& [stamp, file] : timed) {
      stamps_.push_back(stamp);
      files_.push_back(std::move(file));
    }
  }

  std::span<const Nanoseconds> stamps() const override { return stamps_; }

  ColorImage image(std::size_t index) const override {
    const fs::path& file = files_.at(index);
    const std::string content = read_whole_file(file);
    try {
      return decode_image(std::as_bytes(std::span(content)));
    } catch (const ImageError& error) {
      throw InputError(file, {}, error.what(), "The image is damaged or cut off: copy it again");
    }
  }

 private:
  std::vector<Nanoseconds> stamps_;
  std::vector<fs::path> files_;
};

}  // namespace

std::shared_ptr<const ImageSeries> open_image_folder(const fs::path& folder) {
  return std::make_shared<FolderImages>(folder);
}

}  // namespace adit
