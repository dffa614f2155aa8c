// SPDX-License-Identifier: GPL-3.0-or-later
#include "triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "realmodel/exact/turn.hpp"

namespace realmodel::cutting {

namespace {

double cross(const PlanePosition& a, const PlanePosition& b, const PlanePosition& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double length(const PlanePosition& a, const PlanePosition& b) {
    return std::hypot(b[0] - a[0], b[1] - a[1]);
}

double twice_area(const Loop& loop) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
        sum += cross(loop[0].at, loop[i].at, loop[i + 1].at);
    return sum;
}

/// A ring of corners that ears are cut from.
class Ring {
public:
    using Triangle = std::array<LoopCorner, 3>;

    Ring(double rounding, std::vector<Triangle>& triangles)
        : rounding_(rounding), triangles_(triangles) {}

    void take(const Loop& outline) { entry_ = append(outline); }
    void join_hole(const Loop& hole);
    void cut_ears();

private:
    struct Link {
        LoopCorner corner;
        std::int32_t previous, next;
        std::uint32_t curve = 0;  ///< place along the space-filling curve
        std::int32_t curve_previous = -1, curve_next = -1;
    };
    enum class Care { kFat, kProper, kStrict, kNone };
    static constexpr std::size_t kFew = 64;

    Link& link(std::int32_t i) { return links_[index(i)]; }
    const PlanePosition& at(std::int32_t i) { return link(i).corner.at; }
    NodeId node(std::int32_t i) { return link(i).corner.node; }

    std::int32_t append(const Loop& loop);
    std::int32_t find_bridge(const PlanePosition& from);
    bool inside_corner(std::int32_t corner, const PlanePosition& p);
    bool is_ear(std::int32_t tip, Care care);
    bool blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c, Care care);
    void lay_curve();
    std::uint32_t curve_value(const PlanePosition& p) const;
    void remove(std::int32_t i);

    double rounding_;
    std::vector<Triangle>& triangles_;
    std::vector<Link> links_;
    std::int32_t entry_ = -1;
    std::size_t count_ = 0;
    bool has_curve_ = false;
    PlanePosition low_{}, scale_{};
};

std::int32_t Ring::append(const Loop& loop) {
    const auto first = static_cast<std::int32_t>(links_.size());
    const auto size = static_cast<std::int32_t>(loop.size());
    for (std::int32_t i = 0; i < size; ++i) {
        links_.push_back(
            {loop[index(i)], first + (i + size - 1) % size, first + (i + 1) % size, 0, -1, -1});
    }
    count_ += loop.size();
    return first;
}

/// Whether the way from a corner towards p begins inside of the ring.
bool Ring::inside_corner(std::int32_t corner, const PlanePosition& p) {
    const PlanePosition &a = at(link(corner).previous), &b = at(corner), &c = at(link(corner).next);
    if (exact::turn(a, b, c) > 0) return exact::turn(a, b, p) > 0 && exact::turn(b, c, p) > 0;
    return exact::turn(a, b, p) > 0 || exact::turn(b, c, p) > 0;
}

/// The corner that a hole's leftmost corner can be joined with: seen from there to the left, the
/// edge that is met first, and of its left end and what hides it the corner nearest in direction.
std::int32_t Ring::find_bridge(const PlanePosition& from) {
    std::int32_t best = -1;
    double met = -HUGE_VAL;
    std::int32_t i = entry_;
    do {
        const PlanePosition &p = at(i), &q = at(link(i).next);
        if (from[1] <= p[1] && from[1] >= q[1] && p[1] != q[1]) {  // runs down, has its left inside
            const double x = p[0] + (from[1] - p[1]) * (q[0] - p[0]) / (q[1] - p[1]);
            if (x <= from[0] && x > met) {
                met = x;
                best = p[0] < q[0] ? i : link(i).next;
            }
        }
        i = link(i).next;
    } while (i != entry_);
    if (best < 0) return entry_;
    const PlanePosition target = at(best), hit{met, from[1]};
    const bool target_below = target[1] < from[1];
    double flattest = HUGE_VAL;
    std::int32_t chosen = best;
    i = entry_;
    do {
        const PlanePosition& p = at(i);
        if (p[0] <= from[0] && p[0] >= target[0] && p != from) {
            const PlanePosition &a = target_below ? from : hit, &b = target_below ? hit : from;
            const bool within = exact::turn(a, b, p) >= 0 && exact::turn(b, target, p) >= 0 &&
                                exact::turn(target, a, p) >= 0;
            if (within && inside_corner(i, from)) {
                const double slope = std::abs(from[1] - p[1]) / (from[0] - p[0]);
                if (slope < flattest || (slope == flattest && p[0] > at(chosen)[0])) {
                    flattest = slope;
                    chosen = i;
                }
            }
        }
        i = link(i).next;
    } while (i != entry_);
    return chosen;
}

void Ring::join_hole(const Loop& hole) {
    std::size_t leftmost = 0;
    for (std::size_t i = 1; i < hole.size(); ++i) {
        if (hole[i].at < hole[leftmost].at) leftmost = i;
    }
    const std::int32_t outer = find_bridge(hole[leftmost].at);
    const std::int32_t inner = append(hole) + static_cast<std::int32_t>(leftmost);
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

std::uint32_t Ring::curve_value(const PlanePosition& p) const {
    std::uint32_t value = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        auto bits = static_cast<std::uint32_t>((p[axis] - low_[axis]) * scale_[axis]) & 0x7fffU;
        bits = (bits | (bits << 8)) & 0x00ff00ffU;
        bits = (bits | (bits << 4)) & 0x0f0f0f0fU;
        bits = (bits | (bits << 2)) & 0x33333333U;
        bits = (bits | (bits << 1)) & 0x55555555U;
        value |= bits << axis;
    }
    return value;
}

void Ring::lay_curve() {
    has_curve_ = count_ > kFew;
    if (!has_curve_) return;
    std::vector<std::int32_t> order;
    PlanePosition high{-HUGE_VAL, -HUGE_VAL};
    low_ = {HUGE_VAL, HUGE_VAL};
    std::int32_t i = entry_;
    do {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low_[axis] = std::min(low_[axis], at(i)[axis]);
            high[axis] = std::max(high[axis], at(i)[axis]);
        }
        order.push_back(i);
        i = link(i).next;
    } while (i != entry_);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        scale_[axis] = high[axis] > low_[axis] ? 32767.0 / (high[axis] - low_[axis]) : 0.0;
    }
    for (const std::int32_t k : order)
        link(k).curve = curve_value(at(k));
    std::stable_sort(order.begin(), order.end(), [this](std::int32_t a, std::int32_t b) {
        return link(a).curve < link(b).curve;
    });
    for (std::size_t k = 1; k < order.size(); ++k) {
        link(order[k - 1]).curve_next = order[k];
        link(order[k]).curve_previous = order[k - 1];
    }
}

