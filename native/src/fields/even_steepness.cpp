// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/even_steepness.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "fields/frame_function.hpp"
#include "fields/neighbors.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::fields {

namespace {

// About so many places; twice as many, or half as many, hardly change fields.
constexpr double kPlaces = 400;
// How far a field may be from rising evenly, as a share. Beds of similar folds do not keep their
// thickness, and where data say so this must cost less than bending.
constexpr double kDeviation = 0.3;
constexpr std::size_t kSampled = 600;
// Of the steepness of a bed: where a field rises less it has no direction.
constexpr double kFlat = 1e-3;

/// How steep a field is on each surface, in the median of contacts.
std::vector<double> steepness_of_surfaces(const KnownData& known, const Spline& spline,
                                          std::span<const std::size_t> contacts) {
    std::vector<std::vector<double>> on(static_cast<std::size_t>(known.data().surfaces));
    for (const std::size_t n : contacts)
        on[known.surface_of(n)].push_back(
            length(spline.gradient(known.contacts()[n], known.lift_of(n))));
    std::vector<double> out;
    for (std::vector<double>& each : on) {
        const auto middle = each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2);
        std::nth_element(each.begin(), middle, each.end());
        out.push_back(std::max(*middle, 1e-9));
    }
    return out;
}

/// How steep it is at a value: between two levels in between, beyond all as on the last one.
double steepness_at(double value, std::span<const double> levels, std::span<const double> steep) {
    const auto above = std::ranges::lower_bound(levels, value);
    if (above == levels.begin()) return steep.front();
    if (above == levels.end()) return steep.back();
    const auto k = static_cast<std::size_t>(above - levels.begin());
    const double share = (value - levels[k - 1]) / (levels[k] - levels[k - 1]);
    return steep[k - 1] + std::clamp(share, 0.0, 1.0) * (steep[k] - steep[k - 1]);
}

}  // namespace

EvenSteepness::EvenSteepness(const KnownData& known)
    : known_(known), contacts_(thinned(known, kSampled)) {
    Lattice coarse = known.lattice();
    Vec3 size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = coarse.spacing[axis] * (coarse.counts[axis] - 1);
    const double step = elementary::pow(size[0] * size[1] * size[2] / kPlaces, 1.0 / 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        coarse.counts[axis] = std::max(1, static_cast<int>(std::lround(size[axis] / step)));
        coarse.spacing[axis] = size[axis] / coarse.counts[axis];
        coarse.origin[axis] += 0.5 * coarse.spacing[axis];
    }
    for (int k = 0; k < coarse.counts[2]; ++k) {
        for (int j = 0; j < coarse.counts[1]; ++j) {
            for (int i = 0; i < coarse.counts[0]; ++i) {
                const Vec3 at = coarse.position(i, j, k);
                // the combinations of sides of faults by turns
                const std::size_t side = places_.size() % known.data().slits.sides;
                places_.push_back(
                    {known.frame().to_local(at), lifts_at(known, std::span(&at, 1), side)});
            }
        }
    }
}

std::vector<Vec3> EvenSteepness::directions(const Spline& spline) const {
    const std::vector<double> levels = FrameFunction(known_, spline).levels();
    const std::vector<double> steep = steepness_of_surfaces(known_, spline, contacts_);
    std::vector<Vec3> out;
    for (const Place& place : places_) {
        const Vec3 rise = spline.gradient(place.at, place.lift);
        const double own = length(rise);
        const double given = steepness_at(spline.value(place.at, place.lift), levels, steep);
        out.push_back(own > kFlat * given ? times(1 / (given * own), rise) : Vec3{});
    }
    return out;
}

std::vector<Functional> EvenSteepness::rows(std::span<const Vec3> directions, int order,
                                            double variance) const {
    assert(directions.size() == places_.size());
    std::vector<Functional> out;
    for (std::size_t n = 0; n < places_.size() && std::isfinite(variance); ++n) {
        if (!(length(directions[n]) > 0)) continue;
        const Place& place = places_[n];
        const Lift as_it_is(place.lift.size(), 0.0);
        Functional row{{}, {{place.at, directions[n], place.lift, as_it_is}}, 1, false};
        row.error = variance;
        out.push_back(known_.for_order(order, row));
    }
    return out;
}

double EvenSteepness::variance(const Spline& spline) {
    return kDeviation * kDeviation / spline.scale();
}

}  // namespace realmodel::fields
