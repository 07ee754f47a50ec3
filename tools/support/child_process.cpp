// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/child_process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr int kNotStarted = 127;              // as shells have it
constexpr useconds_t kBetweenLooks = 20'000;  // us, at a child that takes seconds

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// In the new process, where nothing may be allocated any more.
[[noreturn]] void become(const char* program, char* const* words, const char* folder, int log,
                         pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (getppid() != parent || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 ||
      dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0 || chdir(folder) != 0) {
    _exit(kNotStarted);
  }
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    std::signal(number, SIG_DFL);
  }
  execv(program, words);
  _exit(kNotStarted);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const char* what) {
  throw OutputError(file, file.string() + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

ChildOutcome run_child(const ChildProcess& child) {
  const int log =
      open(child.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);  // NOLINT: POSIX
  if (log < 0) {
    refuse(child.log, "cannot be written");
  }
  std::string name = child.program.string();
  std::vector<std::string> words = child.words;
  std::vector<char*> pointers = {name.data()};
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  const auto begin = std::chrono::steady_clock::now();
  const pid_t parent = getpid();
  std::signal(SIGCHLD,
              SIG_DFL);  // if a parent ignored it, wait4() would not return the exit status
  const pid_t process = fork();
  if (process == 0) {
    become(child.program.c_str(), pointers.data(), child.folder.c_str(), log, parent);
  }
  close(log);
  if (process < 0) {
    refuse(child.program, "no process can be made");
  }
  int status = 0;
  rusage usage{};
  int passed_on = 0;
  pid_t ended = 0;
  while ((ended = wait4(process, &status, WNOHANG, &usage)) == 0) {
    if (StopSignal::received() != passed_on) {
      passed_on = StopSignal::received();
      kill(process, passed_on);
    }
    usleep(kBetweenLooks);
  }
  if (ended < 0) {
    refuse(child.program, "nobody knows how it ended");
  }
  return {
      .code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status),
      .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
      .processor_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
      .peak_memory = static_cast<uint64_t>(usage.ru_maxrss) * 1024};
}

std::filesystem::path own_program() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace adit
