// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/vectors.hpp"
#include "meshing/improvement.hpp"
#include "meshing/plan_predicates.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::meshing {

namespace {

constexpr double kLeastRatio = 0.35;            // of triangles that flips and collapses make
constexpr double kLongestAfterCollapse = 1.55;  // lengths wanted

}  // namespace

double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    const double squares = squared_distance(a, b) + squared_distance(b, c) + squared_distance(c, a);
    return 2 * std::numbers::sqrt3 * twice_area(a, b, c) / squares;
}

Valences::Valences(FlatMesh& mesh, SizeField& size) : mesh_(mesh), size_(size) {
    const std::size_t points = mesh.points.size();
    leaving_.resize(points);
    triangles_.assign(points, 0);
    wanted_.assign(points, 6);
    is_fixed_.assign(points, false);
    mesh_.for_each_edge([&](HalfEdge edge) {
        const std::int32_t v = mesh_.from(edge);
        leaving_[v] = edge;
        ++triangles_[v];
        if (mesh_.is_fixed(edge)) is_fixed_[v] = is_fixed_[mesh_.to(edge)] = true;
    });
    want_on_lines();
}

/// Each sector between two fixed edges wants triangles of 60 degrees.
void Valences::want_on_lines() {
    std::vector<bool> seen(mesh_.points.size(), false);
    mesh_.for_each_edge([&](HalfEdge begin) {
        if (!mesh_.is_fixed(begin)) return;
        const std::int32_t v = mesh_.from(begin);
        if (!seen[v]) {
            seen[v] = true;
            wanted_[v] = 0;
        }
        double angle = angle_at(begin);
        for (HalfEdge edge = begin; !mesh_.is_fixed(edge.prev());) {
            edge = mesh_.rotate_ccw(edge);
            angle += angle_at(edge);
        }
        wanted_[v] += std::max(1, static_cast<int>(std::lround(angle * 3 / std::numbers::pi)));
    });
}

double Valences::angle_at(HalfEdge edge) const {
    const PlanPoint &p = mesh_.origin_point(edge), &a = mesh_.target_point(edge),
                    &b = mesh_.apex_point(edge);
    const double ux = a[0] - p[0], uy = a[1] - p[1], vx = b[0] - p[0], vy = b[1] - p[1];
    return elementary::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
}

int Valences::gain_of_flip(HalfEdge edge) const {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    return strain(a, 0) + strain(b, 0) + strain(c, 0) + strain(d, 0) - strain(a, -1) -
           strain(b, -1) - strain(c, 1) - strain(d, 1);
}

bool Valences::can_flip(HalfEdge edge) const {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    if ((triangles_[a] <= 3 && !is_fixed_[a]) || (triangles_[b] <= 3 && !is_fixed_[b])) {
        return false;
    }
    const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b], &l = mesh_.points[c],
                    &r = mesh_.points[d];
    return mean_ratio(r, l, p) >= kLeastRatio && mean_ratio(l, r, q) >= kLeastRatio &&
           orient2d(r, l, p) > 0 && orient2d(l, r, q) > 0;
}

HalfEdge Valences::flip(HalfEdge edge) {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge);
    const HalfEdge diagonal = mesh_.flip(edge);
    const HalfEdge other = mesh_.twin(diagonal);
    --triangles_[a];
    --triangles_[b];
    ++triangles_[mesh_.from(diagonal)];
    ++triangles_[mesh_.to(diagonal)];
    for (const HalfEdge e : {diagonal, diagonal.next(), diagonal.prev(), other.prev()})
        leaving_[mesh_.from(e)] = e;
    return diagonal;
}

