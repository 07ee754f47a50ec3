// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/completion.hpp"

#include <algorithm>
#include <functional>
#include <string_view>
#include <vector>

namespace adit {
namespace {

constexpr const char* kHead = "# Written by `adit generate`, of the options that adit has.\n";

/// A text with each of `special` behind a backslash.
std::string escaped(std::string_view text, std::string_view special) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != special.npos) {
      result += '\\';
    }
    result += c;
  }
  return result;
}

/// A word of the shells bash and zsh: within single quotes, a quote ends them for a moment.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return result + "'";
}

std::string fish_quoted(std::string_view text) {
  return "'" + escaped(text, "\\'") + "'";
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : std::string(between)) + word;
  }
  return text;
}

std::vector<std::string> names_of(const std::vector<CommandDescription>& commands) {
  std::vector<std::string> names;
  for (const CommandDescription& command : commands) {
    names.push_back(command.own_name());
  }
  return names;
}

/// Calls `visit` with a command and all below it.
void visit_all(const CommandDescription& command,
               const std::function<void(const CommandDescription&)>& visit) {
  visit(command);
  for (const CommandDescription& below : command.commands) {
    visit_all(below, visit);
  }
}

/// Names of all commands but the program itself, in single quotes.
std::vector<std::string> quoted_paths(const CommandDescription& program) {
  std::vector<std::string> paths;
  visit_all(program, [&](const CommandDescription& command) {
    if (&command != &program) {
      paths.push_back(in_quotes(command.name));
    }
  });
  return paths;
}

// --- bash
// -----------------------------------------------------------------------------------------

constexpr const char* kBashBegin = R"(
_adit() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  # --option=value comes as three words
  if [[ $current == = ]]; then
    current=
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  local command=adit i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$command ${COMP_WORDS[i]}" in
)";

constexpr const char* kBashEnd = R"(      esac
      [[ $current != -* ]] || words=$options files=
      ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  # Files are what the shell itself offers where nothing else fits.
  [[ -z $files ]] || compopt -o default 2>/dev/null
}
complete -F _adit adit
)";

/// "words='a b' files=1", what of it there is.
std::string bash_values(const OptionDescription& option) {
  std::string text = option.words.empty() ? "" : "words=" + in_quotes(joined(option.words, " "));
  if (option.file) {
    text += (text.empty() ? "" : " ") + std::string("files=1");
  }
  return text;
}

std::string bash_option_cases(const CommandDescription& command) {
  std::string text;
  for (const OptionDescription& option : command.options) {
    if (option.value.empty()) {
      continue;
    }
    std::vector<std::string> calls;
    for (const std::string& name : option.names) {
      calls.push_back(in_quotes(command.name + " " + name));
    }
    const std::string values = bash_values(option);
    text += "    " + joined(calls, " | ") + ") " + (values.empty() ? "" : values + " ") + ";;\n";
  }
  return text;
}

std::string bash_command_case(const CommandDescription& command) {
  std::vector<std::string> options;
  for (const OptionDescription& option : command.options) {
    options.insert(options.end(), option.names.begin(), option.names.end());
  }
  std::vector<std::string> words = names_of(command.commands);
  bool files = false;
  for (const OptionDescription& argument : command.arguments) {
    words.insert(words.end(), argument.words.begin(), argument.words.end());
    files = files || argument.file;
  }
  return "        " + in_quotes(command.name) + ") options=" + in_quotes(joined(options, " ")) +
         (words.empty() ? "" : " words=" + in_quotes(joined(words, " "))) +
         (files ? " files=1" : "") + " ;;\n";
}

// --- zsh
// ------------------------------------------------------------------------------------------

std::string zsh_function(const CommandDescription& command) {
  std::string name = "_" + command.name;
  std::ranges::replace(name, ' ', '_');
  return name;
}

/// ":VALUE:what is offered" for each word that the value has.
std::string zsh_values(const OptionDescription& option, const std::string& begin) {
  std::string action;
  if (!option.words.empty() && option.file) {
    action = "{compadd -- " + joined(option.words, " ") + "; _files}";
  } else if (!option.words.empty()) {
    action = "(" + joined(option.words, " ") + ")";
  } else if (option.file) {
    action = "_files";
  }
  return begin + ":" + escaped(option.value, ":") + ":" + action;
}

std::string zsh_option(const OptionDescription& option) {
  const std::string all = joined(option.names, " ");
  std::string specs;
  for (const std::string& name : option.names) {
    const bool assigns = !option.value.empty() && name.starts_with("--");
    const std::string once = option.repeats ? "*" : option.names.size() > 1 ? "(" + all + ")" : "";
    std::string spec =
        once + name + (assigns ? "=" : "") + "[" + escaped(option.text, "[]\\:") + "]";
    spec += option.value.empty() ? "" : zsh_values(option, "");
    specs += "    " + in_quotes(spec) + " \\\n";
  }
  return specs;
}

