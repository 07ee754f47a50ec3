// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/loop_verifier.hpp"

#include <optional>

#include "adit/tools/setup/config_file.hpp"

namespace adit {

VerifyLoop loop_verifier(const DeviceOptions& device) {
  return [device](const MapDatabase& map, const LoopByHand& loop) {
    const std::optional<MapKeyframe> keyframe = map.keyframe(loop.from);
    const std::optional<MapSession> session =
        keyframe ? map.session(keyframe->session) : std::nullopt;
    const Config config = session ? parse_config(session->configuration, map.file()) : Config{};
    DeviceSession opened(device);
    engine::Context& context = opened.context();
    auto verified = verify_by_hand(context, config, map, loop, usual_rms(context, config, map));
    opened.require_no_complaints();
    return verified;
  };
}

}  // namespace adit
