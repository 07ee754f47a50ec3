// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_convert.hpp"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/foxglove/foxglove_recording.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

void print(const ConvertOptions& options, const ConvertReport& report, std::ostream& out) {
  std::size_t width = 0;
  for (const ConvertedTopic& topic : report.topics) {
    width = std::max(width, topic.topic.size());
  }
  for (const ConvertedTopic& topic : report.topics) {
    out << std::left << std::setw(static_cast<int>(width + 2)) << topic.topic << std::right
        << std::setw(9);
    if (topic.left_out.empty()) {
      out << topic.messages << "  " << topic.type;
      if (topic.from_before > 0) {
        out << " (" << topic.from_before << " from before the cut, as received at its begin)";
      }
      out << "\n";
    } else {
      out << "-"
          << "  " << topic.type << ": left out, " << topic.left_out << "\n";
    }
  }
  out << "wrote " << options.output.string() << std::endl;
}

/// Throws UsageError for what is of use with recordings alone.
void refuse_options_of_recordings(const ConvertOptions& options) {
  const auto refuse = [](bool given, const char* name) {
    if (given) {
      throw UsageError(std::string(name) + ": --as foxglove shows a run as a whole, without it.");
    }
  };
  refuse(!options.topics.empty(), "--topic");
  refuse(options.begin_s.has_value(), "--begin");
  refuse(options.end_s.has_value(), "--end");
  refuse(options.encoding.has_value(), "--ros");
  refuse(options.repair.has_value(), "--repair");
  refuse(options.metadata.has_value(), "--metadata");
  if (options.compression == Compression::bz2) {
    throw UsageError("--compression bz2: MCAP knows none, lz4 and zstd.");
  }
}

int convert_run(const ConvertOptions& options, std::ostream& out, std::ostream& err) {
  refuse_options_of_recordings(options);
  const FoxgloveReport report =
      write_foxglove({.input = options.input,
                      .output = options.output,
                      .compression = options.compression.value_or(Compression::zstd)},
                     err);
  std::size_t width = 0;
  for (const FoxgloveTopic& topic : report.topics) {
    width = std::max(width, topic.topic.size());
  }
  for (const FoxgloveTopic& topic : report.topics) {
    out << std::left << std::setw(static_cast<int>(width + 2)) << topic.topic << std::right
        << std::setw(9) << topic.messages << "  " << topic.type << "\n";
  }
  out << "wrote " << options.output.string() << "\nwrote " << report.layout.string()
      << " (a layout for Foxglove and Lichtblick)" << std::endl;
  return 0;
}

int convert(const ConvertOptions& options, std::ostream& out, std::ostream& err) {
  if (options.foxglove) {
    if (!options.further_inputs.empty()) {
      throw UsageError("--as foxglove shows one run; name its folder alone.");
    }
    keep_input("OUT", options.output, options.input);
    require_free_output(options);
    return convert_run(options, out, err);
  }
  keep_input("OUT", options.output, options.input);
  for (const fs::path& input : options.further_inputs) {
    keep_input("OUT", options.output, input);
  }
  const ConvertReport report = convert_recording(options);
  for (const std::string& note : report.notes) {
    err << "note: " << note << "\n";
  }
  for (const std::string& error : report.errors) {
    err << "adit convert: " << error << "\n";
  }
  if (report.error_count > report.errors.size()) {
    err << "adit convert: and " << report.error_count - report.errors.size()
        << " more like these\n";
  }
  if (report.error_count > 0 && report.messages() == 0) {
    err << "adit convert: the recording is damaged; nothing could be read, "
        << options.output.string() << " is empty" << std::endl;
    return 1;
  }
  print(options, report, out);
  if (report.error_count > 0) {
    err << "adit convert: the recording is damaged; what could be read was written" << std::endl;
  }
  return report.error_count == 0 ? 0 : 1;
}

}  // namespace

int convert_command(const ConvertOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit convert", out, err, [&] { return convert(options, out, err); });
}

