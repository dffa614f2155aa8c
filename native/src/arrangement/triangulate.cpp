// SPDX-License-Identifier: GPL-3.0-or-later
// Regions in triangles, by cutting off ears, and in convex polygons, by merging triangles.
#include "arrangement/triangulate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "spatial/corner_grid.hpp"

namespace realmodel::arrangement {

namespace {

double twice_loop_area(const Loop& loop) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
        sum += twice_area(loop[0].at, loop[i].at, loop[i + 1].at);
    return sum;
}

/// A ring of corners that ears are cut from.
class Ring {
public:
    using Triangle = std::array<LoopCorner, 3>;

    Ring(const PlanePosition& rounding, const CornerTurns& turns, std::vector<Triangle>& triangles)
        : rounding_(rounding), turns_(turns), triangles_(triangles) {}

    /// @param sides  of its corners; ears on one side alone are cut off first. Empty: not known
    void take(const Loop& outline, std::span<const std::int8_t> sides = {}) {
        entry_ = append(outline);
        sides_ = sides;
    }
    /// `others`: loops that the bridge must not cross, the hole among them.
    void join_hole(const Loop& hole, std::span<const Loop> others);
    /// False where an ear had to be cut off that is none.
    bool cut_ears();

private:
    struct Link {
        LoopCorner corner;
        std::int32_t previous, next;
    };
    /// What is asked of an ear: less and less, as long as none is found.
    enum class EarTest {
        kOneSide,  ///< its corners are on one side, and it is fat
        kFat,      ///< it has an area whatever rounding does; no corner lies in it or just beyond
        kProper,   ///< it turns left; no corner that does not turn left lies in it or on its border
        kStrict,   ///< it turns left; no such corner lies in it
        kNone      ///< it has three different nodes
    };
    static constexpr std::size_t kGridFrom = 64;

    Link& link(std::int32_t i) { return links_[index(i)]; }
    const PlanePosition& at(std::int32_t i) { return link(i).corner.at; }
    NodeId node(std::int32_t i) { return link(i).corner.node; }

    std::int32_t append(const Loop& loop);
    std::int32_t find_bridge(const LoopCorner& from, std::span<const Loop> others);
    bool inside_corner(std::int32_t corner, const LoopCorner& p);
    bool is_hidden(const LoopCorner& p, const LoopCorner& q, std::span<const Loop> others);
    int turn(std::int32_t a, std::int32_t b, std::int32_t c) {
        return turns_(link(a).corner, link(b).corner, link(c).corner);
    }
    bool is_ear(std::int32_t tip, EarTest test);
    bool blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c, EarTest test);
    EarTest first_test() const { return sides_.empty() ? EarTest::kFat : EarTest::kOneSide; }
    void enter_corners();
    void remove(std::int32_t i);

    PlanePosition rounding_;
    const CornerTurns& turns_;
    std::vector<Triangle>& triangles_;
    std::vector<Link> links_;
    std::span<const std::int8_t> sides_;
    std::int32_t entry_ = -1;
    std::size_t count_ = 0;
    std::optional<spatial::CornerGrid> grid_;  ///< of the ring's corners, where they are many
};

std::int32_t Ring::append(const Loop& loop) {
    const auto first = static_cast<std::int32_t>(links_.size());
    const auto size = static_cast<std::int32_t>(loop.size());
    for (std::int32_t i = 0; i < size; ++i) {
        links_.push_back({loop[index(i)], first + (i + size - 1) % size, first + (i + 1) % size});
    }
    count_ += loop.size();
    return first;
}

/// Whether the way from a corner towards p begins inside of the ring.
bool Ring::inside_corner(std::int32_t corner, const LoopCorner& p) {
    const LoopCorner &a = link(link(corner).previous).corner, &b = link(corner).corner,
                     &c = link(link(corner).next).corner;
    if (turns_(a, b, c) > 0) return turns_(a, b, p) > 0 && turns_(b, c, p) > 0;
    return turns_(a, b, p) > 0 || turns_(b, c, p) > 0;
}

