// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Mixed pixels: a beam on an edge lights two surfaces, and a range between them is measured.
#pragma once

#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Which returns of a sweep (points that are returns, in their order) are mixed pixels, by their
/// neighbours in the ring. On a plane the inverse of the range is linear over small angles: the
/// four returns on either side say where their surface is at the return. It is mixed where both
/// sides are smooth, it lies between the two surfaces, more than three standard deviations away
/// from either, and these are no farther apart than a pulse is long (0.9 m for 6 ns, VLP-16 manual
/// 63-9243). The noise of ranges is that of the sweep. None of a sweep without rings.
std::vector<bool> mixed_pixels(const Sweep& sweep);

}  // namespace adit
