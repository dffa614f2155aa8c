// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>

#include "base/key_table.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Where a point may move to: anywhere, on its height only, or rather up and down than aside.
enum class Freedom { kAny, kLevel, kUpright };

/// The same for both zeros.
inline std::uint32_t hash_of(const Position& p) {
    return KeyTable::hash(std::array{std::bit_cast<std::uint64_t>(p[0] + 0.0),
                                     std::bit_cast<std::uint64_t>(p[1] + 0.0),
                                     std::bit_cast<std::uint64_t>(p[2] + 0.0)});
}

/// A set of positions; both zeros are alike.
class Positions {
public:
    Positions() = default;
    Positions(std::initializer_list<Position> positions) {
        for (const Position& p : positions)
            insert(p);
    }

    /// @return false where it is one of them already
    bool insert(const Position& p) {
        const auto next = static_cast<std::int32_t>(all_.size());
        const auto is_it = [this, &p](std::int32_t i) { return all_[index(i)] == p; };
        if (!table_.find_or_add(hash_of(p), next, is_it).is_new) return false;
        all_.push_back(p);
        return true;
    }
    bool contains(const Position& p) const {
        return table_.find(hash_of(p), [&](std::int32_t i) { return all_[index(i)] == p; }) >= 0;
    }
    std::size_t size() const { return all_.size(); }
    void reserve(std::size_t count) { table_.reserve(count); }

private:
    Array<Position> all_;
    KeyTable table_;
};

/// A position as near to p as doubles allow that is not taken yet; it is then.
Position free_position_beside(const Position& p, Freedom freedom, Positions& taken);

}  // namespace realmodel::cutting