/// Whether an edge of the ring, or of the other loops, crosses the way from p to q or ends on it.
bool Ring::is_hidden(const LoopCorner& p, const LoopCorner& q, std::span<const Loop> others) {
    const auto crosses = [&](const LoopCorner& a, const LoopCorner& b) {
        for (std::size_t k = 0; k < 2; ++k) {
            if (std::max(a.at[k], b.at[k]) < std::min(p.at[k], q.at[k]) ||
                std::min(a.at[k], b.at[k]) > std::max(p.at[k], q.at[k]))
                return false;
        }
        const bool a_is_end = a.node == p.node || a.node == q.node;
        const bool b_is_end = b.node == p.node || b.node == q.node;
        if (a_is_end && b_is_end) return true;
        if (a_is_end || b_is_end) {  // only an edge along the way hides its other end
            const LoopCorner& other = a_is_end ? b : a;
            if (turns_(p, q, other) != 0) return false;
            for (std::size_t k = 0; k < 2; ++k) {
                if (p.at[k] != q.at[k])
                    return (other.at[k] > std::min(p.at[k], q.at[k])) &&
                           (other.at[k] < std::max(p.at[k], q.at[k]));
            }
            return false;
        }
        return turns_(p, q, a) * turns_(p, q, b) <= 0 && turns_(a, b, p) * turns_(a, b, q) <= 0;
    };
    std::int32_t i = entry_;
    do {
        if (crosses(link(i).corner, link(link(i).next).corner)) return true;
        i = link(i).next;
    } while (i != entry_);
    for (const Loop& loop : others) {
        for (std::size_t k = 0; k < loop.size(); ++k) {
            if (crosses(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0])) return true;
        }
    }
    return false;
}

/// The nearest corner of the ring that a hole's corner can be joined with.
std::int32_t Ring::find_bridge(const LoopCorner& from, std::span<const Loop> others) {
    std::vector<std::pair<double, std::int32_t>> nearest;
    std::int32_t i = entry_;
    do {
        if (node(i) == from.node) return i;  // the hole touches the ring
        nearest.push_back({distance(at(i), from.at), i});
        i = link(i).next;
    } while (i != entry_);
    std::sort(nearest.begin(), nearest.end());
    for (const auto& [way, corner] : nearest) {
        if (inside_corner(corner, from) && !is_hidden(from, link(corner).corner, others))
            return corner;
    }
    return nearest[0].second;  // rounding has put the hole over the outline
}

void Ring::join_hole(const Loop& hole, std::span<const Loop> others) {
    const auto leftmost = std::ranges::min_element(hole, {}, &LoopCorner::at);
    const std::int32_t outer = find_bridge(*leftmost, others);
    const std::int32_t inner = append(hole) + static_cast<std::int32_t>(leftmost - hole.begin());
    // both ends of the bridge stand in the ring twice, once for each of its sides
    const auto outer_again = static_cast<std::int32_t>(links_.size());
    links_.push_back(link(outer));
    const auto inner_again = static_cast<std::int32_t>(links_.size());
    links_.push_back(link(inner));
    count_ += 2;
    link(link(outer).next).previous = outer_again;
    link(link(inner).previous).next = inner_again;
    link(outer).next = inner;
    link(inner).previous = outer;
    link(inner_again).next = outer_again;
    link(outer_again).previous = inner_again;
}

void Ring::enter_corners() {
    if (count_ <= kGridFrom) return;
    std::vector<spatial::CornerGrid::Member> corners;
    std::int32_t i = entry_;
    do {
        corners.push_back({at(i), i});
        i = link(i).next;
    } while (i != entry_);
    grid_.emplace(std::move(corners), links_.size());
}

void Ring::remove(std::int32_t i) {
    const Link gone = link(i);
    link(gone.previous).next = gone.next;
    link(gone.next).previous = gone.previous;
    if (grid_) grid_->remove(i);
    --count_;
}

/// Whether a corner of the ring lies in the triangle a, tip, c, so that it cannot be cut off. At
/// first one is in the way, too, that rounding may have put just beyond an edge which it only
/// touches: what is left without that edge would be turned over.
bool Ring::blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c,
                  EarTest test) {
    if (other == a || other == tip || other == c) return false;
    const NodeId own = node(other);
    if (own == node(a) || own == node(tip) || own == node(c)) return false;
    const auto is_beyond = [&](std::int32_t p, std::int32_t q, int turned) {
        return turned < 0 &&
               (test != EarTest::kFat ||
                twice_area(at(p), at(q), at(other)) < -slack(at(p), at(q), at(other), rounding_));
    };
    const int ab = turn(a, tip, other);
    if (is_beyond(a, tip, ab)) return false;
    const int bc = turn(tip, c, other);
    if (is_beyond(tip, c, bc)) return false;
    const int ca = turn(c, a, other);
    if (is_beyond(c, a, ca)) return false;
    if (test == EarTest::kStrict && (ab == 0 || bc == 0 || ca == 0)) return false;
    // where a corner that turns left lies inside, one that does not lies inside as well
    return test == EarTest::kFat || turn(link(other).previous, other, link(other).next) <= 0;
}

