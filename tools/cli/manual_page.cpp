// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/manual_page.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/core.h>

#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

std::vector<std::string> split(std::string_view text, std::string_view separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == text.npos) {
      return parts;
    }
    text.remove_prefix(end + separator.size());
  }
}

/// Text as roff prints it: `code` in bold, nothing taken for a request.
std::string roff(std::string_view text) {
  std::string result;
  bool bold = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if ((c == '.' || c == '\'') && (i == 0 || text[i - 1] == '\n')) {
      result += "\\&";
    }
    if (c == '`') {
      bold = !bold;
      result += bold ? "\\fB" : "\\fR";
    } else if (c == '-') {
      result += "\\-";
    } else if (c == '\\') {
      result += "\\e";
    } else if (c == '~') {
      result += "\\(ti";
    } else if (c == '^') {
      result += "\\(ha";
    } else {
      result += c;
    }
  }
  return result;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string page_name(const CommandDescription& command) {
  std::string name = command.name;
  std::ranges::replace(name, ' ', '-');
  return name;
}

/// "-o, --output OUT", the names in bold.
std::string title(const OptionDescription& option) {
  std::string text;
  for (const std::string& name : option.names) {
    text += (text.empty() ? "" : ", ") + bold(name);
  }
  if (!option.value.empty()) {
    text += (text.empty() ? "" : " ") + italic(option.value);
  }
  return text + (option.repeats ? " ..." : "");
}

std::string sentence(const std::string& text) {
  const bool ends = text.empty() || std::string_view(".!?:").find(text.back()) != text.npos;
  return text + (ends ? "" : ".");
}

std::string entries(const std::string& heading, const std::vector<OptionDescription>& options) {
  std::string text = options.empty() ? "" : ".SH " + heading + "\n";
  for (const OptionDescription& option : options) {
    std::string more = option.required && !option.names.empty() ? " Required." : "";
    more += option.default_value.empty() ? "" : " Default: " + option.default_value + ".";
    text += ".TP\n" + title(option) + "\n" + roff(sentence(option.text) + more) + "\n";
  }
  return text;
}

std::string synopsis(const CommandDescription& command) {
  std::string text = ".SH SYNOPSIS\n" + bold(command.name);
  for (const OptionDescription& option : command.options) {
    if (option.required) {
      text += " " + bold(option.names.front()) + " " + italic(option.value);
    }
  }
  text += " [" + italic("OPTIONS") + "]";
  for (const OptionDescription& argument : command.arguments) {
    const std::string name = italic(argument.value) + (argument.repeats ? " ..." : "");
    text += argument.required ? " " + name : " [" + name + "]";
  }
  text += "\n";
  if (!command.commands.empty()) {
    text += ".br\n" + bold(command.name) + " " + italic("COMMAND") + " ...\n";
  }
  return text;
}

std::string commands(const CommandDescription& command) {
  std::string text = command.commands.empty() ? "" : ".SH COMMANDS\n";
  for (const CommandDescription& below : command.commands) {
    text += ".TP\n.BR " + roff(page_name(below)) + " (1)\n" + roff(sentence(below.text)) + "\n";
  }
  return text;
}

/// A line "Name:   text", as those of lists are.
bool names_something(const std::string& line) {
  const std::size_t colon = line.find(':');
  return colon != line.npos && colon + 1 < line.size() && line[colon + 1] == ' ' &&
         std::isupper(static_cast<unsigned char>(line.front())) != 0 &&
         line.substr(0, colon).find_first_of(" \"") == line.npos;
}

std::string lines_as_they_are(const std::vector<std::string>& lines) {
  std::string text = ".nf\n";
  for (const std::string& line : lines) {
    text += roff(line.substr(std::min(line.find_first_not_of(' '), line.size()))) + "\n";
  }
  return text + ".fi\n";
}

/// Lines "  NAME  text", the name in bold.
std::string tagged_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t end = std::min(line.find("  ", begin), line.size());
    const std::size_t meaning = std::min(line.find_first_not_of(' ', end), line.size());
    text += ".TP\n" + bold(line.substr(begin, end - begin)) + "\n" +
            roff(sentence(line.substr(meaning))) + "\n";
  }
  return text;
}

std::string prose(const std::vector<std::string>& lines) {
  std::string text;
  bool begun = false;
  for (const std::string& line : lines) {
    if (names_something(line)) {
      const std::size_t colon = line.find(':');
      const std::size_t rest = std::min(line.find_first_not_of(' ', colon + 1), line.size());
      text += ".TP\n" + bold(line.substr(0, colon)) + "\n" + roff(line.substr(rest)) + "\n";
    } else {
      text += (begun ? "" : ".PP\n") + roff(line) + "\n";
    }
    begun = true;
  }
  return text;
}

/// What a footer holds, by section.
struct Sections {
  std::string description{};
  std::string environment{};
  std::string examples{};
  std::string exit_status{};
};

Sections sections(const std::string& footer) {
  Sections found;
  for (const std::string& paragraph : split(footer, "\n\n")) {
    std::vector<std::string> lines = split(paragraph, "\n");
    std::erase_if(lines, [](const std::string& line) { return line.empty(); });
    if (lines.empty()) {
      continue;
    }
    const std::vector<std::string> below(lines.begin() + 1, lines.end());
    constexpr std::string_view kCodes = "Exit codes: ";
    if (lines.front() == "Examples:" || lines.front() == "Example:") {
      found.examples = ".SH EXAMPLES\n" + lines_as_they_are(below);
    } else if (lines.front() == "Environment:") {
      found.environment = ".SH ENVIRONMENT\n" + tagged_lines(below);
    } else if (lines.front().starts_with(kCodes)) {
      lines.front().erase(0, kCodes.size());
      found.exit_status = ".SH EXIT STATUS\n" + prose(lines).substr(std::string(".PP\n").size());
    } else {
      found.description += prose(lines);
    }
  }
  return found;
}

ManualPage page(const CommandDescription& command, const std::string& above) {
  const Sections footer = sections(command.footer);
  std::string upper = page_name(command);
  std::ranges::transform(upper, upper.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string text = fmt::format(".TH {} 1 \"\" \"adit {}\" \"User Commands\"\n", upper, version());
  text += ".SH NAME\n" + roff(page_name(command)) + " \\- " + roff(command.text) + "\n";
  text += synopsis(command);
  text += ".SH DESCRIPTION\n" + roff(sentence(command.text)) + "\n" + footer.description;
  text += commands(command) + entries("ARGUMENTS", command.arguments) +
          entries("OPTIONS", command.options);
  text += footer.environment + footer.exit_status + footer.examples;
  if (!above.empty()) {
    text += ".SH SEE ALSO\n.BR " + roff(above) + " (1)\n";
  }
  return {.name = page_name(command), .text = text};
}

void add_pages(const CommandDescription& command, const std::string& above,
               std::vector<ManualPage>& pages) {
  pages.push_back(page(command, above));
  for (const CommandDescription& below : command.commands) {
    add_pages(below, page_name(command), pages);
  }
}

}  // namespace

std::vector<ManualPage> manual_pages(const CommandDescription& program) {
  std::vector<ManualPage> pages;
  add_pages(program, "", pages);
  return pages;
}

}  // namespace adit