std::string zsh_body(const CommandDescription& command) {
  std::string text = zsh_function(command) + "() {\n";
  const bool chooses = !command.commands.empty();
  if (chooses) {
    text += "  local context state state_descr line\n  typeset -A opt_args\n";
  }
  text += std::string("  _arguments ") + (chooses ? "-C" : "-S") + " \\\n";
  for (const OptionDescription& option : command.options) {
    text += zsh_option(option);
  }
  if (chooses) {
    text += "    '1: :->command' '*:: :->arguments'\n  case $state in\n    command)\n";
    text += "      local -a commands=(\n";
    for (const CommandDescription& below : command.commands) {
      text += "        " + in_quotes(below.own_name() + ":" + escaped(below.text, ":")) + "\n";
    }
    text += "      )\n      _describe command commands\n";
    for (const OptionDescription& argument : command.arguments) {
      if (!argument.words.empty()) {
        text += "      compadd -- " + joined(argument.words, " ") + "\n";
      }
      text += argument.file ? "      _files\n" : "";
    }
    text += "      ;;\n    arguments)\n      case $words[1] in\n";
    for (const CommandDescription& below : command.commands) {
      text += "        " + below.own_name() + ") " + zsh_function(below) + " ;;\n";
    }
    return text + "      esac\n      ;;\n  esac\n}\n\n";
  }
  for (std::size_t i = 0; i < command.arguments.size(); ++i) {
    const OptionDescription& argument = command.arguments[i];
    std::string place = argument.repeats ? "*" : std::to_string(i + 1);
    place += argument.repeats || argument.required ? "" : ":";
    text += "    " + in_quotes(zsh_values(argument, place)) + " \\\n";
  }
  return text + "    && return\n}\n\n";
}

// --- fish
// -----------------------------------------------------------------------------------------

constexpr const char* kFishBegin = R"(
# The words before the cursor lead to this command.
function __adit_at
    set -l command adit
    for word in (commandline -opc)[2..-1]
        switch "$command $word"
)";

constexpr const char* kFishEnd = R"(                set command "$command $word"
        end
    end
    test "$command" = "$argv"
end

complete -c adit -f
)";

std::string fish_words(const OptionDescription& option) {
  return option.words.empty() ? "" : " -a " + fish_quoted(joined(option.words, " "));
}

std::string fish_lines(const CommandDescription& command) {
  const std::string begin = "complete -c adit -n " + fish_quoted("__adit_at " + command.name);
  std::string text;
  for (const CommandDescription& below : command.commands) {
    text += begin + " -a " + below.own_name() + " -d " + fish_quoted(below.text) + "\n";
  }
  for (const OptionDescription& argument : command.arguments) {
    const std::string values = (argument.file ? " -F" : "") + fish_words(argument);
    text += values.empty() ? "" : begin + values + "\n";
  }
  for (const OptionDescription& option : command.options) {
    text += begin;
    for (const std::string& name : option.names) {
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    text += option.value.empty() ? "" : (option.file ? " -r -F" : " -x") + fish_words(option);
    text += " -d " + fish_quoted(option.text) + "\n";
  }
  return text;
}

}  // namespace

std::string bash_completion(const CommandDescription& program) {
  std::string text = std::string(kHead) + kBashBegin;
  text += "      " + joined(quoted_paths(program), " | ") + ") command+=\" ${COMP_WORDS[i]}\" ;;\n";
  text += "    esac\n  done\n  local options= words= files=\n";
  text += "  case \"$command $previous\" in\n";
  visit_all(program,
            [&](const CommandDescription& command) { text += bash_option_cases(command); });
  text += "    *)\n      case $command in\n";
  visit_all(program,
            [&](const CommandDescription& command) { text += bash_command_case(command); });
  return text + kBashEnd;
}

std::string zsh_completion(const CommandDescription& program) {
  std::string text = std::string("#compdef adit\n") + kHead + "\n";
  visit_all(program, [&](const CommandDescription& command) { text += zsh_body(command); });
  return text + zsh_function(program) + " \"$@\"\n";
}

std::string fish_completion(const CommandDescription& program) {
  std::string text = std::string(kHead) + kFishBegin;
  text += "            case " + joined(quoted_paths(program), " ") + "\n" + kFishEnd;
  visit_all(program, [&](const CommandDescription& command) { text += fish_lines(command); });
  return text;
}

}  // namespace adit
