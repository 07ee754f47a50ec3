// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/command_line.hpp"

#include <cstdint>
#include <filesystem>
#include <iostream>
#include <span>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/given_option.hpp"
#include "adit/tools/cli/readable_error.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
constexpr int kUsage = 2;
constexpr const char* kOfEveryCommand = "Options of every command";

/// Complains unless the text is a number that `fits`.
CLI::Validator number(const std::string& wanted, const std::function<bool(double)>& fits) {
  return {[wanted, fits](std::string& text) { return number_complaint(text, wanted, fits); }, ""};
}

/// Makes a number of bytes out of "512MiB"; else a complaint.
std::string size_to_bytes(std::string& text) {
  if (text.starts_with('-')) {
    return "a size is not negative";
  }
  const std::string given = text;
  try {
    if (CLI::AsSizeValue(false)(text).empty()) {
      return text == "0" ? "a size of 0 is none; without the option there is no limit"
                         : std::string();
    }
  } catch (const CLI::ValidationError&) {
    // It lists every unit that it knows: the complaint below is for people.
  }
  return "'" + given + "' is no size; write 512MiB, 2GiB or a number of bytes";
}

constexpr char kBetweenWords = '\n';  // as in joined()
constexpr const char* kFile = "\nfile";
constexpr const char* kWritten = "\nwritten";

/// What shells offer for an option travels with it as the name of a check, which CLI11 keeps.
std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, "\n"));
}

CLI::Validator passes(const std::string& name) {
  return {[](std::string&) { return std::string(); }, "", name};
}

/// Names of an option's checks.
std::vector<std::string> checks(CLI::Option& option) {
  std::vector<std::string> names;
  try {
    for (int i = 0;; ++i) {
      names.push_back(option.get_validator(i)->get_name());
    }
  } catch (const CLI::OptionNotFound&) {  // there are no more; CLI11 does not tell how many
  }
  return names;
}

OptionDescription describe(CLI::Option& option) {
  OptionDescription described{
      .value = option.get_expected_max() == 0 ? "" : option.get_type_name(),
      .text = option.get_description(),
      .default_value = option.get_default_str(),
      .required = option.get_required(),
      .repeats = option.get_expected_max() == CLI::detail::expected_max_vector_size ||
                 (option.get_positional() && option.get_expected_max() > 1)};
  for (const std::string& name : option.get_snames()) {
    described.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    described.names.push_back("--" + name);
  }
  for (const std::string& name : checks(option)) {
    if (name == kFile) {
      described.file = true;
    } else if (!name.empty() && !name.starts_with(kWritten)) {
      described.words = CLI::detail::split(name, kBetweenWords);
    }
  }
  return described;
}

CommandDescription describe(CLI::App& command, const std::string& above) {
  CommandDescription described{.name = above + command.get_name(),
                               .text = command.get_description(),
                               .footer = command.get_footer()};
  for (CLI::Option* option : command.get_options()) {
    (option->nonpositional() ? described.options : described.arguments)
        .push_back(describe(*option));
  }
  for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    described.commands.push_back(describe(*below, described.name + " "));
  }
  return described;
}

/// Of a file to write the endings of its name that are taken, none for any; nothing of other
/// options.
std::optional<std::vector<std::string>> written_endings(CLI::Option& option) {
  for (const std::string& name : checks(option)) {
    if (name.starts_with(kWritten)) {
      const std::string endings = name.substr(std::string_view(kWritten).size());
      return endings.empty() ? std::vector<std::string>{} : CLI::detail::split(endings, '\n');
    }
  }
  return std::nullopt;
}

std::vector<GivenOption> given_options(CLI::App& command) {
  std::vector<GivenOption> given;
  for (CLI::Option* option : command.get_options()) {
    const auto endings = written_endings(*option);
    given.push_back({.name = option->get_name(),
                     .values = option->results(),
                     .written = endings.has_value(),
                     .endings = endings.value_or(std::vector<std::string>{})});
  }
  return given;
}

/// Help without the marks that CLI11 puts behind names.
class PlainFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string value = option->get_type_name();
    std::string text = value.empty() ? "" : " " + value;
    if (!option->get_default_str().empty()) {
      text += "=" + option->get_default_str();
    }
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) {
      text += " ...";
    }
    return text + (option->get_required() ? " (required)" : "");
  }
};

