// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/message_files.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/containers/bag_reader.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/containers/packed_messages.hpp"
#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/containers/rosbag2_reader.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using MessageFiles = std::vector<std::unique_ptr<MessageFile>>;

/// Recorders that split a recording write messages to the next file while others are still on
/// their way to the last one.
constexpr Nanoseconds kSplitOverlap = std::chrono::seconds(1);

/// One that is not packed.
std::unique_ptr<MessageFile> open_plain_file(const fs::path& path) {
  if (is_mcap(path)) {
    return open_mcap(path);
  }
  if (is_bag(path)) {
    return open_bag(path);
  }
  return is_rosbag2_database(path) ? open_rosbag2_database(path) : nullptr;
}

/// Recognised by content; null where it is no container.
std::unique_ptr<MessageFile> open_message_file(const fs::path& path) {
  if (is_zstd_file(path)) {
    return open_packed_file(path, open_plain_file);
  }
  return open_plain_file(path);
}

std::unique_ptr<MessageFile> require_message_file(const fs::path& path) {
  std::unique_ptr<MessageFile> file = open_message_file(path);
  if (!file) {
    throw InputError(path, Place::byte(0),
                     "it is neither an MCAP file, a ROS 1 bag nor an SQLite database",
                     "The file is damaged: copy it again, or move it out of the folder");
  }
  return file;
}

class NoMessages final : public MessageStream {
 public:
  std::optional<RawMessage> next() override { return std::nullopt; }
};

/// What is declared and not there.
class AbsentFile final : public MessageFile {
 public:
  AbsentFile(fs::path path, std::vector<DeclarationError> contradictions)
      : path_(std::move(path)), contradictions_(std::move(contradictions)) {}

  const fs::path& path() const override { return path_; }
  const std::vector<Channel>& channels() const override { return channels_; }
  std::optional<TimeSpan> span() const override { return std::nullopt; }
  std::string format() const override { return {}; }
  const std::optional<InputError>& damage() const override { return damage_; }
  std::vector<DeclarationError> contradictions() const override { return contradictions_; }
  std::unique_ptr<MessageStream> messages(const MessageSelection&) const override {
    return std::make_unique<NoMessages>();
  }

 private:
  fs::path path_;
  std::vector<Channel> channels_;
  std::optional<InputError> damage_;
  std::vector<DeclarationError> contradictions_;
};

/// `counted`: what is known of its messages is reported elsewhere.
std::unique_ptr<MessageFile> absent(const fs::path& path, std::string found, bool counted) {
  DeclarationError error(path, std::move(found),
                         "Its messages are lost: copy the file into the folder, and run again", {},
                         std::nullopt);
  std::vector<DeclarationError> errors;
  errors.push_back(counted ? std::move(error).counted_elsewhere() : std::move(error));
  return std::make_unique<AbsentFile>(path, std::move(errors));
}

/// The file in the folder that metadata.yaml means: itself, packed or unpacked since; of a path
/// (old versions wrote them from the folder above) the name counts. Nothing where there is none.
std::optional<fs::path> listed_file(const fs::path& folder, const fs::path& listed) {
  const fs::path name = listed.filename();
  const fs::path packed = name.string() + ".zstd";
  const fs::path unpacked = name.extension() == ".zstd" ? fs::path(name).replace_extension() : name;
  for (const fs::path& file : {listed, name, packed, unpacked}) {
    std::error_code unknown;
    if (!file.is_absolute() && fs::is_regular_file(folder / file, unknown)) {
      return folder / file;
    }
  }
  return std::nullopt;
}

/// Messages by topic that the files hold, or declared by themselves.
std::map<std::string, uint64_t> counts_of(const MessageFiles& files) {
  std::map<std::string, uint64_t> counts;
  for (const auto& file : files) {
    for (const Channel& channel : file->channels()) {
      counts[channel.topic] += channel.messages.value_or(0);
    }
    for (const DeclarationError& error : file->contradictions()) {
      counts[error.topic()] += error.missing().value_or(0);
    }
  }
  return counts;
}

/// Some file's messages could not be counted.
bool has_uncounted(const MessageFiles& files) {
  return std::ranges::any_of(files, [](const auto& file) {
    return std::ranges::any_of(file->channels(),
                               [](const Channel& channel) { return !channel.messages; });
  });
}

/// Where the numbers of metadata.yaml are not those of the files.
std::vector<DeclarationError> wrong_counts(const fs::path& metadata,
                                           const Rosbag2Declaration& declared,
                                           const MessageFiles& files) {
  std::vector<DeclarationError> wrong;
  std::map<std::string, uint64_t> there = counts_of(files);
  std::map<std::string, uint64_t> told;
  uint64_t sum = 0;
  for (const auto& [topic, messages] : declared.topics) {
    told[topic] += messages;
    sum += messages;
  }
  for (const auto& [topic, messages] : told) {
    if (messages != there[topic]) {
      wrong.push_back(wrong_count(metadata, "it", topic, messages, there[topic]));
    }
  }
  if (declared.messages && !told.empty() && *declared.messages != sum) {
    wrong.emplace_back(
        metadata,
        fmt::format("it declares {} messages in all, but {} by topic", *declared.messages, sum),
        "All that is there is read; write it anew (ros2 bag reindex)");
  }
  return wrong;
}

