// SPDX-License-Identifier: GPL-3.0-or-later
// Regions in triangles, by cutting off ears, and in convex polygons, by merging triangles.
#include "arrangement/triangulate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "spatial/box_tree.hpp"
#include "spatial/corner_grid.hpp"

namespace realmodel::arrangement {

namespace {

/// Loops joined into a ring of corners that ears are cut from.
class EarClipping {
public:
    EarClipping(std::span<const Loop> loops, const PlanePosition& rounding,
                const CornerTurns& turns, EarChoice choice,
                std::vector<std::array<std::int32_t, 3>>& triangles, Progress* progress);
    bool run();

private:
    static constexpr std::int32_t kNone = -1, kNoEar = -2;
    static constexpr std::size_t kGridFrom = 64;

    /// A corner in the ring. Those at the ends of a bridge are there twice, once for each side.
    struct Link {
        LoopCorner corner;
        std::int32_t number;  ///< of the corner
        std::int32_t previous, next;
        std::int32_t again = kNone;          ///< the same corner at the other side of a bridge
        std::int32_t queued = kNone;         ///< its position in the queue
        std::int32_t first_waiting = kNone;  ///< in `waiting_`: who waits until it is cut off
        bool is_in_ring = false;
    };
    /// What is asked of an ear: less and less, as long as none is found.
    enum class EarTest {
        kRound,   ///< it is fat, and neither of the two next corners lies in its circle
        kFat,     ///< it has an area whatever rounding does; no corner lies in it or just beyond
        kProper,  ///< it turns left; no corner that does not turn left lies in it or on its border
        kStrict,  ///< it turns left; no such corner lies in it
        kNone     ///< it has three different nodes
    };

    Link& link(std::int32_t i) { return links_[index(i)]; }
    const PlanePosition& at(std::int32_t i) { return link(i).corner.at; }
    int turn(std::int32_t a, std::int32_t b, std::int32_t c) {
        if (is_exact()) {
            if (const auto known = exact::orient2d_filter(at(a), at(b), at(c))) return *known;
        }
        return turns_(link(a).corner, link(b).corner, link(c).corner);
    }
    int turn_at(std::int32_t i) { return turn(link(i).previous, i, link(i).next); }
    bool is_exact() const { return rounding_ == PlanePosition{0, 0}; }
    /// Whether an ear is looked for that rounded places tell of: what is surely on one side in
    /// these is so in the exact ones, so that nothing has to be asked exactly.
    bool is_rounded(EarTest test) const { return test <= EarTest::kFat && !is_exact(); }
    /// Exact corners at one place are one node.
    bool are_same(const LoopCorner& p, const LoopCorner& q) const {
        return p.node == q.node || (is_exact() && p.at == q.at);
    }
    bool are_same(std::int32_t i, std::int32_t k) {
        return are_same(link(i).corner, link(k).corner);
    }
    template <class Visit>
    void visit_ring(std::int32_t first, const Visit& visit) {
        std::int32_t i = first;
        do {
            visit(i);
            i = link(i).next;
        } while (i != first);
    }

    void join_holes(std::span<const std::int32_t> holes);
    void join(std::int32_t hole, std::int32_t outer);
    bool opens_towards(std::int32_t corner, const LoopCorner& p);
    bool hides(const LoopCorner& a, const LoopCorner& b, const LoopCorner& p, const LoopCorner& q);
    void enter_corners();
    void enqueue(std::int32_t tip);
    void enqueue_all(std::int32_t from);
    std::int32_t blocker_of(std::int32_t tip, EarTest test);
    bool blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c, EarTest test);
    bool is_in_circle(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c);
    void cut(std::int32_t tip);
    std::int32_t drop_path(std::int32_t from);
    void remove(std::int32_t i);