void Valences::collapse(std::int32_t v) {
    if (triangles_[v] > 5) return;
    edges_.clear();
    around(v, [&](HalfEdge edge) { edges_.push_back(edge); });
    HalfEdge best = HalfEdge::none();
    int best_gain = 0;
    for (const HalfEdge edge : edges_) {
        const std::int32_t u = mesh_.to(edge), c = mesh_.apex(edge),
                           d = mesh_.apex(mesh_.twin(edge));
        const int gain = strain(v, 0) + strain(u, 0) + strain(c, 0) + strain(d, 0) -
                         strain(u, triangles_[v] - 4) - strain(c, -1) - strain(d, -1);
        if (gain <= best_gain) continue;
        if ((!is_fixed_[c] && triangles_[c] <= 4) || (!is_fixed_[d] && triangles_[d] <= 4)) {
            continue;
        }
        if (!can_collapse_to(u)) continue;
        best = edge;
        best_gain = gain;
    }
    if (!best.is_none()) collapse(best);
}

/// Whether no triangle turns over or gets too long or thin if the vertex that `edges_` leave goes
/// to where u is.
bool Valences::can_collapse_to(std::int32_t u) const {
    const PlanPoint& to = mesh_.points[u];
    const double longest = kLongestAfterCollapse * size_.at(to);
    for (const HalfEdge edge : edges_) {
        const std::int32_t a = mesh_.to(edge), b = mesh_.apex(edge);
        if (a == u || b == u) continue;
        const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b];
        if (orient2d(p, q, to) <= 0) return false;
        if (mean_ratio(p, q, to) < kLeastRatio) return false;
        if (squared_distance(p, to) > longest * longest) return false;
    }
    return true;
}

void Valences::collapse(HalfEdge edge) {
    const std::int32_t v = mesh_.from(edge), u = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    triangles_[u] += triangles_[v] - 4;
    --triangles_[c];
    --triangles_[d];
    triangles_[v] = 0;
    const auto [left, right] = mesh_.collapse(edge);
    leaving_[u] = left;         // from u to c
    leaving_[c] = left.next();  // a triangle of what was the star of v
    leaving_[d] = right;        // from d to u
}

void Valences::remove_from_border(std::int32_t v) {
    if (triangles_[v] != 2) return;
    HalfEdge edge = leaving_[v];
    if (!mesh_.is_border(edge)) edge = mesh_.rotate_cw(edge);
    const std::int32_t next = mesh_.to(edge), opposite = mesh_.apex(edge),
                       last = mesh_.apex(mesh_.twin(edge.prev()));
    if (strain(v, 0) + strain(opposite, 0) <= strain(opposite, -1)) return;
    const PlanPoint &p = mesh_.points[last], &q = mesh_.points[next], &r = mesh_.points[opposite];
    const double longest = kLongestAfterCollapse * size_.at(mesh_.points[v]);
    if (squared_distance(p, q) > longest * longest) return;
    if (mean_ratio(p, q, r) < kLeastRatio || orient2d(p, q, r) <= 0) return;
    mesh_.remove_from_border(edge);
    triangles_[v] = 0;
    --triangles_[opposite];
    leaving_[last] = edge;
    leaving_[next] = edge.next();
    leaving_[opposite] = edge.prev();
}

namespace {

// Steps are made longer than Newton's: each vertex moves alone, and its neighbors will follow
// (successive over-relaxation, Young 1954).
constexpr double kFreeStep = 1.5, kSlidingStep = 1.4;
constexpr double kMovedEnough = 1e-3;  // of an edge: less is not worth another visit

}  // namespace

