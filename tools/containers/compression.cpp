// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/compression.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

namespace adit {
namespace {

/// One call of a library: how far it came, and whether that is the end.
struct Step {
  std::size_t consumed = 0;
  std::size_t produced = 0;
  bool finished = false;
  std::string error;
};

/// Calls step(in, out) until the stream ends, growing the buffer as it fills.
template <class Advance>
Unpacked run(std::vector<std::byte>& buffer, std::span<const std::byte> packed, uint64_t size,
             Advance&& advance) {
  std::size_t in = 0;
  std::size_t out = 0;
  while (true) {
    if (out == buffer.size() && out < size) {
      const std::size_t first = std::max<std::size_t>(std::size_t{64} << 10U, 4 * packed.size());
      buffer.resize(static_cast<std::size_t>(
          std::min<uint64_t>(size, std::max<uint64_t>(first, 2 * buffer.size()))));
    }
    const std::size_t room = std::min<std::size_t>(buffer.size(), size) - out;
    const Step step = advance(packed.subspan(in), std::span(buffer).subspan(out, room));
    in += step.consumed;
    out += step.produced;
    const std::span<const std::byte> done = std::span(buffer).first(out);
    if (!step.error.empty()) {
      return {done, false, step.error};
    }
    if (step.finished) {
      if (out < size) {
        return {done, false,
                "it unpacks to " + std::to_string(out) + " bytes, not to the " +
                    std::to_string(size) + " that it declares"};
      }
      return {done, false, {}};
    }
    if (step.consumed == 0 && step.produced == 0) {
      if (out == size && room == 0) {
        return {done, false,
                "it unpacks to more than the " + std::to_string(size) + " bytes that it declares"};
      }
      return {done, true,
              "its compressed data end after " + std::to_string(out) + " of " +
                  std::to_string(size) + " unpacked bytes"};
    }
  }
}

Unpacked unpack_lz4(std::vector<std::byte>& buffer, std::span<const std::byte> packed,
                    uint64_t size) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  return run(buffer, packed, size, [&](auto in, auto out) {
    std::size_t consumed = in.size();
    std::size_t produced = out.size();
    const std::size_t code =
        LZ4F_decompress(context.get(), out.data(), &produced, in.data(), &consumed, nullptr);
    if (LZ4F_isError(code) != 0U) {
      return Step{0, 0, false, std::string("LZ4 finds it damaged: ") + LZ4F_getErrorName(code)};
    }
    return Step{consumed, produced, code == 0, {}};
  });
}

Unpacked unpack_zstd(std::vector<std::byte>& buffer, std::span<const std::byte> packed,
                     uint64_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  if (!context) {
    throw std::bad_alloc();
  }
  return run(buffer, packed, size, [&](auto in, auto out) {
    ZSTD_inBuffer source{in.data(), in.size(), 0};
    ZSTD_outBuffer target{out.data(), out.size(), 0};
    const std::size_t code = ZSTD_decompressStream(context.get(), &target, &source);
    if (ZSTD_isError(code) != 0U) {
      return Step{0, 0, false,
                  std::string("Zstandard finds it damaged: ") + ZSTD_getErrorName(code)};
    }
    return Step{source.pos, target.pos, code == 0, {}};
  });
}

unsigned int bounded(std::size_t size) {
  return static_cast<unsigned int>(
      std::min<std::size_t>(size, std::numeric_limits<unsigned int>::max()));
}

Unpacked unpack_bz2(std::vector<std::byte>& buffer, std::span<const std::byte> packed,
                    uint64_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream,
                                                                         &BZ2_bzDecompressEnd);
  return run(buffer, packed, size, [&](auto in, auto out) {
    stream.next_in = reinterpret_cast<char*>(const_cast<std::byte*>(in.data()));  // only read
    stream.avail_in = bounded(in.size());
    stream.next_out = reinterpret_cast<char*>(out.data());
    stream.avail_out = bounded(out.size());
    const unsigned int before_in = stream.avail_in;
    const unsigned int before_out = stream.avail_out;
    const int code = BZ2_bzDecompress(&stream);
    if (code != BZ_OK && code != BZ_STREAM_END) {
      return Step{0, 0, false, "bzip2 finds it damaged (code " + std::to_string(code) + ")"};
    }
    return Step{
        before_in - stream.avail_in, before_out - stream.avail_out, code == BZ_STREAM_END, {}};
  });
}

}  // namespace

std::string_view to_string(Compression compression) {
  constexpr std::array<std::string_view, 4> kNames = {"none", "lz4", "zstd", "bz2"};
  return kNames[static_cast<std::size_t>(compression)];
}

std::optional<Compression> compression_named(std::string_view name) {
  for (const Compression one :
       {Compression::none, Compression::lz4, Compression::zstd, Compression::bz2}) {
    if (name == to_string(one)) {
      return one;
    }
  }
  return name.empty() ? std::optional(Compression::none) : std::nullopt;
}

Unpacked Decompressor::unpack(Compression compression, std::span<const std::byte> packed,
                              uint64_t size) {
  switch (compression) {
    case Compression::none:
      if (packed.size() != size) {
        return {packed, packed.size() < size,
                "it holds " + std::to_string(packed.size()) + " bytes, not the " +
                    std::to_string(size) + " that it declares"};
      }
      return {packed, false, {}};
    case Compression::lz4:
      return unpack_lz4(buffer_, packed, size);
    case Compression::zstd:
      return unpack_zstd(buffer_, packed, size);
    case Compression::bz2:
      return unpack_bz2(buffer_, packed, size);
  }
  return {};
}

std::optional<uint64_t> zstd_content_size(std::span<const std::byte> frame) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  const bool known = size != ZSTD_CONTENTSIZE_UNKNOWN && size != ZSTD_CONTENTSIZE_ERROR;
  return known ? std::optional<uint64_t>(size) : std::nullopt;
}

std::vector<std::byte> compress(Compression compression, std::span<const std::byte> bytes) {
  std::vector<std::byte> packed;
  switch (compression) {
    case Compression::none:
      packed.assign(bytes.begin(), bytes.end());
      break;
    case Compression::lz4: {
      packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
      const std::size_t size =
          LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
      if (LZ4F_isError(size) != 0U) {
        throw std::runtime_error(std::string("LZ4 cannot compress: ") + LZ4F_getErrorName(size));
      }
      packed.resize(size);
      break;
    }
    case Compression::zstd: {
      packed.resize(ZSTD_compressBound(bytes.size()));
      const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(),
                                             bytes.size(), ZSTD_CLEVEL_DEFAULT);
      if (ZSTD_isError(size) != 0U) {
        throw std::runtime_error(std::string("Zstandard cannot compress: ") +
                                 ZSTD_getErrorName(size));
      }
      packed.resize(size);
      break;
    }
    case Compression::bz2: {
      packed.resize(bytes.size() + bytes.size() / 100 + 600);
      unsigned int size = bounded(packed.size());
      char* source = reinterpret_cast<char*>(const_cast<std::byte*>(bytes.data()));  // only read
      const int code = BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size,
                                                source, bounded(bytes.size()), 9, 0, 0);
      if (code != BZ_OK) {
        throw std::runtime_error("bzip2 cannot compress (code " + std::to_string(code) + ")");
      }
      packed.resize(size);
      break;
    }
  }
  return packed;
}

}  // namespace adit
