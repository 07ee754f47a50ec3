// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/unpacked_file.hpp"

#include <stdlib.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <system_error>

#include "adit/tools/containers/seekable_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/temporary_folder.hpp"

namespace adit {
namespace fs = std::filesystem;

UnpackedFile::~UnpackedFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

std::unique_ptr<UnpackedFile> make_temporary_file() {
  const fs::path folder = temporary_place();
  std::string pattern = (folder / "adit_XXXXXX").string();
  const int descriptor = ::mkstemp(pattern.data());
  if (descriptor < 0) {
    throw OutputError(folder, folder.string() + ": no temporary file can be made there: " +
                                  std::strerror(errno) + ". Set TMPDIR to another folder.");
  }
  ::close(descriptor);
  return std::make_unique<UnpackedFile>(pattern);
}

std::unique_ptr<UnpackedFile> unpack_file(const fs::path& packed) {
  const SeekableFile file(packed);
  std::unique_ptr<UnpackedFile> unpacked = make_temporary_file();
  OutputFile output(unpacked->path());
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  if (!context) {
    throw std::bad_alloc();
  }
  std::vector<std::byte> in(ZSTD_DStreamInSize());
  std::vector<std::byte> out(ZSTD_DStreamOutSize());
  std::size_t expected = 1;
  for (uint64_t at = 0; at < file.size();) {
    const std::size_t size = std::min<uint64_t>(in.size(), file.size() - at);
    file.read(at, std::span(in).first(size));
    ZSTD_inBuffer source{in.data(), size, 0};
    bool filled = true;  // the output may hold more
    while (source.pos < size || filled) {
      ZSTD_outBuffer target{out.data(), out.size(), 0};
      expected = ZSTD_decompressStream(context.get(), &target, &source);
      if (ZSTD_isError(expected) != 0U) {
        throw InputError(packed, Place::byte(at + source.pos),
                         std::string("Zstandard finds it damaged: ") + ZSTD_getErrorName(expected),
                         "The file is damaged: copy it again");
      }
      output.write(out.data(), target.pos);
      filled = target.pos == out.size();
    }
    at += size;
  }
  if (expected != 0) {
    throw InputError(packed, Place::byte(file.size()), "its compressed data end early",
                     "The file is cut off: copy it again");
  }
  output.close();
  return unpacked;
}

}  // namespace adit
