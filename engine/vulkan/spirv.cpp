// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/spirv.hpp"

#include <algorithm>
#include <map>

#include <spirv/unified1/spirv.hpp11>

#include "adit/engine/vulkan/spirv_words.hpp"

namespace adit::engine::spirv {
namespace {

using spv::Decoration;
using spv::Op;
using spv::StorageClass;

struct Member {
  std::string name;
  std::optional<uint32_t> offset;
  uint32_t matrix_stride = 0;
  bool non_writable = false;
};

// What is known of one id. Decorations and names come before the types they belong to.
struct Id {
  Op op = Op::OpNop;  // OpNop: not defined
  std::string name;
  std::optional<uint32_t> spec_id, binding, set;
  uint32_t array_stride = 0;
  bool non_writable = false;
  bool texel_buffer = false;  // read through a uniform texel buffer of uint
  std::map<uint32_t, Member> members;
  uint32_t bytes = 0;           // size of a type; 0: not known before run time
  uint32_t columns = 0;         // number in a matrix
  uint32_t element = 0;         // id an array or a pointer refers to
  uint32_t value = 0;           // a constant's; for an integer type 1: signed
  std::vector<uint32_t> types;  // a struct's members
};

class Parser {
 public:
  Reflection parse(std::span<const uint32_t> words);

 private:
  Id& id(uint32_t index) {
    if (index >= ids_.size()) {
      fail("id " + std::to_string(index) + " is out of range");
    }
    return ids_[index];
  }
  void instruction(Op op, const Operands& in);
  void decorate(Decoration decoration, uint32_t value, Id& target);
  void decorate_member(Decoration decoration, uint32_t value, Member& member);
  void define_type(Op op, const Operands& in);
  void define_struct(Id& type);
  void variable(const Operands& in);
  void finish();

