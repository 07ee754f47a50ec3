// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_align.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/drawing/overlay_picture.hpp"
#include "adit/tools/export/align_report.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kPairsAtOnce = 64;  // whose clouds are held on the device together
constexpr float kWall = 3.0F;             // steps that a column of a wall rises at least

std::vector<NamedPair> wanted(const AlignCommandOptions& options) {
  if (options.pairs.has_value() == !options.clouds.empty() ||
      (!options.clouds.empty() && options.clouds.size() != 2)) {
    throw UsageError("name two clouds, A B, or a list of pairs with --pairs FILE.");
  }
  if (options.pairs) {
    if (!options.guess.empty() || options.picture) {
      throw UsageError("--guess and --picture are of two clouds; a list has guesses of its own.");
    }
    return read_pairs(*options.pairs);
  }
  NamedPair pair{.a = options.clouds[0], .b = options.clouds[1]};
  if (!options.guess.empty()) {
    pair.guess = pose_of_numbers(options.guess);
    if (!pair.guess) {
      throw UsageError(
          "--guess takes X Y Z YAW (m, degrees) or X Y Z QX QY QZ QW, none beyond 1000 km.");
    }
  }
  if (options.picture && options.picture->extension() != ".png") {
    throw UsageError("--picture " + options.picture->string() + ": name it *.png.");
  }
  return {pair};
}

/// Clouds by name, as long as pairs want them.
class Clouds {
 public:
  Clouds(CloudAligner& aligner, std::ostream& notes) : aligner_(&aligner), notes_(&notes) {}

  /// Forgets those that none of the pairs has.
  void keep(std::span<const NamedPair> pairs) {
    std::set<std::string> names;
    for (const NamedPair& pair : pairs) {
      names.insert({pair.a, pair.b});
    }
    std::erase_if(clouds_, [&](const auto& entry) { return !names.contains(entry.first); });
  }

  /// A cloud on the device.
  struct Prepared {
    AlignableCloud cloud;
    Eigen::Vector3d offset;  ///< Sweep::offset
  };

  /// Reads and prepares it the first time. Throws InputError.
  const Prepared& get(const std::string& name) {
    auto found = clouds_.find(name);
    if (found == clouds_.end()) {
      const Sweep sweep = read_cloud(name, [&](const InputError& damage) {
        *notes_ << "note: " << damage.what() << std::endl;
      });
      found = clouds_.emplace(name, Prepared{aligner_->prepare(sweep.points), sweep.offset}).first;
    }
    return found->second;
  }

 private:
  CloudAligner* aligner_;
  std::ostream* notes_;
  std::map<std::string, Prepared> clouds_;
};

/// Poses of b in a with the clouds' own offsets have this much less along b's axes than poses with
/// a's offset for both, m. Zero where one of the clouds has none: then each keeps its own.
Eigen::Vector3d between_offsets(const Clouds::Prepared& a, const Clouds::Prepared& b) {
  const bool both = !a.offset.isZero(0.0) && !b.offset.isZero(0.0);
  return both ? Eigen::Vector3d(a.offset - b.offset) : Eigen::Vector3d::Zero();
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& along_b) {
  return pose * Eigen::Translation3d(along_b);
}

/// Of a list a cloud that cannot be read is reported with its pairs; of two clouds it is thrown.
std::vector<AlignedPair> align_some(CloudAligner& aligner, Clouds& clouds,
                                    std::span<const NamedPair> named, bool list) {
  clouds.keep(named);
  std::vector<AlignedPair> pairs(named.size());
  std::vector<CloudPair> readable;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < named.size(); ++i) {
    pairs[i].named = named[i];
    try {
      const Clouds::Prepared& a = clouds.get(named[i].a);
      const Clouds::Prepared& b = clouds.get(named[i].b);
      std::optional<Eigen::Isometry3d> guess = named[i].guess;
      if (guess) {
        guess = moved(*guess, -between_offsets(a, b));
      }
      readable.push_back({.a = &a.cloud, .b = &b.cloud, .guess = guess});
      pairs[i].r_input = b.cloud.r_input;
      pairs[i].offset_a = a.offset;
      pairs[i].offset_b = b.offset.isZero(0.0) || a.offset.isZero(0.0) ? b.offset : a.offset;
      of.push_back(i);
    } catch (const InputError& error) {
      if (!list) {
        throw;
      }
      pairs[i].unreadable = error.what();
    }
  }
  std::vector<CloudAlignment> alignments = aligner.align(readable);
  for (std::size_t k = 0; k < of.size(); ++k) {
    AlignedPair& pair = pairs[of[k]];
    pair.alignment = std::move(alignments[k]);
    const Eigen::Vector3d apart =
        between_offsets(clouds.get(pair.named.a), clouds.get(pair.named.b));
    pair.alignment.T_a_b = moved(pair.alignment.T_a_b, apart);
    if (pair.alignment.competing) {
      Eigen::Isometry3d& other = pair.alignment.competing->result.T_target_source;
      other = moved(other, apart);
    }
  }
  return pairs;
}