bool Ring::is_ear(std::int32_t tip, EarTest test) {
    const std::int32_t a = link(tip).previous, c = link(tip).next;
    if (test == EarTest::kOneSide) {
        if (sides_[index(a)] != sides_[index(tip)] || sides_[index(tip)] != sides_[index(c)])
            return false;
        test = EarTest::kFat;
    }
    if (node(a) == node(tip) || node(tip) == node(c) || node(a) == node(c)) return false;
    if (test == EarTest::kNone) return true;
    if (turn(a, tip, c) <= 0) return false;
    if (test == EarTest::kFat &&
        twice_area(at(a), at(tip), at(c)) <= slack(at(a), at(tip), at(c), rounding_))
        return false;
    if (!grid_) {
        for (std::int32_t other = link(c).next; other != a; other = link(other).next) {
            if (blocks(other, a, tip, c, test)) return false;
        }
        return true;
    }
    // A little more than the triangle: what rounding may have put just beyond it counts, too.
    const auto outward = [&](std::int32_t i) {
        PlanePosition p = at(i);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double from_middle = 3 * p[axis] - at(a)[axis] - at(tip)[axis] - at(c)[axis];
            p[axis] += std::copysign(2 * rounding_[axis], from_middle);
        }
        return p;
    };
    return !grid_->any_in_triangle(outward(a), outward(tip), outward(c),
                                   [&](const spatial::CornerGrid::Member& other) {
                                       return blocks(other.number, a, tip, c, test);
                                   });
}

bool Ring::cut_ears() {
    bool clean = true;
    [[maybe_unused]] const std::size_t corners = count_ + triangles_.size();
    enter_corners();
    EarTest test = first_test();
    std::int32_t tip = entry_, stop = entry_;
    while (count_ > 2) {
        if (is_ear(tip, test)) {
            const std::int32_t a = link(tip).previous, c = link(tip).next;
            triangles_.push_back({link(a).corner, link(tip).corner, link(c).corner});
            clean = clean && test != EarTest::kNone;
            remove(tip);
            test = first_test();
            tip = stop = link(c).next;  // leaving out the next corner makes fewer needles
            continue;
        }
        tip = link(tip).next;
        if (tip != stop) continue;
        if (test != EarTest::kNone) {
            test = static_cast<EarTest>(static_cast<int>(test) + 1);
            continue;
        }
        clean = false;
        // Only paths that run back over themselves are left: from such a turn both edges go.
        while (node(tip) != node(link(tip).next) &&
               node(link(tip).previous) != node(link(tip).next))
            tip = link(tip).next;
        const std::int32_t beyond = link(tip).next;
        if (node(tip) != node(beyond)) remove(beyond);
        stop = link(beyond).next;
        remove(tip);
        tip = stop;
        test = first_test();
    }
    assert(!clean || triangles_.size() + 2 == corners);
    return clean;
}

bool contains(const Loop& loop, const LoopCorner& p, const CornerTurns& turns) {
    bool inside = false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const LoopCorner &a = loop[i], &b = loop[(i + 1) % loop.size()];
        if ((a.at[1] > p.at[1]) == (b.at[1] > p.at[1])) continue;
        if ((turns(a, b, p) > 0) == (b.at[1] > a.at[1])) inside = !inside;
    }
    return inside;
}

/// The outline of least area around a hole; the number of loops where there is none. What has some
/// area is a hole of the only outline even where rounding put its first corner just outside.
std::size_t outline_around(std::span<const Loop> loops, const std::vector<double>& areas,
                           std::size_t hole, const PlanePosition& rounding,
                           const CornerTurns& turns) {
    std::size_t found = loops.size(), only = loops.size(), outlines = 0;
    double allowed = 0;
    for (std::size_t i = 0; i < loops[hole].size(); ++i) {
        const PlanePosition &p = loops[hole][i].at,
                            &q = loops[hole][(i + 1) % loops[hole].size()].at;
        allowed += slack(p, q, q, rounding);
    }
    const LoopCorner& corner = *std::ranges::min_element(loops[hole], {}, &LoopCorner::at);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] <= 0) continue;
        ++outlines;
        only = i;
        const bool touches =
            std::ranges::find(loops[i], corner.node, &LoopCorner::node) != loops[i].end();
        if (!touches && !contains(loops[i], corner, turns)) continue;
        if (found == loops.size() || areas[i] < areas[found]) found = i;
    }
    if (found == loops.size() && outlines == 1 && areas[hole] < -allowed) return only;
    return found;
}

}  // namespace