/// 4 sqrt(3) / mean ratio of a triangle over base a-b, as a function of its apex, with derivatives:
/// convex for apexes left of the base.
struct StarMoves::StarShape {
    double value = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    /// False where the apex is not left of the base.
    bool add(const PlanPoint& a, const PlanPoint& b, const PlanPoint& apex) {
        const double bx = b[0] - a[0], by = b[1] - a[1];
        const double base = std::sqrt(bx * bx + by * by);
        const double ux = bx / base, uy = by / base;
        const double px = apex[0] - 0.5 * (a[0] + b[0]), py = apex[1] - 0.5 * (a[1] + b[1]);
        const double s = px * ux + py * uy, h = py * ux - px * uy;
        if (!(h > 0)) return false;
        const double over = 1 / (base * h);
        const double ds = 8 * s * over, dh = (4 * h * h - 3 * base * base - 4 * s * s) * over / h;
        const double dss = 8 * over, dsh = -ds / h,
                     dhh = (8 * s * s + 6 * base * base) * over / (h * h);
        value += (3 * base * base + 4 * s * s + 4 * h * h) * over;
        x += ds * ux - dh * uy;
        y += ds * uy + dh * ux;
        xx += dss * ux * ux - 2 * dsh * ux * uy + dhh * uy * uy;
        xy += dss * ux * uy + dsh * (ux * ux - uy * uy) - dhh * ux * uy;
        yy += dss * uy * uy + 2 * dsh * ux * uy + dhh * ux * ux;
        return true;
    }
};

std::int32_t StarMoves::add_line(const PlanPoint& begin, const PlanPoint& end) {
    lines_.push_back({begin, end});
    return static_cast<std::int32_t>(lines_.size()) - 1;
}

void StarMoves::move(std::int32_t v) {
    if (slides(v)) {
        slide(v);
    } else if (moves_freely(v)) {
        go_freely(v);
    }
}

/// Goes as large a share of a way as makes the star better.
template <class Place>
void StarMoves::step(std::int32_t v, const StarShape& now, double way, const Place& place_at) {
    PlanPoint& p = mesh_.points[v];
    if (!std::isfinite(now.value) || !std::isfinite(way)) return;
    const double least = kMovedEnough * std::sqrt(squared_distance(p, mesh_.points[base_[0][0]]));
    double share = slides(v) ? kSlidingStep : kFreeStep;
    for (int halving = 0; halving < 6; ++halving, share /= 2) {
        if (share * way < least) return;
        const PlanPoint place = place_at(share);
        if (!(shape_at(place).value < now.value)) continue;
        const bool is_upright = std::all_of(base_.begin(), base_.end(), [&](const auto& base) {
            return orient2d(mesh_.points[base[0]], mesh_.points[base[1]], place) > 0;
        });
        if (!is_upright) continue;
        p = place;
        return;
    }
}

void StarMoves::go_freely(std::int32_t v) {
    const PlanPoint& p = mesh_.points[v];
    const StarShape now = shape_of_star(v);
    const double determinant = now.xx * now.yy - now.xy * now.xy;
    const double dx = -(now.yy * now.x - now.xy * now.y) / determinant;
    const double dy = -(now.xx * now.y - now.xy * now.x) / determinant;
    step(v, now, std::sqrt(dx * dx + dy * dy), [&](double share) {
        return PlanPoint{p[0] + share * dx, p[1] + share * dy};
    });
}

/// The same along the line between two corners of the border.
void StarMoves::slide(std::int32_t v) {
    const PlanPoint& p = mesh_.points[v];
    const auto& line = lines_[kinds_[v]];
    const PlanPoint &a = line[0], &b = line[1];
    const double length = std::sqrt(squared_distance(a, b));
    const double ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length;
    const StarShape now = shape_of_star(v);
    const double bend = ux * ux * now.xx + 2 * ux * uy * now.xy + uy * uy * now.yy;
    const double along = -(ux * now.x + uy * now.y) / bend;
    const double from = (p[0] - a[0]) * ux + (p[1] - a[1]) * uy;
    step(v, now, std::abs(along), [&](double share) {
        const double where = (from + share * along) / length;  // from the corners, rounded once
        return moved(a, where, minus(b, a));
    });
}

StarMoves::StarShape StarMoves::shape_of_star(std::int32_t v) {
    base_.clear();
    valences_.around(v, [&](HalfEdge edge) {
        base_.push_back({mesh_.to(edge), mesh_.apex(edge)});
    });
    return shape_at(mesh_.points[v]);
}

