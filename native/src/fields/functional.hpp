// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/vectors.hpp"

namespace realmodel::fields {

/// A linear map of space, by its rows.
using Map3 = std::array<Vec3, 3>;

inline Vec3 mapped(const Map3& map, const Vec3& v) {
    return {dot(map[0], v), dot(map[1], v), dot(map[2], v)};
}

struct ValueAtom {
    Vec3 at;
    double weight;
};

/// The derivative along a vector, which says its weight by its length.
struct SlopeAtom {
    Vec3 at, along;
};

/// What is known of a function f: a sum of values and of derivatives is `right`. The weights of
/// values sum to 0, since a constant may be added to f.
struct Functional {
    std::vector<ValueAtom> values;
    std::vector<SlopeAtom> slopes;
    double right = 0;

    /// f(at) - f(from)
    static Functional difference(const Vec3& at, const Vec3& from) {
        return {{{at, 1.0}, {from, -1.0}}, {}, 0};
    }
    static Functional slope(const Vec3& at, const Vec3& along) { return {{}, {{at, along}}, 0}; }

    Functional mapped_by(const Map3& map) const;

    /// Of the three coordinates.
    Vec3 of_coordinates() const;

    /// Of the kernel r^3, in both of its arguments.
    double with(const Functional& other) const;
};

}  // namespace realmodel::fields
