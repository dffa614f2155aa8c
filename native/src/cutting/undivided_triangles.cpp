// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "arrangement/edge_fan.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "cutting/cutter_overlay.hpp"
#include "exact/orientation.hpp"

namespace realmodel::cutting {

namespace {

using Triangle = std::array<std::int32_t, 3>;
using TrianglePositions = std::array<Position, 3>;

/// The sign of a volume where doubles tell it, 0 where they do not.
int sure_side(const Position& a, const Position& b, const Position& c, const Position& d) {
    return exact::orient3d_filter(a, b, c, d).value_or(0);
}

/// Whether all corners of one triangle are surely on one side of the plane of another.
bool is_beside_plane(const TrianglePositions& one, const TrianglePositions& plane) {
    const int side = sure_side(plane[0], plane[1], plane[2], one[0]);
    return side != 0 && side == sure_side(plane[0], plane[1], plane[2], one[1]) &&
           side == sure_side(plane[0], plane[1], plane[2], one[2]);
}

/// Whether a plane at right angles to some axis surely parts two triangles.
/// @param margin  of products with the axis, by its length
bool separates(const Position& axis, const TrianglePositions& one, const TrianglePositions& other,
               double margin) {
    const auto [low, high] = std::minmax({dot(axis, one[0]), dot(axis, one[1]), dot(axis, one[2])});
    const auto [low_beyond, high_beyond] =
        std::minmax({dot(axis, other[0]), dot(axis, other[1]), dot(axis, other[2])});
    margin *= length(axis);
    return low > high_beyond + margin || low_beyond > high + margin;
}

/// Whether a plane at right angles to the way between their middles surely parts two triangles,
/// whose first corner may be one.
/// @param shares_corner  it is, and lies in the plane
bool are_parted_between_middles(const TrianglePositions& one, const TrianglePositions& other,
                                bool shares_corner) {
    constexpr double kRounding = 0x1p-40;  // of lengths
    TrianglePositions a{}, b{};
    double size = 0;
    Position axis{0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i) {
        a[i] = minus(one[i], one[0]);
        b[i] = minus(other[i], one[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            axis[k] += a[i][k] - b[i][k];
            size = std::max({size, std::abs(a[i][k]), std::abs(b[i][k])});
        }
    }
    const double margin =
        kRounding * size * (std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]));
    const std::size_t first = shares_corner ? 1 : 0;
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (std::size_t i = first; i < 3; ++i) {
        least = std::min(least, dot(axis, a[i]));
        most = std::max(most, dot(axis, b[i]));
    }
    return shares_corner ? least > margin && most < -margin : least > most + margin;
}

/// Whether planes along the edges of two triangles part them surely (the theorem of separating
/// axes; S. Gottschalk, M. C. Lin and D. Manocha, 1996).
bool are_parted_along_edges(const TrianglePositions& one, const TrianglePositions& other) {
    constexpr double kRounding = 0x1p-40;  // of lengths
    TrianglePositions a{}, b{};
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        a[i] = minus(one[i], one[0]);
        b[i] = minus(other[i], one[0]);
        size = std::max({size, length(a[i]), length(b[i])});
    }
    const Position normal = polygon_normal(a), beyond = polygon_normal(b);
    for (std::size_t i = 0; i < 3; ++i) {
        const Position edge = minus(a[(i + 1) % 3], a[i]), facing = minus(b[(i + 1) % 3], b[i]);
        // of triangles that are nearly in one plane, too
        if (separates(cross(normal, edge), a, b, kRounding * size) ||
            separates(cross(beyond, facing), a, b, kRounding * size))
            return true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Position axis = cross(edge, minus(b[(k + 1) % 3], b[k]));
            if (separates(axis, a, b, kRounding * size)) return true;
        }
    }
    return false;
}

