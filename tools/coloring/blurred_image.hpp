// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/tools/cameras/color_image.hpp"

namespace adit {

/// Each pixel the mean of those up to `radius` pixels away in both directions, as far as the image
/// goes.
ColorImage blurred(const ColorImage& image, int radius);

}  // namespace adit
