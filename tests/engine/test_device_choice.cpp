// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/engine/error.hpp"
#include "adit/engine/vulkan/device_choice.hpp"

namespace adit::engine {
namespace {

DeviceInfo device(uint32_t index, std::string name, bool software, bool meets) {
  DeviceInfo info;
  info.index = index;
  info.name = std::move(name);
  info.driver = software ? "llvmpipe" : "vendor driver";
  info.uuid = "0000000" + std::to_string(index) + "-1111-2222-3333-abcdefabcdef";
  info.software = software;
  info.requirements = {{"maxPushConstantsSize", ">= 128", meets ? "128" : "64", meets}};
  return info;
}

std::string message(const std::vector<DeviceInfo>& devices, std::string_view wanted) {
  try {
    choose_device(devices, wanted);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::vector<DeviceInfo> laptop() {
  return {device(0, "llvmpipe (LLVM 15.0.6, 256 bits)", true, true),
          device(1, "Radeon RX 7600", false, true), device(2, "Old Graphics 520", false, false)};
}

TEST(DeviceChoice, HardwareIsTakenBeforeSoftware) {
  EXPECT_EQ(choose_device(laptop(), "").position, 1U);
  EXPECT_FALSE(choose_device(laptop(), "").software_fallback);
}

TEST(DeviceChoice, SoftwareThatNobodyAskedForIsMarked) {
  const std::vector<DeviceInfo> devices{laptop()[0]};
  EXPECT_TRUE(choose_device(devices, "").software_fallback);
  EXPECT_FALSE(choose_device(devices, "llvmpipe").software_fallback);
}

TEST(DeviceChoice, HardwareBelowTheBaselineIsNotReplacedBySoftwareInSilence) {
  const std::vector<DeviceInfo> devices{laptop()[0], laptop()[2]};
  const std::string text = message(devices, "");
  EXPECT_NE(text.find("Old Graphics 520"), std::string::npos) << text;
  EXPECT_NE(text.find("maxPushConstantsSize: needs >= 128, has 64"), std::string::npos) << text;
  EXPECT_NE(text.find("llvmpipe"), std::string::npos) << "what to ask for instead: " << text;
}

TEST(DeviceChoice, IndexUuidAndNameNameADevice) {
  EXPECT_EQ(choose_device(laptop(), "0").position, 0U);
  EXPECT_EQ(choose_device(laptop(), "00000001-1111-2222-3333-ABCDEFABCDEF").position, 1U);
  EXPECT_EQ(choose_device(laptop(), "00000001111122223333abcdefabcdef").position, 1U);
  EXPECT_EQ(choose_device(laptop(), "radeon").position, 1U);
}

TEST(DeviceChoice, LavapipeIsKnownByTheNameOfItsProject) {
  EXPECT_EQ(choose_device(laptop(), "lavapipe").position, 0U);
}

TEST(DeviceChoice, NumberThatIsNoIndexIsPartOfAName) {
  EXPECT_EQ(choose_device(laptop(), "7600").position, 1U);
}

TEST(DeviceChoice, UnknownDeviceListsWhatThereIs) {
  const std::string text = message(laptop(), "GeForce");
  EXPECT_NE(text.find("'GeForce'"), std::string::npos) << text;
  for (const DeviceInfo& each : laptop()) {
    EXPECT_NE(text.find(each.name), std::string::npos) << text;
    EXPECT_NE(text.find(each.uuid), std::string::npos) << text;
  }
  EXPECT_NE(message(laptop(), "3").find("no Vulkan device"), std::string::npos);
}

TEST(DeviceChoice, NameThatDoesNotChooseIsToldFromADeviceThatCannotRun) {
  EXPECT_THROW(choose_device(laptop(), "GeForce"), NoSuchDevice);
  EXPECT_THROW(choose_device(laptop(), "e"), NoSuchDevice) << "part of several names";
  try {
    choose_device(laptop(), "2");
    FAIL() << "a device below the baseline was chosen";
  } catch (const NoSuchDevice& error) {
    FAIL() << "the device exists: " << error.what();
  } catch (const Error&) {
  }
}

TEST(DeviceChoice, NameOfSeveralDevicesIsAnError) {
  const std::vector<DeviceInfo> twins{device(0, "A100", false, true),
                                      device(1, "A100", false, true)};
  EXPECT_NE(message(twins, "A100").find("several"), std::string::npos);
  EXPECT_EQ(choose_device(twins, "1").position, 1U);
}

TEST(DeviceChoice, DeviceAskedForThatLacksSomethingIsRefusedWithTheReason) {
  EXPECT_NE(message(laptop(), "2").find("maxPushConstantsSize"), std::string::npos);
}

TEST(DeviceChoice, EmptyMachineIsAnError) {
  EXPECT_THROW(choose_device({}, ""), Error);
}

}  // namespace
}  // namespace adit::engine
