// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// A page for whoever takes delivery of a map: where it lies and in which coordinates, what it was
/// made of and by what, how much it covers, its loops, a picture with north up, and what is to be
/// watched. Printable. Returns what was written, for people.
std::string export_report(const ExportJob& job);

}  // namespace adit
