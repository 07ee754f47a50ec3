// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/device_cache.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/environment.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

engine::DeviceInfo some_device() {
  engine::DeviceInfo device;
  device.name = "some GPU";
  device.uuid = "01234567-89ab-cdef-0123-456789abcdef";
  device.driver = "some driver";
  device.driver_version = "1.2.3";
  device.api_version = "1.3.0";
  device.subgroup_size = 32;
  return device;
}

std::vector<std::byte> some_bytes(std::size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) {
    bytes[i] = static_cast<std::byte>(7 * i + 3);  // line ends among them
  }
  return bytes;
}

class DeviceCacheTest : public testing::Test {
 protected:
  fs::path folder() const { return temporary_.path() / "cache"; }
  test::TemporaryFolder temporary_;
};

TEST_F(DeviceCacheTest, HoldsWhatWasKeptForThisDeviceDriverAndBuildAlone) {
  const DeviceCache cache(folder());
  const engine::DeviceInfo device = some_device();
  EXPECT_FALSE(cache.find(device));
  for (const std::size_t size : {0UL, 1UL, 100'000UL}) {
    cache.keep(device, some_bytes(size));
    EXPECT_EQ(cache.find(device), some_bytes(size));
  }
  for (auto change : {+[](engine::DeviceInfo& d) { d.uuid.back() = '0'; },
                      +[](engine::DeviceInfo& d) { d.driver = "another"; },
                      +[](engine::DeviceInfo& d) { d.driver_version = "1.2.4"; },
                      +[](engine::DeviceInfo& d) { d.subgroup_size = 64; }}) {
    engine::DeviceInfo other = device;
    change(other);
    EXPECT_FALSE(cache.find(other));
  }
  cache.forget(device);
  EXPECT_FALSE(cache.find(device));
}

TEST_F(DeviceCacheTest, ADamagedOrForeignFileIsPassedOverAndReplaced) {
  const DeviceCache cache(folder());
  const engine::DeviceInfo device = some_device();
  cache.keep(device, some_bytes(1000));
  const fs::path file = *cache.file_of(device);
  const auto content_of = [](const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string whole = content_of(file);
  std::vector<std::string> damaged = {"",          "\n\n\n",
                                      "adit",      whole.substr(0, whole.size() / 2),
                                      whole + "x", std::string(5000, '\n')};
  for (std::size_t at = 0; at < whole.size(); at += 13) {
    damaged.push_back(whole);
    damaged.back()[at] ^= 1;
  }
  engine::DeviceInfo other = device;
  other.driver_version = "0.9";
  cache.keep(other, some_bytes(10));
  damaged.push_back(content_of(*cache.file_of(other)));  // a file that was renamed
  for (const std::string& content : damaged) {
    std::ofstream(file, std::ios::binary) << content;
    EXPECT_FALSE(cache.find(device));
  }
  cache.keep(device, some_bytes(1000));
  EXPECT_EQ(content_of(file), whole);
}

TEST_F(DeviceCacheTest, AFolderThatCannotBeWrittenHoldsNothing) {
  const fs::path in_the_way = temporary_.path() / "file";
  std::ofstream(in_the_way) << "no folder";
  for (const std::optional<fs::path>& none :
       {std::optional(in_the_way / "cache"), std::optional<fs::path>()}) {
    const DeviceCache cache(none);
    cache.keep(some_device(), some_bytes(10));
    EXPECT_FALSE(cache.find(some_device()));
    cache.forget(some_device());
  }
}

TEST_F(DeviceCacheTest, ProcessesThatKeepAtOnceLeaveAWholeFile) {
  const DeviceCache cache(folder());
  cache.keep(some_device(), some_bytes(200'000));
  std::vector<pid_t> children;
  for (int child = 0; child < 3; ++child) {
    children.push_back(fork());
    if (children.back() == 0) {
      bool whole = true;
      for (int i = 0; i < 50; ++i) {
        cache.keep(some_device(), some_bytes(200'000));
        whole = whole && cache.find(some_device()) == some_bytes(200'000);
      }
      _exit(whole ? 0 : 1);
    }
  }
  for (const pid_t child : children) {
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder()), fs::directory_iterator()), 1)
      << "no drafts are left";
}

TEST_F(DeviceCacheTest, LiesInTheUsersCacheOrInAPrivateFolder) {
  const fs::path xdg = temporary_.path() / "xdg";
  const fs::path temporary = temporary_.path() / "tmp";
  fs::create_directory(temporary);
  const fs::path own = temporary / ("adit-cache-" + std::to_string(getuid()));
  const test::Variable tmpdir("TMPDIR", temporary.string());
  const test::Variable cache_home("XDG_CACHE_HOME", xdg.string());
  const test::Variable home("HOME", temporary_.path().string());
  EXPECT_EQ(cache_folder(), xdg / "adit");
  cache_home.put(std::nullopt);
  EXPECT_EQ(cache_folder(), temporary_.path() / ".cache" / "adit");
  home.put("/proc/self");  // nothing can be made there
  EXPECT_EQ(cache_folder(), own);
  EXPECT_EQ(fs::status(own).permissions(), fs::perms::owner_all);
  fs::permissions(own, fs::perms::all);
  EXPECT_FALSE(cache_folder()) << "others may write there";
  fs::remove(own);
  fs::create_directory_symlink(xdg, own);
  EXPECT_FALSE(cache_folder()) << "somebody else chose where";
}

TEST_F(DeviceCacheTest, MesaGetsAFolderWhereItHasNone) {
  const test::Variable tmpdir("TMPDIR", temporary_.path().string());
  const test::Variable cache_home("XDG_CACHE_HOME", temporary_.path().string());
  const test::Variable folder("MESA_SHADER_CACHE_DIR", std::nullopt);
  const test::Variable older_folder("MESA_GLSL_CACHE_DIR", std::nullopt);
  const test::Variable disabled("MESA_SHADER_CACHE_DISABLE", std::nullopt);
  const test::Variable older_disabled("MESA_GLSL_CACHE_DISABLE", std::nullopt);
  give_mesa_a_cache();
  EXPECT_EQ(std::getenv("MESA_SHADER_CACHE_DIR"), nullptr) << "it has one";
  cache_home.put("/proc/self");
  disabled.put("true");
  give_mesa_a_cache();
  EXPECT_EQ(std::getenv("MESA_SHADER_CACHE_DIR"), nullptr) << "it shall have none";
  disabled.put(std::nullopt);
  give_mesa_a_cache();
  ASSERT_NE(std::getenv("MESA_SHADER_CACHE_DIR"), nullptr);
  const fs::path given = std::getenv("MESA_SHADER_CACHE_DIR");
  EXPECT_TRUE(fs::is_directory(given));
  EXPECT_EQ(given.parent_path().parent_path(), temporary_.path());
}

}  // namespace
}  // namespace adit
