// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/places.hpp"

#include "adit/engine/context.hpp"

namespace adit::engine {

PlaceKernels::PlaceKernels(Context& context)
    : shape_(launch_shape(context.device())),
      describe_(context, "place_describe", {{0, shape_.local_size}}),
      match_(context, "place_match", {{0, shape_.local_size}}),
      correlate_(context, "place_correlate", {{0, shape_.local_size}}) {}

void PlaceKernels::record_describe(Recorder& recorder, const PlaceCloud& cloud, Slice record,
                                   Slice block, uint32_t place) const {
  const Scope scope = recorder.scope("describe place");
  recorder.dispatch(describe_, 1,
                    gpu::DescribePush{.inverse_cell = static_cast<float>(1.0 / cloud.cell),
                                      .point_count = cloud.count,
                                      .place = place},
                    {cloud.points, record, block});
}

void PlaceKernels::record_match(Recorder& recorder, Slice record, Slice block, uint32_t count,
                                Slice matches) const {
  const Scope scope = recorder.scope("match places");
  recorder.dispatch(match_, match_.groups_for(count), gpu::MatchPush{.place_count = count},
                    {record, block, matches});
}

void PlaceKernels::record_correlate(Recorder& recorder, const PlanArguments& arguments) const {
  const Scope scope = recorder.scope("correlate plans");
  recorder.dispatch(
      correlate_, arguments.job_count,
      gpu::CorrelatePush{.cell_count = arguments.cell_count, .first_job = arguments.first_job},
      {arguments.cells, arguments.jobs, arguments.block, arguments.matches});
}

}  // namespace adit::engine
