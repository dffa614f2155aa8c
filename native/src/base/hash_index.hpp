// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace realmodel {

/// Finds the numbers of things by hashes of them; the things themselves are kept elsewhere. Open
/// addressing with linear probing.
class HashIndex {
public:
    /// The number with this hash that `is_it` holds of (of one at most), or -1.
    template <class IsIt>
    std::int32_t find(std::uint64_t hash, const IsIt& is_it) const {
        if (slots_.empty()) return -1;
        for (std::size_t i = hash & mask(); slots_[i].number >= 0; i = (i + 1) & mask()) {
            if (slots_[i].hash == hash && is_it(slots_[i].number)) return slots_[i].number;
        }
        return -1;
    }
    void insert(std::uint64_t hash, std::int32_t number) {
        if (3 * (size_ + 1) > 2 * slots_.size()) grow();
        put({hash, number});
        ++size_;
    }

    /// A hash of a few numbers.
    template <class Words>
    static std::uint64_t hash(const Words& words) {
        std::uint64_t value = 0;
        for (const auto word : words) {
            value ^= static_cast<std::uint64_t>(word);
            value *= 0x9e3779b97f4a7c15ULL;
            value ^= value >> 29;
        }
        return value ^ (value >> 32);
    }

private:
    struct Slot {
        std::uint64_t hash = 0;
        std::int32_t number = -1;
    };
    std::size_t mask() const { return slots_.size() - 1; }
    void put(const Slot& slot) {
        std::size_t i = slot.hash & mask();
        while (slots_[i].number >= 0)
            i = (i + 1) & mask();
        slots_[i] = slot;
    }
    void grow() {
        std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
        std::swap(old, slots_);
        for (const Slot& slot : old) {
            if (slot.number >= 0) put(slot);
        }
    }

    std::vector<Slot> slots_;
    std::size_t size_ = 0;
};

}  // namespace realmodel