/// The same of triangles nearly in one plane that share their first corner: a line through it
/// parts their edges there. Where any does, the middle one lies between two of these edges, or
/// between one and what is opposite to another.
bool are_parted_by_line(const TrianglePositions& one, const TrianglePositions& other) {
    constexpr double kRounding = 0x1p-40;
    const std::array<Position, 4> edges{unit(minus(one[1], one[0])), unit(minus(one[2], one[0])),
                                        unit(minus(other[1], one[0])),
                                        unit(minus(other[2], one[0]))};
    const Position normal = unit(polygon_normal(one));
    const auto are_apart = [&](const Position& line) {
        const Position axis = cross(normal, line);
        const double margin = kRounding * length(axis);
        std::array<double, 4> off{};
        for (std::size_t i = 0; i < 4; ++i)
            off[i] = dot(axis, edges[i]);
        if (off[0] < 0) std::ranges::transform(off, off.begin(), std::negate<>());
        return off[0] > margin && off[1] > margin && off[2] < -margin && off[3] < -margin;
    };
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = i + 1; k < 4; ++k) {
            if (are_apart(minus(edges[i], edges[k])) || are_apart(plus(edges[i], edges[k])))
                return true;
        }
    }
    return false;
}

/// The same of triangles in any position that share their first corner and nothing else by name.
bool are_parted_at_corner(const TrianglePositions& one, const TrianglePositions& other) {
    const auto are_apart = [](const TrianglePositions& plane, const TrianglePositions& beside) {
        const int side = sure_side(plane[0], plane[1], plane[2], beside[1]);
        return side != 0 && side == sure_side(plane[0], plane[1], plane[2], beside[2]);
    };
    if (are_apart(one, other) || are_apart(other, one)) return true;
    for (std::size_t i = 1; i < 3; ++i) {
        for (std::size_t k = 1; k < 3; ++k) {
            const int side = sure_side(one[0], one[i], other[k], one[3 - i]);
            if (side != 0 && side == -sure_side(one[0], one[i], other[k], other[3 - k]))
                return true;
        }
    }
    return are_parted_by_line(one, other);
}

/// The same of triangles that share their first two corners.
bool are_parted_at_edge(const TrianglePositions& one, const TrianglePositions& other) {
    if (sure_side(one[0], one[1], one[2], other[2]) != 0) return true;
    // nearly in one plane: on both sides of the edge they do not fold back
    constexpr double kRounding = 0x1p-40;
    const auto lengths = [](const TrianglePositions& t) {
        return length(minus(t[1], t[0])) * length(minus(t[2], t[0]));
    };
    const Position normal = polygon_normal(one), beyond = polygon_normal(other);
    return -dot(normal, beyond) > kRounding * lengths(one) * lengths(other);
}

/// Notes which triangles are not surely apart from some other one.
void note_meeting(const Cutter& cutter, const spatial::BoxTree& tree,
                  std::vector<std::uint8_t>& meets, const Execution& execution) {
    const auto note = [&meets](std::size_t t) {
        std::atomic_ref(meets[t]).store(1, std::memory_order_relaxed);
    };
    const auto does_meet = [&meets](std::size_t t) {
        return std::atomic_ref(meets[t]).load(std::memory_order_relaxed) != 0;
    };
    // of two that meet already nothing has to be asked: what is noted is the same in any order
    parallel_ranges(tree.leaf_count(), 1 << 6, execution, [&](std::size_t begin, std::size_t end) {
        tree.find_pairs(begin, end, [&](std::size_t i, std::size_t k) {
            const std::size_t one = index(tree.number_at(i)), other = index(tree.number_at(k));
            if ((does_meet(one) && does_meet(other)) ||
                are_surely_apart(cutter, cutter.triangles[one], cutter.triangles[other]))
                return;
            note(one);
            note(other);
        });
    });
}

}  // namespace