/// The files of a folder as its metadata.yaml declares them.
MessageFiles open_declared(const fs::path& folder, const Rosbag2Declaration& declared) {
  MessageFiles files;
  const fs::path metadata = folder / "metadata.yaml";
  std::size_t there = 0;
  for (const fs::path& listed : declared.files) {
    if (const std::optional<fs::path> file = listed_file(folder, listed)) {
      files.push_back(require_message_file(*file));
      ++there;
    } else {
      files.push_back(absent(folder / listed.filename(),
                             "metadata.yaml lists this file, and it is not there",
                             !declared.topics.empty()));
    }
  }
  if (there == 0) {
    throw InputError(metadata, {},
                     "none of the files that it lists is there, the first is " +
                         in_quotes(declared.files.front().string()),
                     "Copy them into the folder; where they were renamed, write it anew (ros2 bag "
                     "reindex) or move it away");
  }
  if (has_uncounted(files)) {
    return files;
  }
  if (std::vector<DeclarationError> wrong = wrong_counts(metadata, declared, files);
      !wrong.empty()) {
    files.push_back(std::make_unique<AbsentFile>(metadata, std::move(wrong)));
  }
  return files;
}

/// "drive_12.mcap" as "drive_", 12, ".mcap".
struct NumberedName {
  std::string head;
  uint64_t number = 0;
  std::string tail;
};
std::optional<NumberedName> numbered(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t dot = name.find('.');
  const std::string stem = name.substr(0, dot);
  const std::size_t last = stem.find_last_not_of("0123456789");
  const std::size_t begin = last == std::string::npos ? 0 : last + 1;
  const std::optional<uint64_t> number = parse_unsigned(stem.substr(begin));
  if (!number) {
    return std::nullopt;
  }
  return NumberedName{stem.substr(0, begin), *number,
                      dot == std::string::npos ? "" : name.substr(dot)};
}

/// Where numbers are missing between those of two files in a row, a file that stands for them.
std::unique_ptr<MessageFile> file_between(const fs::path& before, const fs::path& after) {
  constexpr uint64_t kMost = 1000;  // more than that are no numbers of splits, but dates
  const auto a = numbered(before);
  const auto b = numbered(after);
  if (!a || !b || a->head != b->head || a->tail != b->tail || b->number <= a->number + 1 ||
      b->number - a->number > kMost) {
    return nullptr;
  }
  const std::string first = a->head + std::to_string(a->number + 1) + a->tail;
  const uint64_t missing = b->number - a->number - 1;
  return absent(before.parent_path() / first,
                (missing == 1 ? "this file is not there"
                              : "this file and the next are not there, " + std::to_string(missing) +
                                    " in all") +
                    std::string(", but those before and after it are: ") +
                    before.filename().string() + " and " + after.filename().string(),
                false);
}

Nanoseconds length_of(const MessageFile& file) {
  constexpr Nanoseconds kFarthestStamp = Nanoseconds::max() / 4;  // differences do not overflow
  return std::clamp(file.span()->end, -kFarthestStamp, kFarthestStamp) -
         std::clamp(file.span()->begin, -kFarthestStamp, kFarthestStamp);
}

/// Throws InputError unless the second follows the first.
void require_after(const MessageFile& first, const MessageFile& second) {
  constexpr Nanoseconds kFarthestStamp = Nanoseconds::max() / 4;  // differences do not overflow
  const Nanoseconds begin = std::clamp(second.span()->begin, -kFarthestStamp, kFarthestStamp);
  const Nanoseconds end =
      std::clamp(std::min(first.span()->end, second.span()->end), -kFarthestStamp, kFarthestStamp);
  const Nanoseconds shorter = std::min(length_of(first), length_of(second));
  if (end - begin > std::min(kSplitOverlap, shorter / 2)) {
    throw InputError(second.path(), {},
                     "its times overlap with those of " + first.path().string() + " by " +
                         fmt::format("{:.1f} s", seconds(end - begin)) +
                         ", so they are not parts of one recording that follow each other",
                     "Name one of them; topics that were recorded apart are put together by `mcap "
                     "merge` or `ros2 bag convert`");
  }
}

/// Throws InputError where a topic has different types.
void require_same_types(const MessageFiles& files) {
  std::map<std::string, std::pair<std::string, const MessageFile*>> types;
  for (const auto& file : files) {
    for (const Channel& channel : file->channels()) {
      const auto [known, is_new] =
          types.emplace(channel.topic, std::pair(channel.type, file.get()));
      if (!is_new && known->second.first != channel.type && known->second.second != file.get()) {
        throw InputError(file->path(), {},
                         "its topic " + channel.topic + " is of type " + channel.type + ", in " +
                             known->second.second->path().string() + " it is of type " +
                             known->second.first,
                         "They are different recordings: give them one by one");
      }
    }
  }
}

