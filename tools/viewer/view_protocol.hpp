// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a page may ask, as JSON: {"tiles": [3, 17]}, {"place": [1.5, 2, 0]}, {"revoke": 5} or
// {"restore": 5}.
#pragma once

#include <string_view>

#include "adit/tools/viewer/view_data.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {

/// The answer to a page's message. A change of the map goes to all pages; one that cannot be is
/// told to the page that asked, in words. Throws nothing that a message could cause.
ViewAnswer answer_to(ViewData& data, std::string_view message);

/// The answer while a run goes on, which nobody edits.
ViewAnswer answer_while_running(std::string_view message);

/// Text for people in the page.
std::string told(const std::string& text, bool problem);

}  // namespace adit