/// What to tell about the words that neither the program nor the command knows; empty where there
/// are none. A missing argument is often a misspelt one, so this comes before what CLI11 complains
/// about.
std::string unknown_words(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty()) {
      options.push_back("--" + option->get_lnames().front());
    }
  }
  std::string text;
  for (const std::string& word : app.remaining(true)) {
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      if (std::ranges::count(options, name) > 0) {
        return name + ": " + place_of_option(command.get_name());
      }
      return "there is no option '" + name + "'. " + suggestion(name, options) + ".";
    }
    text += (text.empty() ? "not expected: " : " ") + word;
  }
  const CLI::Option* output = command.get_option_no_throw("--output");
  if (!text.empty() && output != nullptr && output->count() == 0) {
    text += ". The output is named with -o: -o " + app.remaining(true).back();
  }
  return text;
}

/// The complaint, and how many values the option takes that it is about.
std::string with_values(const CLI::App& command, const std::string& complaint) {
  const CLI::Option* option = command.get_option_no_throw(complaint.substr(0, complaint.find(':')));
  return option == nullptr
             ? complaint
             : complaint + wanted_values(option->get_expected_min(), option->get_expected_max(),
                                         option->get_type_name());
}

/// "adit loops".
std::string name_of_chosen(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command = &app; !command->get_subcommands().empty();) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  return name;
}

/// Help and version are answers, everything else that parsing throws is a mistake on the command
/// line.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return reported(app.get_name(), std::cout, std::cerr, app.exit(error, std::cout, std::cerr));
  }
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
  }
  const std::string name = name_of_chosen(app);
  const std::string unknown = unknown_words(app, *command);
  const std::string complaint = readable_error(error.what());
  std::cerr << name << ": " << (unknown.empty() ? with_values(*command, complaint) : unknown)
            << "\nRun `" << name << " --help` for what it takes.\n";
  return kUsage;
}

}  // namespace

CommandOption CommandOption::required() const {
  option_->required();
  return *this;
}

