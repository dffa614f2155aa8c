// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "realmodel/base/array.hpp"

namespace realmodel {

/// Numbers things that are told apart by keys of four 32-bit numbers, consecutively. The keys stay
/// with the things: the table has their hashes only. Open addressing with linear probing; numbers
/// are given in the order of first insertion, so nothing depends on the hash.
class KeyTable {
public:
    using Key = std::array<std::int32_t, 4>;

    struct Found {
        std::int32_t number;
        bool is_new;
    };

    std::int32_t size() const { return size_; }

    /// The number of the key, which is `size()` before the call where the key is new; key_of gives
    /// the key of a number that was given before.
    template <class KeyOf>
    Found insert(const Key& key, const KeyOf& key_of) {
        return insert(key, size_, key_of);
    }
    /// The same with numbers that the caller gives: a new key's is `next`.
    template <class KeyOf>
    Found insert(const Key& key, std::int32_t next, const KeyOf& key_of) {
        if ((static_cast<std::size_t>(size_) + 1) * 3 > slots_.size() * 2) grow();
        const std::uint32_t tag = hash(key);
        for (std::size_t slot = tag & mask_;; slot = (slot + 1) & mask_) {
            Slot& here = slots_[slot];
            if (here.number < 0) {
                here = {tag, next};
                ++size_;
                return {next, true};
            }
            if (here.tag == tag && same(key_of(here.number), key)) return {here.number, false};
        }
    }

    /// Where a key will be looked for first, nothing where there is no table yet: to be fetched
    /// some time before it is inserted, as memory takes its time.
    const void* place(const Key& key) const {
        return slots_.empty() ? nullptr : &slots_[hash(key) & mask_];
    }
    /// Fetches that. (Calls that do nothing else are left out by g++, so this and what calls it
    /// must be inlined.)
    [[gnu::always_inline]] void prefetch(const Key& key) const { __builtin_prefetch(place(key)); }

    /// Makes room for so many keys at once.
    void reserve(std::size_t count) {
        const std::size_t slots = std::bit_ceil(std::max<std::size_t>(64, count + count / 2 + 2));
        if (slots > slots_.size()) resize(slots);
    }

private:
    struct Slot {
        std::uint32_t tag = 0;  ///< hash of the key
        std::int32_t number = -1;
    };

    // two words rather than a call that compares bytes
    static bool same(const Key& a, const Key& b) {
        using Words = std::array<std::uint64_t, 2>;
        const auto p = std::bit_cast<Words>(a), q = std::bit_cast<Words>(b);
        return p[0] == q[0] && p[1] == q[1];
    }
    static std::uint32_t hash(const Key& key) {
        const auto word = [](std::int32_t a, std::int32_t b) {
            return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) |
                   static_cast<std::uint32_t>(b);
        };
        std::uint64_t h = word(key[0], key[1]) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
        h = (h + word(key[2], key[3])) * 0xBF58476D1CE4E5B9u;
        h ^= h >> 32;
        h *= 0x94D049BB133111EBu;
        return static_cast<std::uint32_t>(h ^ (h >> 31));
    }

    void grow() { resize(slots_.empty() ? 64 : slots_.size() * 2); }
    void resize(std::size_t slots) {
        Array<Slot> old(slots, Slot{});
        std::swap(old, slots_);
        mask_ = slots - 1;
        for (const Slot& from : old) {
            if (from.number < 0) continue;
            std::size_t slot = from.tag & mask_;
            while (slots_[slot].number >= 0)
                slot = (slot + 1) & mask_;
            slots_[slot] = from;
        }
    }

    Array<Slot> slots_;
    std::size_t mask_ = 0;
    std::int32_t size_ = 0;
};

}  // namespace realmodel
