// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/cloud_pairs.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <utility>
#include <variant>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// m. Coarser coordinates round surfaces away: range sensors measure to one or two centimetres.
constexpr double kCoarsest = 0.01;
// m: beyond, neighbouring float32 are more than 8 mm apart.
constexpr float kFarthest = 1e5F;
constexpr double kFarthestGuess = 1e6;  // m

/// The words of a line, quoted ones whole.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line.substr(0, line.find('#')));
  std::vector<std::string> words;
  std::string word;
  while (in >> std::quoted(word)) {
    words.push_back(word);
  }
  return words;
}

std::optional<double> number_of(const std::string& word) {
  double value = 0.0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  return end.ec == std::errc() && end.ptr == word.data() + word.size() ? std::optional(value)
                                                                       : std::nullopt;
}

std::string from_folder(const fs::path& folder, const std::string& name) {
  return fs::path(name).is_absolute() ? name : (folder / name).string();
}

NamedPair pair_of(const std::vector<std::string>& words, const fs::path& file, uint64_t line) {
  const auto wrong = [&](const std::string& found) {
    return InputError(file, Place::line(line), found,
                      "A line names two clouds, A B, and may add T_a_b: X Y Z YAW (m, degrees) or "
                      "X Y Z QX QY QZ QW");
  };
  if (words.size() < 2) {
    throw wrong("it names one cloud");
  }
  std::vector<double> numbers;
  for (std::size_t i = 2; i < words.size(); ++i) {
    const std::optional<double> number = number_of(words[i]);
    if (!number) {
      throw wrong("'" + words[i] + "' is not a number");
    }
    numbers.push_back(*number);
  }
  const fs::path folder = file.parent_path();
  NamedPair pair{.a = from_folder(folder, words[0]), .b = from_folder(folder, words[1])};
  if (!numbers.empty()) {
    pair.guess = pose_of_numbers(numbers);
    if (!pair.guess) {
      throw wrong("its " + std::to_string(numbers.size()) + " numbers are no pose");
    }
  }
  return pair;
}

/// NAME@N, unless there is a file of that very name.
std::pair<fs::path, uint64_t> file_and_number(const std::string& name) {
  const std::size_t at = name.rfind('@');
  std::error_code ignored;
  if (at == std::string::npos || fs::exists(name, ignored)) {
    return {name, 0};
  }
  uint64_t number = 0;
  const char* const last = name.data() + name.size();
  const auto end = std::from_chars(name.data() + at + 1, last, number);
  const bool whole = at + 1 < name.size() && end.ec == std::errc() && end.ptr == last;
  return whole ? std::pair(fs::path(name.substr(0, at)), number) : std::pair(fs::path(name), 0UL);
}

bool is_return(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

void require_points(const Sweep& sweep, double step, const fs::path& file) {
  if (std::ranges::none_of(sweep.points, is_return)) {
    throw InputError(file, {},
                     sweep.points.empty()
                         ? "the cloud has no points"
                         : "all of its " + std::to_string(sweep.points.size()) +
                               " points are NaN or at the sensor: none is a return",
                     "Take a cloud with points");
  }
  if (step > kCoarsest) {
    throw InputError(file, {}, "it lies far from the origin, and " + coarse_note(step), "");
  }
  const auto far = std::ranges::find_if(sweep.points, [](const Point& p) {
    return is_return(p) &&
           !(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest);
  });
  if (far != sweep.points.end()) {
    throw InputError(file, Place::point(static_cast<uint64_t>(far - sweep.points.begin())),
                     "it lies more than 100 km from the origin, where coordinates are coarse",
                     "Subtract a common offset from both clouds first (of UTM coordinates, say)");
  }
}

}  // namespace

std::optional<Eigen::Isometry3d> pose_of_numbers(std::span<const double> numbers) {
  const bool possible =
      std::ranges::all_of(numbers, [](double value) { return std::abs(value) <= kFarthestGuess; });
  if (!possible || (numbers.size() != 4 && numbers.size() != 7)) {
    return std::nullopt;
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (numbers.size() == 4) {
    pose.linear() =
        Eigen::AngleAxisd(numbers[3] * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  } else {
    const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
    if (!(q.norm() > 1e-6)) {
      return std::nullopt;
    }
    pose.linear() = q.normalized().toRotationMatrix();
  }
  pose.translation() << numbers[0], numbers[1], numbers[2];
  return pose;
}

std::vector<NamedPair> read_pairs(const fs::path& file) {
  std::ifstream in = open_text_file(file);
  std::vector<NamedPair> pairs;
  std::string line;
  for (uint64_t number = 1; std::getline(in, line); ++number) {
    if (const std::vector<std::string> words = words_of(line); !words.empty()) {
      pairs.push_back(pair_of(words, file, number));
    }
  }
  if (pairs.empty()) {
    throw InputError(file, {}, "there are no pairs in it", "Each line names two clouds: A B");
  }
  return pairs;
}

Sweep read_cloud(const std::string& name, const std::function<void(const InputError&)>& damage) {
  const auto [file, number] = file_and_number(name);
  const std::unique_ptr<Recording> recording = open_recording(file);
  EventSelection selection;
  selection.topics = {sweep_topic(*recording, file, std::nullopt)};
  selection.skip = number;
  const std::unique_ptr<EventStream> events = recording->events(selection);
  std::vector<InputError> damaged;
  for (bool more = true; more;) {
    std::optional<Event> event;
    try {
      event = events->next();
      more = event.has_value();
    } catch (const InputError& error) {
      damaged.push_back(error);
    }
    const auto* sweep = event ? std::get_if<Sweep>(&event->value) : nullptr;
    if (sweep == nullptr) {
      continue;
    }
    if (event->number.value_or(number) != number) {
      break;  // the one that is wanted could not be read at all
    }
    require_points(*sweep, event->coordinate_step, file);
    for (const InputError& error : damaged) {
      if (damage) {
        damage(error);
      }
    }
    return *sweep;
  }
  if (!damaged.empty()) {
    throw InputError(damaged.front());
  }
  throw InputError(file, {}, "it has no sweep number " + std::to_string(number),
                   "Sweeps are counted from 0; `adit inspect` says how many there are");
}

}  // namespace adit
