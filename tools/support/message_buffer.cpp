// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/message_buffer.hpp"

#include <ostream>

namespace adit {

MessageBuffer::~MessageBuffer() {
  give_rest();
}

void MessageBuffer::give_rest() {
  if (painter_) {
    const std::string rest = painter_->rest();
    target_.sputn(rest.data(), static_cast<std::streamsize>(rest.size()));
    target_.pubsync();
  }
  if (const std::string line = log_lines_.rest(); settings_.log != nullptr && !line.empty()) {
    settings_.log->write(line);
  }
}

void MessageBuffer::use(const MessageSettings& settings) {
  const std::lock_guard guard(mutex_);
  give_rest();
  settings_ = settings;
  painter_.reset();
  if (settings.colors != nullptr) {
    painter_.emplace(settings.colors);
  }
}

void MessageBuffer::write_log(std::string_view line) {
  const std::lock_guard guard(mutex_);
  if (settings_.log != nullptr) {
    settings_.log->write(line);
  }
}

bool MessageBuffer::put(std::string_view text) {
  const std::lock_guard guard(mutex_);
  if (settings_.log != nullptr) {
    for (const std::string& line : log_lines_.take(text)) {
      settings_.log->write(line);
    }
  }
  const std::string shown = painter_ ? painter_->take(text) : std::string(text);
  const auto size = static_cast<std::streamsize>(shown.size());
  return target_.sputn(shown.data(), size) == size;
}

MessageBuffer::int_type MessageBuffer::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) {
    return traits_type::not_eof(c);
  }
  const char letter = traits_type::to_char_type(c);
  return put({&letter, 1}) ? c : traits_type::eof();
}

std::streamsize MessageBuffer::xsputn(const char* text, std::streamsize size) {
  return put({text, static_cast<std::size_t>(size)}) ? size : 0;
}

int MessageBuffer::sync() {
  const std::lock_guard guard(mutex_);
  return target_.pubsync();
}

void log_line(std::ostream& stream, std::string_view line) {
  if (auto* buffer = dynamic_cast<MessageBuffer*>(stream.rdbuf())) {
    buffer->write_log(line);
  }
}

void say_detail(std::ostream& stream, const std::string& line) {
  auto* buffer = dynamic_cast<MessageBuffer*>(stream.rdbuf());
  if (buffer == nullptr) {
    return;
  }
  if (buffer->settings().details) {
    stream << "note: " + line + "\n" << std::flush;
  } else {
    buffer->write_log("note: " + line);
  }
}

bool shows_details(const std::ostream& stream) {
  const auto* buffer = dynamic_cast<const MessageBuffer*>(stream.rdbuf());
  return buffer != nullptr && buffer->settings().details;
}

}  // namespace adit