/// Of the star that base_ bounds; its value is infinite where a triangle would be turned over.
StarMoves::StarShape StarMoves::shape_at(const PlanPoint& place) const {
    StarShape shape;
    for (const auto& [a, b] : base_) {
        if (shape.add(mesh_.points[a], mesh_.points[b], place)) continue;
        shape.value = std::numeric_limits<double>::infinity();
        break;
    }
    return shape;
}

namespace {

constexpr int kMostLooks = 100;  // flips tried from one vertex
constexpr int kSweeps = 2;       // of moves before a way is judged

// How much of the sum of inverse mean ratios less strain by one may cost. Beside fixed lines angles
// are given, and six neighbors no longer mean good triangles: there these must get better.
constexpr double kPrice = 0.4, kPriceBesideLines = -0.05;

constexpr double kBadRatio = 0.9;     // of a triangle that is to be mended
constexpr double kWorthAFlip = 0.02;  // in that sum

}  // namespace

bool JudgedFlips::glide(std::int32_t vertex, int most_flips) {
    looks_left_ = kMostLooks;
    candidates_.clear();
    way_.clear();
    const std::array changed{vertex};
    return seek(changed, 0, most_flips);
}

bool JudgedFlips::seek(std::span<const std::int32_t> changed, int gained, int flips_left) {
    const std::size_t begin = candidates_.size();
    for (const std::int32_t v : changed) {
        if (valences_.is_fixed(v) || valences_.is_regular(v)) continue;
        valences_.around(v, [&](HalfEdge edge) {
            add_candidate(edge, 0);
            add_candidate(edge.next(), 0);
        });
    }
    sort_candidates(begin);
    const std::size_t end = candidates_.size();
    bool improves = false;
    for (std::size_t i = begin; i < end && !improves; ++i) {
        const int all = gained + candidates_[i].gain;
        if (all <= 0 && flips_left == 1) break;  // they are sorted
        if (--looks_left_ < 0) break;
        if (!try_flip(candidates_[i].ends)) continue;
        if (all > 0) {
            improves = is_worth_it(kPrice * all, kPriceBesideLines * all);
        } else {
            const auto [before, after] = way_.back();
            const std::array touched{before[0], before[1], after[0], after[1]};
            improves = seek(touched, all, flips_left - 1);
        }
        if (!improves) undo();
    }
    candidates_.resize(begin);
    return improves;
}

bool JudgedFlips::mend(std::int32_t vertex) {
    const FlatMesh& mesh = valences_.mesh();
    bool is_bad = false;
    valences_.around(vertex, [&](HalfEdge edge) {
        is_bad = is_bad || mean_ratio(mesh.origin_point(edge), mesh.target_point(edge),
                                      mesh.apex_point(edge)) < kBadRatio;
    });
    if (!is_bad) return false;
    candidates_.clear();
    way_.clear();
    valences_.around(vertex, [&](HalfEdge edge) { add_candidate(edge, kAnyGain); });
    sort_candidates(0);
    for (const FlipCandidate& candidate : candidates_) {
        if (!try_flip(candidate.ends)) continue;
        if (is_worth_it(-kWorthAFlip, -kWorthAFlip)) return true;
        undo();
    }
    return false;
}

bool JudgedFlips::may_change(std::int32_t vertex) const {
    return moves_.moves_freely(vertex) || valences_.is_fixed(vertex);
}

/// An edge whose flip lessens the strain by so much at least.
void JudgedFlips::add_candidate(HalfEdge edge, int least_gain) {
    const FlatMesh& mesh = valences_.mesh();
    if (mesh.is_fixed(edge)) return;
    for (const HalfEdge e : {edge, mesh.twin(edge)})
        if (!may_change(mesh.from(e)) || !may_change(mesh.apex(e))) return;
    const int gain = valences_.gain_of_flip(edge);
    if (gain < least_gain) return;
    const Ends ends = unordered(mesh.from(edge), mesh.to(edge));
    for (const Flip& flip : way_)
        if (flip.after == ends) return;
    candidates_.push_back({gain, ends});
}

