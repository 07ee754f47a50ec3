// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_inspect.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/evaluation/run_page.hpp"
#include "adit/tools/inspection/inspection.hpp"
#include "adit/tools/inspection/inspection_page.hpp"
#include "adit/tools/inspection/recording_inference.hpp"
#include "adit/tools/inspection/unchecked.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr const char* kInspectSchema = "inspect/1";  // docs/schemas

void print_table(const Inspection& inspection, std::ostream& out) {
  std::size_t name = 5;
  std::size_t type = 4;
  for (const Topic& topic : inspection.topics) {
    name = std::max(name, topic.name.size());
    type = std::max(type, topic.type.size());
  }
  const auto words = [&](std::string_view topic, std::string_view types, std::string_view kind,
                         std::string_view events) {
    out << fmt::format("{:<{}}  {:<{}}  {:<10} {:>9}", topic, name, types, type, kind, events);
  };
  words("topic", "type", "kind", "events");
  out << fmt::format(" {:>9} {:>9} {:>9} {:>9}\n", "rate Hz", "span s", "gap s", "MiB");
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    const TopicStatistics& s = inspection.statistics[i];
    if (topic.kind == TopicKind::other) {
      words(topic.name, topic.type, to_string(topic.kind),
            topic.messages ? std::to_string(*topic.messages) : "?");
      out << "\n";
      continue;
    }
    words(topic.name, topic.type, to_string(topic.kind), std::to_string(s.events));
    out << fmt::format(" {:>9.2f} {:>9.2f} {:>9.3f} {:>9.2f}\n", s.rate(), s.span(),
                       s.largest_interval(), static_cast<double>(s.bytes) / 1048576.0);
  }
}

void print(const Inspection& inspection, std::ostream& out) {
  out << inspection.description << "\n\n";
  print_table(inspection, out);
  out << "\n";
  for (const Inference& one : infer(inspection)) {
    out << one.topic << ": " << one.text << "\n";
  }
  for (const Finding& finding : inspection.findings) {
    out << "\n"
        << to_string(finding.severity) << ": "
        << (finding.topic.empty() ? "" : finding.topic + ": ") << finding.found << ".\n";
    if (!finding.effect.empty()) {
      out << "  effect: " << finding.effect << "\n";
    }
    if (!finding.remedy.empty()) {
      out << "  what to do: " << finding.remedy << "\n";
    }
  }
  if (const std::string text = conclusion(inspection); !text.empty()) {
    out << "\n" << text << "\n";
  }
  out << std::flush;
}

ordered_json to_json(const Extent& extent) {
  return {{"min", extent.least}, {"mean", extent.mean()}, {"max", extent.greatest}};
}

ordered_json to_json(const Topic& topic, const TopicStatistics& s) {
  ordered_json json = {{"name", topic.name}, {"type", topic.type}, {"kind", to_string(topic.kind)}};
  json["messages_declared"] = topic.messages ? ordered_json(*topic.messages) : ordered_json();
  if (topic.kind == TopicKind::other) {
    return json;
  }
  json["events"] = s.events;
  json["bytes"] = s.bytes;
  json["frame"] = s.frame;
  json["first_ns"] = s.stamps ? ordered_json(s.stamps->begin.count()) : ordered_json();
  json["last_ns"] = s.stamps ? ordered_json(s.stamps->end.count()) : ordered_json();
  json["period_s"] = s.period();
  json["largest_interval_s"] = s.largest_interval();
  json["gaps"] = s.gaps();
  json["repeated"] = s.repeated();
  json["backwards"] = s.backwards();
  json["delay_s"] = to_json(s.delay);
  if (topic.kind == TopicKind::sweeps) {
    json["points"] = to_json(s.sweeps.points);
    json["returns"] = to_json(s.sweeps.returns);
    json["with_times"] = s.sweeps.with_times;
    json["duration_s"] = to_json(s.sweeps.duration);
    json["with_rings"] = s.sweeps.with_rings;
    json["with_doppler"] = s.sweeps.with_doppler;
    if (s.point_times) {
      json["point_times"] = {{"field", s.point_times->field},
                             {"unit_s", s.point_times->unit},
                             {"absolute", s.point_times->absolute},
                             {"first_s", s.point_times->first}};
    }
  } else if (topic.kind == TopicKind::imu) {
    json["acceleration"] = to_json(s.imu.acceleration);
    json["rotation_rad_s"] = to_json(s.imu.rotation);
    json["at_rest"] = ordered_json::array();
    for (const RestStretch& rest : rest_stretches(s.imu.timeline)) {
      const Eigen::Vector3d& up = rest.acceleration;
      json["at_rest"].push_back(
          {{"begin_s", rest.begin},
           {"end_s", rest.end},
           {"gyroscope_rad_s", {rest.gyro_bias.x(), rest.gyro_bias.y(), rest.gyro_bias.z()}},
           {"acceleration", {up.x(), up.y(), up.z()}}});
    }
  }
  if (s.velocities.speed.count > 0) {
    json["speed_m_s"] = to_json(s.velocities.speed);
    json["without_covariance"] = s.velocities.without_covariance;
  }
  return json;
}

