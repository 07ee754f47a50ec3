// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/input_error.hpp"

#include <utility>

namespace adit {
namespace {

std::string message(const std::filesystem::path& file, const std::string& place,
                    const std::string& found, const std::string& remedy) {
  std::string text = file.string();
  if (!place.empty()) {
    text += ", " + place;
  }
  text += ": " + found + ".";
  if (!remedy.empty()) {
    text += " " + remedy + ".";
  }
  return text;
}

}  // namespace

Place Place::line(uint64_t number) {
  return named("line " + std::to_string(number));
}
Place Place::byte(uint64_t offset) {
  return named("byte " + std::to_string(offset));
}
Place Place::point(uint64_t index) {
  return named("point " + std::to_string(index));
}

Place Place::named(std::string_view name) {
  Place place;
  place.text_ = name;
  return place;
}

InputError::InputError(const std::filesystem::path& file, const Place& place, std::string found,
                       std::string remedy)
    : FileError(file, message(file, place.text(), found, remedy)),
      place_(place.text()),
      found_(std::move(found)),
      remedy_(std::move(remedy)) {}

}  // namespace adit
