// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/deskew.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/texels.hpp"

namespace adit::engine {

Deskew::Deskew(Context& context)
    : shape_(launch_shape(context.device())),
      texels_(reads_texels(context.device())),
      kernel_(context, "deskew", {{0, shape_.local_size}, {2, texels_ ? 1U : 0U}}) {}

void Deskew::record(Recorder& recorder, const DeskewSettings& settings,
                    const DeskewArguments& arguments) const {
  if (arguments.knot_count < 2 || !(settings.last_time > settings.first_time)) {
    throw std::logic_error("deskew: needs two knots or more, of different times");
  }
  if (arguments.point_count == 0) {
    return;
  }
  const Scope scope = recorder.scope("deskew");
  const double step = (settings.last_time - settings.first_time) / (arguments.knot_count - 1);
  const gpu::DeskewPush push{
      .point_count = arguments.point_count,
      .knots = arguments.knot_count,
      .first_time = static_cast<float>(settings.first_time),
      .per_second = static_cast<float>(1.0 / step),
      .min_squared = std::max(static_cast<float>(settings.c_min * settings.c_min),
                              std::numeric_limits<float>::min()),
      .max_squared = static_cast<float>(settings.c_max * settings.c_max)};
  recorder.dispatch(kernel_, std::min(shape_.groups, kernel_.groups_for(arguments.point_count)),
                    push,
                    {arguments.raw, arguments.times, arguments.knots, arguments.moved,
                     texel_slice(arguments.raw, texels_), texel_slice(arguments.knots, texels_)});
}

}  // namespace adit::engine
