// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/console.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "adit/tests/support/environment.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/program_support.hpp"
#include "adit/tests/tools/run_support.hpp"

namespace adit {
namespace {

using test::Answer;
using test::call;

constexpr const char* kEscape = "\x1b[";

/// Without what a developer's own environment may ask for.
class ConsoleTest : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path log_ = folder_ / "adit.log";
  std::string log_name_ = log_.string();
  test::Variable no_color_{"NO_COLOR", std::nullopt};
  test::Variable force_{"CLICOLOR_FORCE", std::nullopt};
  test::Variable term_{"TERM", "xterm-256color"};
};

/// A terminal in place of the standard error stream. What it shows is read in the end.
class Terminal {
 public:
  Terminal() : ours_(::posix_openpt(O_RDWR | O_NOCTTY)), before_(::dup(STDERR_FILENO)) {
    std::array<char, 128> name{};
    if (ours_ < 0 || ::grantpt(ours_) != 0 || ::unlockpt(ours_) != 0 ||
        ::ptsname_r(ours_, name.data(), name.size()) != 0) {
      throw std::runtime_error("there is no terminal to be had");
    }
    theirs_ = ::open(name.data(), O_RDWR | O_NOCTTY);
    ::dup2(theirs_, STDERR_FILENO);
  }
  ~Terminal() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    ::close(theirs_);
    ::close(ours_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::string shown() const {
    std::string text;
    std::array<char, 4096> part{};
    pollfd ready{.fd = ours_, .events = POLLIN, .revents = 0};
    while (::poll(&ready, 1, 0) > 0 && (ready.revents & POLLIN) != 0) {
      const ssize_t bytes = ::read(ours_, part.data(), part.size());
      text.append(part.data(), static_cast<std::size_t>(std::max<ssize_t>(bytes, 0)));
    }
    return text;
  }

 private:
  int ours_;
  int before_;
  int theirs_ = -1;
};

std::string shown_on_terminal(std::vector<const char*> words) {
  words.insert(words.begin(), "adit");
  const Terminal terminal;
  program(static_cast<int>(words.size()), words.data());
  return terminal.shown();
}

TEST_F(ConsoleTest, TerminalsSeeComplaintsInColorAndFilesDoNot) {
  const std::vector<const char*> wrong = {"run", "nothing.mcap", "-o", "out"};
  EXPECT_NE(shown_on_terminal(wrong).find(painted("adit run:", Tone::error)), std::string::npos);
  EXPECT_TRUE(call(wrong).err.starts_with("adit run: ")) << call(wrong).err;
  const test::Variable none("NO_COLOR", "1");
  EXPECT_TRUE(shown_on_terminal(wrong).starts_with("adit run: "));
}

TEST_F(ConsoleTest, ColorsAreAsTheUserAsksEvenForACommandLineThatCannotBeRead) {
  const std::string red = painted("adit run:", Tone::error);
  EXPECT_TRUE(call({"run", "--color", "always", "--jsn"}).err.starts_with(red));
  EXPECT_TRUE(call({"run", "--jsn", "--color=always"}).err.starts_with(red));
  EXPECT_TRUE(call({"--color", "always", "run", "--jsn"}).err.starts_with(red));
  EXPECT_TRUE(call({"run", "--jsn", "--color", "never"}).err.starts_with("adit run: "));
  const test::Variable force("CLICOLOR_FORCE", "1");
  EXPECT_TRUE(call({"run", "--jsn"}).err.starts_with(red));
  EXPECT_TRUE(call({"run", "--jsn", "--color", "never"}).err.starts_with("adit run: "));
}

TEST_F(ConsoleTest, OtherWordsAreUsageErrorsOfEveryCommand) {
  for (const char* command : {"run", "config", "devices", "generate", "help"}) {
    const Answer answer = call({command, "--color", "blue"});
    EXPECT_EQ(answer.code, 2) << command;
    EXPECT_NE(answer.err.find("--color: 'blue' is none of auto, always or never"),
              std::string::npos)
        << answer.err;
    EXPECT_EQ(call({command, "--log"}).code, 2) << command;
  }
}

TEST_F(ConsoleTest, EveryCommandHasTheOptions) {
  for (const char* command : {"demo", "run", "live", "simulate", "inspect", "convert", "align",
                              "evaluate", "info", "check", "recover", "view", "export", "loops",
                              "optimize", "devices", "config", "generate"}) {
    const std::string help = call({command, "--help"}).out;
    for (const char* part :
         {"Options of every command:", "--color auto|always|never", "--log FILE", "--verbose"}) {
      EXPECT_NE(help.find(part), std::string::npos) << command << ": " << part << "\n" << help;
    }
  }
}

TEST_F(ConsoleTest, FilesAndJsonAreNeverColored) {
  const std::string drive = test::small_recording(folder_.path(), 3).recording.string();
  const std::string out = (folder_ / "out").string();
  const Answer table = call({"run", drive.c_str(), "-o", out.c_str(), "--color", "always"});
  EXPECT_TRUE(table.out.starts_with("verdict  \x1b[")) << table.out;
  const Answer json =
      call({"run", drive.c_str(), "-o", out.c_str(), "--color", "always", "--json", "--overwrite"});
  EXPECT_EQ(json.out.find(kEscape), std::string::npos) << json.out;
  EXPECT_TRUE(nlohmann::json::accept(json.out));
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    const auto extension = entry.path().extension();
    if (extension != ".ply" && extension != ".adit") {  // whose bytes are any
      EXPECT_EQ(test::content(entry.path()).find(kEscape), std::string::npos) << entry.path();
    }
  }
}

TEST_F(ConsoleTest, LogHasWhatWasSaidWithItsTimeAndWithoutColor) {
  const std::string drive = test::small_recording(folder_.path(), 3).recording.string();
  const std::string out = (folder_ / "out").string();
  const Answer answer = call(
      {"run", drive.c_str(), "-o", out.c_str(), "--color", "always", "--log", log_name_.c_str()});
  const std::string log = test::content(log_);
  const std::regex line(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z .+)");
  std::istringstream lines(log);
  for (std::string one; std::getline(lines, one);) {
    EXPECT_TRUE(std::regex_match(one, line)) << one;
  }
  EXPECT_EQ(log.find(kEscape), std::string::npos) << log;
  for (const char* part :
       {"Z note: adit ", "note: it runs: adit run ", "note: device: ", "note: settings: defaults\n",
        "mapping 3/3 sweeps (100 %)", "Z note: exit code 0 after "}) {
    EXPECT_NE(log.find(part), std::string::npos) << part << " in: " << log;
  }
  EXPECT_EQ(answer.err.find("exit code"), std::string::npos) << answer.err;
  // Another run goes on with it.
  EXPECT_EQ(
      call({"run", "nothing.mcap", "-o", (out + "2").c_str(), "--log", log_name_.c_str()}).code, 1);
  const std::string longer = test::content(log_);
  EXPECT_TRUE(longer.starts_with(log));
  EXPECT_NE(longer.find("Z adit run: nothing.mcap: "), std::string::npos) << longer;
  EXPECT_NE(longer.find("Z note: exit code 1 after "), std::string::npos) << longer;
}

TEST_F(ConsoleTest, LogThatCannotBeWrittenIsSaidBeforeAnythingStarts) {
  const std::string drive = test::small_recording(folder_.path(), 3).recording.string();
  const std::string out = (folder_ / "out").string();
  const std::string times = drive + "/times.txt";
  const std::string before = test::content(times);
  for (const std::string& log : {(folder_ / "no" / "adit.log").string(), folder_.path().string(),
                                 times, std::string("/dev/full")}) {
    const Answer answer = call({"run", drive.c_str(), "-o", out.c_str(), "--log", log.c_str()});
    EXPECT_EQ(answer.code, 1) << log << ": " << answer.err;
    EXPECT_TRUE(answer.err.starts_with("adit: " + log + ": ")) << answer.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << log;
  }
  EXPECT_EQ(test::content(times), before);
}

TEST_F(ConsoleTest, VerboseSaysWhatTheLogHas) {
  const Answer quiet = call({"config"});
  EXPECT_EQ(quiet.err, "");
  const test::Variable device("ADIT_DEVICE", "no such");
  const Answer answer = call({"config", "--verbose", "--set", "submap.l=7"});
  EXPECT_TRUE(answer.err.starts_with("note: adit ")) << answer.err;
  for (const char* part : {"note: it runs: adit config --verbose --set submap.l=7\n",
                           "note: ADIT_DEVICE='no such'", "note: exit code 0 after "}) {
    EXPECT_NE(answer.err.find(part), std::string::npos) << part << " in: " << answer.err;
  }
  EXPECT_NE(answer.out.find("l = 7"), std::string::npos);
}

}  // namespace
}  // namespace adit
