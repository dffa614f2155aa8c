// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <tuple>
#include <vector>

#include "base/index.hpp"
#include "base/key_table.hpp"

namespace realmodel {

/// Numbers things by arrays of numbers, in the order in which they come. Both zeros are alike.
template <class Key>
class KeyNumbers {
public:
    std::size_t size() const { return keys_.size(); }
    const Key& operator[](std::int32_t number) const { return keys_[index(number)]; }
    const std::vector<Key>& keys() const { return keys_; }
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
    /// @return false where it is there already
    bool insert(const Key& key) {
        const std::size_t before = size();
        return index(add(key)) == before;
    }
    void reserve(std::size_t count) { table_.reserve(count); }

    static std::uint32_t hash(const Key& key) {
        std::array<std::uint64_t, std::tuple_size_v<Key>> words;
        std::transform(key.begin(), key.end(), words.begin(), [](auto of) { return word(of); });
        return KeyTable::hash(words);
    }

private:
    template <class Kind>
    static std::uint64_t word(Id<Kind> id) {
        return static_cast<std::uint64_t>(id.number());
    }
    static std::uint64_t word(std::int64_t number) { return static_cast<std::uint64_t>(number); }
    static std::uint64_t word(double x) { return std::bit_cast<std::uint64_t>(x + 0.0); }

    KeyTable table_;
    std::vector<Key> keys_;
};

}  // namespace realmodel
