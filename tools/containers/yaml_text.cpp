// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/yaml_text.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestScalar = 65536;  // bytes, over several lines
constexpr int kDeepest = 32;                   // mappings and sequences in each other

class NotUnderstood : public std::runtime_error {
 public:
  NotUnderstood() : std::runtime_error("YAML") {}
};

struct Line {
  std::size_t indent = 0;
  std::string_view text;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

bool is_item(std::string_view text) {
  return text == "-" || text.starts_with("- ");
}

/// A value without the name of its type, as OpenCV writes "!!opencv-matrix".
std::string_view without_tag(std::string_view value) {
  return value.starts_with('!') ? trimmed(value.substr(std::min(value.find(' '), value.size())))
                                : value;
}

/// Where the quoted text at the begin ends, behind its quote; npos where it does not.
std::size_t end_of_quoted(std::string_view text) {
  const char quote = text.front();
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 >= text.size() || text[i + 1] != quote) {
        return i + 1;
      }
      ++i;  // two single quotes stand for one
    }
  }
  return std::string_view::npos;
}

/// Where the list in brackets that begins the text ends, behind its bracket; npos where it does
/// not.
std::size_t end_of_list(std::string_view text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const char before = i == 0 ? '[' : text[i - 1];
    const bool opens = before == '[' || before == ',' || before == ' ' || before == '\t';
    if ((c == '"' || c == '\'') && opens) {
      const std::size_t size = end_of_quoted(text.substr(i));
      if (size == std::string_view::npos) {
        return size;
      }
      i += size - 1;
    } else if (c == '[') {
      ++depth;
    } else if (c == ']' && --depth == 0) {
      return i + 1;
    }
  }
  return std::string_view::npos;
}

/// What the quoted text, with its quotes, stands for.
std::string unquoted(std::string_view text) {
  const char quote = text.front();
  std::string out;
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\' && i + 2 < text.size()) {
      ++i;
      out += text[i] == 'n' ? '\n' : text[i] == 't' ? '\t' : text[i];
    } else {
      out += text[i];
      i += quote == '\'' && text[i] == quote ? 1U : 0U;
    }
  }
  return out;
}

class Parser {
 public:
  explicit Parser(std::string_view text) {
    LineReader lines(text);
    while (const auto line = lines.next()) {
      const std::size_t indent = line->find_first_not_of(' ');
      const std::string_view content = trimmed(*line);
      const bool directive = indent == 0 && content.starts_with('%') && lines_.empty();
      if (!content.empty() && content.front() != '#' && content != "---" && content != "..." &&
          !directive) {
        lines_.push_back({indent, content});
      }
    }
  }

  YamlNode document() {
    YamlNode node = lines_.empty() ? YamlNode{} : block(lines_.front().indent, 0);
    if (at_ < lines_.size()) {
      throw NotUnderstood();
    }
    return node;
  }

 private:
  bool more(std::size_t indent) const {
    return at_ < lines_.size() && lines_[at_].indent == indent;
  }

  YamlNode block(std::size_t indent, int depth) {
    if (depth > kDeepest) {
      throw NotUnderstood();
    }
    return is_item(lines_[at_].text) ? sequence(indent, depth) : mapping(indent, depth);
  }

  YamlNode sequence(std::size_t indent, int depth) {
    YamlNode node;
    while (more(indent) && is_item(lines_[at_].text)) {
      const std::string_view rest = trimmed(lines_[at_].text.substr(1));
      if (rest.empty()) {
        ++at_;
        node.items.push_back(child(indent, false, depth));
        continue;
      }
      Line& line = lines_[at_];
      line.indent += static_cast<std::size_t>(rest.data() - line.text.data());
      line.text = rest;
      const bool nested = is_item(rest) || key_of(rest).has_value();
      node.items.push_back(nested ? block(line.indent, depth + 1) : scalar(indent));
    }
    return node;
  }