/// In the order of their times; those without messages stay behind the one before them.
MessageFiles in_order_of_time(MessageFiles files) {
  std::vector<std::pair<Nanoseconds, std::unique_ptr<MessageFile>>> timed;
  for (auto& file : files) {
    const Nanoseconds before = timed.empty() ? Nanoseconds::min() : timed.back().first;
    const Nanoseconds begin = file->span() ? file->span()->begin : before;
    timed.emplace_back(begin, std::move(file));
  }
  std::ranges::stable_sort(timed, {}, [](const auto& one) { return one.first; });
  files.clear();
  for (auto& [begin, file] : timed) {
    files.push_back(std::move(file));
  }
  const MessageFile* before = nullptr;
  for (const auto& file : files) {
    if (file->span()) {
      if (before != nullptr) {
        require_after(*before, *file);
      }
      if (before == nullptr || before->span()->end < file->span()->end) {
        before = file.get();
      }
    }
  }
  require_same_types(files);
  return files;
}

/// The files of a folder without metadata.yaml.
MessageFiles open_undeclared(const std::vector<fs::path>& paths) {
  MessageFiles files;
  for (const fs::path& path : paths) {
    if (!files.empty()) {
      if (std::unique_ptr<MessageFile> between = file_between(files.back()->path(), path)) {
        files.push_back(std::move(between));
      }
    }
    files.push_back(require_message_file(path));
  }
  return in_order_of_time(std::move(files));
}

/// A folder of clouds in which a bag lies is one of clouds.
bool is_of_clouds(const fs::path& folder, const std::vector<fs::path>& containers) {
  const auto is_bag_file = [](const fs::path& file) {
    return file.filename().string().find(".bag") != std::string::npos;
  };
  if (!std::ranges::all_of(containers, is_bag_file)) {
    return false;
  }
  constexpr std::array kClouds = {".pcd", ".ply", ".las", ".laz", ".bin"};
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (const fs::directory_iterator end; !error && entries != end; entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (name == "velodyne" ||
        std::ranges::any_of(kClouds, [&](const char* suffix) { return name.ends_with(suffix); })) {
      return true;
    }
  }
  return false;
}

MessageFiles open_folder(const fs::path& folder) {
  const std::vector<fs::path> paths = container_files(folder);
  if (paths.empty() || is_of_clouds(folder, paths)) {
    return {};
  }
  try {
    if (const std::optional<Rosbag2Declaration> declared = read_rosbag2_declaration(folder)) {
      return open_declared(folder, *declared);
    }
  } catch (const UnusableMetadata& error) {
    MessageFiles files = open_undeclared(paths);
    files.push_back(std::make_unique<AbsentFile>(
        error.file(),
        std::vector<DeclarationError>{{error.file(), error.found(), error.remedy()}}));
    return files;
  }
  return open_undeclared(paths);
}

}  // namespace

std::vector<std::unique_ptr<MessageFile>> open_message_files(const fs::path& given) {
  const fs::path path = without_metadata_file(given);
  std::error_code ignored;
  MessageFiles files;
  if (fs::is_regular_file(path, ignored)) {
    if (std::unique_ptr<MessageFile> file = open_message_file(path)) {
      files.push_back(std::move(file));
    }
  } else if (fs::is_directory(path, ignored)) {
    files = open_folder(path);
  }
  return files;
}

std::vector<std::unique_ptr<MessageFile>> open_message_files(const std::vector<fs::path>& paths) {
  if (paths.size() == 1) {
    return open_message_files(paths.front());
  }
  MessageFiles all;
  for (const fs::path& path : paths) {
    MessageFiles files = open_message_files(path);
    if (files.empty()) {
      std::error_code unknown;
      const bool there = fs::exists(path, unknown);
      throw InputError(
          path, {},
          there ? "it is no recording of messages, and only such are put together"
                : "there is no such file or folder",
          there ? "Give several MCAP files, ROS 1 bags or rosbag2 folders, or this one alone"
                : "Check the path; the folder for the results is named with -o");
    }
    std::ranges::move(files, std::back_inserter(all));
  }
  return in_order_of_time(std::move(all));
}

std::vector<RecordingNotice> unlisted_file_notices(const fs::path& given) {
  const fs::path path = without_metadata_file(given);
  std::error_code unknown;
  if (!fs::is_directory(path, unknown)) {
    return {};
  }
  std::optional<Rosbag2Declaration> declared;
  try {
    declared = read_rosbag2_declaration(path);
  } catch (const UnusableMetadata&) {
    return {};  // reported where the files are opened
  }
  if (!declared) {
    return {};
  }
  std::vector<fs::path> listed;
  for (const fs::path& file : declared->files) {
    listed.push_back(listed_file(path, file).value_or(fs::path()));
  }
  std::vector<RecordingNotice> notices;
  for (const fs::path& file : container_files(path)) {
    if (std::ranges::count(listed, file) == 0) {
      notices.push_back({.kind = "unlisted_file",
                         .found = file.filename().string() +
                                  " is in the folder, but metadata.yaml does not list it",
                         .effect = "it is not read",
                         .remedy =
                             "Nothing need be done where it is a copy; else write metadata.yaml "
                             "anew (ros2 bag reindex)"});
    }
  }
  return notices;
}

}  // namespace adit
