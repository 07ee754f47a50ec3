// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Format: https://www.sqlite.org/fileformat2.html, "The Write-Ahead Log".
#include "adit/tools/map_database/write_ahead_log.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <fstream>
#include <span>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLogHeader = 32;
constexpr std::size_t kFrameHeader = 24;
constexpr uint32_t kLogMagic = 0x377f0682;  // the lowest bit: checksums of big-endian words
constexpr uint32_t kLogVersion = 3007000;
constexpr uint32_t kUsualPage = 4096;
constexpr int kLogAttempts = 5;

using LogBytes = std::span<const unsigned char>;

uint32_t log_word(LogBytes bytes, std::size_t at) {
  uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    value = value << 8U | bytes[i];
  }
  return value;
}

struct Salts {
  uint32_t first = 0;
  uint32_t second = 0;
  bool operator==(const Salts&) const = default;
};

struct Sums {
  uint32_t first = 0;
  uint32_t second = 0;
  bool operator==(const Sums&) const = default;
};

/// Goes on with the running checksum over a multiple of 8 bytes.
Sums sum_up(Sums sums, LogBytes bytes, bool big) {
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    std::array<uint32_t, 2> words = {log_word(bytes, at), log_word(bytes, at + 4)};
    if (!big) {
      for (uint32_t& word : words) {
        word = word >> 24U | (word >> 8U & 0xff00U) | (word << 8U & 0xff0000U) | word << 24U;
      }
    }
    sums.first += words[0] + sums.second;
    sums.second += words[1] + sums.first;
  }
  return sums;
}

/// A frame as it stands in the log.
struct StoredFrame {
  LogFrame frame;
  Salts salts;
  Sums sums;            ///< as its header has them
  bool proven = false;  ///< they are those of its content after the frame before
};

class LogReader {
 public:
  explicit LogReader(const fs::path& log) : file_(log, std::ios::binary) {}

  /// All frames of the log's present generation, and no more than one generation.
  WriteAheadLog read() {
    WriteAheadLog log;
    std::array<unsigned char, kLogHeader> header{};
    if (!file_ || !file_.read(reinterpret_cast<char*>(header.data()), kLogHeader)) {
      return log;
    }
    read_header(header, log);
    std::vector<StoredFrame> frames;
    StoredFrame next;
    while (read_frame(next, frames.size())) {
      frames.push_back(next);
    }
    if (!log.header_is_whole) {
      salts_ = likely_salts(frames);
    }
    if (frames.empty() || (!log.header_is_whole && salts_ == Salts{})) {
      return {};
    }
    log.page_size = page_size_;
    sort(frames, log);
    return log;
  }

 private:
  void read_header(LogBytes header, WriteAheadLog& log) {
    const uint32_t magic = log_word(header, 0);
    page_size_ = log_word(header, 8);
    big_ = (magic & 1U) != 0;
    last_ = sum_up({}, header.first(24), big_);
    log.header_is_whole = (magic & ~1U) == kLogMagic && log_word(header, 4) == kLogVersion &&
                          std::has_single_bit(page_size_) && page_size_ >= 512 &&
                          page_size_ <= 65536 &&
                          last_ == Sums{log_word(header, 24), log_word(header, 28)};
    salts_ = {log_word(header, 16), log_word(header, 20)};
    if (!log.header_is_whole) {
      page_size_ = kUsualPage;
      big_ = std::endian::native == std::endian::big;
    }
  }

  bool read_frame(StoredFrame& stored, std::size_t number) {
    bytes_.resize(kFrameHeader + page_size_);
    if (!file_.read(reinterpret_cast<char*>(bytes_.data()),
                    static_cast<std::streamsize>(bytes_.size()))) {
      return false;
    }
    const LogBytes bytes(bytes_);
    stored.frame = {.page = log_word(bytes, 0),
                    .offset = kLogHeader + number * bytes_.size() + kFrameHeader,
                    .commits = log_word(bytes, 4) != 0};
    stored.salts = {log_word(bytes, 8), log_word(bytes, 12)};
    stored.sums = {log_word(bytes, 16), log_word(bytes, 20)};
    stored.proven =
        stored.frame.page > 0 && sum_up(sum_up(last_, bytes.first(8), big_),
                                        bytes.subspan(kFrameHeader), big_) == stored.sums;
    last_ = stored.sums;
    return true;
  }