void add_convert_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<ConvertOptions>();
  const Command command =
      app.add_command("convert", "Write a recording, or a run, in another format, or a part of it");
  command.footer(
      "IN is any recording that `adit run` reads. OUT tells the format by its name: NAME.mcap,\n"
      "NAME.bag (ROS 1), or a folder for rosbag2. Messages are copied byte for byte; between ROS "
      "1\n"
      "and ROS 2 those of the types that adit understands are translated.\n"
      "With --as foxglove IN is the folder of a run or a map (map.adit). OUT is then an MCAP file\n"
      "for Foxglove, Lichtblick and Rerun; a layout, NAME.foxglove.json, comes beside it.\n\n"
      "Examples:\n"
      "  adit convert drive.bag drive.mcap\n"
      "  adit convert drive_0.bag drive_1.bag drive.mcap\n"
      "  adit convert drive.mcap part.mcap --begin 10 --end 40 --topic /points --topic /imu "
      "--topic /tf_static\n"
      "  adit convert kitti_0001 kitti.mcap --compression lz4\n"
      "  adit convert drive.bag right.mcap --repair --config drive.toml\n"
      "  adit convert out run.mcap --as foxglove\n\n"
      "Exit codes: 0 done, 1 failed, or the recording is damaged, 2 usage.");
  auto inputs = std::make_shared<std::vector<fs::path>>();
  command
      .option("input", *inputs,
              "The recording, in one part or several that follow each other in time; with --as "
              "foxglove a run or a map")
      .required()
      .value_name("IN");
  // The last of all words: the reader of the command line gives every one to IN.
  command.option("output", options->output, "What to write").value_name("OUT").written();
  command.choice<bool>("--as", "What other viewers show of a run, by Foxglove's schemas",
                       options->foxglove, {{"foxglove", true}});
  command.option("--topic", options->topics, "Keep this topic; may be given again")
      .one_value_each()
      .value_name("NAME");
  command.option("--begin", options->begin_s, "From here on (s after the first message)")
      .value_name("S");
  command.option("--end", options->end_s, "Up to here (s after the first message)").value_name("S");
  command.choice<Encoding>("--ros", "Serialisation of the messages in an MCAP file",
                           options->encoding, {{"1", Encoding::ros1}, {"2", Encoding::cdr}});
  command.choice<Compression>("--compression",
                              "none, lz4 or zstd for MCAP; none, lz4 or bz2 for ROS 1 bags",
                              options->compression,
                              {{"none", Compression::none},
                               {"lz4", Compression::lz4},
                               {"zstd", Compression::zstd},
                               {"bz2", Compression::bz2}});
  command.flag("--overwrite", options->overwrite, "Replace OUT where it is there already");
  auto repair = std::make_shared<bool>(false);
  auto config = std::make_shared<ConfigSource>();
  command.flag("--repair", *repair,
               "Write sweeps and IMU samples as they are understood: times of points in "
               "seconds after the stamp, and what --config corrects");
  add_config_options(command, *config);
  add_metadata_option(command, *config);
  command.action([options, inputs, repair, config, done = std::move(done)] {
    if (inputs->size() < 2) {
      miss_argument("OUT");
    }
    options->output = inputs->back();
    options->input = inputs->front();
    options->further_inputs.assign(inputs->begin() + 1, inputs->end() - 1);
    done(guarded("adit convert", std::cout, std::cerr, [&] {
      if (!*repair && (config->file || !config->overrides.empty() || !config->preset.empty())) {
        throw UsageError("--config, --set and --preset are of use with --repair alone.");
      }
      options->metadata = config->metadata;
      if (*repair) {
        options->repair = load_config(*config).recording;
        const auto other = std::ranges::find_if(config->overrides, [](const std::string& one) {
          return !one.starts_with("recording.");
        });
        if (other != config->overrides.end()) {
          throw UsageError("--set " + *other +
                           ": --repair corrects by the settings of recording alone; leave it out.");
        }
      }
      return convert(*options, std::cout, std::cerr);
    }));
  });
}

}  // namespace adit
