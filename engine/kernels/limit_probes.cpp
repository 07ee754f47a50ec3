// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/limit_probes.hpp"

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/texels.hpp"

namespace adit::engine {

LimitProbes::LimitProbes(Context& context)
    : shape_(launch_shape(context.device())),
      texels_(reads_texels(context.device())),
      copy_(context, "limit_copy", {{0, shape_.local_size}, {2, texels_ ? 1U : 0U}}),
      multiply_add_(context, "limit_multiply_add", {{0, shape_.local_size}}),
      gather_(context, "limit_gather", {{0, shape_.local_size}, {2, texels_ ? 1U : 0U}}),
      atomic_(context, "limit_atomic", {{0, shape_.local_size}}) {}

void LimitProbes::record_copy(Recorder& recorder, Slice from, Slice to) const {
  recorder.dispatch(copy_, shape_.groups,
                    gpu::LimitCopyPush{static_cast<uint32_t>(from.bytes / sizeof(gpu::uvec4))},
                    {from, to, texel_slice(from, texels_)});
}

void LimitProbes::record_multiply_add(Recorder& recorder, const gpu::LimitMultiplyAddPush& push,
                                      Slice results) const {
  recorder.dispatch(multiply_add_, shape_.groups, push, {results});
}

void LimitProbes::record_gather(Recorder& recorder, uint32_t count, Slice table,
                                Slice results) const {
  const auto records =
      static_cast<uint32_t>(table.bytes / (gpu::kRecordQuads * sizeof(gpu::uvec4)));
  recorder.dispatch(gather_, shape_.groups, gpu::LimitGatherPush{count, records - 1},
                    {table, results, texel_slice(table, texels_)});
}

void LimitProbes::record_atomics(Recorder& recorder, uint32_t count, Slice table) const {
  const auto words = static_cast<uint32_t>(table.bytes / sizeof(uint32_t));
  recorder.dispatch(atomic_, shape_.groups, gpu::LimitScatterPush{count, words - 1}, {table});
}

}  // namespace adit::engine