void Ring::remove(std::int32_t i) {
    const Link gone = link(i);
    link(gone.previous).next = gone.next;
    link(gone.next).previous = gone.previous;
    if (gone.curve_previous >= 0) link(gone.curve_previous).curve_next = gone.curve_next;
    if (gone.curve_next >= 0) link(gone.curve_next).curve_previous = gone.curve_previous;
    --count_;
}

/// Whether a corner of the ring lies in the triangle a, tip, c, so that it cannot be cut off.
bool Ring::blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c, Care care) {
    if (other == a || other == tip || other == c) return false;
    const NodeId own = node(other);
    if (own == node(a) || own == node(tip) || own == node(c)) return false;
    const PlanePosition& p = at(other);
    const int ab = exact::turn(at(a), at(tip), p);
    if (ab < 0) return false;
    const int bc = exact::turn(at(tip), at(c), p);
    if (bc < 0) return false;
    const int ca = exact::turn(at(c), at(a), p);
    if (ca < 0) return false;
    if (care == Care::kStrict && (ab == 0 || bc == 0 || ca == 0)) return false;
    // where a corner that turns left lies inside, one that does not lies inside as well
    return exact::turn(at(link(other).previous), p, at(link(other).next)) <= 0;
}

bool Ring::is_ear(std::int32_t tip, Care care) {
    const std::int32_t a = link(tip).previous, c = link(tip).next;
    if (node(a) == node(tip) || node(tip) == node(c) || node(a) == node(c)) return false;
    if (care == Care::kNone) return true;
    if (exact::turn(at(a), at(tip), at(c)) <= 0) return false;
    if (care == Care::kFat) {
        const double longest =
            std::max({length(at(a), at(tip)), length(at(tip), at(c)), length(at(c), at(a))});
        if (cross(at(a), at(tip), at(c)) <= rounding_ * longest) return false;
    }
    if (!has_curve_) {
        for (std::int32_t other = link(c).next; other != a; other = link(other).next) {
            if (blocks(other, a, tip, c, care)) return false;
        }
        return true;
    }
    PlanePosition low = at(a), high = at(a);
    for (const std::int32_t k : {tip, c}) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], at(k)[axis]);
            high[axis] = std::max(high[axis], at(k)[axis]);
        }
    }
    const std::uint32_t first = curve_value(low), last = curve_value(high);
    for (std::int32_t k = tip; k >= 0 && link(k).curve >= first; k = link(k).curve_previous) {
        if (blocks(k, a, tip, c, care)) return false;
    }
    for (std::int32_t k = tip; k >= 0 && link(k).curve <= last; k = link(k).curve_next) {
        if (blocks(k, a, tip, c, care)) return false;
    }
    return true;
}

