// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/arithmetic_coder.hpp"

#include <algorithm>
#include <utility>

namespace adit {
namespace {

constexpr uint32_t kShortest = 1U << 24;  // interval: below this a byte is known
constexpr uint32_t kHalf = 1U << 31;
// The format's own: how often models are updated, and how many bits are coded at once.
constexpr uint32_t kLongestBitCycle = 64;
constexpr uint32_t kMostBitsAtOnce = 19;

}  // namespace

void SymbolModel::begin() {
  counts_.assign(symbols_, 1);
  below_.resize(symbols_);
  cycle_ = symbols_;
  update();
  cycle_ = (symbols_ + 6) >> 1;
  until_update_ = cycle_;
}

void SymbolModel::update() {
  total_ += cycle_;
  if (total_ > 1U << kBits) {
    total_ = 0;
    for (uint32_t& count : counts_) {
      count = (count + 1) >> 1;
      total_ += count;
    }
  }
  const uint32_t scale = kHalf / total_;
  uint32_t sum = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    below_[i] = (scale * sum) >> (31 - kBits);
    sum += counts_[i];
  }
  cycle_ = std::min((5 * cycle_) >> 2, (symbols_ + 6) << 3);
  until_update_ = cycle_;
}

uint32_t SymbolModel::symbol_at(uint32_t value) const {
  const auto above = std::upper_bound(below_.begin() + 1, below_.end(), value);
  return static_cast<uint32_t>(above - below_.begin() - 1);
}

void BitModel::update() {
  total_ += cycle_;
  if (total_ > 1U << kBits) {
    total_ = (total_ + 1) >> 1;
    zeros_ = (zeros_ + 1) >> 1;
    if (zeros_ == total_) {
      ++total_;
    }
  }
  zero_ = (zeros_ * (kHalf / total_)) >> (31 - kBits);
  cycle_ = std::min((5 * cycle_) >> 2, kLongestBitCycle);
  until_update_ = cycle_;
}

void ArithmeticEncoder::move_base(uint32_t by) {
  base_ += by;
  if (base_ < by) {  // a carry into the bytes that are written
    auto at = bytes_.rbegin();
    for (; static_cast<unsigned char>(*at) == 0xff; ++at) {
      *at = '\0';
    }
    ++*at;
  }
}

void ArithmeticEncoder::renormalise() {
  while (length_ < kShortest) {
    bytes_.push_back(static_cast<char>(base_ >> 24));
    base_ <<= 8;
    length_ <<= 8;
  }
}

uint32_t ArithmeticEncoder::symbol(SymbolModel& model, uint32_t symbol) {
  model.prepare();
  const uint32_t unit = length_ >> SymbolModel::kBits;
  const uint32_t below = model.below(symbol) * unit;
  length_ = symbol == model.last() ? length_ - below : model.below(symbol + 1) * unit - below;
  move_base(below);
  renormalise();
  model.count(symbol);
  return symbol;
}

bool ArithmeticEncoder::bit(BitModel& model, bool bit) {
  const uint32_t zero = model.zero() * (length_ >> BitModel::kBits);
  length_ = bit ? length_ - zero : zero;
  if (bit) {
    move_base(zero);
  }
  renormalise();
  model.count(bit);
  return bit;
}

uint32_t ArithmeticEncoder::bits(uint32_t count, uint32_t value) {
  uint32_t left = value;
  if (count > kMostBitsAtOnce) {
    bits(16, left & 0xffffU);
    left >>= 16;
    count -= 16;
  }
  length_ >>= count;
  move_base(left * length_);
  renormalise();
  return value;
}

std::string ArithmeticEncoder::finish() {
  const bool is_long = length_ > 2 * kShortest;
  length_ = is_long ? kShortest >> 1 : kShortest >> 9;
  move_base(is_long ? kShortest : kShortest >> 1);
  renormalise();
  bytes_.append(is_long ? 3 : 2, '\0');  // a decoder reads that far ahead
  return std::move(bytes_);
}

ArithmeticDecoder::ArithmeticDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) {
    value_ = (value_ << 8) | next();
  }
}

void ArithmeticDecoder::renormalise() {
  while (length_ < kShortest) {
    value_ = (value_ << 8) | next();
    length_ <<= 8;
  }
}

uint32_t ArithmeticDecoder::symbol(SymbolModel& model, uint32_t /*ignored*/) {
  model.prepare();
  const uint32_t unit = length_ >> SymbolModel::kBits;
  const uint32_t symbol = model.symbol_at(value_ / unit);
  const uint32_t below = model.below(symbol) * unit;
  length_ = symbol == model.last() ? length_ - below : model.below(symbol + 1) * unit - below;
  value_ -= below;
  renormalise();
  model.count(symbol);
  return symbol;
}

bool ArithmeticDecoder::bit(BitModel& model, bool /*ignored*/) {
  const uint32_t zero = model.zero() * (length_ >> BitModel::kBits);
  const bool bit = value_ >= zero;
  length_ = bit ? length_ - zero : zero;
  value_ -= bit ? zero : 0;
  renormalise();
  model.count(bit);
  return bit;
}

uint32_t ArithmeticDecoder::bits(uint32_t count, uint32_t /*ignored*/) {
  if (count > kMostBitsAtOnce) {
    const uint32_t lower = bits(16);
    return (bits(count - 16) << 16) | lower;
  }
  length_ >>= count;
  const uint32_t value = value_ / length_;
  value_ -= value * length_;
  renormalise();
  return value & ((1U << count) - 1U);  // damaged bytes may give more
}

uint32_t IntegerModel::difference_of(int32_t predicted, int32_t value) const {
  const uint32_t difference = static_cast<uint32_t>(value) - static_cast<uint32_t>(predicted);
  if (bits_ == 32) {
    return difference;
  }
  // As near to 0 as the wrapped range allows.
  const uint32_t half = 1U << (bits_ - 1);
  return ((difference + half) & ((1U << bits_) - 1U)) - half;
}

}  // namespace adit