CommandOption CommandOption::value_name(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

CommandOption CommandOption::show_default() const {
  option_->capture_default_str();
  return *this;
}

CommandOption CommandOption::show_default(const std::string& value) const {
  option_->default_str(value);
  return *this;
}

CommandOption CommandOption::values(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

CommandOption CommandOption::one_value_each() const {
  option_->allow_extra_args(false);
  return *this;
}

CommandOption CommandOption::with_commas() const {
  option_->delimiter(',');
  return *this;
}

CommandOption CommandOption::from(double low) const {
  option_->check(
      number(fmt::format("of {:g} or more", low), [low](double value) { return value >= low; }));
  return *this;
}

CommandOption CommandOption::from(double low, double high) const {
  option_->check(number(fmt::format("from {:.10g} to {:.10g}", low, high),
                        [low, high](double value) { return value >= low && value <= high; }));
  return *this;
}

CommandOption CommandOption::above(double low) const {
  option_->check(
      number(fmt::format("above {:g}", low), [low](double value) { return value > low; }));
  return *this;
}

CommandOption CommandOption::one_of(const std::vector<std::string>& words) const {
  const auto check = [words](std::string& text) {
    return std::ranges::count(words, text) > 0 ? std::string()
                                               : "'" + text + "' is none of " + listed_words(words);
  };
  option_->check(CLI::Validator(check, "", joined(words)));
  return *this;
}

CommandOption CommandOption::suggest(const std::vector<std::string>& words) const {
  option_->check(passes(joined(words)));
  return *this;
}

CommandOption CommandOption::file() const {
  option_->check(passes(kFile));
  return *this;
}

CommandOption CommandOption::written(const std::vector<std::string>& endings) const {
  option_->check(passes(kWritten + joined(endings)));
  return *this;
}

CommandOption CommandOption::bytes() const {
  option_->transform(CLI::Validator(size_to_bytes, ""));
  return *this;
}

CommandOption CommandOption::of_every_command() const {
  option_->group(kOfEveryCommand);
  return *this;
}

bool CommandOption::given() const {
  return option_->count() > 0;
}

Command Command::add_command(const std::string& name, const std::string& description) const {
  return Command(*command_->add_subcommand(name, description));
}

void Command::footer(const std::string& text) const {
  command_->footer(text);
}

template <class Target>
CommandOption Command::option(const std::string& name, Target& target,
                              const std::string& description) const {
  const CommandOption option(*command_->add_option(name, target, description));
  if constexpr (std::is_same_v<Target, fs::path> ||
                std::is_same_v<Target, std::optional<fs::path>> ||
                std::is_same_v<Target, std::vector<fs::path>>) {
    option.file();
  }
  return option;
}

#define ADIT_TARGET(type) \
  template CommandOption Command::option(const std::string&, type&, const std::string&) const
ADIT_TARGET(double);
ADIT_TARGET(int);
ADIT_TARGET(int64_t);
ADIT_TARGET(uint32_t);
ADIT_TARGET(uint64_t);
ADIT_TARGET(std::string);
ADIT_TARGET(fs::path);
ADIT_TARGET(std::optional<double>);
ADIT_TARGET(std::optional<int>);
ADIT_TARGET(std::optional<int64_t>);
ADIT_TARGET(std::optional<uint64_t>);
ADIT_TARGET(std::optional<std::string>);
ADIT_TARGET(std::optional<fs::path>);
ADIT_TARGET(std::vector<double>);
ADIT_TARGET(std::vector<int>);
ADIT_TARGET(std::vector<int64_t>);
ADIT_TARGET(std::vector<uint32_t>);
ADIT_TARGET(std::vector<uint64_t>);
ADIT_TARGET(std::vector<std::string>);
ADIT_TARGET(std::vector<fs::path>);
#undef ADIT_TARGET

CommandOption Command::choice(const std::string& name, const std::string& description,
                              const std::vector<std::string>& words,
                              const std::function<void(std::size_t)>& set) const {
  std::string type;
  for (const std::string& word : words) {
    type += (type.empty() ? "" : "|") + word;
  }
  const auto find = [name, words, set](const std::string& given) {
    const auto found = std::ranges::find(words, given);
    if (found == words.end()) {
      refuse_option(name, "'" + given + "' is none of " + listed_words(words));
    }
    set(static_cast<std::size_t>(found - words.begin()));
  };
  return CommandOption(*command_->add_option_function<std::string>(name, find, description)
                            ->type_name(type)
                            ->check(passes(joined(words))));
}

CommandOption Command::flag(const std::string& name, bool& target,
                            const std::string& description) const {
  return CommandOption(*command_->add_flag(name, target, description));
}

void Command::flag(const std::string& name, const std::function<void()>& set,
                   const std::string& description) const {
  command_->add_flag_callback(name, set, description);
}

void Command::action(const std::function<void()>& run) const {
  command_->callback(run);
}

bool Command::has_chosen() const {
  return !command_->get_subcommands().empty();
}

std::string Command::given_besides(const std::vector<std::string>& known) const {
  for (const CLI::Option* option : command_->get_options()) {
    if (option->count() > 0 && option->get_group() != kOfEveryCommand &&
        std::ranges::count(known, option->get_name()) == 0) {
      return option->get_name();
    }
  }
  return {};
}

void refuse_option(const std::string& name, const std::string& why) {
  throw CLI::ValidationError(name, why);
}

void miss_argument(const std::string& name) {
  throw CLI::RequiredError(name);
}

void end_parsing() {
  throw CLI::Success();
}

CommandLine::CommandLine(const std::string& name, const std::string& description)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->formatter(std::make_shared<PlainFormatter>());  // of all its commands, too
}

CommandLine::~CommandLine() = default;

Command CommandLine::program() const {
  return Command(*app_);
}

void CommandLine::version(const std::function<std::string()>& text) const {
  app_->set_version_flag("-V,--version", text,
                         "Print version, commit, build, compiler and Vulkan loader");
}

std::string CommandLine::help() const {
  return app_->help();
}

std::vector<std::string> CommandLine::commands() const {
  std::vector<std::string> names;
  for (const CLI::App* command : app_->get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<Command> CommandLine::all() const {
  std::vector<CLI::App*> apps = {app_.get()};
  for (std::size_t i = 0; i < apps.size(); ++i) {
    for (CLI::App* below : apps[i]->get_subcommands([](const CLI::App*) { return true; })) {
      apps.push_back(below);
    }
  }
  std::vector<Command> commands;
  for (CLI::App* app : apps) {
    commands.emplace_back(*app);
  }
  return commands;
}

CommandDescription CommandLine::description() const {
  return describe(*app_, "");
}

std::optional<int> CommandLine::run(int argc, const char* const* argv,
                                    const std::function<void()>& before) const {
  app_->parse_complete_callback([&] {
    for (CLI::App* command = app_.get(); !command->get_subcommands().empty();) {
      const std::string stray = Command(*command).given_besides({});
      command = command->get_subcommands().front();
      if (!stray.empty()) {
        refuse_option(stray, place_of_option(command->get_name()));
      }
      const std::vector<GivenOption> given = given_options(*command);
      keep_inputs(given);
      require_endings(given);
    }
    if (before) {
      before();
    }
  });
  if (!commands().empty()) {
    app_->require_subcommand(1);
  }
  const std::span words(argv, static_cast<std::size_t>(argc));
  if (const std::string mistaken = mistaken_words(description(), words); !mistaken.empty()) {
    std::cerr << app_->get_name() << ": " << mistaken << "." << std::endl;
    return kUsage;
  }
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(*app_, error);
  } catch (const UsageError& error) {
    std::cerr << name_of_chosen(*app_) << ": " << error.what() << std::endl;
    return kUsage;
  }
  return std::nullopt;
}

}  // namespace adit