void Ring::cut_ears() {
    lay_curve();
    Care care = Care::kFat;
    std::int32_t tip = entry_, stop = entry_;
    while (count_ > 2) {
        if (is_ear(tip, care)) {
            const std::int32_t a = link(tip).previous, c = link(tip).next;
            triangles_.push_back({link(a).corner, link(tip).corner, link(c).corner});
            remove(tip);
            care = Care::kFat;
            tip = stop = link(c).next;  // leaving out the next corner makes fewer needles
            continue;
        }
        tip = link(tip).next;
        if (tip != stop) continue;
        if (care != Care::kNone) {
            care = static_cast<Care>(static_cast<int>(care) + 1);
            continue;
        }
        // Only paths that run back over themselves are left: from such a turn both edges go.
        while (node(tip) != node(link(tip).next) &&
               node(link(tip).previous) != node(link(tip).next))
            tip = link(tip).next;
        const std::int32_t beyond = link(tip).next;
        if (node(tip) != node(beyond)) remove(beyond);
        stop = link(beyond).next;
        remove(tip);
        tip = stop;
        care = Care::kFat;
    }
}

bool left_or_straight(const PlanePosition& a, const PlanePosition& b, const PlanePosition& c,
                      double rounding) {
    return cross(a, b, c) >= -rounding * std::max(length(a, b), length(b, c));
}

bool contains(const Loop& loop, const PlanePosition& p) {
    bool inside = false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const PlanePosition &a = loop[i].at, &b = loop[(i + 1) % loop.size()].at;
        if ((a[1] > p[1]) == (b[1] > p[1])) continue;
        if ((exact::turn(a, b, p) > 0) == (b[1] > a[1])) inside = !inside;
    }
    return inside;
}

/// The outline of least area around a hole; the number of loops where there is none. What has some
/// area is a hole of the only outline even where rounding put its first corner just outside.
std::size_t outline_around(std::span<const Loop> loops, const std::vector<double>& areas,
                           std::size_t hole, double rounding) {
    std::size_t found = loops.size(), only = loops.size(), outlines = 0;
    double around = 0;
    for (std::size_t i = 0; i < loops[hole].size(); ++i)
        around += length(loops[hole][i].at, loops[hole][(i + 1) % loops[hole].size()].at);
    const LoopCorner& corner =
        *std::min_element(loops[hole].begin(), loops[hole].end(),
                          [](const LoopCorner& a, const LoopCorner& b) { return a.at < b.at; });
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] <= 0) continue;
        ++outlines;
        only = i;
        const bool touches = std::any_of(loops[i].begin(), loops[i].end(),
                                         [&](const auto& c) { return c.node == corner.node; });
        if (!touches && !contains(loops[i], corner.at)) continue;
        if (found == loops.size() || areas[i] < areas[found]) found = i;
    }
    if (found == loops.size() && outlines == 1 && areas[hole] < -rounding * around) return only;
    return found;
}

