// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <spirv/unified1/spirv.hpp11>

#include "adit/engine/error.hpp"
#include "adit/engine/vulkan/spirv.hpp"
#include "adit/shaders/embedded.hpp"

namespace adit::engine {
namespace {

using spv::Op;

std::vector<uint32_t> probe() {
  const std::span<const uint32_t> words = shaders::find("engine_probe");
  return {words.begin(), words.end()};
}

TEST(Spirv, ProbeShaderIsReflectedAsItIsWritten) {
  const Reflection reflection = reflect(probe());
  ASSERT_EQ(reflection.bindings.size(), 2U);
  EXPECT_EQ(reflection.bindings[0].binding, 0U);
  EXPECT_TRUE(reflection.bindings[0].read_only);
  EXPECT_EQ(reflection.bindings[1].binding, 1U);
  EXPECT_FALSE(reflection.bindings[1].read_only);
  EXPECT_EQ(reflection.push_bytes, 8U);
  EXPECT_EQ(reflection.local_size_ids[0], 0U);
  EXPECT_FALSE(reflection.local_size_ids[1].has_value());
  EXPECT_EQ(reflection.local_size[1], 1U);
  EXPECT_EQ(reflection.local_size[2], 1U);
  ASSERT_EQ(reflection.spec_constants.size(), 2U);
  EXPECT_EQ(reflection.spec_constants[0].id, 0U);
  EXPECT_EQ(reflection.spec_constants[1].id, 1U);
  EXPECT_EQ(reflection.spec_constants[1].default_value, 1U);
}

TEST(Spirv, TexelBuffersAreToldFromStorageBuffers) {
  for (const auto words :
       {shaders::find("engine_texel_probe"), shaders::find_debug("engine_texel_probe")}) {
    const Reflection reflection = reflect(words);
    ASSERT_EQ(reflection.bindings.size(), 4U);
    for (uint32_t i = 0; i < 4; ++i) {
      EXPECT_EQ(reflection.bindings[i].binding, i);
      EXPECT_EQ(reflection.bindings[i].texels, i == 1 || i == 2) << i;
      EXPECT_EQ(reflection.bindings[i].read_only, i < 3) << i;
    }
  }
}

// A module that declares `count` variables of one opaque type, bindings 0, 1, ... of set 0. Modules
// before SPIR-V 1.6 make a usamplerBuffer a sampled image, which today's compiler does not.
struct Image {
  spv::Dim dim = spv::Dim::Buffer;
  uint32_t sampled = 1;     // 2: a storage image
  uint32_t signedness = 0;  // signedness of its int
  uint32_t width = 32;      // width of its int, bits
  bool combined = false;    // OpTypeSampledImage
  uint32_t count = 1;
};

std::vector<uint32_t> module_of(const Image& image) {
  enum Id : uint32_t { entry = 1, number, texels, combined, pointer, first_variable = 10 };
  std::vector<uint32_t> words{spv::MagicNumber, 0x00010500, 0, 100, 0};
  const auto add = [&](Op op, std::initializer_list<uint32_t> operands) {
    words.push_back(static_cast<uint32_t>(operands.size() + 1) << spv::WordCountShift |
                    static_cast<uint32_t>(op));
    words.insert(words.end(), operands);
  };
  const auto uniform = static_cast<uint32_t>(spv::StorageClass::UniformConstant);
  add(Op::OpEntryPoint, {static_cast<uint32_t>(spv::ExecutionModel::GLCompute), entry, 0});
  for (uint32_t i = 0; i < image.count; ++i) {
    const uint32_t variable = first_variable + i;
    add(Op::OpDecorate, {variable, static_cast<uint32_t>(spv::Decoration::DescriptorSet), 0});
    add(Op::OpDecorate, {variable, static_cast<uint32_t>(spv::Decoration::Binding), i});
  }
  add(Op::OpTypeInt, {number, image.width, image.signedness});
  add(Op::OpTypeImage,
      {texels, number, static_cast<uint32_t>(image.dim), 0, 0, 0, image.sampled, 0});
  add(Op::OpTypeSampledImage, {combined, texels});
  add(Op::OpTypePointer, {pointer, uniform, image.combined ? combined : texels});
  for (uint32_t i = 0; i < image.count; ++i) {
    add(Op::OpVariable, {pointer, first_variable + i, uniform});
  }
  return words;
}

TEST(Spirv, SamplerBufferOfOlderModulesIsATexelBuffer) {
  for (const bool combined : {false, true}) {
    const Reflection reflection = reflect(module_of({.combined = combined}));
    ASSERT_EQ(reflection.bindings.size(), 1U);
    EXPECT_TRUE(reflection.bindings[0].texels);
    EXPECT_TRUE(reflection.bindings[0].read_only);
  }
}

TEST(Spirv, OnlyTexelBuffersOfUintAreUniformDescriptorsThatCanBeBound) {
  for (const Image& image :
       {Image{.dim = spv::Dim::Dim2D}, Image{.sampled = 2}, Image{.signedness = 1},
        Image{.width = 64}, Image{.dim = spv::Dim::Dim2D, .combined = true}}) {
    try {
      reflect(module_of(image));
      FAIL() << "dim " << static_cast<uint32_t>(image.dim) << ", sampled " << image.sampled
             << " was taken";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("texel buffers of uint"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Spirv, MoreTexelBuffersThanEveryDeviceBindsAreRefused) {
  EXPECT_EQ(reflect(module_of({.count = kMaxTexelBindings})).bindings.size(), kMaxTexelBindings);
  EXPECT_THROW(reflect(module_of({.count = kMaxTexelBindings + 1})), Error);
}

TEST(Spirv, DebugBuildKeepsNamesThatOptimisationDrops) {
  const auto names_push = [](const StructLayout& layout) { return layout.name == "ProbePush"; };
  const Reflection debug = reflect(shaders::find_debug("engine_probe"));
  EXPECT_TRUE(std::ranges::any_of(debug.structs, names_push));
  EXPECT_FALSE(std::ranges::any_of(reflect(probe()).structs, names_push));
  EXPECT_EQ(debug.push_bytes, 8U);
}

TEST(Spirv, EveryEmbeddedShaderIsReflectedTheSameInBothBuilds) {
  ASSERT_FALSE(shaders::names().empty());
  EXPECT_EQ(shaders::names(), shaders::names_debug());
  for (const std::string_view name : shaders::names()) {
    SCOPED_TRACE(name);
    const Reflection optimised = reflect(shaders::find(name));
    const Reflection debug = reflect(shaders::find_debug(name));
    ASSERT_EQ(optimised.bindings.size(), debug.bindings.size())
        << "a buffer is declared and never used";
    for (std::size_t i = 0; i < debug.bindings.size(); ++i) {
      EXPECT_EQ(optimised.bindings[i].binding, i);
      EXPECT_EQ(debug.bindings[i].binding, i);
      EXPECT_EQ(optimised.bindings[i].read_only, debug.bindings[i].read_only);
      EXPECT_EQ(optimised.bindings[i].texels, debug.bindings[i].texels);
    }
    EXPECT_EQ(optimised.push_bytes, debug.push_bytes);
    EXPECT_LE(optimised.push_bytes, 128U);
    EXPECT_EQ(optimised.local_size_ids[0], 0U)
        << "constant 0 is the work-group size in every shader";
  }
}

TEST(Spirv, WideBuildsBindTheSameAsTheOthers) {
  std::size_t wide_builds = 0;
  for (const std::string_view name : shaders::names()) {
    SCOPED_TRACE(name);
    if (shaders::find_wide(name).empty()) {
      continue;
    }
    wide_builds += 1;
    const Reflection wide = reflect(shaders::find_wide(name));
    const Reflection narrow = reflect(shaders::find(name));
    ASSERT_EQ(wide.bindings.size(), narrow.bindings.size());
    for (std::size_t i = 0; i < wide.bindings.size(); ++i) {
      EXPECT_EQ(wide.bindings[i].read_only, narrow.bindings[i].read_only);
      EXPECT_EQ(wide.bindings[i].texels, narrow.bindings[i].texels);
    }
    EXPECT_EQ(wide.push_bytes, narrow.push_bytes);
    EXPECT_EQ(wide.spec_constants.size(), narrow.spec_constants.size());
  }
  EXPECT_GE(wide_builds, 5U);
}

TEST(Spirv, UnknownShaderIsEmpty) {
  EXPECT_TRUE(shaders::find_wide("no_such_shader").empty());
  EXPECT_TRUE(shaders::find("no_such_shader").empty());
  EXPECT_TRUE(shaders::find_debug("no_such_shader").empty());
}

TEST(Spirv, ModuleCutAnywhereIsAnErrorOrStillWhole) {
  const std::vector<uint32_t> words = probe();
  std::size_t errors = 0;
  for (std::size_t length = 0; length < words.size(); ++length) {
    try {
      reflect(
          std::span(words).first(length));  // cut between instructions: what is there can be read
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, words.size() / 2);
}

TEST(Spirv, CorruptWordsNeverDoMoreThanThrow) {
  const std::span<const uint32_t> debug = shaders::find_debug("engine_probe");
  std::mt19937 engine(7);
  const auto random = [&] { return static_cast<uint32_t>(engine()); };
  std::size_t errors = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<uint32_t> words(debug.begin(), debug.end());
    for (int change = 0; change < 3; ++change) {
      uint32_t& word = words[random() % words.size()];
      word = random() % 2 == 0 ? random() % 400 : word ^ (1U << (random() % 32));
    }
    words[3] = std::min(words[3], 100'000U);  // keeps the time of a run down, not its outcome
    try {
      reflect(words);
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 0U);
}

TEST(Spirv, FileThatIsNoSpirvIsAnError) {
  const std::vector<uint32_t> words(100, 0x12345678U);
  EXPECT_THROW(reflect(words), Error);
  EXPECT_THROW(reflect({}), Error);
}

}  // namespace
}  // namespace adit::engine
