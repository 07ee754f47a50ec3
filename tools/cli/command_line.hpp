// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Commands and what they take on the command line. CLI11, which reads it, takes longer to compile
// than all that is ours: command_line.cpp alone sees it. Help and complaints are in plain words,
// where CLI11's own speak of its internals.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/cli/command_description.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace adit {

/// An option or argument of a command. Each call says more of it; copies mean the same option.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option& option) : option_(&option) {}

  CommandOption required() const;
  /// What the help calls its value.
  CommandOption value_name(const std::string& name) const;
  /// The help names the value that the target has now, or this one.
  CommandOption show_default() const;
  CommandOption show_default(const std::string& value) const;
  /// So many values.
  CommandOption values(int least, int most) const;
  /// One value each time it is given.
  CommandOption one_value_each() const;
  /// Several values may stand in one word, with commas between them.
  CommandOption with_commas() const;

  /// Numbers from `low` to `high`; without `high` no bound above.
  CommandOption from(double low) const;
  CommandOption from(double low, double high) const;
  CommandOption above(double low) const;
  CommandOption one_of(const std::vector<std::string>& words) const;
  /// Shells offer these words; the command tells which others it takes.
  CommandOption suggest(const std::vector<std::string>& words) const;
  /// Shells offer files. Those whose target is a path need not say so.
  CommandOption file() const;
  /// It names a file to write. None of the files that the command reads is written over: then
  /// nothing is begun. A name that ends otherwise than in one of `endings` (".html") is refused:
  /// the file would not be what it is called. Names without an ending are taken.
  CommandOption written(const std::vector<std::string>& endings = {}) const;
  /// A number of bytes, with or without a unit.
  CommandOption bytes() const;
  /// One of those that all commands have: the help lists them last, and given_besides() knows them.
  CommandOption of_every_command() const;

  /// It is on the command line.
  bool given() const;

 private:
  CLI::Option* option_;
};

/// A command while it is put together: what it takes and what it does. Copies mean the same
/// command; targets are written to when the command line is read.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command) {}

  Command add_command(const std::string& name, const std::string& description) const;
  void footer(const std::string& text) const;

  /// `name` is "--name", "-n,--name", or "name" for an argument. The target is a text, a path, a
  /// number, an optional or a list of one of these; which, command_line.cpp says.
  template <class Target>
  CommandOption option(const std::string& name, Target& target,
                       const std::string& description) const;

  /// An option whose value is one of a few words. `target` keeps what it is where the option is not
  /// given; the help names the words.
  template <class T, class Target>
  CommandOption choice(const std::string& name, const std::string& description, Target& target,
                       const std::vector<std::pair<std::string, T>>& choices) const {
    std::vector<std::string> words;
    for (const auto& [word, value] : choices) {
      words.push_back(word);
    }
    return choice(name, description, words,
                  [&target, choices](std::size_t chosen) { target = choices[chosen].second; });
  }

  CommandOption flag(const std::string& name, bool& target, const std::string& description) const;
  void flag(const std::string& name, const std::function<void()>& set,
            const std::string& description) const;

  /// What the command does once the command line is read.
  void action(const std::function<void()>& run) const;

  /// One of its sub-commands is on the command line.
  bool has_chosen() const;
  /// The first option on the command line that is none of those, nor of every command; empty where
  /// there is none.
  std::string given_besides(const std::vector<std::string>& known) const;

 private:
  CommandOption choice(const std::string& name, const std::string& description,
                       const std::vector<std::string>& words,
                       const std::function<void(std::size_t)>& set) const;

  CLI::App* command_;
};

/// For actions: what was given does not go together.
[[noreturn]] void refuse_option(const std::string& name, const std::string& why);
[[noreturn]] void miss_argument(const std::string& name);
/// For flags: all that was asked for is done.
[[noreturn]] void end_parsing();

/// The command line of a program.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// What the program itself takes.
  Command program() const;
  /// What --version prints, made when it is asked for.
  void version(const std::function<std::string()>& text) const;
  std::string help() const;
  /// Names of its commands.
  std::vector<std::string> commands() const;
  /// The program itself, its commands and those below them.
  std::vector<Command> all() const;
  /// All that it takes.
  CommandDescription description() const;

  /// Reads the words, calls `before` and runs the command's action. Help and mistakes are printed
  /// on the standard streams; then the exit code is given, and nothing is called.
  std::optional<int> run(int argc, const char* const* argv,
                         const std::function<void()>& before = {}) const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace adit
