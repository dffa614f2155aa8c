// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/ring_graph.hpp"
#include "realmodel/meshing/rings.hpp"
#include "spatial/corner_grid.hpp"

namespace realmodel::meshing {

namespace {

/// A corner in a ring, and the edge from it to the next.
struct EarNode {
    PlanPoint place;
    std::int32_t corner;
    std::int32_t previous, next;
    std::int32_t twin = -1;              ///< for a bridge: the node whose edge runs the other way
    HalfEdge behind = HalfEdge::none();  ///< what lies behind the edge, once it is known
    HalfEdge placed = HalfEdge::none();  ///< for a bridge: the edge that was made of its edge
};

/// The rings of a polygon, the outline counter-clockwise and holes clockwise, joined into one.
class EarRing {
public:
    /// Corners are numbered through the rings.
    explicit EarRing(std::span<const Ring> rings) {
        std::size_t corners = 0;
        for (const Ring& ring : rings)
            corners += ring.size();
        nodes.reserve(corners + 2 * rings.size());
        std::int32_t first_corner = 0;
        for (std::size_t r = 0; r < rings.size(); ++r) {
            const std::int32_t node = add_ring(rings[r], first_corner, r == 0);
            if (r == 0) {
                outline_ = node;
            } else {
                holes_.push_back(node);
            }
            first_corner += static_cast<std::int32_t>(rings[r].size());
        }
    }

    /// Joins the holes to the outline. False where a bridge cannot be told from the rounding of
    /// what it has to pass.
    bool join_holes() {
        if (holes_.empty()) return true;
        low_ = std::numeric_limits<double>::infinity();
        double high = -low_;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            low_ = std::min(low_, place(static_cast<std::int32_t>(n))[1]);
            high = std::max(high, place(static_cast<std::int32_t>(n))[1]);
        }
        rows_.resize(std::clamp<std::size_t>(nodes.size() / 8, 1, 4096));
        row_height_ = (high - low_) / static_cast<double>(rows_.size());
        if (!(row_height_ > 0)) return false;
        std::int32_t node = outline_;
        do {
            enter_rows(node);
            node = nodes[node].next;
        } while (node != outline_);
        // What lies left of a hole is joined before it.
        std::ranges::sort(holes_, {}, [&](std::int32_t n) { return std::pair(place(n), n); });
        for (const std::int32_t hole : holes_) {
            const std::int32_t bridge = find_bridge(hole);
            if (bridge < 0) return false;
            join(hole, bridge);
        }
        return true;
    }

    std::vector<EarNode> nodes;
    std::int32_t first() const { return outline_; }
    const PlanPoint& place(std::int32_t node) const { return nodes[node].place; }
    /// Whether the way from a node towards a place begins inside of the ring. Exact.
    bool opens_towards(std::int32_t node, const PlanPoint& p) const {
        const PlanPoint &a = place(nodes[node].previous), &b = place(node),
                        &c = place(nodes[node].next);
        const bool left_of_first = orient2d(a, b, p) > 0, left_of_second = orient2d(b, c, p) > 0;
        return orient2d(a, b, c) > 0 ? left_of_first && left_of_second
                                     : left_of_first || left_of_second;
    }

private:
    /// Returns the ring's leftmost node, the lowest of those.
    std::int32_t add_ring(const Ring& ring, std::int32_t first_corner, bool is_outline) {
        double area = 0;
        for (std::size_t i = 0; i + 1 < ring.size(); ++i)
            area += twice_area(ring[0], ring[i], ring[i + 1]);
        const bool turns = is_outline ? area < 0 : area > 0;
        const auto begin = static_cast<std::int32_t>(nodes.size());
        const auto count = static_cast<std::int32_t>(ring.size());
        for (std::int32_t i = 0; i < count; ++i) {
            const std::int32_t corner = turns ? count - 1 - i : i;
            const auto here = static_cast<std::int32_t>(nodes.size());
            if (here > begin && place(here - 1) == ring[corner]) continue;
            nodes.push_back({ring[corner], first_corner + corner, here - 1, here + 1});
        }
        while (static_cast<std::int32_t>(nodes.size()) > begin + 1 &&
               place(static_cast<std::int32_t>(nodes.size()) - 1) == place(begin)) {
            nodes.pop_back();
        }
        const auto last = static_cast<std::int32_t>(nodes.size()) - 1;
        nodes[begin].previous = last;
        nodes[last].next = begin;
        std::int32_t leftmost = begin;
        for (std::int32_t n = begin; n <= last; ++n)
            if (place(n) < place(leftmost)) leftmost = n;
        return leftmost;
    }

