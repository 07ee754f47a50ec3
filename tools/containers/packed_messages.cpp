// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/packed_messages.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "adit/tools/containers/seekable_file.hpp"
#include "adit/tools/containers/unpacked_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::array<unsigned char, 4> kZstdMagic = {0x28, 0xb5, 0x2f, 0xfd};
constexpr uint64_t kLargestMessage = uint64_t{1} << 30U;

bool is_zstd(std::span<const std::byte> bytes) {
  return bytes.size() >= kZstdMagic.size() &&
         std::memcmp(bytes.data(), kZstdMagic.data(), kZstdMagic.size()) == 0;
}

/// The same, but of the packed file.
InputError renamed(const InputError& error, const fs::path& packed) {
  return {
      packed,
      Place::named(error.place() + (error.place().empty() ? "" : " of ") + "what it unpacks to"),
      error.found(), error.remedy()};
}

class PackedStream final : public MessageStream {
 public:
  PackedStream(std::unique_ptr<MessageStream> messages, const fs::path& packed)
      : messages_(std::move(messages)), packed_(&packed) {}

  std::optional<RawMessage> next() override {
    try {
      return messages_->next();
    } catch (const InputError& error) {
      throw renamed(error, *packed_);
    }
  }

 private:
  std::unique_ptr<MessageStream> messages_;
  const fs::path* packed_;
};

class PackedFile final : public MessageFile {
 public:
  PackedFile(fs::path packed, std::unique_ptr<UnpackedFile> unpacked,
             std::unique_ptr<MessageFile> file)
      : packed_(std::move(packed)), unpacked_(std::move(unpacked)), file_(std::move(file)) {
    if (file_->damage()) {
      damage_ = renamed(*file_->damage(), packed_);
    }
  }

  const fs::path& path() const override { return packed_; }
  const std::vector<Channel>& channels() const override { return file_->channels(); }
  std::optional<TimeSpan> span() const override { return file_->span(); }
  std::string format() const override { return file_->format() + ", packed with zstd"; }
  std::string ros_distro() const override { return file_->ros_distro(); }
  const std::optional<InputError>& damage() const override { return damage_; }
  std::vector<DeclarationError> contradictions() const override {
    std::vector<DeclarationError> renamed;
    for (const DeclarationError& one : file_->contradictions()) {
      renamed.emplace_back(packed_, one.found(), one.remedy(), one.topic(), one.missing());
    }
    return renamed;
  }
  MessageLayout layout() const override { return file_->layout(); }
  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    return std::make_unique<PackedStream>(file_->messages(selection), packed_);
  }

 private:
  fs::path packed_;
  std::unique_ptr<UnpackedFile> unpacked_;
  std::unique_ptr<MessageFile> file_;
  std::optional<InputError> damage_;
};

}  // namespace

bool is_zstd_file(const fs::path& file) {
  const SeekableFile opened(file);
  return is_zstd(opened.read(0, std::min<uint64_t>(opened.size(), kZstdMagic.size())));
}

std::unique_ptr<MessageFile> open_packed_file(
    const fs::path& packed,
    const std::function<std::unique_ptr<MessageFile>(const fs::path&)>& open) {
  std::unique_ptr<UnpackedFile> unpacked = unpack_file(packed);
  try {
    std::unique_ptr<MessageFile> file = open(unpacked->path());
    return file ? std::make_unique<PackedFile>(packed, std::move(unpacked), std::move(file))
                : nullptr;
  } catch (const InputError& error) {
    throw renamed(error, packed);
  }
}

std::span<const std::byte> MessageUnpacker::unpack(std::span<const std::byte> bytes,
                                                   const fs::path& file, const std::string& place) {
  if (!is_zstd(bytes)) {
    return bytes;
  }
  const std::optional<uint64_t> size = zstd_content_size(bytes);
  const Unpacked message =
      decompressor_.unpack(Compression::zstd, bytes, std::min(size.value_or(0), kLargestMessage));
  if (!size || !message.problem.empty()) {
    throw InputError(file, Place::named(place),
                     "its packed message cannot be unpacked" +
                         (message.problem.empty() ? "" : ": " + message.problem),
                     "The file is damaged: copy it again, or go without this message");
  }
  return message.bytes;
}

}  // namespace adit
