// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "base/index.hpp"
#include "base/key_table.hpp"
#include "exact/space_points.hpp"

namespace realmodel::booleans {

/// Numbers things by arrays of numbers.
template <class Key>
class KeyNumbers {
public:
    std::size_t size() const { return keys_.size(); }
    const Key& operator[](std::int32_t number) const { return keys_[index(number)]; }
    /// -1 where it is not there.
    std::int32_t find(const Key& key) const {
        return table_.find(hash(key), [&](std::int32_t i) { return keys_[index(i)] == key; });
    }
    std::int32_t add(const Key& key) {
        const auto found =
            table_.find_or_add(hash(key), static_cast<std::int32_t>(keys_.size()),
                               [&](std::int32_t i) { return keys_[index(i)] == key; });
        if (found.is_new) keys_.push_back(key);
        return found.number;
    }

private:
    static std::uint64_t word(exact::SpacePointId p) {
        return static_cast<std::uint64_t>(p.number());
    }
    static std::uint64_t word(std::int64_t number) { return static_cast<std::uint64_t>(number); }
    static std::uint32_t hash(const Key& key) {
        std::array<std::uint64_t, std::tuple_size_v<Key>> words;
        std::transform(key.begin(), key.end(), words.begin(), [](auto of) { return word(of); });
        return KeyTable::hash(words);
    }
    KeyTable table_;
    std::vector<Key> keys_;
};

}  // namespace realmodel::booleans
