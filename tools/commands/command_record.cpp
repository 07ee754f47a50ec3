// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_record.hpp"

#include <iostream>
#include <memory>
#include <utility>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {

int record_command(const RecordOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit record", out, err, [&] {
    if (!(options.wait_s > 0.0 && options.duration_s >= 0.0 && options.split_s >= 0.0)) {
      throw UsageError("--wait must be above 0, --duration and --split-time not below.");
    }
    return record(options, err);
  });
}

void add_record_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<RecordOptions>();
  const Command command = app.add_command("record", "Record what sensors send, without mapping it");
  command.footer(
      "SOURCE is as for `adit live`: udp://ADDRESS:PORT, several of one sensor; `ros2` for all ROS "
      "2 "
      "topics that\nadit reads; or the names of topics, of any type.\n"
      "FILE is NAME.pcap for packets and NAME.mcap for topics. A message is on its way to the disk "
      "as "
      "soon as it\nhas arrived: what was written stays when the program is killed.\n\n"
      "Examples:\n"
      "  adit record udp://0.0.0.0:2368 -o drive.pcap\n"
      "  adit record ros2 --split-time 60 -o drive.mcap\n"
      "  adit record /points /imu /camera/image --duration 30 -o drive.mcap\n\n"
      "Exit codes: 0 done, also after Ctrl-C or SIGTERM; 1 failed, or nothing arrived; 2 usage.");
  command.option("source", options->sources, "Where sensors send to, or topics")
      .value_name("SOURCE");
  command.option("-o,--output", options->output, "The file to write").value_name("FILE").required();
  command.option("--metadata", options->metadata, "An Ouster's metadata (JSON)").value_name("FILE");
  command.option("--wait", options->wait_s, "Wait so long for the first messages, then exit 1")
      .value_name("S");
  command.option("--duration", options->duration_s, "Record for so long; 0: until Ctrl-C")
      .value_name("S");
  command.option("--split-time", options->split_s, "Go on in a next file after so long")
      .value_name("S");
  command.option("--split-size", options->split_bytes, "Go on in a next file after so much")
      .bytes()
      .value_name("SIZE");
  command.flag("--overwrite", options->overwrite, "Replace a file that is there already");
  command.flag("--quiet", options->quiet, "Print errors alone");
  command.action(
      [options, done = std::move(done)] { done(record_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