int CornerTurns::operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const {
    return exact::orient2d(a.at, b.at, c.at);
}

bool triangulate_beside(const Loop& loop, std::span<const std::int8_t> sides,
                        const PlanePosition& rounding,
                        std::vector<std::array<LoopCorner, 3>>& triangles) {
    const CornerTurns turns;
    Ring ring(rounding, turns, triangles);
    ring.take(loop, sides);
    return ring.cut_ears();
}

bool triangulate(std::span<const Loop> loops, const PlanePosition& rounding,
                 std::vector<std::array<LoopCorner, 3>>& triangles, const CornerTurns& turns) {
    bool clean = true;
    std::vector<double> areas;
    for (const Loop& loop : loops)
        areas.push_back(twice_loop_area(loop));
    std::vector<std::vector<std::size_t>> holes(loops.size());
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] > 0) continue;
        const std::size_t outline = outline_around(loops, areas, i, rounding, turns);
        if (outline < loops.size()) {
            holes[outline].push_back(i);
        } else {
            clean = false;
            areas[i] = 1;  // no region around it: rounding has turned it over, so it is one itself
        }
    }
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] <= 0) continue;
        Ring ring(rounding, turns, triangles);
        ring.take(loops[i]);
        const auto left = [&](std::size_t hole) {
            return std::ranges::min_element(loops[hole], {}, &LoopCorner::at)->at;
        };
        std::sort(holes[i].begin(), holes[i].end(), [&](std::size_t a, std::size_t b) {
            return std::pair(left(a), a) < std::pair(left(b), b);
        });
        std::vector<Loop> others;
        for (const std::size_t hole : holes[i])
            others.push_back(loops[hole]);
        for (const std::size_t hole : holes[i])
            ring.join_hole(loops[hole], others);
        clean = ring.cut_ears() && clean;
    }
    return clean;
}

namespace {

/// Whether a loop turns left or goes straight on, up to rounding, at one of its corners: from the
/// last corner before that is not in the same position to the first after. Of a way that is not
/// much longer than rounding nobody knows where it points, so ways to corners farther off are
/// looked at, too.
bool left_or_straight(const Loop& loop, std::size_t corner, const PlanePosition& rounding) {
    const std::size_t n = loop.size();
    const PlanePosition& at = loop[corner].at;
    std::size_t before = (corner + n - 1) % n, after = (corner + 1) % n;
    PlanePosition near{4 * rounding[0], 4 * rounding[1]};
    for (int widened = 0; widened < 4; ++widened) {
        const auto is_apart = [&](std::size_t i) {
            return std::abs(loop[i].at[0] - at[0]) > near[0] ||
                   std::abs(loop[i].at[1] - at[1]) > near[1];
        };
        while (before != corner && !is_apart(before))
            before = (before + n - 1) % n;
        while (after != corner && !is_apart(after))
            after = (after + 1) % n;
        const PlanePosition &a = loop[before].at, &c = loop[after].at;
        if (twice_area(a, at, c) < -slack(a, at, c, rounding)) return false;
        near.fill(64 * std::max(near[0], near[1]));
    }
    return true;
}

/// Whether the corners of a loop go there and back once along an axis, up to rounding. One that
/// turns left or goes straight on everywhere may still run back along itself, or wind round twice.
bool goes_there_and_back(const Loop& loop, std::size_t axis, const PlanePosition& rounding) {
    int changes = 0;
    double last = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const double step = loop[(i + 1) % loop.size()].at[axis] - loop[i].at[axis];
        if (std::abs(step) <= rounding[axis]) continue;
        if (last != 0 && (step > 0) != (last > 0)) ++changes;
        last = step;
    }
    return changes <= 2;
}

