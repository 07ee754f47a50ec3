// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What stands between a stream and where it leads: colours for a terminal, and a log of all that is
// said. Whoever writes to the stream knows of neither.
#pragma once

#include <iosfwd>
#include <mutex>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>

#include "adit/tools/support/line_painter.hpp"
#include "adit/tools/support/log_file.hpp"

namespace adit {

struct MessageSettings {
  LinePainter::OpeningOf colors = nullptr;  ///< none: no colours
  LogFile* log = nullptr;                   ///< none: no log
  bool details = false;                     ///< say_detail() shows on the stream, too
};

/// Hands on to `target`. Threads may write at the same time.
class MessageBuffer : public std::streambuf {
 public:
  explicit MessageBuffer(std::streambuf& target) : target_(target) {}
  ~MessageBuffer() override;
  MessageBuffer(const MessageBuffer&) = delete;
  MessageBuffer& operator=(const MessageBuffer&) = delete;

  /// From here on. Log and `target` must outlive the buffer, or its next settings.
  void use(const MessageSettings& settings);

  const MessageSettings& settings() const { return settings_; }
  /// A line for the log, whatever is half-said on the stream.
  void write_log(std::string_view line);

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;

 private:
  bool put(std::string_view text);
  void give_rest();

  std::streambuf& target_;
  MessageSettings settings_{};
  std::optional<LinePainter> painter_;
  LogLines log_lines_;
  std::mutex mutex_;
};

/// In the log of what is said on the stream; nothing where there is none.
void log_line(std::ostream& stream, std::string_view line);

/// What only some want to know, as a note of one line: in the log, and on the stream where details
/// are wanted.
void say_detail(std::ostream& stream, const std::string& line);

/// Whether details are wanted on the stream.
bool shows_details(const std::ostream& stream);

}  // namespace adit
