// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/key_numbers.hpp"
#include "base/vectors.hpp"

namespace realmodel::booleans {

using exact::SpacePointId;
using exact::SpacePoints;

inline double distance(const exact::SpacePosition& p, const exact::SpacePosition& q) {
    return length(minus(p, q));
}

/// Finds vertices by their place, in cells twice as wide as what is near.
class VertexGrid {
public:
    VertexGrid(const SpacePoints& points, double within) : points_(points), cell_(2 * within) {}

    void add(SpacePointId p) {
        if (index(p) < is_there_.size() && is_there_[index(p)]) return;
        is_there_.resize(std::max(is_there_.size(), index(p) + 1));
        is_there_[index(p)] = true;
        const std::int32_t cell = cells_.add(cell_of(points_.rounded(p)));
        first_.resize(cells_.size(), -1);
        entries_.push_back({p, first_[index(cell)]});
        first_[index(cell)] = static_cast<std::int32_t>(entries_.size()) - 1;
    }
    /// The nearest vertex within a distance, of equally near ones the first; kNone: there is none.
    SpacePointId nearest(const exact::SpacePosition& at, double within) const {
        assert(2 * within <= cell_);
        std::pair<double, SpacePointId> best{within, kNone};
        for (int corner = 0; corner < 8; ++corner) {
            exact::SpacePosition place = at;
            bool is_new = true;
            for (std::size_t k = 0; k < 3; ++k) {
                place[k] += within * ((corner >> k & 1) != 0 ? 1 : -1);
                is_new = is_new &&
                         ((corner >> k & 1) == 0 || cell(at[k] + within) != cell(at[k] - within));
            }
            if (!is_new) continue;
            const std::int32_t number = cells_.find(cell_of(place));
            for (std::int32_t i = number < 0 ? -1 : first_[index(number)]; i >= 0;
                 i = entries_[index(i)].next) {
                const SpacePointId p = entries_[index(i)].vertex;
                const std::pair found(distance(points_.rounded(p), at), p);
                if (found.first <= within && (!best.second.has_value() || found < best))
                    best = found;
            }
        }
        return best.second;
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    struct Entry {
        SpacePointId vertex;
        std::int32_t next;  ///< in its cell
    };
    std::int64_t cell(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }
    Cell cell_of(const exact::SpacePosition& p) const {
        return {cell(p[0]), cell(p[1]), cell(p[2])};
    }

    const SpacePoints& points_;
    double cell_;
    KeyNumbers<Cell> cells_;
    std::vector<std::int32_t> first_;
    std::vector<Entry> entries_;
    std::vector<bool> is_there_;
};

}  // namespace realmodel::booleans
