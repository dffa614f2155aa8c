// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/neighbors.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace realmodel::fields {

Cube cube_of(const KnownData& known, std::size_t contact, double size) {
    Cube cube{0, 0, 0, known.surface_of(contact)};
    for (std::size_t axis = 0; axis < 3; ++axis)
        cube[axis] = static_cast<std::int64_t>(std::floor(known.contacts()[contact][axis] / size));
    return cube;
}

std::vector<std::size_t> thinned(const KnownData& known, std::size_t most) {
    std::vector<std::size_t> kept;
    for (double size = 1.0 / 64;; size *= 1.25) {
        std::map<Cube, std::size_t> first;
        for (std::size_t n = 0; n < known.contacts().size(); ++n)
            first.emplace(cube_of(known, n, size), n);
        if (first.size() > most && size < 4) continue;
        kept.clear();
        for (const auto& [cube, n] : first)
            kept.push_back(n);
        std::sort(kept.begin(), kept.end());
        return kept;
    }
}

std::vector<std::size_t> spread_pairs(const KnownData& known, std::size_t most) {
    const std::vector<Vec3>& at = known.contacts();
    std::set<std::size_t> numbers;
    for (const std::size_t n : thinned(known, most)) {
        numbers.insert(n);
        std::size_t nearest = n;
        double least = 1e300;
        for (std::size_t m = 0; m < at.size(); ++m) {
            const Vec3 d = minus(at[m], at[n]);
            const double squared = dot(d, d);
            if (m == n || known.surface_of(m) != known.surface_of(n) || !(squared > 0) ||
                squared >= least)
                continue;
            least = squared;
            nearest = m;
        }
        numbers.insert(nearest);
    }
    std::vector<std::size_t> out;
    for (const std::size_t n : numbers) {
        if (n != known.reference(known.surface_of(n))) out.push_back(n);
    }
    return out;
}

std::vector<double> distances_between(const KnownData& known, std::size_t most) {
    const std::vector<Vec3>& at = known.contacts();
    std::vector<std::vector<std::size_t>> on(known.data().surfaces);
    for (const std::size_t n : thinned(known, most))
        on[known.surface_of(n)].push_back(n);
    std::vector<Lift> lifts;
    for (std::size_t n = 0; n < at.size(); ++n)
        lifts.push_back(known.lift_of(n));
    std::vector<double> out;
    for (std::size_t k = 0; k + 1 < on.size(); ++k) {
        std::vector<double> nearest;
        for (const std::size_t n : on[k]) {
            double least = 1e300;
            for (const std::size_t m : on[k + 1]) {
                const Vec3 d = minus(at[m], at[n]);
                least = std::min(least, std::sqrt(dot(d, d) + squared(lifts[m], lifts[n])));
            }
            nearest.push_back(least);
        }
        const auto tenth = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 10);
        std::nth_element(nearest.begin(), tenth, nearest.end());
        out.push_back(std::max(*tenth, 1e-6));
    }
    return out;
}

bool is_against_neighbors(const KnownData& known, std::size_t dip) {
    const FieldData& data = known.data();
    constexpr std::size_t kNearest = 3, kNear = 8;
    constexpr double kAlike = 0.7;
    const Lift lift = known.lift_of_dip(dip);
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t n = 0; n < data.dips.size(); ++n) {
        if (n == dip) continue;
        const Vec3 d = times(1 / known.frame().unit, minus(data.dips[n], data.dips[dip]));
        near.emplace_back(dot(d, d) + squared(known.lift_of_dip(n), lift), n);
    }
    if (near.size() < kNearest) return false;
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), kNear));
    for (std::size_t n = 0; n < near.size(); ++n) {
        const double cosine = dot(data.normals[near[n].second], data.normals[dip]);
        if (n < kNearest ? cosine > -kAlike : cosine > kAlike) return false;
    }
    return true;
}

}  // namespace realmodel::fields
