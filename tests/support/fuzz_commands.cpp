// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// fuzz_commands [CASES [FIRST [COMMAND]]]: the commands on so many damaged inputs each (5000), from
// case FIRST on. `./dev fuzz-commands` builds and runs it. A case that a command does not end as it
// should is told by its number; the last that was begun, where that ends the program.
#include <sys/time.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <string>

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

/// Of the processor: what hangs is ended by SIGPROF, however busy the machine.
void allow_seconds(long seconds) {
  const itimerval timer{.it_interval = {}, .it_value = {.tv_sec = seconds, .tv_usec = 0}};
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

int fuzz(uint64_t count, uint64_t first, const std::string& only) {
  adit::engine::Context context({});
  const adit::test::CommandCases cases(context);
  uint64_t complaints = 0;
  for (const adit::test::FuzzedCommand command : adit::test::kFuzzedCommands) {
    const std::string name(to_string(command));
    if (!only.empty() && only != name) {
      continue;
    }
    std::map<int, uint64_t> codes;
    for (uint64_t number = first; number < first + count; ++number) {
      std::snprintf(g_case, sizeof g_case, "%s, case %llu", name.c_str(),
                    static_cast<unsigned long long>(number));
      allow_seconds(120);
      const adit::test::CommandOutcome outcome = cases.run(command, number);
      ++codes[outcome.code];
      if (!outcome.complaint.empty()) {
        ++complaints;
        std::printf("%s: %s\n", g_case, outcome.complaint.c_str());
        std::fflush(stdout);
      }
    }
    std::printf("%s: %llu cases", name.c_str(), static_cast<unsigned long long>(count));
    for (const auto& [code, times] : codes) {
      std::printf(", %llu ended with %d", static_cast<unsigned long long>(times), code);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("%llu complaints\n", static_cast<unsigned long long>(complaints));
  return complaints == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPROF}) {
    std::signal(signal, tell_case);
  }
  const auto number = [&](int at, uint64_t otherwise) {
    return at < count ? std::strtoull(arguments[at], nullptr, 10) : otherwise;
  };
  try {
    return fuzz(number(1, 5000), number(2, 0), count > 3 ? arguments[3] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_commands: %s, in %s\n", error.what(), g_case);
    return 1;
  }
}