    PlanePosition rounding_;
    const CornerTurns& turns_;
    EarChoice choice_;
    std::vector<std::array<std::int32_t, 3>>& triangles_;
    Progress* progress_;
    bool is_clean_ = true;
    std::vector<Link> links_;
    std::size_t count_ = 0;                    ///< of the ring's corners
    std::optional<spatial::CornerGrid> grid_;  ///< of these, where they are many
    std::vector<std::int32_t> queue_;          ///< tips to be cut off, from `begin_` on
    std::size_t begin_ = 0;
    std::vector<std::array<std::int32_t, 2>> waiting_;  ///< a tip, and the next that waits
};

EarClipping::EarClipping(std::span<const Loop> loops, const PlanePosition& rounding,
                         const CornerTurns& turns, EarChoice choice,
                         std::vector<std::array<std::int32_t, 3>>& triangles, Progress* progress)
    : rounding_(rounding),
      turns_(turns),
      choice_(choice),
      triangles_(triangles),
      progress_(progress) {
    std::size_t corners = 0;
    for (const Loop& loop : loops)
        corners += loop.size();
    links_.reserve(corners + 2 * loops.size());
    queue_.reserve(3 * corners);
    triangles_.reserve(triangles_.size() + corners + 2 * loops.size());
    std::vector<std::int32_t> holes;  // the leftmost corner of each
    for (const Loop& loop : loops) {
        const auto first = static_cast<std::int32_t>(links_.size());
        const auto size = static_cast<std::int32_t>(loop.size());
        for (std::int32_t i = 0; i < size; ++i) {
            links_.push_back(
                {loop[index(i)], first + i, first + (i + size - 1) % size, first + (i + 1) % size});
        }
        if (first == 0) continue;
        const auto leftmost = std::ranges::min_element(loop, {}, &LoopCorner::at);
        holes.push_back(first + static_cast<std::int32_t>(leftmost - loop.begin()));
    }
    count_ = links_.size();
    visit_ring(0, [this](std::int32_t i) { link(i).is_in_ring = true; });
    if (!holes.empty()) {
        // what lies left of a hole is joined before it
        std::ranges::sort(holes, {}, [this](std::int32_t i) { return std::pair(at(i), i); });
        join_holes(holes);
    }
}

/// Whether the way from a corner towards p begins inside of the ring.
bool EarClipping::opens_towards(std::int32_t corner, const LoopCorner& p) {
    const LoopCorner &a = link(link(corner).previous).corner, &b = link(corner).corner,
                     &c = link(link(corner).next).corner;
    if (turns_(a, b, c) > 0) return turns_(a, b, p) > 0 && turns_(b, c, p) > 0;
    return turns_(a, b, p) > 0 || turns_(b, c, p) > 0;
}

/// Whether an edge from a to b crosses the way from p to q or ends on it.
bool EarClipping::hides(const LoopCorner& a, const LoopCorner& b, const LoopCorner& p,
                        const LoopCorner& q) {
    const bool a_is_end = are_same(a, p) || are_same(a, q);
    const bool b_is_end = are_same(b, p) || are_same(b, q);
    if (a_is_end && b_is_end) return true;
    if (!a_is_end && !b_is_end)
        return turns_(p, q, a) * turns_(p, q, b) <= 0 && turns_(a, b, p) * turns_(a, b, q) <= 0;
    const LoopCorner& other = a_is_end ? b : a;  // only an edge along the way hides its other end
    if (turns_(p, q, other) != 0) return false;
    const std::size_t k = p.at[0] != q.at[0] ? 0 : 1;
    return other.at[k] > std::min(p.at[k], q.at[k]) && other.at[k] < std::max(p.at[k], q.at[k]);
}

/// Joins each hole to the nearest corner of the ring that its leftmost one touches or can see.
void EarClipping::join_holes(std::span<const std::int32_t> holes) {
    std::vector<std::array<LoopCorner, 2>> edges;  // from each corner
    std::vector<spatial::Box> boxes;
    for (const Link& start : links_) {
        edges.push_back({start.corner, link(start.next).corner});
        boxes.emplace_back().include(start.corner.at);
        boxes.back().include(edges.back()[1].at);
    }
    const spatial::BoxTree tree(std::move(boxes));
    std::vector<std::array<LoopCorner, 2>> bridges;  // from left to right, as the holes are
    double widest = 0;                               // of the bridges
    for (const std::int32_t hole : holes) {
        if (progress_ != nullptr) progress_->check();
        const LoopCorner from = link(hole).corner;
        const auto sees = [&](const LoopCorner& to) {
            spatial::Box way;
            way.include(from.at);
            way.include(to.at);
            const auto is_hidden_by = [&](const std::array<LoopCorner, 2>& edge) {
                return hides(edge[0], edge[1], from, to);
            };
            const auto near =
                std::ranges::lower_bound(bridges, way.low[0] - 2 * widest, {},
                                         [](const auto& bridge) { return bridge[0].at[0]; });
            return std::none_of(near, bridges.end(), is_hidden_by) &&
                   !tree.any(way, [&](std::int32_t i) { return is_hidden_by(edges[index(i)]); });
        };
        using Near = std::pair<double, std::int32_t>;  // squared distance, corner
        std::int32_t outer = kNone, nearest_in_ring = kNone;
        for (Near last{-1, kNone}; outer == kNone;) {
            Near next{HUGE_VAL, kNone};
            const auto visit = [&](std::int32_t corner) {
                const Near near{squared_distance(at(corner), from.at), corner};
                if (link(corner).is_in_ring && last < near && (next.second == kNone || near < next))
                    next = near;
            };
            tree.approach(
                {from.at[0], from.at[1], 0}, [&] { return next.first; }, visit);
            if (next.second == kNone) break;
            if (nearest_in_ring == kNone) nearest_in_ring = next.second;
            for (std::int32_t i = next.second; outer == kNone && i != kNone; i = link(i).again) {
                const bool fits = are_same(i, hole)
                                      ? opens_towards(i, link(link(hole).next).corner)
                                      : opens_towards(i, from) && sees(link(i).corner);
                if (fits) outer = i;
            }
            last = next;
        }
        if (outer == kNone) {  // rounding has put the hole over the outline
            is_clean_ = false;
            outer = nearest_in_ring;
        }
        bridges.push_back({from, link(outer).corner});
        widest = std::max(widest, std::abs(from.at[0] - at(outer)[0]));
        join(hole, outer);
    }
}

void EarClipping::join(std::int32_t hole, std::int32_t outer) {
    visit_ring(hole, [this](std::int32_t i) { link(i).is_in_ring = true; });
    if (are_same(hole, outer)) {  // the two take each other's way on
        std::swap(link(hole).next, link(outer).next);
        link(link(hole).next).previous = hole;
        link(link(outer).next).previous = outer;
        return;
    }
    const auto outer_again = static_cast<std::int32_t>(links_.size());
    const std::int32_t hole_again = outer_again + 1;
    links_.push_back(link(outer));
    links_.push_back(link(hole));
    count_ += 2;
    link(outer).again = outer_again;
    link(hole).again = hole_again;
    link(link(outer).next).previous = outer_again;
    link(link(hole).previous).next = hole_again;
    link(outer).next = hole;
    link(hole).previous = outer;
    link(hole_again).next = outer_again;
    link(outer_again).previous = hole_again;
}

/// Of exact corners only those that do not turn left can be in the way: of those in an ear, the one
/// farthest from its diagonal does not.
void EarClipping::enter_corners() {
    if (count_ <= kGridFrom) return;
    std::vector<spatial::CornerGrid::Member> corners;
    visit_ring(0, [&](std::int32_t i) {
        if (!is_exact() || turn_at(i) <= 0) corners.push_back({at(i), i});
    });
    grid_.emplace(std::move(corners), links_.size());
}

/// To the end of the queue: going round spreads the ears, which makes fewer needles.
void EarClipping::enqueue(std::int32_t tip) {
    link(tip).queued = static_cast<std::int32_t>(queue_.size());
    queue_.push_back(tip);
}

void EarClipping::enqueue_all(std::int32_t from) {
    queue_.clear();
    begin_ = 0;
    waiting_.clear();
    visit_ring(from, [this](std::int32_t i) {
        link(i).first_waiting = kNone;
        enqueue(i);
    });
}

void EarClipping::remove(std::int32_t i) {
    Link& gone = link(i);
    link(gone.previous).next = gone.next;
    link(gone.next).previous = gone.previous;
    gone.is_in_ring = false;
    gone.queued = kNone;
    if (grid_) grid_->remove(i);
    --count_;
}

/// Whether a corner of the ring lies in the triangle a, tip, c, so that it cannot be cut off. At
/// first one is in the way, too, that rounding may have put just beyond an edge which it only
/// touches: what is left without that edge would be turned over.
bool EarClipping::blocks(std::int32_t other, std::int32_t a, std::int32_t tip, std::int32_t c,
                         EarTest test) {
    const NodeId node = link(other).corner.node;
    for (const std::int32_t i : {a, tip, c})
        if (node == link(i).corner.node) return false;
    bool is_on_border = false;
    for (const auto& [p, q] : {std::pair(a, tip), std::pair(tip, c), std::pair(c, a)}) {
        if (is_rounded(test)) {
            if (twice_area(at(p), at(q), at(other)) < -slack(at(p), at(q), at(other), rounding_))
                return false;
            continue;
        }
        const int turned = turn(p, q, other);
        if (turned < 0) return false;
        is_on_border |= turned == 0;
    }
    if (are_same(other, a) || are_same(other, tip) || are_same(other, c)) return false;
    if (test == EarTest::kStrict && is_on_border) return false;
    // where a corner that turns left lies inside, one that does not lies inside as well
    return test <= EarTest::kFat || turn_at(other) <= 0;
}

/// In doubles: it decides how good the triangle is, not whether it is one.
bool EarClipping::is_in_circle(std::int32_t other, std::int32_t a, std::int32_t tip,
                               std::int32_t c) {
    const PlanePosition u = minus(at(a), at(tip)), v = minus(at(c), at(tip)),
                        p = minus(at(other), at(tip));
    const double twice = 2 * cross(v, u), u2 = dot(u, u), v2 = dot(v, v);
    const PlanePosition center{(v2 * u[1] - u2 * v[1]) / twice, (u2 * v[0] - v2 * u[0]) / twice};
    return squared_distance(p, center) < (1 - 1e-9) * dot(center, center) &&
           twice_area(at(c), at(other), at(a)) > 0;
}

/// What keeps a tip from being cut off: a corner, or that it makes no such triangle (kNoEar).
std::int32_t EarClipping::blocker_of(std::int32_t tip, EarTest test) {
    const std::int32_t a = link(tip).previous, c = link(tip).next;
    if (are_same(a, tip) || are_same(tip, c) || are_same(a, c)) return kNoEar;
    if (test == EarTest::kNone) return kNone;
    if (is_rounded(test)
            ? twice_area(at(a), at(tip), at(c)) <= slack(at(a), at(tip), at(c), rounding_)
            : turn(a, tip, c) <= 0)
        return kNoEar;
    if (test == EarTest::kRound) {
        for (const std::int32_t other : {link(a).previous, link(c).next})
            if (is_in_circle(other, a, tip, c)) return other;
    }
    if (!grid_) {
        for (std::int32_t other = link(c).next; other != a; other = link(other).next)
            if (blocks(other, a, tip, c, test)) return other;
        return kNone;
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
    const std::array corners{at(a), at(tip), at(c)};
    std::int32_t blocker = kNone;
    grid_->any_in_triangle(
        outward(a), outward(tip), outward(c), [&](const spatial::CornerGrid::Member& other) {
            for (std::size_t k = 0; is_exact() && k < 3; ++k) {  // most are surely beyond an edge
                if (exact::orient2d_filter(corners[k], corners[(k + 1) % 3], other.position) == -1)
                    return false;
            }
            if (!blocks(other.number, a, tip, c, test)) return false;
            blocker = other.number;
            return true;
        });
    return blocker;
}

void EarClipping::cut(std::int32_t tip) {
    const std::int32_t a = link(tip).previous, c = link(tip).next;
    triangles_.push_back({link(a).number, link(tip).number, link(c).number});
    remove(tip);
    for (const std::int32_t i : {a, c}) {
        if (is_exact() && turn_at(i) <= 0) continue;  // no tip until something beside it is cut
        if (grid_ && is_exact()) grid_->remove(i);
        enqueue(i);
    }
    for (std::int32_t w = link(tip).first_waiting; w != kNone; w = waiting_[index(w)][1]) {
        const std::int32_t other = waiting_[index(w)][0];
        if (link(other).is_in_ring && link(other).queued == kNone) enqueue(other);
    }
}

/// Where only paths that run back over themselves are left: from such a turn both edges go.
/// @return what follows
std::int32_t EarClipping::drop_path(std::int32_t from) {
    std::int32_t tip = from;
    while (!are_same(tip, link(tip).next) && !are_same(link(tip).previous, link(tip).next))
        tip = link(tip).next;
    const std::int32_t beyond = link(tip).next;
    if (!are_same(tip, beyond)) remove(beyond);
    remove(tip);
    return link(beyond).next;
}

bool EarClipping::run() {
    enter_corners();
    const EarTest first = choice_ == EarChoice::kRound ? EarTest::kRound : EarTest::kFat;
    EarTest test = first;
    std::int32_t from = 0;
    enqueue_all(from);
    for (std::size_t step = 0; count_ > 2; ++step) {
        poll(progress_, step);
        if (begin_ == queue_.size()) {
            if (choice_ == EarChoice::kRound && test == EarTest::kFat) return false;
            if (test != EarTest::kNone) {
                test = static_cast<EarTest>(static_cast<int>(test) + 1);
            } else {
                is_clean_ = false;
                from = drop_path(from);
                test = first;
            }
            enqueue_all(from);
            continue;
        }
        const std::int32_t tip = queue_[begin_++];
        if (link(tip).queued != static_cast<std::int32_t>(begin_) - 1) continue;
        link(tip).queued = kNone;
        const std::int32_t blocker = blocker_of(tip, test);
        if (blocker >= 0) {
            waiting_.push_back({tip, link(blocker).first_waiting});
            link(blocker).first_waiting = static_cast<std::int32_t>(waiting_.size()) - 1;
        }
        if (blocker != kNone) continue;
        is_clean_ = is_clean_ && test != EarTest::kNone;
        from = link(link(tip).next).next;
        cut(tip);
        if (test > EarTest::kFat) {  // there may be better ones again
            test = first;
            enqueue_all(from);
        }
    }
    return is_clean_;
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
    std::size_t smallest = loops.size(), only = loops.size(), outlines = 0;
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
        if (smallest == loops.size() || areas[i] < areas[smallest]) smallest = i;
    }
    if (smallest == loops.size() && outlines == 1 && areas[hole] < -allowed) return only;
    return smallest;
}

}  // namespace

