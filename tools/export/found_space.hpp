// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <memory>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// Looks for what has moved, and says what it has found.
std::shared_ptr<const MovedSpace> find_moving(const ExportJob& job, std::ostream& out);

/// Looks for what is gone since earlier sessions, and says what it has found.
std::shared_ptr<const GoneSpace> find_gone(const ExportJob& job, std::ostream& out);

}  // namespace adit