  /// Of a log whose header is spoilt: frames of one generation stand together.
  static Salts likely_salts(const std::vector<StoredFrame>& frames) {
    const auto pair = std::ranges::adjacent_find(
        frames, [](const StoredFrame& a, const StoredFrame& b) { return a.salts == b.salts; });
    return pair == frames.end() ? Salts{} : pair->salts;
  }

  void sort(const std::vector<StoredFrame>& frames, WriteAheadLog& log) const {
    const auto is_of_log = [&](const StoredFrame& stored) { return stored.salts == salts_; };
    const auto bad = std::ranges::find_if(
        frames, [&](const StoredFrame& stored) { return !is_of_log(stored) || !stored.proven; });
    const auto whole_end = log.header_is_whole ? bad : frames.begin();
    auto end = frames.begin();
    for (auto at = frames.begin(); at != frames.end(); ++at) {
      // A frame counts only as one of its generation, and by its own or its successor's checksum.
      const bool follows = at + 1 != frames.end() && is_of_log(*(at + 1)) && (at + 1)->proven;
      if (at < whole_end) {
        end = at->frame.commits ? at + 1 : end;
      } else if (at->frame.commits && is_of_log(*at) && (at->proven || follows)) {
        log.hidden_commits += 1;
        end = at + 1;
      }
    }
    auto committed = frames.begin();
    for (auto at = frames.begin(); at != whole_end; ++at) {
      committed = at->frame.commits ? at + 1 : committed;
    }
    for (auto at = frames.begin(); at != end; ++at) {
      if (at < committed) {
        log.committed.push_back(at->frame);
      } else if (is_of_log(*at) && (at->proven || at != bad || !log.header_is_whole)) {
        log.hidden.push_back(at->frame);
      }
    }
    if (log.hidden_commits > 0 && bad != frames.end()) {
      log.damaged = static_cast<uint64_t>(bad - frames.begin()) + 1;
    }
  }

  std::ifstream file_;
  std::vector<unsigned char> bytes_;
  uint32_t page_size_ = 0;
  bool big_ = false;
  Salts salts_;
  Sums last_;
};

std::string log_findings(const fs::path& log_file, const WriteAheadLog& log) {
  const std::string frames =
      std::to_string(log.hidden.size()) + (log.hidden.size() == 1 ? " frame" : " frames");
  const std::string rest = " `adit recover` salvages what can be read of them.";
  if (log.page_size > 0 && !log.header_is_whole) {
    return log_file.string() + ": its header, bytes 0 to 31, is not what was written, and all " +
           frames + " of the log are passed over: the map is what it was before them." + rest;
  }
  if (log.damaged) {
    return log_file.string() + ", frame " + std::to_string(*log.damaged) +
           ": it is not what was written, and from there on " + frames + " of " +
           std::to_string(log.hidden_commits) +
           " committed transactions are passed over: what they stored is missing from the map." +
           rest;
  }
  return {};
}

}  // namespace

WriteAheadLog read_log(const fs::path& database) {
  return LogReader(database.string() + "-wal").read();
}

// A writer may begin the log anew while it is being read: what is damaged is so twice.
std::vector<std::string> check_log(const fs::path& database) {
  const fs::path file = database.string() + "-wal";
  std::string found = log_findings(file, read_log(database));
  for (int attempt = 1; attempt < kLogAttempts && !found.empty(); ++attempt) {
    std::string again = log_findings(file, read_log(database));
    if (again == found) {
      return {found};
    }
    found = std::move(again);
  }
  return {};
}

}  // namespace adit
