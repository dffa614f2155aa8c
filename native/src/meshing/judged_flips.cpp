// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/judged_flips.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/keep_single.hpp"

namespace realmodel::meshing {

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
    bool found = false;
    for (std::size_t i = begin; i < end && !found; ++i) {
        const int all = gained + candidates_[i].gain;
        if (all <= 0 && flips_left == 1) break;  // they are sorted
        if (--looks_left_ < 0) break;
        if (!try_flip(candidates_[i].ends)) continue;
        if (all > 0) {
            found = is_worth_it(kPrice * all, kPriceBesideLines * all);
        } else {
            const auto [before, after] = way_.back();
            const std::array touched{before[0], before[1], after[0], after[1]};
            found = seek(touched, all, flips_left - 1);
        }
        if (!found) undo();
    }
    candidates_.resize(begin);
    return found;
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
    for (const Candidate& candidate : candidates_) {
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
                      [](const Candidate& c) { return std::pair(-c.gain, c.ends); });
    const auto last =
        std::unique(first, candidates_.end(),
                    [](const Candidate& a, const Candidate& b) { return a.ends == b.ends; });
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
    HalfEdge found = HalfEdge::none();
    valences_.around(ends[0], [&](HalfEdge edge) {
        if (mesh.to(edge) == ends[1]) found = edge;
    });
    if (!found.is_none()) return found;
    valences_.around(ends[1], [&](HalfEdge edge) {
        if (mesh.to(edge) == ends[0]) found = mesh.twin(edge);
    });
    return found;
}

}  // namespace realmodel::meshing
