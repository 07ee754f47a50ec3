// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The same recording without its damage: where a stream would throw InputError, `damage` is called
/// and the stream goes on behind. `recording` must outlive it.
std::unique_ptr<Recording> pass_over_damage(const Recording& recording,
                                            std::function<void(const InputError&)> damage);

}  // namespace adit
