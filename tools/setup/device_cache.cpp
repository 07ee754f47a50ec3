// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/device_cache.hpp"

#define XXH_INLINE_ALL
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <xxhash.h>

#include "adit/engine/self_test/self_test.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string hash_of(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

// All that decides whether what was found out still holds.
std::string key_of(const engine::DeviceInfo& device) {
  return fmt::format("{} | {} | {} {} | Vulkan {} | {} lanes | adit {} | kernels {}", device.uuid,
                     device.name, device.driver, device.driver_version, device.api_version,
                     device.subgroup_size, version(), engine::kernels_identity());
}

std::string head_of(const std::string& key, std::span<const std::byte> pipelines) {
  return fmt::format("adit device cache 1\n{}\n{} bytes, {}\n", key, pipelines.size(),
                     hash_of(pipelines));
}

std::optional<fs::path> environment_path(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr || *value == '\0' ? std::nullopt : std::optional<fs::path>(value);
}

std::optional<fs::path> users_cache() {
  if (const auto xdg = environment_path("XDG_CACHE_HOME")) {
    return xdg;
  }
  if (const auto home = environment_path("HOME")) {
    return *home / ".cache";
  }
  const passwd* user = getpwuid(getuid());
  return user == nullptr ? std::nullopt : std::optional(fs::path(user->pw_dir) / ".cache");
}

// Makes it where it is missing.
bool can_write(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  return fs::is_directory(folder, error) && access(folder.c_str(), W_OK | X_OK) == 0;
}

// Others may write into the system's temporary folder: only one that is ours, and closed to them,
// is used.
std::optional<fs::path> private_folder() {
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (error) {
    return std::nullopt;
  }
  const fs::path folder = temporary / fmt::format("adit-cache-{}", getuid());
  struct stat status {};
  if (mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST) {
    return std::nullopt;
  }
  const bool ours = lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
                    status.st_uid == getuid() && (status.st_mode & (S_IRWXG | S_IRWXO)) == 0;
  return ours && can_write(folder) ? std::optional(folder) : std::nullopt;
}

}  // namespace

std::optional<fs::path> DeviceCache::file_of(const engine::DeviceInfo& device) const {
  if (!folder_) {
    return std::nullopt;
  }
  const std::string key = key_of(device);
  return *folder_ / (hash_of(std::as_bytes(std::span(key))) + ".device");
}

std::optional<std::vector<std::byte>> DeviceCache::find(const engine::DeviceInfo& device) const {
  const std::optional<fs::path> file = file_of(device);
  if (!file) {
    return std::nullopt;
  }
  std::ifstream stream(*file, std::ios::binary);
  const std::string content((std::istreambuf_iterator<char>(stream)), {});
  std::size_t end = 0;  // of the head's three lines
  for (int line = 0; line < 3 && end != std::string::npos; ++line) {
    end = content.find('\n', end);
    end = end == std::string::npos ? end : end + 1;
  }
  if (!stream || end == std::string::npos) {
    return std::nullopt;
  }
  const auto bytes = std::as_bytes(std::span(content)).subspan(end);
  if (head_of(key_of(device), bytes) != content.substr(0, end)) {
    return std::nullopt;
  }
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

void DeviceCache::keep(const engine::DeviceInfo& device,
                       std::span<const std::byte> pipelines) const {
  const std::optional<fs::path> file = file_of(device);
  if (!file) {
    return;
  }
  std::error_code error;
  fs::create_directories(*folder_, error);
  // Each process writes a file of its own, and the last to be done has the name.
  const fs::path draft = file->string() + fmt::format(".{}", getpid());
  {
    std::ofstream stream(draft, std::ios::binary);
    stream << head_of(key_of(device), pipelines);
    stream.write(reinterpret_cast<const char*>(pipelines.data()),
                 static_cast<std::streamsize>(pipelines.size()));
    stream.close();
    if (!stream) {
      fs::remove(draft, error);
      return;
    }
  }
  fs::rename(draft, *file, error);
  if (error) {
    fs::remove(draft, error);
  }
}

void DeviceCache::forget(const engine::DeviceInfo& device) const {
  if (const std::optional<fs::path> file = file_of(device)) {
    std::error_code error;
    fs::remove(*file, error);
  }
}

std::optional<fs::path> cache_folder() {
  if (const auto users = users_cache(); users && can_write(*users / "adit")) {
    return *users / "adit";
  }
  return private_folder();
}

void give_mesa_a_cache() {
  for (const char* chosen : {"MESA_SHADER_CACHE_DIR", "MESA_GLSL_CACHE_DIR",
                             "MESA_SHADER_CACHE_DISABLE", "MESA_GLSL_CACHE_DISABLE"}) {
    if (std::getenv(chosen) != nullptr) {
      return;
    }
  }
  if (const auto users = users_cache(); users && can_write(*users / "mesa_shader_cache")) {
    return;
  }
  if (const auto folder = private_folder(); folder && can_write(*folder / "mesa")) {
    setenv("MESA_SHADER_CACHE_DIR", (*folder / "mesa").c_str(), 0);
  }
}

}  // namespace adit
