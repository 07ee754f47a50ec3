// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <ostream>
#include <streambuf>
#include <string>

namespace adit {

/// Lines of text as lines of JSON, for machines that collect logs:
/// `{"time":"2026-11-29T16:05:07.123Z","level":"info","message":"session 2: out-2"}`. A line that
/// begins with a command ("adit live: ...") is an error, unless it is a warning. Threads may share
/// a stream on it.
class JsonLog final : public std::streambuf {
 public:
  /// `out` outlives it.
  explicit JsonLog(std::ostream& out) : out_(out) {}
  ~JsonLog() override;

 protected:
  int_type overflow(int_type character) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;

 private:
  void take(char character);
  void end_line();

  std::ostream& out_;
  std::mutex mutex_;
  std::string line_;
};

/// A line of text as JSON, without a line's end.
std::string json_log_line(const std::string& line, const std::string& time);

}  // namespace adit
