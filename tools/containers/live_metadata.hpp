// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What adit notes of a channel that it recorded as its messages arrived.
#pragma once

namespace adit {

/// "arrival": the messages are in the order of their arrival, whatever their stamps say.
inline constexpr const char* kOrderKey = "adit.order";
inline constexpr const char* kArrivalOrder = "arrival";
/// ImuConfig::wait of the run that mapped them as they arrived, s.
inline constexpr const char* kWaitKey = "adit.wait";

}  // namespace adit
