// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <link.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/environment.hpp"

namespace adit::engine {
namespace {

template <class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

ContextOptions named(std::string device) {
  ContextOptions options;
  options.device = std::move(device);
  return options;
}

TEST(Context, EveryDeviceOfTheTestMeetsTheBaseline) {
  const std::vector<DeviceInfo> devices = list_devices();
  ASSERT_FALSE(devices.empty());
  for (const DeviceInfo& device : devices) {
    EXPECT_TRUE(device.unified_memory || !device.software) << device.name;
    EXPECT_GE(device.requirements.size(), 20U);
    for (const Requirement& requirement : device.requirements) {
      EXPECT_TRUE(requirement.met) << device.name << ": " << requirement.name << " needs "
                                   << requirement.needed << ", has " << requirement.has;
    }
  }
}

TEST(Context, DeviceIsOpenedByIndexNameAndUuid) {
  const DeviceInfo first = list_devices().front();
  for (const std::string& name :
       {std::to_string(first.index), first.uuid, first.name, first.name.substr(0, 5)}) {
    const Context context(named(name));
    EXPECT_EQ(context.device().uuid, first.uuid);
    EXPECT_FALSE(context.software_fallback());
  }
}

// NVIDIA's driver can be loaded some ten times in a process, and then no more.
TEST(Context, DriversStayLoaded) {
  const auto loaded = [] {
    std::set<std::string> names;
    dl_iterate_phdr(
        [](dl_phdr_info* library, std::size_t /*bytes*/, void* found) {
          static_cast<std::set<std::string>*>(found)->emplace(library->dlpi_name);
          return 0;
        },
        &names);
    return names;
  };
  std::set<std::string> during;
  {
    const Context context(named(""));
    during = loaded();
  }
  EXPECT_EQ(loaded(), during);
}

TEST(Context, OnlySoftwareAndNothingAskedForIsAFallback) {
  const Context context(named(""));
  EXPECT_EQ(context.software_fallback(),
            std::ranges::all_of(list_devices(), &DeviceInfo::software));
}

TEST(Context, DeviceThatDoesNotExistIsAnErrorThatListsWhatThereIs) {
  const std::string text = message([] { Context context(named("Voodoo 2")); });
  EXPECT_NE(text.find("Voodoo 2"), std::string::npos) << text;
  EXPECT_NE(text.find(list_devices().front().name), std::string::npos) << text;
}

TEST(Context, MachineWithoutADriverIsToldWhatToInstall) {
  const test::Variable no_driver("VK_DRIVER_FILES", "/nonexistent/driver.json");
  const test::Variable older_name("VK_ICD_FILENAMES", "/nonexistent/driver.json");
  const std::string text = message([] { Context context(named("")); });
  EXPECT_NE(text.find("no Vulkan driver"), std::string::npos) << text;
  EXPECT_NE(text.find("mesa-vulkan-drivers"), std::string::npos) << text;
  EXPECT_EQ(message([] { list_devices(); }), text);
}

TEST(Context, MissingValidationLayerNamesItsPackage) {
  const test::Variable no_layers("VK_LAYER_PATH", "/nonexistent");
  ContextOptions options;
  options.validation = true;
  const std::string text = message([&] { Context context(options); });
  EXPECT_NE(text.find("vulkan-validationlayers"), std::string::npos) << text;
}

TEST(Context, TakesThePipelineCacheOfAnEarlierOneAndNothingElse) {
  std::vector<std::byte> kept;
  {
    Context context(test::test_options());
    const Kernel kernel(context, "engine_probe");
    kept = context.pipeline_cache();  // empty where the driver keeps nothing in it
  }
  std::vector<std::byte> foreign = kept;
  for (std::size_t i = 8; i < std::min<std::size_t>(16, foreign.size()); ++i) {
    foreign[i] ^= std::byte{0xff};  // vendor and device
  }
  const std::vector<std::byte> noise(5000, std::byte{0x5a});
  Context context(test::test_options());
  for (const std::vector<std::byte>& bytes : {std::vector<std::byte>(), noise, foreign, kept}) {
    context.add_to_pipeline_cache(bytes);
    context.add_to_pipeline_cache(std::span(bytes).first(std::min<std::size_t>(20, bytes.size())));
  }
  const Kernel kernel(context, "engine_probe");
  EXPECT_EQ(kernel.name(), "engine_probe");
  EXPECT_TRUE(context.validation_messages().empty());
}

TEST(Context, CanBeMovedWhileItsBuffersLive) {
  std::optional<Context> last;  // outlives the buffer
  Context first(named(""));
  const Buffer buffer = first.make_buffer(1000, Memory::upload, "kept");
  last.emplace(std::move(first));
  EXPECT_EQ(last->memory_in_use(), 1024U);
  EXPECT_EQ(buffer.size(), 1000U);
}

}  // namespace
}  // namespace adit::engine
