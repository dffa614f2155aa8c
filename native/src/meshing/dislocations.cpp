// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/dislocations.hpp"

#include <algorithm>

namespace realmodel::meshing {

namespace {

constexpr int most_looks = 100;  // flips tried from one vertex
constexpr int sweeps = 2;        // of moves before a way is judged

// How much of the sum of inverse mean ratios less strain by one may cost. Beside fixed lines angles
// are given, and six neighbours no longer mean good triangles: there these must get better.
constexpr double price = 0.4, price_beside_lines = -0.05;

}  // namespace

bool Dislocations::glide(std::int32_t vertex, int most_flips) {
    looks_left_ = most_looks;
    candidates_.clear();
    way_.clear();
    const std::array changed{vertex};
    return seek(changed, 0, most_flips);
}

bool Dislocations::may_change(std::int32_t vertex) const {
    return moves_.moves_freely(vertex) || valences_.is_fixed(vertex);
}

bool Dislocations::seek(std::span<const std::int32_t> changed, int gained, int flips_left) {
    const std::size_t begin = candidates_.size();
    find_candidates(changed);
    const std::size_t end = candidates_.size();
    bool found = false;
    for (std::size_t i = begin; i < end && !found; ++i) {
        const auto [gain, edge] = candidates_[i];
        const int all = gained + gain;
        if (all <= 0 && flips_left == 1) break;  // they are sorted
        if (--looks_left_ < 0) break;
        const Side side = side_between(edge);
        if (!valences_.can_flip(side)) continue;
        const Side diagonal = valences_.flip(side);
        const FlatMesh& mesh = valences_.mesh();
        const std::int32_t c = mesh.from(diagonal), d = mesh.to(diagonal);
        way_.push_back({edge, {std::min(c, d), std::max(c, d)}});
        if (all > 0) {
            found = is_better_shaped(all);
        } else {
            const std::array touched{edge[0], edge[1], c, d};
            found = seek(touched, all, flips_left - 1);
        }
        if (!found) valences_.flip(side_between(way_.back().after));
        way_.pop_back();
    }
    candidates_.resize(begin);
    return found;
}

/// Whether the way just gone leaves better triangles, or hardly worse ones, once its vertices have
/// been moved a little. If so they stay moved.
bool Dislocations::is_better_shaped(int gained) {
    touched_.clear();
    for (const Flip& flip : way_)
        for (const Edge& edge : {flip.before, flip.after})
            touched_.insert(touched_.end(), edge.begin(), edge.end());
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (auto flip = way_.rbegin(); flip != way_.rend(); ++flip)
        valences_.flip(side_between(flip->after));
    const double before = badness();
    for (const Flip& flip : way_)
        valences_.flip(side_between(flip.before));
    std::vector<PlanPoint>& points = valences_.mesh().points;
    places_.clear();
    for (const std::int32_t v : touched_)
        places_.push_back(points[v]);
    for (int i = 0; i < sweeps; ++i)
        for (const std::int32_t v : touched_)
            moves_.move(v);
    const bool is_beside_line = std::any_of(touched_.begin(), touched_.end(),
                                            [&](std::int32_t v) { return valences_.is_fixed(v); });
    if (badness() < before + (is_beside_line ? price_beside_lines : price) * gained) return true;
    for (std::size_t i = 0; i < touched_.size(); ++i)
        points[touched_[i]] = places_[i];
    return false;
}

/// The sum over the triangles of the vertices touched of what their inverse mean ratios have above
/// 1.
double Dislocations::badness() {
    const FlatMesh& mesh = valences_.mesh();
    star_.clear();
    for (const std::int32_t v : touched_)
        valences_.around(v, [&](Side side) { star_.push_back(side.triangle()); });
    std::sort(star_.begin(), star_.end());
    star_.erase(std::unique(star_.begin(), star_.end()), star_.end());
    double sum = 0;
    for (const std::int32_t t : star_) {
        const auto [a, b, c] = mesh.corners[t];
        sum += 1 / mean_ratio(mesh.points[a], mesh.points[b], mesh.points[c]) - 1;
    }
    return sum;
}

/// Sides whose flip costs nothing, of the stars of those that have too many or too few; those that
/// gain most first.
void Dislocations::find_candidates(std::span<const std::int32_t> changed) {
    const FlatMesh& mesh = valences_.mesh();
    const auto begin = static_cast<std::ptrdiff_t>(candidates_.size());
    const auto take = [&](Side side) {
        if (mesh.is_fixed(side)) return;
        for (const Side s : {side, mesh.behind(side)})
            if (!may_change(mesh.from(s)) || !may_change(mesh.apex(s))) return;
        const int gain = valences_.gain_of_flip(side);
        if (gain < 0) return;
        Edge edge{mesh.from(side), mesh.to(side)};
        if (edge[1] < edge[0]) std::swap(edge[0], edge[1]);
        for (const Flip& flip : way_)
            if (flip.after == edge) return;
        candidates_.push_back({gain, edge});
    };
    for (const std::int32_t v : changed) {
        if (valences_.is_fixed(v) || valences_.is_regular(v)) continue;
        valences_.around(v, [&](Side side) {
            take(side);
            take(side.next());
        });
    }
    std::sort(candidates_.begin() + begin, candidates_.end(),
              [](const Candidate& a, const Candidate& b) {
                  return a.gain != b.gain ? a.gain > b.gain : a.edge < b.edge;
              });
    const auto last =
        std::unique(candidates_.begin() + begin, candidates_.end(),
                    [](const Candidate& a, const Candidate& b) { return a.edge == b.edge; });
    candidates_.erase(last, candidates_.end());
}

Side Dislocations::side_between(const Edge& edge) const {
    Side found = Side::outside();
    valences_.around(edge[0], [&](Side side) {
        if (valences_.mesh().to(side) == edge[1]) found = side;
    });
    return found;
}

}  // namespace realmodel::meshing