double twice_loop_area(const Loop& loop) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
        sum += twice_area(loop[0].at, loop[i].at, loop[i + 1].at);
    return sum;
}

int CornerTurns::operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const {
    return exact::orient2d(a.at, b.at, c.at);
}

bool cut_ears(std::span<const Loop> loops, const PlanePosition& rounding, const CornerTurns& turns,
              EarChoice choice, std::vector<std::array<std::int32_t, 3>>& triangles,
              Progress* progress) {
    return EarClipping(loops, rounding, turns, choice, triangles, progress).run();
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
        std::vector<Loop> region{loops[i]};
        for (const std::size_t hole : holes[i])
            region.push_back(loops[hole]);
        const std::vector<LoopCorner> corners = concatenated(region);
        std::vector<std::array<std::int32_t, 3>> ears;
        clean = cut_ears(region, rounding, turns, EarChoice::kAny, ears) && clean;
        for (const auto& [a, b, c] : ears)
            triangles.push_back({corners[index(a)], corners[index(b)], corners[index(c)]});
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
bool retraces_itself(const Loop& loop, std::size_t axis, const PlanePosition& rounding) {
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
        : rounding_(rounding), merged_(triangles.size()) {
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
            join(merged_.find(uses[0].triangle), merged_.find(uses[1].triangle), ends);
        }
    }

    void write(Polygons& result) {
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            if (polygons_[i].empty()) continue;
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
        if (!retraces_itself(merged, 0, rounding_) || !retraces_itself(merged, 1, rounding_))
            return;
        for (std::size_t k = seam + 1; k < n; ++k) {
            for (std::size_t l = 0; l <= seam; ++l) {
                if (merged[k].node == merged[l].node) return;
            }
        }
        polygons_[index(std::min(one, two))] = std::move(merged);
        polygons_[index(std::max(one, two))].clear();
        merged_.join(one, two);
    }

    PlanePosition rounding_;
    DisjointSets merged_;  ///< of triangles; their polygon has the number of the least
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
    if (!retraces_itself(loop, 0, rounding) || !retraces_itself(loop, 1, rounding)) return false;
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