ordered_json to_json(const MotionCheck& check) {
  ordered_json json = {{"sweeps", check.pair.sweeps.name},
                       {"imu", check.pair.imu.name},
                       {"compared", check.sweeps},
                       {"tracked", check.tracked}};
  if (check.comparison) {
    const RotationComparison& found = *check.comparison;
    const Eigen::Quaterniond q(found.R_range_gyro);
    json["imu_offset_s"] = found.offset;
    json["imu_offset_sigma_s"] = found.offset_sigma;
    json["correlation"] = found.correlation;
    json["R_range_imu_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
    json["misalignment_rad"] =
        check.pair.R_range_gyro ? ordered_json(found.misalignment) : ordered_json();
  }
  return json;
}

ordered_json to_json(const LidarMounting& mounting) {
  return {{"topic", mounting.topic},
          {"to_topic", mounting.to_topic},
          {"compared", mounting.compared},
          {"aligned", mounting.aligned},
          {"expected", numbers_of(mounting.expected)},
          {"found", mounting.found ? ordered_json(numbers_of(*mounting.found)) : ordered_json()}};
}

ordered_json to_json(const Inspection& inspection) {
  ordered_json json = {{"schema", kInspectSchema}, {"description", inspection.description}};
  json["topics"] = ordered_json::array();
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    json["topics"].push_back(to_json(inspection.topics[i], inspection.statistics[i]));
  }
  json["motion"] = ordered_json::array();
  for (const MotionCheck& check : inspection.motion) {
    json["motion"].push_back(to_json(check));
  }
  json["lidars"] = ordered_json::array();
  for (const LidarMounting& mounting : inspection.lidars) {
    json["lidars"].push_back(to_json(mounting));
  }
  json["findings"] = ordered_json::array();
  for (const Finding& f : inspection.findings) {
    json["findings"].push_back({{"severity", to_string(f.severity)},
                                {"kind", f.kind},
                                {"topic", f.topic},
                                {"found", f.found},
                                {"effect", f.effect},
                                {"remedy", f.remedy}});
  }
  json["not_checked"] = unchecked(inspection);
  return json;
}

/// The folder that `adit run` wrote: how the run went, without a truth.
int inspect_run(const InspectCommandOptions& options, std::ostream& out) {
  if (options.write_config) {
    throw UsageError("--write-config needs a recording, and " + options.recording.string() +
                     " is the folder of a run.");
  }
  const RunReview review = review_run(options.recording);
  const std::string report = describe(review);
  if (options.json) {
    ordered_json json = {{"schema", kInspectSchema}};
    json.update(to_json(review));
    out << json.dump(2, ' ', false, ordered_json::error_handler_t::replace) << std::endl;
  } else {
    out << report << std::flush;
  }
  if (options.html) {
    write_text_file(*options.html, run_page(options.recording.string(), report, review, nullptr));
  }
  return 0;
}

}  // namespace

int inspect_command(const InspectCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit inspect", out, err, [&] {
    if (options.further_recordings.empty() && is_run(options.recording)) {
      return inspect_run(options, out);
    }
    const Config config = load_config(options.config);
    std::vector<std::filesystem::path> recordings = {options.recording};
    recordings.insert(recordings.end(), options.further_recordings.begin(),
                      options.further_recordings.end());
    const Inspection inspection = inspect(recordings, config, options.device);
    if (options.json) {
      out << to_json(inspection).dump(2, ' ', false, ordered_json::error_handler_t::replace)
          << std::endl;
    } else {
      print(inspection, out);
    }
    if (options.html) {
      write_text_file(*options.html, inspection_page(inspection));
    }
    if (options.write_config) {
      write_text_file(*options.write_config, suggested_toml(inspection, config));
    }
    return has_problem(inspection) ? 1 : 0;
  });
}

void add_inspect_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<InspectCommandOptions>();
  const Command command =
      app.add_command("inspect", "What is in a recording, and what is wrong with it");
  command.footer(
      "Reads all of it. A problem says what it does to mapping, and what to do about it. What "
      "could\n"
      "not be checked is named.\n\n"
      "OUT, the folder of a run, can stand for RECORDING: then it is told how the run went, and\n"
      "--html draws it: states, innovations with their gates, biases, gravity, weakly held\n"
      "directions, how well the pose is known. `adit evaluate` does so beside a truth.\n\n"
      "Examples:\n"
      "  adit inspect drive.mcap\n"
      "  adit inspect drive.bag --json\n"
      "  adit inspect drive.mcap --html drive.html\n"
      "  adit inspect out --html run.html\n"
      "  adit inspect drive.mcap --write-config drive.toml\n"
      "  adit run drive.mcap --config drive.toml -o out\n\n"
      "Exit codes: 0 no fault found, 1 a problem found, or it cannot be opened, 2 usage; of a run "
      "0 "
      "where it can be read.");
  auto recordings = std::make_shared<std::vector<std::filesystem::path>>();
  command
      .option("recording", *recordings,
              "Any recording that `adit run` reads, several that are one, or the folder of a run")
      .required()
      .value_name("RECORDING");
  command.flag("--json", options->json, "Print JSON instead of text");
  command
      .option("--html", options->html,
              "Write a page with plots of rates, gaps, clocks, the IMU and the motion, or of a run")
      .value_name("FILE.html")
      .written({".html", ".htm"});
  command
      .option("--write-config", options->write_config,
              "Write a configuration that makes up for what is wrong, for --config")
      .value_name("FILE.toml")
      .written({".toml"});
  add_config_options(command, options->config);
  add_metadata_option(command, options->config);
  add_device_options(command, options->device);
  command.action([command, options, recordings, done = std::move(done)] {
    options->recording = recordings->front();
    options->further_recordings.assign(recordings->begin() + 1, recordings->end());
    const std::string other =
        command.given_besides({"recording", "--json", "--html", "--write-config"});
    if (!other.empty() && is_run(options->recording)) {
      refuse_option(other, "is of recordings, and " + options->recording.string() +
                               " is the folder of a run; leave it out");
    }
    done(inspect_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit
