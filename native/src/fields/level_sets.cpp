// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/level_sets.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/index.hpp"
#include "base/key_table.hpp"
#include "base/parallel.hpp"
#include "fields/refined_lattice.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

/// A vertex of a level set: where it passes between two corners, the lesser first, or twice the
/// corner that it passes through. Twice -1 - side: the point beyond a side of the lattice from
/// which that is closed.
using EdgeCrossing = std::array<std::int64_t, 2>;
using CrossingTriangle = std::array<EdgeCrossing, 3>;
using BoxFace = RefinedLattice::BoxFace;

/// An edge around what of a side of the lattice is inside, seen from beyond counter-clockwise.
struct BoxFaceEdge {
    BoxFace box_face,
        along;  ///< along another side: it lies in both; along itself: on the level set
    EdgeCrossing from, to;
};

/// What some cells have of the closed boundary of one level.
struct LevelPieces {
    std::vector<CrossingTriangle> triangles;
    std::vector<BoxFaceEdge> edges;

    void add(const LevelPieces& more) {
        triangles.insert(triangles.end(), more.triangles.begin(), more.triangles.end());
        edges.insert(edges.end(), more.edges.begin(), more.edges.end());
    }
};

/// The corners of a tetrahedron in the order in which those of a mask come first, turned as before.
std::array<std::uint8_t, 4> sorted_corners(std::size_t mask) {
    std::array<std::uint8_t, 4> order{};
    std::size_t count = 0;
    for (const bool first : {true, false}) {
        for (std::uint8_t i = 0; i < 4; ++i) {
            if (((mask >> i & 1) != 0) == first) order[count++] = i;
        }
    }
    bool is_odd = false;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j)
            is_odd ^= order[i] > order[j];
    }
    // two that are on one side
    const std::size_t swapped = std::popcount(mask) < 2 ? 2 : 0;
    if (is_odd) std::swap(order[swapped], order[swapped + 1]);
    return order;
}

/// The level sets of some cells, by levels.
class CellLevelSets {
public:
    CellLevelSets(const RefinedLattice& lattice, std::span<const double> levels)
        : lattice_(lattice), levels_(levels), pieces_(levels.size()) {
        for (std::size_t mask = 0; mask < 16; ++mask)
            orders_[mask] = sorted_corners(mask);
    }

    void add_cell(const CellIndex& cell) {
        std::size_t planes = 0;  // those of the lattice's sides that the cell is at
        for (std::size_t axis = 0; axis < 3; ++axis)
            planes += (cell[axis] == 0) + (cell[axis] + 1 == lattice_.cells(axis));
        const auto add_all = [&](const LatticeTetrahedron& tetrahedron) {
            add(tetrahedron);
            if (planes > 0) add_box_faces(tetrahedron);
        };
        if (const auto* tetrahedra = lattice_.divided(cell)) {
            std::ranges::for_each(*tetrahedra, add_all);
            return;
        }
        const auto corners = lattice_.corners(cell);
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const std::int64_t corner : corners) {
            low = std::min(low, lattice_.value(corner));
            high = std::max(high, lattice_.value(corner));
        }
        if (first_level(low) == first_level(high) && planes < 2) return;
        for (std::size_t number = 0; number < kTetrahedraOfCell.size(); ++number)
            add_all(RefinedLattice::tetrahedron(corners, number));
    }

    std::vector<LevelPieces>& pieces() { return pieces_; }

private:
    /// The first level that is at least some value.
    std::size_t first_level(double value) const {
        return static_cast<std::size_t>(std::ranges::lower_bound(levels_, value) - levels_.begin());
    }

    void add(const LatticeTetrahedron& tetrahedron) {
        std::array<double, 4> values{};
        for (std::size_t i = 0; i < 4; ++i)
            values[i] = lattice_.value(tetrahedron[i]);
        const auto [low, high] = std::ranges::minmax(values);
        // inside is where a value is at most the level
        for (std::size_t level = first_level(low); level < first_level(high); ++level)
            add(tetrahedron, values, level);
    }

    void add(const LatticeTetrahedron& tetrahedron, const std::array<double, 4>& values,
             std::size_t level) {
        const double at = levels_[level];
        std::size_t mask = 0, inside = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            if (values[i] > at) continue;
            mask |= std::size_t{1} << i;
            ++inside;
        }
        assert(inside > 0 && inside < 4);
        const auto& order = orders_[mask];
        const auto between = [&](std::size_t in, std::size_t out) -> EdgeCrossing {
            const std::int64_t inner = tetrahedron[order[in]];
            if (values[order[in]] == at) return {inner, inner};
            return unordered(inner, tetrahedron[order[out]]);
        };
        const auto triangle = [&](const EdgeCrossing& a, const EdgeCrossing& b,
                                  const EdgeCrossing& c) {
            if (a != b && b != c && c != a) pieces_[level].triangles.push_back({a, b, c});
        };
        if (inside == 1) {
            triangle(between(0, 1), between(0, 2), between(0, 3));
        } else if (inside == 2) {
            const std::array loop{between(0, 2), between(0, 3), between(1, 3), between(1, 2)};
            triangle(loop[0], loop[1], loop[2]);
            triangle(loop[0], loop[2], loop[3]);
        } else {
            triangle(between(0, 3), between(1, 3), between(2, 3));
        }
    }

    /// The faces of a tetrahedron in the sides of the lattice.
    void add_box_faces(const LatticeTetrahedron& tetrahedron) {
        constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
            {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};  // outward
        std::array<unsigned, 4> box_faces{};
        for (std::size_t i = 0; i < 4; ++i)
            box_faces[i] = lattice_.box_faces(tetrahedron[i]);
        for (const auto& [a, b, c] : kFaces) {
            const unsigned common = box_faces[a] & box_faces[b] & box_faces[c];
            if (common == 0) continue;
            for (std::size_t level = 0; level < levels_.size(); ++level)
                add_face({tetrahedron[a], tetrahedron[b], tetrahedron[c]},
                         static_cast<BoxFace>(std::countr_zero(common)), level);
        }
    }

    /// Of a triangle in a side of the lattice the edges that are on the level set, or in another
    /// side, around what is inside.
    void add_face(const std::array<std::int64_t, 3>& corners, BoxFace box_face, std::size_t level) {
        std::optional<EdgeCrossing> leaving, entering;
        const auto put = [&](BoxFace along, const EdgeCrossing& from, const EdgeCrossing& to) {
            if (from != to) pieces_[level].edges.push_back({box_face, along, from, to});
        };
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int64_t a = corners[i], b = corners[(i + 1) % 3];
            const bool has_a = lattice_.value(a) <= levels_[level];
            const bool has_b = lattice_.value(b) <= levels_[level];
            if (!has_a && !has_b) continue;
            EdgeCrossing from{a, a}, to{b, b};
            if (has_a != has_b) {
                const std::int64_t in = has_a ? a : b;
                const bool is_at = lattice_.value(in) == levels_[level];
                const EdgeCrossing crossing = is_at ? EdgeCrossing{in, in} : unordered(a, b);
                (has_a ? to : from) = crossing;
                (has_a ? leaving : entering) = crossing;
            }
            const unsigned others =
                lattice_.box_faces(a) & lattice_.box_faces(b) & ~(1U << box_face);
            if (others != 0) put(static_cast<BoxFace>(std::countr_zero(others)), from, to);
        }
        if (leaving) put(box_face, *leaving, *entering);
    }

    const RefinedLattice& lattice_;
    std::span<const double> levels_;
    std::array<std::array<std::uint8_t, 4>, 16> orders_{};
    std::vector<LevelPieces> pieces_;
};

/// Closes a level set: what of a side of the lattice is inside is the base of a pyramid, whose tip
/// lies beyond the middle of the side. Along an edge of the lattice corners between others count
/// for nothing, on both sides alike.
/// @return how many triangles are the level set itself
std::size_t close(LevelPieces& pieces) {
    const std::size_t on_level = pieces.triangles.size();
    const auto add = [&](BoxFace box_face, const EdgeCrossing& from, const EdgeCrossing& to) {
        const std::int64_t tip = -1 - box_face;
        pieces.triangles.push_back({from, to, {tip, tip}});
    };
    std::map<std::pair<BoxFace, BoxFace>, std::map<EdgeCrossing, int>> ends;  // less beginnings
    for (const BoxFaceEdge& edge : pieces.edges) {
        if (edge.along == edge.box_face) {
            add(edge.box_face, edge.from, edge.to);
        } else {
            auto& line = ends[{edge.box_face, edge.along}];
            --line[edge.from];
            ++line[edge.to];
        }
    }
    for (const auto& [box_faces, line] : ends) {
        std::vector<EdgeCrossing> from, to;
        for (const auto& [crossing, count] : line)
            (count < 0 ? from : to)
                .insert((count < 0 ? from : to).end(), index(std::abs(count)), crossing);
        assert(from.size() == to.size());
        for (std::size_t i = 0; i < from.size(); ++i)
            add(box_faces.first, from[i], to[i]);
    }
    return on_level;
}

/// Where a level set passes between two corners.
Vec3 position_of(const RefinedLattice& lattice, const EdgeCrossing& crossing, double level) {
    if (crossing[0] < 0) return lattice.beyond(static_cast<BoxFace>(-1 - crossing[0]));
    const Vec3 a = lattice.position(crossing[0]);
    if (crossing[0] == crossing[1]) return a;
    const Vec3 b = lattice.position(crossing[1]);
    const double from = lattice.value(crossing[0]), to = lattice.value(crossing[1]);
    const double share = (level - from) / (to - from);
    assert(share >= 0 && share <= 1);
    Vec3 p{};
    for (std::size_t k = 0; k < 3; ++k)
        p[k] = std::clamp(a[k] + share * (b[k] - a[k]), std::min(a[k], b[k]), std::max(a[k], b[k]));
    return p;
}

/// Takes away equal triangles that face each other: between them a level set touches itself. Only
/// those can be equal whose corners are all at nodes.
/// @return how many of the first `on_level` are left
std::size_t cancel_equal(std::vector<CrossingTriangle>& triangles, std::size_t on_level) {
    struct Turned {
        CrossingTriangle corners;
        int turn;
        std::size_t number;
    };
    std::vector<Turned> sorted;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        auto corners = triangles[t];
        if (!std::ranges::all_of(corners, [](const EdgeCrossing& c) { return c[0] == c[1]; }))
            continue;
        std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
        const int turn = corners[1] < corners[2] ? 1 : -1;
        if (turn < 0) std::swap(corners[1], corners[2]);
        sorted.push_back({corners, turn, t});
    }
    std::ranges::sort(sorted, {}, [](const Turned& t) { return std::pair(t.corners, t.number); });
    std::vector<std::uint8_t> is_gone(triangles.size(), 0);
    for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
        if (sorted[i].corners != sorted[i + 1].corners || sorted[i].turn == sorted[i + 1].turn)
            continue;
        is_gone[sorted[i].number] = is_gone[sorted[i + 1].number] = 1;
        ++i;
    }
    std::size_t remaining = 0, remaining_on_level = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (is_gone[t] != 0) continue;
        remaining_on_level += t < on_level ? 1 : 0;
        triangles[remaining++] = triangles[t];
    }
    triangles.resize(remaining);
    return remaining_on_level;
}

LevelSet numbered(const RefinedLattice& lattice, double level, LevelPieces pieces) {
    LevelSet level_set;
    const std::size_t on_level = close(pieces);
    level_set.on_level = cancel_equal(pieces.triangles, on_level);
    std::vector<std::pair<EdgeCrossing, std::int32_t>>
        crossings;  // and the number that each had first
    KeyTable known;
    for (const CrossingTriangle& triangle : pieces.triangles) {
        auto& numbers = level_set.triangles.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const EdgeCrossing& crossing = triangle[i];
            const auto words = std::bit_cast<std::array<std::uint64_t, 2>>(crossing);
            const std::int32_t next = checked_number(crossings.size(), "vertices of a level set");
            const auto [number, is_new] = known.find_or_add(
                KeyTable::hash(words), next,
                [&](std::int32_t other) { return crossings[index(other)].first == crossing; });
            if (is_new) crossings.push_back({crossing, number});
            numbers[i] = number;
        }
    }
    std::ranges::sort(crossings);
    level_set.vertices.resize(crossings.size());
    std::vector<std::int32_t> place(crossings.size());
    for (std::size_t v = 0; v < crossings.size(); ++v) {
        level_set.vertices[v] = position_of(lattice, crossings[v].first, level);
        place[index(crossings[v].second)] = static_cast<std::int32_t>(v);
    }
    for (auto& triangle : level_set.triangles) {
        for (std::int32_t& v : triangle)
            v = place[index(v)];
    }
    return level_set;
}

}  // namespace