/// Convex polygons grown from triangles.
class Merger {
public:
    Merger(const std::vector<std::array<LoopCorner, 3>>& triangles, double rounding)
        : rounding_(rounding), owner_(triangles.size()) {
        std::iota(owner_.begin(), owner_.end(), 0);
        for (const auto& t : triangles)
            polygons_.push_back({t.begin(), t.end()});
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const NodeId a = triangles[t][i].node, b = triangles[t][(i + 1) % 3].node;
                edges_.push_back(
                    {std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    void merge(std::span<const std::array<NodeId, 2>> slits) {
        for (std::size_t i = 0; i + 1 < edges_.size(); ++i) {
            const Edge &e = edges_[i], &f = edges_[i + 1];
            if (e.low != f.low || e.high != f.high) continue;
            const bool pair = (i == 0 || !same(edges_[i - 1], e)) &&
                              (i + 2 == edges_.size() || !same(edges_[i + 2], e));
            if (!pair || e.forward == f.forward) continue;
            if (std::binary_search(slits.begin(), slits.end(), std::array{e.low, e.high})) continue;
            join(find(e.triangle), find(f.triangle), e.low, e.high);
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
    struct Edge {
        NodeId low, high;
        std::int32_t triangle;
        bool forward;
        auto operator<=>(const Edge&) const = default;
    };
    static bool same(const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; }

    std::int32_t find(std::int32_t i) {
        while (owner_[index(i)] != i)
            i = owner_[index(i)] = owner_[index(owner_[index(i)])];
        return i;
    }

    void join(std::int32_t one, std::int32_t two, NodeId p, NodeId q) {
        if (one == two) return;
        const Loop &a = polygons_[index(one)], &b = polygons_[index(two)];
        // the shared edge runs from a[i] to its next, and against that in b from j to its next
        const auto find_edge = [p, q](const Loop& loop) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const NodeId m = loop[i].node, n = loop[(i + 1) % loop.size()].node;
                if ((m == p && n == q) || (m == q && n == p)) return i;
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
        const auto turns = [&](std::size_t k) {
            return left_or_straight(merged[(k + n - 1) % n].at, merged[k].at,
                                    merged[(k + 1) % n].at, rounding_);
        };
        if (!turns(0) || !turns(seam)) return;
        for (std::size_t k = seam + 1; k < n; ++k) {
            for (std::size_t l = 0; l <= seam; ++l) {
                if (merged[k].node == merged[l].node) return;
            }
        }
        polygons_[index(one)] = std::move(merged);
        polygons_[index(two)].clear();
        owner_[index(two)] = one;
    }

    double rounding_;
    std::vector<std::int32_t> owner_;
    std::vector<Loop> polygons_;
    std::vector<Edge> edges_;
};

}  // namespace

bool is_convex(const Loop& loop, double rounding) {
    const std::size_t n = loop.size();
    if (n < 3) return false;
    // Turning left everywhere may still wind round twice: along a convex loop the x rise once only.
    int changes = 0;
    double last = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const PlanePosition &a = loop[i].at, &b = loop[(i + 1) % n].at, &c = loop[(i + 2) % n].at;
        if (!left_or_straight(a, b, c, rounding)) return false;
        const double step = b[0] - a[0];
        if (std::abs(step) <= rounding) continue;
        if (last != 0 && (step > 0) != (last > 0)) ++changes;
        last = step;
    }
    if (changes > 2) return false;
    std::vector<NodeId> nodes;
    for (const LoopCorner& c : loop)
        nodes.push_back(c.node);
    std::sort(nodes.begin(), nodes.end());
    return std::adjacent_find(nodes.begin(), nodes.end()) == nodes.end();
}

void triangulate(std::span<const Loop> loops, double rounding,
                 std::vector<std::array<LoopCorner, 3>>& triangles) {
    std::vector<double> areas;
    for (const Loop& loop : loops)
        areas.push_back(twice_area(loop));
    std::vector<std::vector<std::size_t>> holes(loops.size());
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] > 0) continue;
        const std::size_t outline = outline_around(loops, areas, i, rounding);
        if (outline < loops.size()) {
            holes[outline].push_back(i);
        } else {
            areas[i] = 1;  // no region around it: rounding has turned it over, so it is one itself
        }
    }
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (areas[i] <= 0) continue;
        Ring ring(rounding, triangles);
        ring.take(loops[i]);
        const auto left = [&](std::size_t hole) {
            return std::min_element(
                       loops[hole].begin(), loops[hole].end(),
                       [](const LoopCorner& a, const LoopCorner& b) { return a.at < b.at; })
                ->at;
        };
        std::sort(holes[i].begin(), holes[i].end(), [&](std::size_t a, std::size_t b) {
            return std::pair(left(a), a) < std::pair(left(b), b);
        });
        for (const std::size_t hole : holes[i])
            ring.join_hole(loops[hole]);
        ring.cut_ears();
    }
}

void divide_convex(std::span<const Loop> loops, double rounding,
                   std::span<const std::array<NodeId, 2>> slits, Polygons& result) {
    if (loops.size() == 1 && is_convex(loops[0], rounding)) {
        for (const LoopCorner& c : loops[0])
            result.nodes.push_back(c.node);
        result.close();
        return;
    }
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(loops, rounding, triangles);
    Merger merger(triangles, rounding);
    merger.merge(slits);
    merger.write(result);
}

}  // namespace realmodel::cutting