/// Those that gain most first, each once.
void JudgedFlips::sort_candidates(std::size_t begin) {
    const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(begin);
    std::ranges::sort(first, candidates_.end(), {},
                      [](const FlipCandidate& c) { return std::pair(-c.gain, c.ends); });
    const auto last = std::unique(
        first, candidates_.end(),
        [](const FlipCandidate& a, const FlipCandidate& b) { return a.ends == b.ends; });
    candidates_.erase(last, candidates_.end());
}

/// Adds a flip to the way where there can be one.
bool JudgedFlips::try_flip(const Ends& ends) {
    const HalfEdge edge = edge_between(ends);
    if (edge.is_none() || !valences_.can_flip(edge)) return false;
    const HalfEdge diagonal = valences_.flip(edge);
    const FlatMesh& mesh = valences_.mesh();
    way_.push_back({ends, unordered(mesh.from(diagonal), mesh.to(diagonal))});
    return true;
}

/// Takes the last flip of the way back.
void JudgedFlips::undo() {
    valences_.flip(edge_between(way_.back().after));
    way_.pop_back();
}

/// Whether the way just gone makes the triangles of its vertices no worse than that, once these
/// have been moved a little. If so they stay moved.
bool JudgedFlips::is_worth_it(double most_worse, double most_worse_beside_lines) {
    touched_.clear();
    for (const Flip& flip : way_)
        for (const Ends& ends : {flip.before, flip.after})
            touched_.insert(touched_.end(), ends.begin(), ends.end());
    sort_unique(touched_);
    for (auto flip = way_.rbegin(); flip != way_.rend(); ++flip)
        valences_.flip(edge_between(flip->after));
    const double before = badness();
    for (const Flip& flip : way_)
        valences_.flip(edge_between(flip.before));
    std::vector<PlanPoint>& points = valences_.mesh().points;
    places_.clear();
    for (const std::int32_t v : touched_)
        places_.push_back(points[v]);
    for (int i = 0; i < kSweeps; ++i)
        for (const std::int32_t v : touched_)
            moves_.move(v);
    const bool is_beside_line = std::any_of(touched_.begin(), touched_.end(),
                                            [&](std::int32_t v) { return valences_.is_fixed(v); });
    if (badness() < before + (is_beside_line ? most_worse_beside_lines : most_worse)) return true;
    for (std::size_t i = 0; i < touched_.size(); ++i)
        points[touched_[i]] = places_[i];
    return false;
}

/// The sum over the triangles of the vertices touched of what their inverse mean ratios have above
/// 1.
double JudgedFlips::badness() {
    const FlatMesh& mesh = valences_.mesh();
    star_.clear();
    for (const std::int32_t v : touched_)
        valences_.around(v, [&](HalfEdge edge) { star_.push_back(edge.triangle()); });
    sort_unique(star_);
    double sum = 0;
    for (const std::int32_t t : star_) {
        const auto [a, b, c] = mesh.corners[t];
        sum += 1 / mean_ratio(mesh.points[a], mesh.points[b], mesh.points[c]) - 1;
    }
    return sum;
}

/// Looks around both ends: where outlines touch in a vertex, only one of its fans is known.
HalfEdge JudgedFlips::edge_between(const Ends& ends) const {
    const FlatMesh& mesh = valences_.mesh();
    HalfEdge joining_edge = HalfEdge::none();
    valences_.around(ends[0], [&](HalfEdge edge) {
        if (mesh.to(edge) == ends[1]) joining_edge = edge;
    });
    if (!joining_edge.is_none()) return joining_edge;
    valences_.around(ends[1], [&](HalfEdge edge) {
        if (mesh.to(edge) == ends[0]) joining_edge = mesh.twin(edge);
    });
    return joining_edge;
}

}  // namespace realmodel::meshing
