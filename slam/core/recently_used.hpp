// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <utility>

namespace adit {

/// Values of up to so many bytes. Of more, those that were needed longest ago are dropped.
template <class Key, class Value>
class RecentlyUsed {
 public:
  /// The value that was added last stays even if it is larger than `most_bytes`.
  explicit RecentlyUsed(uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// Null where there is none. It is now the one that was needed last.
  const Value* find(const Key& key) {
    const auto place = places_.find(key);
    if (place == places_.end()) {
      return nullptr;
    }
    kept_.splice(kept_.begin(), kept_, place->second);
    return &kept_.front().value;
  }

  /// Keeps a value whose key is not there yet. Valid until the next call.
  const Value& add(const Key& key, Value value, uint64_t bytes) {
    kept_.push_front({.key = key, .value = std::move(value), .bytes = bytes});
    places_[key] = kept_.begin();
    bytes_ += bytes;
    while (bytes_ > most_bytes_ && kept_.size() > 1) {
      bytes_ -= kept_.back().bytes;
      places_.erase(kept_.back().key);
      kept_.pop_back();
    }
    return kept_.front().value;
  }

  /// Of all values that are kept.
  uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    Key key;
    Value value;
    uint64_t bytes = 0;
  };

  uint64_t most_bytes_;
  uint64_t bytes_ = 0;
  std::list<Kept> kept_;  ///< the one that was needed last in front
  std::map<Key, typename std::list<Kept>::iterator> places_;
};

}  // namespace adit