bool are_surely_apart(const Cutter& cutter, const Triangle& one, const Triangle& other) {
    // corners that both have come first, in the same order
    Triangle a = one, b = other;
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto* const same = std::find(b.begin() + shared, b.end(), a[i]);
        if (same == b.end()) continue;
        std::swap(b[shared], b[index(static_cast<std::int32_t>(same - b.begin()))]);
        std::swap(a[shared], a[i]);
        ++shared;
    }
    const auto corners = [&cutter](const Triangle& t) {
        return TrianglePositions{cutter.vertices[index(t[0])], cutter.vertices[index(t[1])],
                                 cutter.vertices[index(t[2])]};
    };
    const TrianglePositions of_a = corners(a), of_b = corners(b);
    if (shared < 2 && are_parted_between_middles(of_a, of_b, shared == 1)) return true;
    if (shared == 0)
        return is_beside_plane(of_a, of_b) || is_beside_plane(of_b, of_a) ||
               are_parted_along_edges(of_a, of_b);
    if (shared == 1) return are_parted_at_corner(of_a, of_b);
    return shared == 2 && are_parted_at_edge(of_a, of_b);
}

UndividedTriangles::UndividedTriangles(const Cutter& cutter, const spatial::BoxTree& tree,
                                       std::vector<std::uint8_t> meets,
                                       std::span<const std::int32_t> groups,
                                       const Execution& execution) {
    const std::size_t count = cutter.triangles.size();
    note_meeting(cutter, tree, meets, execution);
    const auto edges = arrangement::edges_of(
        count,
        cutter.vertices.size(), [&](std::size_t t) -> const auto& { return cutter.triangles[t]; },
        execution);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto uses = edges[e];
        if (uses.size() == 2 && uses[0].direction != uses[1].direction &&
            groups[index(uses[0].item)] == groups[index(uses[1].item)])
            continue;
        for (const arrangement::EdgeUse& use : uses)
            meets[index(use.item)] = 1;
    }
    DisjointSets joined(count);
    std::vector<std::uint8_t> has_border(count, 0);
    const auto for_each_pair = [&](const auto& visit) {
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const auto uses = edges[e];
            if (uses.size() != 2) continue;
            visit(uses[0], uses[1]);
            visit(uses[1], uses[0]);
        }
    };
    for_each_pair([&](const auto& use, const auto& beyond) {
        if (meets[index(use.item)] == 0 && meets[index(beyond.item)] == 0)
            joined.join(use.item, beyond.item);
    });
    for_each_pair([&](const auto& use, const auto& beyond) {
        if (meets[index(use.item)] == 0 && meets[index(beyond.item)] != 0)
            has_border[index(joined.find(use.item))] = 1;
    });
    const auto root = [&](std::size_t t) {
        return index(joined.find(static_cast<std::int32_t>(t)));
    };
    for (std::size_t t = 0; t < count; ++t) {
        if (meets[t] == 0 && root(t) == t && has_border[t] == 0) meets[t] = 1;
    }
    component_.assign(count, -1);
    std::vector<std::int32_t> number(count, -1);  // of roots, in the order of first triangles
    std::int32_t next = 0;
    for (std::size_t t = 0; t < count; ++t) {
        if (meets[t] != 0) continue;
        std::int32_t& component = number[root(t)];
        if (component < 0) component = next++;
        component_[t] = component;
    }
    triangles_ = bucketize<std::int32_t>(index(next), [&](const auto& put) {
        for (std::size_t t = 0; t < count; ++t) {
            if (component_[t] >= 0) put(index(component_[t]), static_cast<std::int32_t>(t));
        }
    });
    borders_ = bucketize<Border>(index(next), [&](const auto& put) {
        for_each_pair([&](const auto& use, const auto& beyond) {
            const std::int32_t component = component_[index(use.item)];
            if (component < 0 || component_[index(beyond.item)] >= 0) return;
            std::array<std::int32_t, 2> edge = use.edge;
            if (use.direction < 0) std::swap(edge[0], edge[1]);
            put(index(component), Border{use.item, beyond.item, edge});
        });
    });
}

}  // namespace realmodel::cutting
