// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "realmodel/base/array.hpp"

namespace realmodel::exact {

/// Finds numbered things again, each among the few that have the same owner: an edge among those of
/// its lower vertex, a crossing among those of the younger of its lines. Neighbors are numbered
/// together, so what is asked for next mostly lies beside what was asked for last, where a hash
/// table would go to another page of memory; and it takes a third of one. Owners may have any
/// number of things: from `kMost` on they have to be kept elsewhere, as lists are read from end to
/// end.
class OwnedNames {
public:
    /// Instead of a number: this owner's things are kept elsewhere from now on.
    static constexpr std::int32_t kElsewhere = -2;

    /// The number of the owner's thing of which `is_it` holds; or `next`, which is greater than all
    /// numbers before, where there is none: then that is its number.
    template <class IsIt>
    std::int32_t find_or_add(std::int32_t owner, std::int32_t next, const IsIt& is_it) {
        const auto o = static_cast<std::size_t>(owner);
        if (o >= last_.size()) last_.resize(o + 1, kNone);
        int count = 0;
        for (std::int32_t number = last_[o]; number != kNone; ++count) {
            if (is_it(number)) return number;
            number = before_[static_cast<std::size_t>(number)];
        }
        if (count == kMost) return kElsewhere;
        before_.resize(static_cast<std::size_t>(next) + 1);
        before_.back() = last_[o];
        last_[o] = next;
        return next;
    }

    /// What will be read first, to be fetched some time before, as memory takes its time.
    const void* slot_of(std::int32_t owner) const {
        const auto o = static_cast<std::size_t>(owner);
        return o < last_.size() ? &last_[o] : nullptr;
    }

private:
    static constexpr std::int32_t kNone = -1;
    static constexpr int kMost = 8;

    Array<std::int32_t> last_;    ///< of each owner
    Array<std::int32_t> before_;  ///< of each thing, the owner's last one before it
};

}  // namespace realmodel::exact