/// Convex polygons grown from triangles.
class Merger {
public:
    Merger(const std::vector<std::array<LoopCorner, 3>>& triangles, const PlanePosition& rounding)
        : rounding_(rounding), owner_(triangles.size()) {
        std::iota(owner_.begin(), owner_.end(), 0);
        for (const auto& t : triangles)
            polygons_.push_back({t.begin(), t.end()});
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const NodeId a = triangles[t][i].node, b = triangles[t][(i + 1) % 3].node;
                edges_.push_back({unordered(a, b), static_cast<std::int32_t>(t), a < b});
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    void merge(std::span<const std::array<NodeId, 2>> slits) {
        for (const auto uses : groups_of(edges_, &TriangleEdge::ends)) {
            if (uses.size() != 2 || uses[0].forward == uses[1].forward) continue;
            const auto& ends = uses[0].ends;
            if (std::binary_search(slits.begin(), slits.end(), ends)) continue;
            join(find(uses[0].triangle), find(uses[1].triangle), ends);
        }
    }

    void write(Polygons& result) {
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            if (find(static_cast<std::int32_t>(i)) != static_cast<std::int32_t>(i)) continue;
            for (const LoopCorner& c : polygons_[i])
                result.nodes.push_back(c.node);
            result.close();
        }
    }

private:
    struct TriangleEdge {
        std::array<NodeId, 2> ends;  ///< lesser, greater
        std::int32_t triangle;
        bool forward;
        auto operator<=>(const TriangleEdge&) const = default;
    };

    std::int32_t find(std::int32_t i) {
        while (owner_[index(i)] != i)
            i = owner_[index(i)] = owner_[index(owner_[index(i)])];
        return i;
    }

    void join(std::int32_t one, std::int32_t two, const std::array<NodeId, 2>& edge) {
        if (one == two) return;
        const Loop &a = polygons_[index(one)], &b = polygons_[index(two)];
        // the shared edge runs from a[i] to its next, and against that in b from j to its next
        const auto find_edge = [&edge](const Loop& loop) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                if (unordered(loop[i].node, loop[(i + 1) % loop.size()].node) == edge) return i;
            }
            return loop.size();
        };
        const std::size_t i = find_edge(a), j = find_edge(b);
        if (i == a.size() || j == b.size()) return;
        Loop merged;
        for (std::size_t k = 1; k <= a.size(); ++k)
            merged.push_back(a[(i + k) % a.size()]);
        const std::size_t seam = merged.size() - 1;
        for (std::size_t k = 2; k < b.size(); ++k)
            merged.push_back(b[(j + k) % b.size()]);
        const std::size_t n = merged.size();
        if (!left_or_straight(merged, 0, rounding_) || !left_or_straight(merged, seam, rounding_))
            return;
        if (!goes_there_and_back(merged, 0, rounding_) ||
            !goes_there_and_back(merged, 1, rounding_))
            return;
        for (std::size_t k = seam + 1; k < n; ++k) {
            for (std::size_t l = 0; l <= seam; ++l) {
                if (merged[k].node == merged[l].node) return;
            }
        }
        polygons_[index(one)] = std::move(merged);
        polygons_[index(two)].clear();
        owner_[index(two)] = one;
    }

    PlanePosition rounding_;
    std::vector<std::int32_t> owner_;
    std::vector<Loop> polygons_;
    std::vector<TriangleEdge> edges_;
};

}  // namespace

bool is_convex(const Loop& loop, const PlanePosition& rounding) {
    const std::size_t n = loop.size();
    if (n < 3) return false;
    for (std::size_t i = 0; i < n; ++i) {
        if (!left_or_straight(loop, i, rounding)) return false;
    }
    if (!goes_there_and_back(loop, 0, rounding) || !goes_there_and_back(loop, 1, rounding))
        return false;
    return !has_repeated(loop, &LoopCorner::node);
}

bool divide_convex(std::span<const Loop> loops, const PlanePosition& rounding,
                   std::span<const std::array<NodeId, 2>> slits, Polygons& result,
                   const CornerTurns& turns) {
    if (loops.size() == 1 && is_convex(loops[0], rounding)) {
        for (const LoopCorner& c : loops[0])
            result.nodes.push_back(c.node);
        result.close();
        return true;
    }
    std::vector<std::array<LoopCorner, 3>> triangles;
    const bool clean = triangulate(loops, rounding, triangles, turns);
    Merger merger(triangles, rounding);
    merger.merge(slits);
    merger.write(result);
    return clean;
}

}  // namespace realmodel::arrangement
