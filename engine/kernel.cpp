// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernel.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "adit/engine/context.hpp"
#include "adit/engine/vulkan/kernel_state.hpp"
#include "adit/engine/vulkan/process.hpp"
#include "adit/shaders/embedded.hpp"

namespace adit::engine {
namespace {

[[noreturn]] void mistake(const std::string& kernel, const std::string& what) {
  throw std::logic_error("kernel '" + kernel + "': " + what);
}

// The constants to set: the caller's, and the work-group size (id 0) whatever the shader's default
// is.
std::vector<Specialization> complete(const Kernel::State& state,
                                     const std::vector<Specialization>& given) {
  const auto& known = state.reflection.spec_constants;
  for (auto each = given.begin(); each != given.end(); ++each) {
    if (!std::ranges::count(known, each->id, &SpecConstant::id)) {
      mistake(state.name, "the shader uses no specialization constant " + std::to_string(each->id));
    }
    if (std::any_of(given.begin(), each,
                    [&](const Specialization& s) { return s.id == each->id; })) {
      mistake(state.name,
              "specialization constant " + std::to_string(each->id) + " is given twice");
    }
  }
  std::vector<Specialization> all = given;
  if (state.reflection.local_size_ids[0] == 0U &&
      !std::ranges::count(given, 0U, &Specialization::id)) {
    all.push_back({0, kDefaultLocalSize});
  }
  return all;
}

uint32_t final_local_size(const Kernel::State& state, const std::vector<Specialization>& values) {
  const Reflection& reflection = state.reflection;
  if (reflection.local_size_ids[0] != 0U || reflection.local_size_ids[1] ||
      reflection.local_size_ids[2] || reflection.local_size[1] != 1 ||
      reflection.local_size[2] != 1) {
    mistake(state.name, "its work-group size is not (constant 0, 1, 1)");
  }
  const uint32_t size = std::ranges::find(values, 0U, &Specialization::id)->value;
  const uint32_t limit = state.device->info.max_workgroup_invocations;
  if (size == 0 || size > limit) {
    mistake(state.name, "a work-group size of " + std::to_string(size) + " is outside 1.." +
                            std::to_string(limit) + ", what " + state.device->info.name +
                            " can run");
  }
  return size;
}

void check_bindings(const Kernel::State& state) {
  const auto& bindings = state.reflection.bindings;
  for (uint32_t i = 0; i < bindings.size(); ++i) {
    if (bindings[i].binding != i) {
      mistake(state.name, "buffer " + std::to_string(i) +
                              " is missing or never used: bindings are 0, 1, ... "
                              "without gaps");
    }
  }
}

void create_layouts(Kernel::State& state) {
  const vk::raii::Device& device = state.device->device;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (const BindingInfo& binding : state.reflection.bindings) {
    bindings.emplace_back(binding.binding,
                          binding.texels ? vk::DescriptorType::eUniformTexelBuffer
                                         : vk::DescriptorType::eStorageBuffer,
                          1, vk::ShaderStageFlagBits::eCompute);
  }
  state.set_layout =
      vk::raii::DescriptorSetLayout(device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0,
                                   state.reflection.push_bytes);
  vk::PipelineLayoutCreateInfo info({}, *state.set_layout);
  if (push.size > 0) {
    info.setPushConstantRanges(push);
  }
  state.layout = vk::raii::PipelineLayout(device, info);
}

void create_pipeline(Kernel::State& state, std::span<const uint32_t> words,
                     const std::vector<Specialization>& values) {
  const vk::raii::Device& device = state.device->device;
  const vk::raii::ShaderModule module(
      device, vk::ShaderModuleCreateInfo({}, words.size() * sizeof(uint32_t), words.data()));
  std::vector<vk::SpecializationMapEntry> entries;
  for (uint32_t i = 0; i < values.size(); ++i) {
    const auto offset =
        static_cast<uint32_t>(i * sizeof(Specialization) + offsetof(Specialization, value));
    entries.emplace_back(values[i].id, offset, sizeof(uint32_t));
  }
  const vk::SpecializationInfo specialization(static_cast<uint32_t>(entries.size()), entries.data(),
                                              values.size() * sizeof(Specialization),
                                              values.data());
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module,
                                                "main", &specialization);
  state.pipeline = vk::raii::Pipeline(
      device, state.device->pipeline_cache,
      vk::ComputePipelineCreateInfo(state.device->pipeline_flags(), stage, *state.layout));
  if (state.device->compile_only) {
    state.device->note_statistics(*state.pipeline, {state.name, values, {}});
  }
  state.device->set_name(state.pipeline, state.name);
}

Shader embedded(const Device& device, std::string_view name) {
  const std::span<const uint32_t> wide = shaders::find_wide(name);
  const std::span<const uint32_t> words = device.wide && !wide.empty() ? wide : shaders::find(name);
  if (words.empty()) {
    throw std::logic_error("there is no shader '" + std::string(name) + "' in this program");
  }
  return {.name = name, .spirv = words};
}

}  // namespace

Kernel::Kernel(Context& context, std::string_view shader_name,
               const std::vector<Specialization>& specializations)
    : Kernel(context, embedded(context.internal(), shader_name), specializations) {}

Kernel::Kernel(Context& context, const Shader& shader,
               const std::vector<Specialization>& specializations)
    : state_(std::make_unique<State>()) {
  state_->device = &context.internal();
  require_device_process();
  state_->name = shader.name;
  state_->reflection = reflect(shader.spirv);
  check_bindings(*state_);
  const std::vector<Specialization> values = complete(*state_, specializations);
  state_->local_size = final_local_size(*state_, values);
  translated("making kernel '" + state_->name + "'", [&] {
    create_layouts(*state_);
    create_pipeline(*state_, shader.spirv, values);
  });
}

Kernel::Kernel(Kernel&&) noexcept = default;
Kernel& Kernel::operator=(Kernel&&) noexcept = default;
Kernel::~Kernel() {
  leave_to_parent(state_);
}

std::string_view Kernel::name() const {
  return state_->name;
}
uint32_t Kernel::local_size() const {
  return state_->local_size;
}
const Reflection& Kernel::reflection() const {
  return state_->reflection;
}

uint32_t Kernel::groups_for(uint64_t items) const {
  const uint64_t groups = items / state_->local_size + (items % state_->local_size != 0 ? 1 : 0);
  // Too many stay too many, so that the dispatch refuses them.
  return static_cast<uint32_t>(std::min<uint64_t>(groups, std::numeric_limits<uint32_t>::max()));
}

}  // namespace adit::engine
