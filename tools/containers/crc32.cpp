// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/crc32.hpp"

#include <zlib.h>

#include <array>
#include <cstddef>
#include <iterator>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace adit {
namespace {

uint32_t zlib_crc32(std::span<const std::byte> bytes, uint32_t before) {
  return static_cast<uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

#if defined(__x86_64__)

constexpr std::size_t kLane = 16;          // bytes of a register
constexpr std::size_t kBlock = 4 * kLane;  // bytes of a round

/// x^power modulo the check sum's polynomial, as a factor of _mm_clmulepi64_si128: bits reflected,
/// one place higher than a product of reflected numbers comes out.
constexpr int64_t factor(int power) {
  constexpr uint32_t kPolynomial = 0xEDB88320U;  // reflected
  uint32_t remainder = 0x80000000U;              // x^0
  for (int i = 0; i < power; ++i) {
    remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kPolynomial : 0U);
  }
  return static_cast<int64_t>(uint64_t{remainder} << 1U);
}

/// A register's 128 bits moved `bits` ahead in the message, modulo the polynomial, where `next` is.
template <int bits>
__attribute__((target("pclmul"))) __m128i fold(__m128i value, __m128i next) {
  constexpr int64_t kHigh = factor(bits - 32);
  constexpr int64_t kLow = factor(bits + 32);
  const __m128i factors = _mm_set_epi64x(kHigh, kLow);
  const __m128i low = _mm_clmulepi64_si128(value, factors, 0x00);
  const __m128i high = _mm_clmulepi64_si128(value, factors, 0x11);
  return _mm_xor_si128(_mm_xor_si128(low, high), next);
}

/// The check sum by carry-less products (V. Gopal et al., Fast CRC Computation for Generic
/// Polynomials Using PCLMULQDQ Instruction, 2009) of whole blocks, one at least: they are folded
/// into 16 bytes with the same remainder.
__attribute__((target("pclmul"))) uint32_t folded_crc32(std::span<const std::byte> blocks,
                                                        uint32_t before) {
  const auto load = [&](std::size_t at) __attribute__((target("pclmul"))) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(blocks.data() + at));
  };
  __m128i lanes[] = {load(0), load(kLane), load(2 * kLane), load(3 * kLane)};
  lanes[0] = _mm_xor_si128(lanes[0], _mm_cvtsi32_si128(static_cast<int>(~before)));
  for (std::size_t at = kBlock; at < blocks.size(); at += kBlock) {
    for (std::size_t i = 0; i < std::size(lanes); ++i) {
      lanes[i] = fold<8 * kBlock>(lanes[i], load(at + i * kLane));
    }
  }
  for (std::size_t i = 1; i < std::size(lanes); ++i) {
    lanes[i] = fold<8 * kLane>(lanes[i - 1], lanes[i]);
  }
  std::array<std::byte, kLane> rest;
  _mm_storeu_si128(reinterpret_cast<__m128i*>(rest.data()), lanes[3]);
  return zlib_crc32(rest, ~0U);  // `before` is in there already
}

#endif

}  // namespace

uint32_t crc32(std::span<const std::byte> bytes, uint32_t before) {
#if defined(__x86_64__)
  static const bool has_products = __builtin_cpu_supports("pclmul") != 0;
  if (const std::size_t blocks = bytes.size() / kBlock * kBlock; has_products && blocks > 0) {
    before = folded_crc32(bytes.first(blocks), before);
    bytes = bytes.subspan(blocks);
  }
#endif
  return zlib_crc32(bytes, before);
}

}  // namespace adit