  YamlNode mapping(std::size_t indent, int depth) {
    YamlNode node;
    while (more(indent) && !is_item(lines_[at_].text)) {
      const std::optional<std::size_t> colon = key_of(lines_[at_].text);
      if (!colon) {
        throw NotUnderstood();
      }
      Line& line = lines_[at_];
      const std::string_view key = trimmed(line.text.substr(0, *colon));
      const bool quoted = key.size() > 1 && (key.front() == '"' || key.front() == '\'');
      std::string name = quoted ? unquoted(key) : std::string(key);
      line.text = without_tag(trimmed(line.text.substr(*colon + 1)));
      if (line.text.empty()) {
        ++at_;
        node.fields.emplace_back(std::move(name), child(indent, true, depth));
      } else {
        node.fields.emplace_back(std::move(name), scalar(indent));
      }
    }
    return node;
  }

  /// What is further in; of a key also the items that are as far in as it is.
  YamlNode child(std::size_t indent, bool of_key, int depth) {
    if (at_ < lines_.size() &&
        (lines_[at_].indent > indent || (of_key && more(indent) && is_item(lines_[at_].text)))) {
      const std::string_view text = lines_[at_].text;
      return is_item(text) || key_of(text) ? block(lines_[at_].indent, depth + 1) : scalar(indent);
    }
    return {};
  }

  /// Where the colon behind a key is.
  static std::optional<std::size_t> key_of(std::string_view text) {
    std::size_t at = 0;
    if (text.front() == '"' || text.front() == '\'') {
      at = end_of_quoted(text);
      if (at == std::string_view::npos) {
        return std::nullopt;
      }
    }
    for (; at < text.size(); ++at) {
      if (text[at] == ':' && (at + 1 == text.size() || text[at + 1] == ' ')) {
        return at;
      }
    }
    return std::nullopt;
  }

  /// A scalar or a sequence in brackets, over as many lines as it has.
  YamlNode scalar(std::size_t indent) {
    std::string text(lines_[at_++].text);
    const char first = text.front();
    const auto add_line = [&] {
      if (at_ >= lines_.size() || text.size() > kLongestScalar) {
        throw NotUnderstood();
      }
      text += ' ';
      text += lines_[at_++].text;
    };
    if (first == '"' || first == '\'') {
      while (end_of_quoted(text) == std::string_view::npos) {
        add_line();
      }
      return {.scalar = unquoted(std::string_view(text).substr(0, end_of_quoted(text)))};
    }
    if (first == '[') {
      while (end_of_list(text) == std::string_view::npos) {
        add_line();
      }
      return list(std::string_view(text).substr(1, end_of_list(text) - 2), 0);
    }
    if (first == '|' || first == '>') {
      text.clear();
    } else if (const std::size_t comment = text.find(" #"); comment != std::string::npos) {
      text.resize(comment);
    }
    while (at_ < lines_.size() && lines_[at_].indent > indent) {
      add_line();
    }
    return {.scalar = std::string(trimmed(text))};
  }

  static YamlNode list(std::string_view inner, int depth) {
    if (depth > kDeepest) {
      throw NotUnderstood();
    }
    YamlNode node;
    for (inner = trimmed(inner); !inner.empty(); inner = trimmed(inner)) {
      const char first = inner.front();
      const bool quoted = first == '"' || first == '\'';
      const std::size_t size = quoted         ? end_of_quoted(inner)
                               : first == '[' ? end_of_list(inner)
                                              : std::min(inner.find(','), inner.size());
      if (size == std::string_view::npos) {
        throw NotUnderstood();
      }
      const std::string_view item = trimmed(inner.substr(0, size));
      node.items.push_back(first == '['
                               ? list(item.substr(1, item.size() - 2), depth + 1)
                               : YamlNode{.scalar = quoted ? unquoted(item) : std::string(item)});
      inner = trimmed(inner.substr(size));
      if (!inner.empty() && inner.front() != ',') {
        throw NotUnderstood();
      }
      inner.remove_prefix(inner.empty() ? 0 : 1);
    }
    return node;
  }

  std::vector<Line> lines_;
  std::size_t at_ = 0;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  const auto found = std::ranges::find(fields, key, &std::pair<std::string, YamlNode>::first);
  return found == fields.end() ? nullptr : &found->second;
}

std::optional<YamlNode> parse_yaml(std::string_view text) {
  try {
    return Parser(text).document();
  } catch (const NotUnderstood&) {
    return std::nullopt;
  }
}

}  // namespace adit
