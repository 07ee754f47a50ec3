// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_recording.hpp"

#include <map>
#include <utility>

#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/foxglove/foxglove_layout.hpp"
#include "adit/tools/foxglove/foxglove_types.hpp"
#include "adit/tools/foxglove/shown_messages.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Topics of an MCAP file, each declared with its first message.
class TopicWriter {
 public:
  TopicWriter(const fs::path& file, Compression compression)
      : types_(shown_types()), writer_(file, {.compression = compression}) {}

  void write(const ShownMessage& message) {
    const auto& [topic, type] = message.topic;
    const auto known = channels_.find(topic);
    std::size_t number = 0;
    if (known == channels_.end()) {
      number = writer_.add_channel(topic, protobuf_mcap_schema(types_, type));
      channels_.emplace(topic, number);
      topics_.push_back({.topic = topic, .type = type});
    } else {
      number = known->second;
    }
    ++topics_[number].messages;
    writer_.write(number, message.stamp, message.message.content());
  }

  std::vector<FoxgloveTopic> close() {
    writer_.close();
    return std::move(topics_);
  }

 private:
  std::vector<ProtobufMessageType> types_;
  McapWriter writer_;
  std::map<std::string, std::size_t> channels_;
  std::vector<FoxgloveTopic> topics_;
};

LayoutSubject subject_of(const ShownRun& run) {
  LayoutSubject subject{.has_sweeps = !run.sweeps.empty(),
                        .has_places = run.georeference.has_value() || !run.fixes.empty()};
  for (const StampedPose& pose : run.poses) {
    subject.way.extend(Eigen::Vector3d(pose.pose.translation()));
  }
  return subject;
}

fs::path layout_beside(fs::path output) {
  return output.replace_extension(".foxglove.json");
}

void check_output(const FoxgloveOptions& options, const ShownRun& run) {
  for (const fs::path& kept : {options.input, run.map, run.cloud, run.recording}) {
    for (const fs::path& written : {options.output, layout_beside(options.output)}) {
      keep_input("OUT", written, kept);
    }
  }
}

}  // namespace

FoxgloveReport write_foxglove(const FoxgloveOptions& options, std::ostream& progress) {
  if (options.output.extension() != ".mcap") {
    throw UsageError(options.output.string() + ": --as foxglove writes MCAP. Name it NAME.mcap.");
  }
  const ShownMessages messages(read_shown_run(options.input));
  check_output(options, messages.run());
  Draft draft(options.output);
  TopicWriter topics(draft.path(), options.compression);
  for (const ShownMessage& message : messages.graph()) {
    topics.write(message);
  }
  if (messages.has_points()) {
    topics.write(messages.overview(progress));
  }
  Progress bar(progress, progress_style_of_stderr(), "write", messages.moments().size(),
               Progress::Clock::now(), "messages");
  std::size_t done = 0;
  for (const ShownMoment& moment : messages.moments()) {
    for (const ShownMessage& message : messages.at(moment)) {
      topics.write(message);
    }
    bar.update(++done, 0);
  }
  bar.finish();
  FoxgloveReport report{.topics = topics.close(), .layout = layout_beside(options.output)};
  draft.take_its_place();
  write_text_file(report.layout, foxglove_layout(subject_of(messages.run())));
  return report;
}

}  // namespace adit
