// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_access.hpp"

#include <algorithm>
#include <random>

#include <fmt/core.h>

namespace adit {
namespace {

bool is_numeric_v4(std::string_view name) {
  return !name.empty() && std::ranges::count(name, '.') == 3 &&
         std::ranges::all_of(name, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

/// "[::1]" or "::1".
bool is_numeric_v6(std::string_view name) {
  return std::ranges::count(name, ':') > 1;
}

/// A Host without its port.
std::string_view name_of(std::string_view host) {
  if (host.starts_with('[')) {
    return host.substr(0, host.find(']') + 1);
  }
  return host.substr(0, host.find(':'));
}

bool is_ours(const ViewAccess& access, std::string_view host) {
  const std::string_view name = name_of(host);
  if (name == "localhost" || name == access.address) {
    return true;
  }
  if (is_loopback(access.address)) {
    return is_loopback(name);
  }
  return is_numeric_v4(name) || is_numeric_v6(name);
}

bool is_same_origin(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme) && origin.substr(scheme.size()) == host) {
      return true;
    }
  }
  return false;
}

std::string_view token_of(std::string_view target) {
  const std::size_t query = target.find('?');
  std::string_view rest = query == target.npos ? std::string_view() : target.substr(query + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    constexpr std::string_view kName = "token=";
    if (rest.substr(0, end).starts_with(kName)) {
      return rest.substr(kName.size(), end - kName.size());
    }
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

/// In a time that does not tell how many characters are right.
bool is_equal(std::string_view given, std::string_view expected) {
  unsigned difference = given.size() == expected.size() ? 0U : 1U;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const char c = i < given.size() ? given[i] : '\0';
    difference |= static_cast<unsigned>(c) ^ static_cast<unsigned>(expected[i]);
  }
  return difference == 0U;
}

}  // namespace

std::string_view to_string(ViewRefusal refusal) {
  switch (refusal) {
    case ViewRefusal::malformed:
      return "malformed";
    case ViewRefusal::too_large:
      return "too large";
    case ViewRefusal::too_slow:
      return "too slow";
    case ViewRefusal::too_many:
      return "too many";
    case ViewRefusal::foreign_host:
      return "foreign host name";
    case ViewRefusal::foreign_origin:
      return "foreign origin";
    case ViewRefusal::wrong_token:
      return "wrong token";
    case ViewRefusal::unknown_path:
      return "unknown path";
    case ViewRefusal::not_offered:
      return "not offered";
  }
  return "unknown";
}

bool is_loopback(std::string_view address) {
  return address == "::1" || address == "[::1]" ||
         (is_numeric_v4(address) && address.starts_with("127."));
}

std::optional<ViewRefusal> refusal_of(const ViewAccess& access, const ViewRequest& request) {
  if (!is_ours(access, request.host)) {
    return ViewRefusal::foreign_host;
  }
  const bool is_foreign = !request.origin.empty() && !is_same_origin(request.origin, request.host);
  const std::string& token = request.is_foxglove ? access.foxglove_token : access.token;
  if (is_foreign && !(request.is_foxglove && !token.empty())) {
    return ViewRefusal::foreign_origin;
  }
  if (!token.empty() && !is_equal(token_of(request.target), token)) {
    return ViewRefusal::wrong_token;
  }
  return std::nullopt;
}

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string make_token() {
  std::random_device random;  // the system's, not a generator with a seed
  std::string token;
  for (int i = 0; i < 4; ++i) {
    token += fmt::format("{:08x}", random());
  }
  return token;
}

}  // namespace adit