std::vector<LevelSet> level_sets(const LatticeField& field, std::span<const double> levels,
                                 const Execution& execution) {
    const RefinedLattice lattice(field, levels);
    const auto slabs = static_cast<std::size_t>(lattice.cells(2));
    std::vector<std::vector<LevelPieces>> of_slabs(slabs);
    parallel_chunks(slabs, execution, [&](std::size_t slab) {
        CellLevelSets sets(lattice, levels);
        for (std::int32_t j = 0; j < lattice.cells(1); ++j) {
            for (std::int32_t i = 0; i < lattice.cells(0); ++i)
                sets.add_cell({i, j, static_cast<std::int32_t>(slab)});
        }
        of_slabs[slab] = std::move(sets.pieces());
    });
    std::vector<LevelSet> sets(levels.size());
    parallel_chunks(levels.size(), execution, [&](std::size_t level) {
        LevelPieces pieces;
        for (const auto& slab : of_slabs)
            pieces.add(slab[level]);
        sets[level] = numbered(lattice, levels[level], std::move(pieces));
    });
    return sets;
}

std::vector<double> moved_onto_levels(const LatticeField& field, std::span<const double> levels) {
    constexpr double kNear = 1e-7;  // of the largest difference to a neighbor
    const RefinedLattice lattice(field, levels);
    std::vector<double> moved(field.values.begin(), field.values.end());
    const std::array<int, 3>& counts = field.lattice.counts;
    std::size_t number = 0;
    for (std::int32_t k = 0; k < counts[2]; ++k) {
        for (std::int32_t j = 0; j < counts[1]; ++j) {
            for (std::int32_t i = 0; i < counts[0]; ++i, ++number) {
                const double value = field.values[number];
                double differs = 0;
                for (const CellIndex& step : {CellIndex{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
                    for (const std::int32_t way : {-1, 1}) {
                        const CellIndex at{i + way * step[0], j + way * step[1], k + way * step[2]};
                        bool is_node = true;
                        for (std::size_t axis = 0; axis < 3; ++axis)
                            is_node &= at[axis] >= 0 && at[axis] < counts[axis];
                        if (is_node)
                            differs = std::max(differs,
                                               std::abs(lattice.value(lattice.node(at)) - value));
                    }
                }
                const auto above = std::ranges::lower_bound(levels, value);
                for (const auto& near : {above, above - (above != levels.begin())}) {
                    if (near != levels.end() && std::abs(*near - value) <= kNear * differs)
                        moved[number] = *near;
                }
            }
        }
    }
    return moved;
}

std::vector<double> field_at(const LatticeField& field, std::span<const double> positions,
                             const Execution& execution) {
    const RefinedLattice lattice(field, {});
    std::vector<double> values(positions.size() / 3);
    parallel_ranges(values.size(), 1 << 10, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            values[i] = lattice.at({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
    });
    return values;
}

TetrahedraAt tetrahedra_at(const LatticeField& field, std::span<const double> positions,
                           const Execution& execution) {
    const RefinedLattice lattice(field, {}, positions);
    TetrahedraAt tetrahedra;
    tetrahedra.corners.resize(positions.size() / 3);
    tetrahedra.weights.resize(positions.size() / 3);
    parallel_ranges(
        tetrahedra.corners.size(), 1 << 10, execution, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3 p{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
                const auto tetrahedron = lattice.located(p);
                if (!tetrahedron)
                    throw InputError("outside", "a position is outside of the lattice", -1,
                                     {static_cast<std::int64_t>(i)}, p);
                tetrahedra.corners[i] = tetrahedron->corners;
                tetrahedra.weights[i] = tetrahedron->weights;
            }
        });
    return tetrahedra;
}

std::vector<std::uint8_t> points_between(const LatticeField& field, const Execution& execution) {
    const RefinedLattice lattice(field, {});
    std::vector<std::uint8_t> is_between(field.point_values.size());
    parallel_ranges(is_between.size(), 1 << 8, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t point = begin; point < end; ++point)
            is_between[point] = lattice.is_between(point) ? 1 : 0;
    });
    return is_between;
}

}  // namespace realmodel::fields
