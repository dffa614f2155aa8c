// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "base/index.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel {

/// Numbers things that are told apart by keys of four 32-bit numbers, or in another way, in the
/// order of first insertion. The keys stay with the things: the table has hashes only, and nothing
/// depends on these. Open addressing with linear probing.
class KeyTable {
public:
    using Key = std::array<std::int32_t, 4>;

    struct Insertion {
        std::int32_t number;
        bool is_new;
    };

    std::int32_t size() const { return size_; }

    /// The number of the key, which is `size()` before the call where the key is new; key_of gives
    /// the key of a number that was given before.
    template <class KeyOf>
    Insertion insert(const Key& key, const KeyOf& key_of) {
        return insert(key, size_, key_of);
    }
    /// The same with numbers that the caller gives: a new key's is `next`.
    template <class KeyOf>
    Insertion insert(const Key& key, std::int32_t next, const KeyOf& key_of) {
        return find_or_add(hash(key), next,
                           [&](std::int32_t number) { return same(key_of(number), key); });
    }
    /// The number of the thing with this hash of which `is_it` holds; `next` where there is none.
    template <class IsIt>
    Insertion find_or_add(std::uint32_t tag, std::int32_t next, const IsIt& is_it) {
        if ((static_cast<std::size_t>(size_) + 1) * 3 > slots_.size() * 2) grow();
        for (std::size_t slot = tag & mask_;; slot = (slot + 1) & mask_) {
            Slot& here = slots_[slot];
            if (here.number < 0) {
                here = {tag, next};
                ++size_;
                return {next, true};
            }
            if (here.tag == tag && is_it(here.number)) return {here.number, false};
        }
    }
    /// The number of the thing with this hash of which `is_it` holds, -1 where there is none.
    template <class IsIt>
    std::int32_t find(std::uint32_t tag, const IsIt& is_it) const {
        if (slots_.empty()) return -1;
        for (std::size_t slot = tag & mask_;; slot = (slot + 1) & mask_) {
            const Slot& here = slots_[slot];
            if (here.number < 0) return -1;
            if (here.tag == tag && is_it(here.number)) return here.number;
        }
    }
    static std::uint32_t hash(std::span<const std::uint64_t> words) {
        std::uint64_t h = 0;
        for (const std::uint64_t word : words) {
            h = (h ^ word) * 0x9E3779B97F4A7C15u;
            h ^= h >> 29;
        }
        return static_cast<std::uint32_t>(h ^ (h >> 32));
    }
    static std::uint32_t hash(const Key& key) {
        return hash(std::bit_cast<std::array<std::uint64_t, 2>>(key));
    }

    /// Where a key will be looked for first, nothing where there is no table yet: to be fetched
    /// some time before it is inserted, as memory takes its time.
    const void* slot_of(const Key& key) const {
        return slots_.empty() ? nullptr : &slots_[hash(key) & mask_];
    }
    /// Fetches that. (Calls that do nothing else are left out by g++, so this and what calls it
    /// must be inlined.)
    [[gnu::always_inline]] void prefetch(const Key& key) const { __builtin_prefetch(slot_of(key)); }

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
        const auto entry =
            table_.find_or_add(hash(key), static_cast<std::int32_t>(keys_.size()),
                               [&](std::int32_t i) { return keys_[index(i)] == key; });
        if (entry.is_new) keys_.push_back(key);
        return entry.number;
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
