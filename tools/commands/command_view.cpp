// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_view.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/evaluation/trajectory_source.hpp"
#include "adit/tools/evaluation/truth_on_map.hpp"
#include "adit/tools/export/cloud_painter.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/run/loop_verifier.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/temporary_folder.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/viewer/view_data.hpp"
#include "adit/tools/viewer/view_protocol.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {
namespace {

/// Empty where none is given.
std::function<ViewTruth(const MapDatabase&)> truth_of(const ViewCommandOptions& options) {
  if (!options.truth) {
    return {};
  }
  Trajectory truth = read_any_trajectory({.path = *options.truth});
  if (!truth.stamped) {
    throw InputError(*options.truth, {}, "its poses have no times",
                     "Keyframes are compared by time: TUM, or a table with times");
  }
  std::ranges::stable_sort(truth.poses, {}, &StampedPose::stamp);
  return [truth = std::move(truth)](const MapDatabase& map) {
    TruthOnMap laid = truth_on_map(map, truth);
    return ViewTruth{.errors = std::move(laid.errors), .path = std::move(laid.path)};
  };
}

/// As `adit run --view` does, but that nothing is left in the end.
int view_recording(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::string what = options.what.string();
  if (options.edit || options.truth || options.color) {
    throw UsageError(
        what +
        " is no map, so there is nothing to edit, to compare or to colour. Map it first: "
        "adit run " +
        what + " -o out");
  }
  const TemporaryFolder folder("adit-view");
  err << "note: " << what
      << " is neither a map nor a cloud: it is mapped, into a folder that goes "
         "away in the end. To keep it: adit run "
      << what << " --view -o out" << std::endl;
  RunCommandOptions mapping;
  mapping.recording = options.what;
  mapping.output = folder.path() / options.what.filename();
  mapping.keeps = false;
  mapping.view = true;
  mapping.serve = options.serve;
  mapping.device = options.device;
  return run_command(mapping, out, err);
}

/// Colours of a map's points, as of `adit export --cloud ply --colorize`.
class MapPaint {
 public:
  MapPaint(const ViewCommandOptions& options, std::ostream& out, std::ostream& err)
      : map_(map_of(options), MapAccess::read),
        memory_(0, 0),
        options_{.map = map_.file(),
                 .output = "",
                 .recording = options.recording,
                 .color = true,
                 .calibration = options.calibration,
                 .device = options.device},
        painter_({.map = &map_,
                  .options = &options_,
                  .file = {},
                  .memory = &memory_,
                  .out = &out,
                  .err = &err}) {}

  std::function<std::span<const CloudPoint>(std::span<const CloudPoint>)> function() {
    return [this](std::span<const CloudPoint> points) { return painter_.painted(points); };
  }
  /// "colours: 49 % of the points have a colour, by ...".
  std::string finish() { return "colours" + painter_.finish().replace(0, 1, ":") + "\n"; }

 private:
  static std::filesystem::path map_of(const ViewCommandOptions& options) {
    const std::filesystem::path file = map_file(options.what);
    if (file.extension() != ".adit" || !std::filesystem::exists(file)) {
      throw UsageError("--colorize: " + options.what.string() +
                       " has no map.adit. Clouds with colours are shown with them anyway.");
    }
    return file;
  }

  MapDatabase map_;
  MemoryLimit memory_;
  ExportCommandOptions options_;
  CloudPainter painter_;
};

int run(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::string_view page = required_page();
  if (!is_shown_as_it_is(options.what)) {
    return view_recording(options, out, err);
  }
  const StopSignal stop;
  std::optional<ViewData> data;
  std::optional<MapPaint> paint;
  const ViewAccess access = access_of(options.serve);
  // Listens before the cloud is read: a port that is taken is reported at once.
  ViewServer server({.page = page,
                     .greeting =
                         [&] {
                           return std::vector{data->scene(), data->graph()};
                         },
                     .answer = [&](std::string_view message) { return answer_to(*data, message); },
                     .tile = [&](uint32_t number) { return data->tile(number); },
                     .foxglove = [&] { return data->foxglove(); }},
                    access, static_cast<uint16_t>(options.serve.port));
  if (options.color) {
    paint.emplace(options, out, err);
  }
  data.emplace(
      ViewDataOptions{.what = options.what,
                      .edit = options.edit,
                      .verify = options.edit ? loop_verifier(options.device) : VerifyLoop{},
                      .truth = truth_of(options),
                      .paint = paint ? paint->function() : nullptr,
                      .stop = [] { return StopSignal::received() != 0; }},
      err);
  if (paint) {
    out << paint->finish();
    paint.reset();  // it holds a device
  }
  out << fmt::format("{}: {} points, {} keyframes\n", data->title(), data->points(),
                     data->keyframes());
  say_link(server.link(), access,
           data->editable() ? "sees the map and may edit it" : "sees the map", out);
  if (options.serve.foxglove) {
    say_foxglove_link(server.foxglove_link(), out);
  }
  out << "Ctrl-C ends it." << std::endl;
  say_counts(server.run([] { return StopSignal::received() != 0; }), out);
  return 0;
}

}  // namespace

int view_command(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit view", out, err, [&] {
    try {
      return run(options, out, err);
    } catch (const ViewStopped&) {
      return 128 + StopSignal::received();
    }
  });
}

void add_view_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command(
      "view", "Show a map, a run, a cloud or a recording in a browser, and edit loops");
  const auto options = std::make_shared<ViewCommandOptions>();
  command.footer(
      "WHAT is a map (OUT/map.adit), the folder OUT of a run, a cloud (PLY, PCD or LAS), or a "
      "recording, which\nis mapped while one looks on; nothing of that is kept (adit run --view "
      "does).\n"
      "The page needs no network beyond this program. It is served to this machine alone, unless "
      "--listen names another address; the printed link then carries a token.\n\n"
      "Examples:\n"
      "  adit view out\n"
      "  adit view out/map.adit --edit\n"
      "  adit view scan.ply --port 8080\n"
      "  adit view drive.mcap\n"
      "  adit view out --truth truth.tum\n"
      "  adit view out --colorize\n"
      "  adit view out --listen 0.0.0.0\n"
      "  adit view out --foxglove\n\n"
      "Exit codes: 0 ended by Ctrl-C or SIGTERM, 1 nothing that can be shown, 2 usage,\n129, 130 "
      "or "
      "143 stopped by SIGHUP, SIGINT or SIGTERM before there was something to show.");
  command.option("what", options->what, "What to show").required().value_name("WHAT");
  add_serve_options(command, options->serve);
  add_device_options(command, options->device);
  command
      .option("--truth", options->truth,
              "The true trajectory: colours by error, and the true way beside the map's")
      .value_name("FILE");
  command.flag("--colorize", options->color,
               "A map's points in the colours of its recording's camera images");
  command
      .option("--recording", options->recording,
              "Where the recording of --colorize is, if not where it was mapped")
      .value_name("REC");
  command
      .option("--calibration", options->calibration,
              "A file of cameras for --colorize, as of adit export")
      .value_name("FILE");
  command.flag("--edit", options->edit, "Loops may be revoked, restored and proposed in the page");
  command.action(
      [options, done = std::move(done)] { done(view_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