  std::vector<Id> ids_;
  std::vector<uint32_t> struct_ids_;
  std::array<uint32_t, 3> size_ids_{};  // constants of LocalSizeId
  uint32_t entry_points_ = 0;
  Reflection result_;
};

Reflection Parser::parse(std::span<const uint32_t> words) {
  if (words.size() < 5 || words[0] != spv::MagicNumber) {
    fail("it does not begin like one");
  }
  if (words[3] > kMaxBound) {
    fail("too many ids");
  }
  ids_.resize(words[3]);
  for (std::size_t at = 5; at < words.size();) {
    const std::size_t length = words[at] >> spv::WordCountShift;
    if (length == 0 || length > words.size() - at) {
      fail("it is cut short at word " + std::to_string(at));
    }
    instruction(Op(words[at] & spv::OpCodeMask), Operands(words.subspan(at + 1, length - 1)));
    at += length;
  }
  finish();
  return std::move(result_);
}

void Parser::instruction(Op op, const Operands& in) {
  switch (op) {
    case Op::OpName:
      id(in[0]).name = in.text(1);
      break;
    case Op::OpMemberName:
      id(in[0]).members[in[1]].name = in.text(2);
      break;
    case Op::OpDecorate:
      decorate(Decoration(in[1]), in.size() > 2 ? in[2] : 0, id(in[0]));
      break;
    case Op::OpMemberDecorate:
      decorate_member(Decoration(in[2]), in.size() > 3 ? in[3] : 0, id(in[0]).members[in[1]]);
      break;
    case Op::OpEntryPoint:
      entry_points_ += spv::ExecutionModel(in[0]) == spv::ExecutionModel::GLCompute ? 1U : 2U;
      break;
    case Op::OpExecutionMode:
      if (spv::ExecutionMode(in[1]) == spv::ExecutionMode::LocalSize) {
        result_.local_size = {in[2], in[3], in[4]};
      }
      break;
    case Op::OpExecutionModeId:
      if (spv::ExecutionMode(in[1]) == spv::ExecutionMode::LocalSizeId) {
        size_ids_ = {in[2], in[3], in[4]};
      }
      break;
    case Op::OpConstant:
    case Op::OpSpecConstant:
      id(in[1]).op = op;
      id(in[1]).value = in[2];
      break;
    case Op::OpSpecConstantTrue:
    case Op::OpSpecConstantFalse:
      id(in[1]).op = op;
      id(in[1]).value = op == Op::OpSpecConstantTrue ? 1 : 0;
      break;
    case Op::OpVariable:
      variable(in);
      break;
    default:
      define_type(op, in);
  }
}

void Parser::decorate(Decoration decoration, uint32_t value, Id& target) {
  switch (decoration) {
    case Decoration::SpecId:
      target.spec_id = value;
      break;
    case Decoration::Binding:
      target.binding = value;
      break;
    case Decoration::DescriptorSet:
      target.set = value;
      break;
    case Decoration::ArrayStride:
      target.array_stride = value;
      break;
    case Decoration::NonWritable:
      target.non_writable = true;
      break;
    default:
      break;
  }
}

void Parser::decorate_member(Decoration decoration, uint32_t value, Member& member) {
  if (decoration == Decoration::Offset) {
    member.offset = value;
  } else if (decoration == Decoration::MatrixStride) {
    member.matrix_stride = value;
  } else if (decoration == Decoration::NonWritable) {
    member.non_writable = true;
  }
}

// Types are defined before they are used, so each one's size is known when the next needs it.
void Parser::define_type(Op op, const Operands& in) {
  switch (op) {
    case Op::OpTypeInt:
      id(in[0]).bytes = in[1] / 8;
      id(in[0]).value = in[2];
      break;
    case Op::OpTypeFloat:
      id(in[0]).bytes = in[1] / 8;
      break;
    case Op::OpTypeVector:
      id(in[0]).bytes = id(in[1]).bytes * in[2];
      break;
    case Op::OpTypeMatrix:
      id(in[0]).columns = in[2];
      id(in[0]).bytes = id(in[1]).bytes * in[2];
      break;
    case Op::OpTypeArray:
      id(in[0]).element = in[1];
      id(in[0]).bytes = id(in[0]).array_stride * id(in[2]).value;
      break;
    case Op::OpTypeRuntimeArray:
    case Op::OpTypePointer:
      id(in[0]).element = in[op == Op::OpTypePointer ? 2 : 1];
      break;
    case Op::OpTypeImage: {
      const Id& of = id(in[1]);
      id(in[0]).texel_buffer = spv::Dim(in[2]) == spv::Dim::Buffer && in[6] == kSampled &&
                               of.op == Op::OpTypeInt && of.bytes == 4 && of.value == 0;
      break;
    }
    case Op::OpTypeSampledImage:
      id(in[0]).texel_buffer = id(in[1]).texel_buffer;
      break;
    case Op::OpTypeStruct:
      for (std::size_t i = 1; i < in.size(); ++i) {
        id(in[0]).types.push_back(in[i]);
      }
      define_struct(id(in[0]));
      if (std::ranges::all_of(id(in[0]).members,
                              [](const auto& m) { return m.second.offset.has_value(); })) {
        struct_ids_.push_back(in[0]);
      }
      break;
    default:
      return;
  }
  id(in[0]).op = op;
}

void Parser::define_struct(Id& type) {
  for (uint32_t i = 0; i < type.types.size(); ++i) {
    const Member& member = type.members[i];
    const Id& of = id(type.types[i]);
    const uint32_t bytes = of.columns > 0 ? of.columns * member.matrix_stride : of.bytes;
    type.bytes = std::max(type.bytes, member.offset.value_or(0) + bytes);
  }
}

void Parser::variable(const Operands& in) {
  const Id& variable = id(in[1]);
  const auto storage = StorageClass(in[2]);
  const Id& type = id(id(in[0]).element);
  const bool texels = storage == StorageClass::UniformConstant && type.texel_buffer;
  if (storage == StorageClass::PushConstant) {
    result_.push_bytes = type.bytes;
  } else if (storage == StorageClass::StorageBuffer || texels) {
    if (variable.set.value_or(0) != 0 || !variable.binding.has_value()) {
      fail("a buffer is outside descriptor set 0");
    }
    const bool read_only =
        variable.non_writable || texels ||
        (!type.types.empty() &&
         std::ranges::all_of(type.members, [](const auto& m) { return m.second.non_writable; }));
    result_.bindings.push_back({*variable.binding, read_only, texels});
  } else if (storage == StorageClass::Uniform || storage == StorageClass::UniformConstant) {
    fail("it uses descriptors other than storage buffers and uniform texel buffers of uint");
  }
}

void Parser::finish() {
  if (entry_points_ != 1) {
    fail("it is not one compute shader");
  }
  std::ranges::sort(result_.bindings, {}, &BindingInfo::binding);
  const auto texels = std::ranges::count(result_.bindings, true, &BindingInfo::texels);
  const auto storage = std::ssize(result_.bindings) - texels;
  if (storage > kMaxStorageBindings || texels > kMaxTexelBindings) {
    fail("it binds " + std::to_string(storage) + " storage and " + std::to_string(texels) +
         " texel buffers, at most " + std::to_string(kMaxStorageBindings) + " and " +
         std::to_string(kMaxTexelBindings) + " are sure to be had");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size_ids_[axis] != 0) {
      result_.local_size[axis] = id(size_ids_[axis]).value;
      result_.local_size_ids[axis] = id(size_ids_[axis]).spec_id;
    }
  }
  std::map<uint32_t, uint32_t> constants;
  for (const Id& constant : ids_) {
    if (constant.spec_id.has_value() && constant.op != Op::OpNop) {
      constants.emplace(*constant.spec_id, constant.value);
    }
  }
  for (const auto& [spec_id, value] : constants) {
    result_.spec_constants.push_back({spec_id, value});
  }
  for (const uint32_t index : struct_ids_) {
    const Id& type = id(index);
    StructLayout layout{type.name, {}, {}};
    for (uint32_t i = 0; i < type.types.size(); ++i) {
      const Member& member = type.members.at(i);
      const Id& of = id(type.types[i]);
      layout.members.push_back({member.name, member.offset.value_or(0),
                                of.columns > 0 ? of.columns * member.matrix_stride : of.bytes,
                                of.array_stride});
    }
    for (const Id& array : ids_) {
      if ((array.op == Op::OpTypeArray || array.op == Op::OpTypeRuntimeArray) &&
          array.element == index && array.array_stride != 0) {
        layout.array_strides.push_back(array.array_stride);
      }
    }
    result_.structs.push_back(std::move(layout));
  }
}

}  // namespace
}  // namespace adit::engine::spirv

namespace adit::engine {

uint32_t StructLayout::end() const {
  uint32_t end = 0;
  for (const StructMember& member : members) {
    end = std::max(end, member.offset + member.bytes);
  }
  return end;
}

Reflection reflect(std::span<const uint32_t> words) {
  return spirv::Parser().parse(words);
}

}  // namespace adit::engine