OverlayCloud drawn(const std::string& name, const OverheadView& above) {
  std::set<std::pair<int, int>> walls;
  const auto cell = [&above](float x, float y) {
    return std::pair(static_cast<int>(std::floor(static_cast<double>(x) / above.step)),
                     static_cast<int>(std::floor(static_cast<double>(y) / above.step)));
  };
  for (const OverheadView::Column& column : above.columns) {
    if (column.rise >= kWall) {
      walls.insert(cell(column.center.x(), column.center.y()));
    }
  }
  OverlayCloud cloud;
  for (const Point& p : read_cloud(name).points) {
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
      cloud.points.emplace_back(p.x, p.y, p.z);
      if (walls.contains(cell(p.x, p.y))) {
        cloud.walls.push_back(cloud.points.back());
      }
    }
  }
  return cloud;
}

void draw(const AlignedPair& pair, Clouds& clouds, const std::filesystem::path& file) {
  const Clouds::Prepared& prepared_a = clouds.get(pair.named.a);
  const Clouds::Prepared& prepared_b = clouds.get(pair.named.b);
  const OverlayCloud a = drawn(pair.named.a, prepared_a.cloud.above);
  const OverlayCloud b = drawn(pair.named.b, prepared_b.cloud.above);
  const Eigen::Isometry3d T_a_b =
      moved(pair.alignment.T_a_b, -between_offsets(prepared_a, prepared_b));
  write_png(file, overlay_picture(a, b, T_a_b, view_of(a, b, T_a_b)));
}

int run(const AlignCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::vector<NamedPair> named = wanted(options);
  DeviceSession device(options.device);
  engine::Context& context = device.context();
  if (context.software_fallback() && !options.json) {
    err << software_note(context.device()) << std::endl;
  }
  CloudAligner aligner(context, options.settings);
  Clouds clouds(aligner, err);
  std::vector<AlignedPair> pairs;
  while (pairs.size() < named.size()) {
    const auto part =
        std::span(named).subspan(pairs.size(), std::min(kPairsAtOnce, named.size() - pairs.size()));
    std::ranges::move(align_some(aligner, clouds, part, options.pairs.has_value()),
                      std::back_inserter(pairs));
  }
  if (options.picture) {
    draw(pairs.front(), clouds, *options.picture);
  }
  device.require_no_complaints();
  const bool all = std::ranges::all_of(pairs, &AlignedPair::usable);
  if (options.json) {
    nlohmann::ordered_json json = {{"schema", "align/1"},
                                   {"method", std::string(to_string(options.settings.method))},
                                   {"usable", std::ranges::count_if(pairs, &AlignedPair::usable)},
                                   {"device", to_json(context.device())},
                                   {"pairs", nlohmann::ordered_json::array()}};
    for (const AlignedPair& pair : pairs) {
      json["pairs"].push_back(to_json(pair, options.settings));
    }
    out << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
  } else {
    out << (options.pairs ? table_of(pairs, options.settings)
                          : text_of(pairs.front(), options.settings));
    if (options.picture) {
      out << "look at  " << options.picture->string() << "\n";
    }
  }
  return all ? 0 : 1;
}

}  // namespace

int align_command(const AlignCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit align", out, err, [&] { return run(options, out, err); });
}

void add_align_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("align", "Find the relative pose of two clouds, or of many pairs");
  const auto options = std::make_shared<AlignCommandOptions>();
  command.footer(
      "Prints T_a_b, which maps B's coordinates to A's. A cloud is a file of points (PCD, PLY, "
      "LAS,\n"
      "KITTI's .bin) or the first sweep of a recording; NAME@N is its sweep N, counted from 0.\n"
      "Without a guess both clouds must have z up, to some 10 degrees. A pose that did not\n"
      "converge, overlaps too little, fits poorly, is held too weakly or is not the only one that\n"
      "fits is refused.\n\n"
      "Examples:\n"
      "  adit align a.pcd b.ply\n"
      "  adit align a.pcd b.ply --guess 1.5 0 0 20 --picture both.png\n"
      "  adit align drive.mcap@0 drive.mcap@10\n"
      "  adit align --pairs pairs.txt --json\n\n"
      "A line of pairs.txt names two clouds and may add a guess: A B [X Y Z YAW | X Y Z QX QY QZ\n"
      "QW].\n\n"
      "Exit codes: 0 done, 1 a cloud that cannot be read or a pose that is refused, 2 usage.");
  command.option("clouds", options->clouds, "The two clouds").values(0, 2).value_name("A B");
  command.option("--pairs", options->pairs, "A list of pairs, aligned together").value_name("FILE");
  command
      .option("--guess", options->guess,
              "T_a_b to some 2 m and 20 degrees: metres and degrees, or a quaternion; without it "
              "the pose is searched")
      .values(4, 7)
      .value_name("X Y Z YAW");
  command.choice<RegistrationMethod>("--method", "How clouds are compared (vgicp)",
                                     options->settings.method, alignment_methods());
  command
      .option("--resolution", options->settings.r_input,
              "One point per this many metres; without it by the cloud's extent, 0.05 to 0.25")
      .from(0.01, 10.0)
      .value_name("M");
  command
      .option("--min-overlap", options->settings.min_overlap,
              "Share of B's points that must lie on A")
      .from(0.0, 1.0)
      .value_name("SHARE")
      .show_default();
  command.option("--picture", options->picture, "Draw B upon A, from above and from the side")
      .value_name("FILE.png")
      .written({".png"});
  add_device_options(command, options->device);
  command.flag("--json", options->json, "Print JSON instead of text");
  command.action(
      [options, done = std::move(done)] { done(align_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