    /// The node that a hole's leftmost corner can see: left of it, the edge met first, and of its
    /// lower left end and the corners that hide that the one nearest in direction.
    std::int32_t find_bridge(std::int32_t hole) const {
        const PlanPoint& from = place(hole);
        // Where the hole touches what is joined already, no bridge is needed.
        const PlanPoint& ahead = place(nodes[hole].next);
        double met = -std::numeric_limits<double>::infinity();
        std::int32_t edge = -1;
        for (const std::int32_t n : rows_[row_of(from[1])]) {
            const std::int32_t m = nodes[n].next;
            const PlanPoint &a = place(n), &b = place(m);
            if (a == from && opens_towards(n, ahead)) return n;
            // The ring lies right of edges that run down.
            if (a[1] < from[1] || b[1] > from[1] || a[1] == b[1]) continue;
            if (a[0] > from[0] && b[0] > from[0]) continue;
            if (orient2d(a, b, from) < 0) continue;  // it is right of here
            const double x = a[0] + (from[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            if (x > met) {
                met = x;
                edge = n;
            }
        }
        if (edge < 0) return -1;
        const std::int32_t end = nodes[edge].next;
        std::int32_t best = place(edge)[0] < place(end)[0] ? edge : end;
        if (met >= from[0]) return -1;  // it touches an edge between its corners
        const PlanPoint hit{met, from[1]}, goal = place(best);
        // Corners in the triangle between here, the edge and its end hide that end.
        const auto slope = [&](const PlanPoint& p) {
            return std::abs(p[1] - from[1]) / (from[0] - p[0]);
        };
        const bool is_above = goal[1] > from[1];
        double least = std::numeric_limits<double>::infinity();
        std::int32_t nearest = -1;
        const auto consider = [&](std::int32_t n) {
            const PlanPoint& p = place(n);
            if (p[0] >= from[0] || p[0] < std::min(goal[0], met)) return;
            const int below = is_above ? orient2d(from, goal, p) : orient2d(goal, from, p);
            const int above = is_above ? orient2d(hit, goal, p) : orient2d(goal, hit, p);
            const bool within =
                p == goal || (p[1] == from[1] && p[0] > met) ||
                (below >= 0 && above <= 0 && (is_above ? p[1] >= from[1] : p[1] <= from[1]));
            if (!within || !opens_towards(n, from)) return;
            const double steepness = slope(p);
            const bool is_nearer = steepness == least && nearest >= 0 && place(nearest)[0] < p[0];
            if (steepness < least || is_nearer) {
                least = steepness;
                nearest = n;
            }
        };
        const std::size_t row = row_of(from[1]), goal_row = row_of(goal[1]);
        for (std::size_t r = std::min(row, goal_row); r <= std::max(row, goal_row); ++r)
            for (const std::int32_t n : rows_[r])
                consider(n);
        return nearest;
    }

    void join(std::int32_t hole, std::int32_t outline) {
        std::int32_t node = hole;
        do {
            enter_rows(node);
            node = nodes[node].next;
        } while (node != hole);
        if (place(hole) == place(outline)) {  // the two take each other's way on
            std::swap(nodes[hole].next, nodes[outline].next);
            std::swap(nodes[hole].twin, nodes[outline].twin);
            for (const std::int32_t n : {hole, outline}) {
                nodes[nodes[n].next].previous = n;
                if (nodes[n].twin >= 0) nodes[nodes[n].twin].twin = n;
                enter_rows(n);
            }
            return;
        }
        // outline -> hole ... round it ... hole again -> outline again -> on
        const auto hole_again = static_cast<std::int32_t>(nodes.size());
        const std::int32_t outline_again = hole_again + 1;
        nodes.push_back(nodes[hole]);
        nodes.push_back(nodes[outline]);
        EarNode &h = nodes[hole_again], &o = nodes[outline_again];
        nodes[h.previous].next = hole_again;
        h.next = outline_again;
        o.previous = hole_again;
        nodes[o.next].previous = outline_again;
        if (o.twin >= 0) nodes[o.twin].twin = outline_again;
        nodes[outline].next = hole;
        nodes[hole].previous = outline;
        nodes[outline].twin = hole_again;
        h.twin = outline;
        enter_rows(outline);
        enter_rows(hole_again);
        enter_rows(outline_again);
    }

    void enter_rows(std::int32_t node) {
        const double y = place(node)[1], z = place(nodes[node].next)[1];
        for (std::size_t row = row_of(std::min(y, z)); row <= row_of(std::max(y, z)); ++row)
            rows_[row].push_back(node);
    }

    std::size_t row_of(double y) const {
        const double row = std::floor((y - low_) / row_height_);
        return static_cast<std::size_t>(
            std::clamp(row, 0.0, static_cast<double>(rows_.size() - 1)));
    }

    std::int32_t outline_ = -1;
    std::vector<std::int32_t> holes_;  ///< a leftmost node of each
    // Nodes by the rows of the plan that their edges pass.
    std::vector<std::vector<std::int32_t>> rows_;
    double low_ = 0, row_height_ = 1;
};

using Triangles = std::vector<std::array<std::int32_t, 3>>;

std::vector<PlanPoint> corners_of(std::span<const Ring> rings) {
    std::vector<PlanPoint> corners;
    for (const Ring& ring : rings)
        corners.insert(corners.end(), ring.begin(), ring.end());
    return corners;
}

/// Cuts ears off a ring until a triangle is left.
class Clipping {
public:
    Clipping(EarRing& ring, std::vector<PlanPoint> corners, const Check& check)
        : ring_(ring), check_(check), tips_(ring.nodes.size()) {
        mesh_.points = std::move(corners);
        mesh_.corners.reserve(ring.nodes.size());
        mesh_.twins.reserve(ring.nodes.size());
        mesh_.marks.reserve(ring.nodes.size());
        queue_.reserve(2 * ring.nodes.size());
    }

    /// False where no ear is left.
    bool run() {
        spatial::CornerGrid grid = take_corners();
        std::int32_t tip = ring_.first();
        for (const bool is_choosy : {true, false}) {
            queue_.clear();
            const std::int32_t begin = tip;
            do {
                enqueue(tip);
                tip = ring_.nodes[tip].next;
            } while (tip != begin);
            tip = cut_ears(grid, is_choosy, begin);
        }
        if (left_ > 3 || tips_[tip].turn <= 0) return false;
        const EarNode& node = ring_.nodes[tip];
        const std::int32_t t = add(node.previous, tip, node.next);
        place({t, 2}, node.next);
        return true;
    }

    Triangles swapped() {
        Ticker tick(check_);
        std::vector<HalfEdge> open;
        // All are asked before the first is flipped: then no answer waits for another.
        mesh_.for_each_edge([&](HalfEdge edge) {
            tick(0);
            if (mesh_.twin(edge).triangle() > edge.triangle() && mesh_.should_flip(edge))
                open.push_back(edge);
        });
        mesh_.legalize(open);
        return std::move(mesh_.corners);
    }

private:
    static constexpr std::int32_t kNone = -1;

    int turn_at(std::int32_t node) const {
        const EarNode& n = ring_.nodes[node];
        return orient2d(ring_.place(n.previous), n.place, ring_.place(n.next));
    }

    /// Only corners that do not turn left can hide in an ear: of those that lie in it, the one
    /// farthest from its diagonal turns right or not at all.
    spatial::CornerGrid take_corners() {
        std::vector<spatial::CornerGrid::Member> hiding;
        std::int32_t node = ring_.first();
        do {
            tips_[node].turn = static_cast<std::int8_t>(turn_at(node));
            if (tips_[node].turn <= 0) hiding.push_back({ring_.place(node), node});
            ++left_;
            node = ring_.nodes[node].next;
        } while (node != ring_.first());
        return {std::move(hiding), ring_.nodes.size()};
    }

    /// Cuts the ears in the queue and those that come of it; returns a corner that is left.
    std::int32_t cut_ears(spatial::CornerGrid& grid, bool is_choosy, std::int32_t left_over) {
        for (std::size_t i = 0; i < queue_.size() && left_ > 3; ++i) {
            if (i % 1024 == 0) check_(0);
            const std::int32_t tip = queue_[i];
            if (tips_[tip].entry != static_cast<std::int32_t>(i))
                continue;  // it comes again, or is cut
            tips_[tip].entry = kNone;
            const std::int32_t a = ring_.nodes[tip].previous, c = ring_.nodes[tip].next;
            const std::int32_t blocker = blocker_of(tip, grid, is_choosy);
            if (blocker != kNone) {
                wait(tip, blocker);
                continue;
            }
            cut(tip);
            wake(tip);
            if (left_over == tip) left_over = c;
            for (const std::int32_t n : {a, c}) {
                const int turn = turn_at(n);
                if (tips_[n].turn <= 0 && turn > 0) {
                    grid.remove(n);
                    wake(n);
                }
                tips_[n].turn = static_cast<std::int8_t>(turn);
                enqueue(n);
            }
        }
        return left_over;
    }

    /// To the end of the queue: going round spreads the ears, which keeps triangles from becoming
    /// slivers that flips must mend.
    void enqueue(std::int32_t tip) {
        stop_waiting(tip);
        tips_[tip].entry = kNone;
        if (tips_[tip].turn <= 0) return;
        tips_[tip].entry = static_cast<std::int32_t>(queue_.size());
        queue_.push_back(tip);
    }

    // A corner that cannot be cut off waits until what is in its way is cut off itself, or turns
    // left and hides in no ear any more.

    void wait(std::int32_t tip, std::int32_t blocker) {
        Tip& first = tips_[blocker];
        tips_[tip].blocker = blocker;
        tips_[tip].before = kNone;
        tips_[tip].after = first.head;
        if (first.head != kNone) tips_[first.head].before = tip;
        first.head = tip;
    }

    void stop_waiting(std::int32_t tip) {
        auto& [entry, blocker, head, before, after, turn] = tips_[tip];
        if (blocker == kNone) return;
        if (before != kNone) {
            tips_[before].after = after;
        } else {
            tips_[blocker].head = after;
        }
        if (after != kNone) tips_[after].before = before;
        blocker = kNone;
    }

    void wake(std::int32_t blocker) {
        while (tips_[blocker].head != kNone)
            enqueue(tips_[blocker].head);
    }

    /// What keeps a corner that turns left from being cut off, or none. Who is choosy takes only
    /// triangles that hardly need flips: with none of a few corners nearby in their circle.
    std::int32_t blocker_of(std::int32_t tip, spatial::CornerGrid& grid, bool is_choosy) const {
        const EarNode& node = ring_.nodes[tip];
        const PlanPoint &a = ring_.place(node.previous), &b = node.place,
                        &c = ring_.place(node.next);
        std::int32_t blocker = kNone;
        if (is_choosy) {
            // Rounded: it decides how good the triangle is, not whether it is one.
            const double ux = a[0] - b[0], uy = a[1] - b[1], vx = c[0] - b[0], vy = c[1] - b[1];
            const double twice = 2 * (vx * uy - vy * ux);
            const double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
            const double x = (v2 * uy - u2 * vy) / twice, y = (u2 * vx - v2 * ux) / twice;
            const double radius2 = (1 - 1e-9) * (x * x + y * y);
            const auto is_within = [&](std::int32_t n) {
                const PlanPoint& p = ring_.place(n);
                const double dx = p[0] - b[0] - x, dy = p[1] - b[1] - y;
                if (dx * dx + dy * dy >= radius2 || twice_area(c, p, a) <= 0) return false;
                blocker = n;
                return true;
            };
            if (is_within(ring_.nodes[node.previous].previous) ||
                is_within(ring_.nodes[node.next].next)) {
                return blocker;
            }
        }
        grid.any_in_triangle(a, b, c, [&](const spatial::CornerGrid::Member& member) {
            const PlanPoint& p = member.position;
            if (p == a || p == b || p == c) return false;
            if (orient2d(a, b, p) < 0 || orient2d(b, c, p) < 0 || orient2d(c, a, p) < 0) {
                return false;
            }
            blocker = member.number;
            return true;
        });
        return blocker;
    }

    /// Makes a triangle whose first two edges are the edges of nodes a and b.
    std::int32_t add(std::int32_t a, std::int32_t b, std::int32_t c) {
        const auto& nodes = ring_.nodes;
        const std::int32_t t =
            mesh_.add_triangle({nodes[a].corner, nodes[b].corner, nodes[c].corner});
        place({t, 0}, a);
        place({t, 1}, b);
        return t;
    }

    /// A half-edge is the edge of a node: it is joined to what lies behind that.
    void place(HalfEdge edge, std::int32_t node) {
        EarNode& own = ring_.nodes[node];
        if (own.twin >= 0) {
            own.placed = edge;
            const HalfEdge other = ring_.nodes[own.twin].placed;
            if (!other.is_none()) mesh_.join(edge, other);
        } else if (!own.behind.is_none()) {
            mesh_.join(edge, own.behind);
        }
    }

    void cut(std::int32_t tip) {
        const std::int32_t a = ring_.nodes[tip].previous, c = ring_.nodes[tip].next;
        const std::int32_t t = add(a, tip, c);
        // The edge from a now is the diagonal, no longer the bridge that it may have been.
        EarNode& from = ring_.nodes[a];
        if (from.twin >= 0) keep_twin(from.twin, from.placed);
        from.twin = -1;
        from.behind = {t, 2};
        from.next = c;
        ring_.nodes[c].previous = a;
        --left_;
    }

    /// The twin of a bridge that has been placed knows from now on what lies behind it.
    void keep_twin(std::int32_t twin, HalfEdge placed) {
        EarNode& other = ring_.nodes[twin];
        if (!other.placed.is_none()) return;  // both are placed and joined
        other.twin = -1;
        other.behind = placed;
    }

    /// What is known of a node as the tip of an ear.
    struct Tip {
        std::int32_t entry = kNone;                  ///< where it stands in the queue
        std::int32_t blocker = kNone;                ///< what it waits for
        std::int32_t head = kNone;                   ///< the first that waits for it
        std::int32_t before = kNone, after = kNone;  ///< others that wait for the same as this one
        std::int8_t turn = 0;                        ///< 1 left, 0 straight on or back, -1 right
    };

    EarRing& ring_;
    const Check& check_;
    FlatMesh mesh_;
    std::vector<Tip> tips_;  ///< of each node
    std::vector<std::int32_t> queue_;
    std::int32_t left_ = 0;
};

/// The same by constrained Delaunay triangulation, corners named by their first appearance.
Triangles by_region(std::span<const Ring> rings, Progress* progress) {
    const std::vector<PlanPoint> corners = corners_of(rings);
    const RingTriangulation region = triangulate_region(rings, progress);
    const std::vector<std::int32_t> first = first_equal(corners);
    std::vector<std::int32_t> corner_of;  // of each point of the region
    for (std::size_t i = 0; i < first.size(); ++i) {
        const auto corner = static_cast<std::int32_t>(i);
        if (first[i] == corner) corner_of.push_back(corner);
    }
    Triangles triangles;
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (!region.inside[t]) continue;
        const auto& [a, b, c] = region.triangulation.triangles[t];
        triangles.push_back({corner_of[a], corner_of[b], corner_of[c]});
    }
    return triangles;
}

/// Whether ear clipping can begin: three distinct corners in each ring, all of them finite.
bool is_plain(std::span<const Ring> rings) {
    if (rings.empty()) return false;
    return std::all_of(rings.begin(), rings.end(), [](const Ring& ring) {
        if (ring.size() < 3) return false;
        const bool is_finite = std::all_of(ring.begin(), ring.end(), [](const PlanPoint& p) {
            return std::isfinite(p[0]) && std::isfinite(p[1]);
        });
        const auto other = std::find_if(ring.begin(), ring.end(),
                                        [&](const PlanPoint& p) { return p != ring[0]; });
        return is_finite && other != ring.end() &&
               std::any_of(other, ring.end(),
                           [&](const PlanPoint& p) { return orient2d(ring[0], *other, p) != 0; });
    });
}

}  // namespace

Triangles triangulate_polygon(std::span<const Ring> rings, Progress* progress) {
    const Check check = stopped_by(progress);
    if (is_plain(rings)) {
        EarRing ring(rings);
        if (ring.join_holes()) {
            Clipping clipping(ring, corners_of(rings), check);
            if (clipping.run()) return clipping.swapped();
        }
    }
    return by_region(rings, progress);
}

}  // namespace realmodel::meshing
