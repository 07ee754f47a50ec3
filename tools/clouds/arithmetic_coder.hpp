// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adaptive arithmetic coding as LAZ files use it: A. Said, "Introduction to Arithmetic Coding -
// Theory and Practice", HP Labs HPL-2004-76, with 32-bit intervals; integers by their prediction
// as in M. Isenburg, "LASzip: lossless compression of LiDAR data", PE&RS 79(2), 2013.
//
// An encoder and a decoder have the same members, each of which takes what to encode and returns
// what was encoded: the decoder ignores its argument. One function so describes a format for both
// directions.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// How likely each of some symbols is, learnt as they come. All are alike at first.
class SymbolModel {
 public:
  static constexpr uint32_t kBits = 15;  ///< of a probability

  explicit SymbolModel(uint32_t symbols) : symbols_(symbols) {}

  uint32_t last() const { return symbols_ - 1; }
  /// That a symbol is below this one, in 1 / 2^15.
  uint32_t below(uint32_t symbol) const { return below_[symbol]; }
  /// The symbol that a value in 1 / 2^15 falls on.
  uint32_t symbol_at(uint32_t value) const;

  /// Before it is used: most models of a file never are.
  void prepare() {
    if (counts_.empty()) {
      begin();
    }
  }
  void count(uint32_t symbol) {
    ++counts_[symbol];
    if (--until_update_ == 0) {
      update();
    }
  }

 private:
  void begin();
  void update();

  uint32_t symbols_;
  std::vector<uint32_t> below_{};
  std::vector<uint32_t> counts_{};
  uint32_t total_ = 0;
  uint32_t cycle_ = 0;  ///< symbols between two updates
  uint32_t until_update_ = 0;
};

/// The same of a bit.
class BitModel {
 public:
  static constexpr uint32_t kBits = 13;  ///< of the probability

  uint32_t zero() const { return zero_; }  ///< probability of a 0, in 1 / 2^13
  void count(bool bit) {
    zeros_ += bit ? 0 : 1;
    if (--until_update_ == 0) {
      update();
    }
  }

 private:
  void update();

  uint32_t zeros_ = 1;
  uint32_t total_ = 2;
  uint32_t zero_ = 1U << (kBits - 1);
  uint32_t cycle_ = 4;
  uint32_t until_update_ = 4;
};

class ArithmeticEncoder {
 public:
  static constexpr bool kEncodes = true;

  uint32_t symbol(SymbolModel& model, uint32_t symbol);
  bool bit(BitModel& model, bool bit);
  /// Up to 32 bits without a model: 0 and 1 are equally likely.
  uint32_t bits(uint32_t count, uint32_t value);
  /// All bytes; nothing may be encoded after it.
  std::string finish();

 private:
  void move_base(uint32_t by);
  void renormalise();

  std::string bytes_{};
  uint32_t base_ = 0;
  uint32_t length_ = 0xffffffffU;
};

class ArithmeticDecoder {
 public:
  static constexpr bool kEncodes = false;

  /// `bytes` must outlive it.
  explicit ArithmeticDecoder(std::span<const std::byte> bytes);

  uint32_t symbol(SymbolModel& model, uint32_t ignored = 0);
  bool bit(BitModel& model, bool ignored = false);
  uint32_t bits(uint32_t count, uint32_t ignored = 0);
  /// More was asked for than there is: zeros were read instead.
  bool is_overrun() const { return at_ > bytes_.size(); }

 private:
  uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? static_cast<uint32_t>(bytes_[at]) : 0U;
  }
  void renormalise();

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  uint32_t value_ = 0;
  uint32_t length_ = 0xffffffffU;
};

/// Integers of 8, 16 or 32 bits, by how far they are from a prediction: the width of the difference
/// by its context, its upper eight bits by the width, the others as they are.
class IntegerModel {
 public:
  IntegerModel(uint32_t bits, uint32_t contexts)
      : bits_(bits), widths_(contexts, SymbolModel(bits + 1)) {
    for (uint32_t width = 1; width <= bits; ++width) {
      upper_.emplace_back(1U << std::min(width, kUpperBits));
    }
  }

  template <class Coder>
  int32_t code(Coder& coder, int32_t predicted, int32_t value, uint32_t context);

  /// Width of the difference that was coded last.
  uint32_t width() const { return width_; }

 private:
  static constexpr uint32_t kUpperBits = 8;

  uint32_t difference_of(int32_t predicted, int32_t value) const;

  uint32_t bits_;
  uint32_t width_ = 0;
  std::vector<SymbolModel> widths_;
  BitModel zero_or_one_{};
  std::vector<SymbolModel> upper_{};
};

template <class Coder>
int32_t IntegerModel::code(Coder& coder, int32_t predicted, int32_t value, uint32_t context) {
  uint32_t difference = Coder::kEncodes ? difference_of(predicted, value) : 0;
  const auto signed_difference = static_cast<int32_t>(difference);
  // The narrowest interval from -(2^width - 1) to 2^width that it is in.
  width_ = std::bit_width(signed_difference <= 0 ? 0U - difference : difference - 1U);
  width_ = coder.symbol(widths_[context], width_);
  if (width_ == 0) {
    difference = coder.bit(zero_or_one_, difference != 0) ? 1 : 0;
  } else if (width_ < 32) {
    const uint32_t most = (1U << width_) - 1U;
    uint32_t code = signed_difference >= 0 ? difference - 1U : difference + most;
    if (width_ <= kUpperBits) {
      code = coder.symbol(upper_[width_ - 1], code);
    } else {
      const uint32_t lower = width_ - kUpperBits;
      const uint32_t high = coder.symbol(upper_[width_ - 1], code >> lower);
      code = (high << lower) | coder.bits(lower, code & ((1U << lower) - 1U));
    }
    difference = code >= 1U << (width_ - 1) ? code + 1U : code - most;
  } else {
    difference = 1U << 31;
  }
  const uint32_t sum = static_cast<uint32_t>(predicted) + difference;
  return static_cast<int32_t>(bits_ < 32 ? sum & ((1U << bits_) - 1U) : sum);
}

}  // namespace adit
