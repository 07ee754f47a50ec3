// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// rosbag2 packs with Zstandard whichever storage it writes to: whole files, or each message.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// True where the file begins as a Zstandard frame does.
bool is_zstd_file(const std::filesystem::path& file);

/// Opens what a packed file holds, with `open`, from a temporary copy that is gone when the
/// recording is closed. What is wrong with it names `packed`. Null where `open` gives null.
std::unique_ptr<MessageFile> open_packed_file(
    const std::filesystem::path& packed,
    const std::function<std::unique_ptr<MessageFile>(const std::filesystem::path&)>& open);

/// Unpacks messages that were packed one by one.
class MessageUnpacker {
 public:
  /// The bytes of a message in CDR, which never begins as a Zstandard frame does: unpacked where
  /// they are packed. Valid until the next call. Throws InputError, naming `file` and `place`.
  std::span<const std::byte> unpack(std::span<const std::byte> bytes,
                                    const std::filesystem::path& file, const std::string& place);

 private:
  Decompressor decompressor_;
};

}  // namespace adit
