// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace realmodel::exact {

/// Maps keys of four 32-bit numbers to consecutive numbers. Open addressing with linear probing;
/// numbers are given in the order of first insertion, so nothing depends on the hash.
class KeyTable {
public:
    using Key = std::array<std::int32_t, 4>;

    struct Found {
        std::int32_t number;
        bool is_new;
    };

    std::int32_t size() const { return static_cast<std::int32_t>(keys_.size()); }

    /// The number of the key, which is `size()` before the call where the key is new.
    Found insert(const Key& key) {
        if ((keys_.size() + 1) * 3 > slots_.size() * 2) grow();
        for (std::size_t slot = hash(key) & mask_;; slot = (slot + 1) & mask_) {
            if (slots_[slot] < 0) {
                slots_[slot] = size();
                keys_.push_back(key);
                return {slots_[slot], true};
            }
            if (same(keys_[static_cast<std::size_t>(slots_[slot])], key))
                return {slots_[slot], false};
        }
    }

    /// Fetches the place of a key that will be inserted soon, as memory takes its time. (Calls that
    /// do nothing else are left out by g++, so this and what calls it must be inlined.)
    [[gnu::always_inline]] void prefetch(const Key& key) const {
        if (!slots_.empty()) __builtin_prefetch(&slots_[hash(key) & mask_]);
    }

    /// Makes room for so many keys at once.
    void reserve(std::size_t count) {
        keys_.reserve(count);
        const std::size_t slots = std::bit_ceil(std::max<std::size_t>(64, count + count / 2 + 2));
        if (slots > slots_.size()) resize(slots);
    }

private:
    // two words rather than a call that compares bytes
    static bool same(const Key& a, const Key& b) {
        using Words = std::array<std::uint64_t, 2>;
        const auto p = std::bit_cast<Words>(a), q = std::bit_cast<Words>(b);
        return p[0] == q[0] && p[1] == q[1];
    }
    static std::size_t hash(const Key& key) {
        const auto word = [](std::int32_t a, std::int32_t b) {
            return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) |
                   static_cast<std::uint32_t>(b);
        };
        std::uint64_t h = word(key[0], key[1]) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
        h = (h + word(key[2], key[3])) * 0xBF58476D1CE4E5B9u;
        h ^= h >> 32;
        h *= 0x94D049BB133111EBu;
        return static_cast<std::size_t>(h ^ (h >> 31));
    }

    void grow() { resize(slots_.empty() ? 64 : slots_.size() * 2); }
    void resize(std::size_t slots) {
        slots_.assign(slots, -1);
        mask_ = slots_.size() - 1;
        for (std::size_t i = 0; i < keys_.size(); ++i) {
            std::size_t slot = hash(keys_[i]) & mask_;
            while (slots_[slot] >= 0)
                slot = (slot + 1) & mask_;
            slots_[slot] = static_cast<std::int32_t>(i);
        }
    }

    std::vector<Key> keys_;
    std::vector<std::int32_t> slots_;
    std::size_t mask_ = 0;
};

}  // namespace realmodel::exact
