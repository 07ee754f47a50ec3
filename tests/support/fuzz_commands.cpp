// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// fuzz_commands [CASES [FORMAT [COMMAND [FIRST]]]]: the commands on so many damaged inputs each
// (5000, over all formats), from case FIRST on; CASES as "600s": for so many seconds a format.
// FORMAT and COMMAND may be "all". `./dev fuzz-commands` builds and runs it. A case that a command
// does not end as it should is reported by its number; the last that was begun, where that ends the
// program.
#include <sys/time.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/tests/commands/command_cases.hpp"

namespace {

char g_case[80] = "no case";  // what a signal handler can tell

void tell_case(int signal) {
  const auto say = [](const char* text) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) {
      std::_Exit(1);
    }
  };
  say(signal == SIGPROF ? "\nfuzz_commands: held up in " : "\nfuzz_commands: crashed in ");
  say(g_case);
  say("\n");
  std::_Exit(1);
}

/// Limits processor time: what hangs is ended by SIGPROF, however busy the machine.
void allow_seconds(long seconds) {
  const itimerval timer{.it_interval = {}, .it_value = {.tv_sec = seconds, .tv_usec = 0}};
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

/// How long to go on with a format: for so many cases of each command, or for so many seconds.
struct Budget {
  uint64_t cases = 0;
  double seconds = 0.0;
};

using Clock = std::chrono::steady_clock;
using Codes = std::map<adit::test::FuzzedCommand, std::map<int, uint64_t>>;

/// A call or two may rightly be refused as a wrong one: of two topics that a recording has.
constexpr uint64_t kCallsToTell = 20;

/// Turn and turn about, so that time is shared alike. Returns how many complaints there were: one
/// is that a command refused every call, and so read nothing.
uint64_t fuzz(const adit::test::CommandCases& cases, const std::string& format,
              const std::string& only, const Budget& budget, uint64_t first, Codes& codes) {
  const Clock::time_point begin = Clock::now();
  const auto since = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  uint64_t complaints = 0;
  uint64_t done = 0;
  uint64_t number = first;
  Codes of_format;
  for (; budget.seconds > 0.0 ? since() < budget.seconds : number < first + budget.cases;
       ++number) {
    for (const adit::test::FuzzedCommand command : adit::test::kFuzzedCommands) {
      const std::string name(to_string(command));
      if (!cases.reads(command, format) || (only != "all" && only != name)) {
        continue;
      }
      std::snprintf(g_case, sizeof g_case, "%s, %s, case %llu", name.c_str(), format.c_str(),
                    static_cast<unsigned long long>(number));
      allow_seconds(120);
      const adit::test::CommandOutcome outcome = cases.run(command, format, number);
      ++of_format[command][outcome.code];
      ++done;
      if (!outcome.complaint.empty()) {
        ++complaints;
        std::printf("%s: %s\n", g_case, outcome.complaint.c_str());
      }
    }
  }
  for (const auto& [command, times_of] : of_format) {
    for (const auto& [code, times] : times_of) {
      codes[command][code] += times;
    }
    if (times_of.size() == 1 && times_of.begin()->first == 2 &&
        times_of.begin()->second >= kCallsToTell) {
      ++complaints;
      std::printf("%s, %s: each call was refused as a wrong one\n",
                  std::string(to_string(command)).c_str(), format.c_str());
    }
  }
  std::printf("%s: %llu cases in %.0f s, %llu complaints\n", format.c_str(),
              static_cast<unsigned long long>(done), since(),
              static_cast<unsigned long long>(complaints));
  std::fflush(stdout);
  return complaints;
}

int fuzz_all(const std::string& amount, const std::string& only_format, const std::string& only,
             uint64_t first) {
  adit::engine::Context context({});
  const adit::test::CommandCases cases(context);
  std::vector<std::string> formats = cases.formats();
  if (only_format != "all") {
    if (std::ranges::count(formats, only_format) == 0) {
      std::fprintf(stderr, "fuzz_commands: there is no format %s\n", only_format.c_str());
      return 2;
    }
    formats = {only_format};
  }
  const double number = std::strtod(amount.c_str(), nullptr);
  const bool seconds = amount.ends_with('s');
  const auto each = static_cast<uint64_t>(std::ceil(number / static_cast<double>(formats.size())));
  const Budget budget = {.cases = seconds ? 0 : each, .seconds = seconds ? number : 0.0};
  Codes codes;
  uint64_t complaints = 0;
  for (const std::string& format : formats) {
    complaints += fuzz(cases, format, only, budget, first, codes);
  }
  for (const auto& [command, times_of] : codes) {
    uint64_t sum = 0;
    std::string told;
    for (const auto& [code, times] : times_of) {
      sum += times;
      told += ", " + std::to_string(times) + " ended with " + std::to_string(code);
    }
    std::printf("%s: %llu cases%s\n", std::string(to_string(command)).c_str(),
                static_cast<unsigned long long>(sum), told.c_str());
  }
  std::printf("%llu complaints\n", static_cast<unsigned long long>(complaints));
  return complaints == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPROF}) {
    std::signal(signal, tell_case);
  }
  const auto word = [&](int at, const char* otherwise) {
    return std::string(at < count ? arguments[at] : otherwise);
  };
  try {
    return fuzz_all(word(1, "5000"), word(2, "all"), word(3, "all"),
                    std::strtoull(word(4, "0").c_str(), nullptr, 10));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_commands: %s, in %s\n", error.what(), g_case);
    return 1;
  }
}
