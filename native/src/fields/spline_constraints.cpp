// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/spline_constraints.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/algorithms.hpp"
#include "fields/frame_function.hpp"
#include "fields/known_data.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::fields {

namespace {

// So many inequalities become active in one round, those that are missed most.
constexpr std::size_t kMostActivated = 200;
constexpr std::size_t kSampledMisfits = 128;
// Data are suspected if the field would miss them by more, as squares, than this times what four
// fifths of the data are missed by without themselves, and than this share of the most.
constexpr double kSuspect = 8, kAsMuch = 0.1;
constexpr double kApart = 0.1;  // of half of the lattice's diagonal

}  // namespace

void ActiveInequalities::leave_out(std::span<const std::size_t> numbers) {
    for (InequalityState& state : states_)  // what was bent for those may be right again
        state = {false, false, false, state.left_out};
    for (const std::size_t n : numbers)
        states_[n].left_out = true;
}

void ActiveInequalities::append_to(std::vector<Functional>& rows) const {
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (!states_[n].active) continue;
        rows.push_back(all_[n].functional);
        rows.back().right = all_[n].least;
    }
}

bool ActiveInequalities::activate(const Spline& spline, double met) {
    std::vector<std::pair<double, std::size_t>> missed;
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (states_[n].active || states_[n].left_out) continue;
        const double lack = all_[n].least - spline.of(all_[n].functional);
        if (lack > met) missed.emplace_back(-lack, n);
    }
    std::sort(missed.begin(), missed.end());
    missed.resize(std::min(missed.size(), kMostActivated));
    for (const auto& [lack, n] : missed) {
        if (states_[n].was_released) states_[n].stays = true;
        states_[n].active = true;
    }
    return !missed.empty();
}

bool ActiveInequalities::release(const Spline& spline, std::size_t first_row) {
    bool any = false;
    std::size_t row = first_row;
    for (InequalityState& state : states_) {
        if (!state.active) continue;
        const double force = spline.force(row++);
        if (force >= 0 || state.stays) continue;
        state.active = false;
        state.was_released = true;
        any = true;
    }
    return any;
}

std::vector<std::size_t> ActiveInequalities::suspected(const Spline& spline,
                                                       std::size_t first_row) const {
    std::vector<std::size_t> rows, numbers;
    const std::size_t step = std::max<std::size_t>(1, first_row / kSampledMisfits);
    for (std::size_t row = 0; row < first_row; row += step)
        rows.push_back(row);
    const std::size_t sampled = rows.size();
    std::size_t row = first_row;
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (!states_[n].active) continue;
        if (all_[n].kind != Inequality::Origin::kOrder) {
            rows.push_back(row);
            numbers.push_back(n);
        }
        ++row;
    }
    if (numbers.empty()) return {};
    const std::vector<double> misfits = spline.misfits_without(rows);
    std::vector<double> sorted = misfits;
    const auto usual = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 4 / 5);
    std::nth_element(sorted.begin(), usual, sorted.end());
    const double most =
        *std::max_element(misfits.begin() + static_cast<std::ptrdiff_t>(sampled), misfits.end());
    const double least = std::max(kSuspect * *usual, kAsMuch * most);
    std::vector<std::pair<double, std::size_t>> suspects;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (misfits[sampled + k] > least) suspects.emplace_back(-misfits[sampled + k], numbers[k]);
    }
    std::sort(suspects.begin(), suspects.end());
    std::vector<std::size_t> out;
    for (const auto& suspect : suspects) {
        const std::size_t n = suspect.second;
        const auto is_near = [&](std::size_t other) {
            return length(minus(all_[n].at, all_[other].at)) < kApart;
        };
        if (std::ranges::none_of(out, is_near)) out.push_back(n);
    }
    return out;
}

namespace {

// About so many places; twice as many, or half as many, hardly change fields.
constexpr double kPlaces = 400;
// How far a field may be from rising evenly, as a share. Beds of similar folds do not keep their
// thickness, and where data say so this must cost less than bending.
constexpr double kDeviation = 0.3;
constexpr std::size_t kSampled = 600;
// Of the steepness of a bed: where a field rises less it has no direction.
constexpr double kFlat = 1e-3;

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

std::vector<std::vector<double>> steepness_on_surfaces(const KnownData& known, const Spline& spline,
                                                       std::span<const std::size_t> contacts) {
    std::vector<std::vector<double>> on(static_cast<std::size_t>(known.data().surfaces));
    for (const std::size_t n : contacts)
        on[known.surface_of(n)].push_back(
            length(spline.gradient(known.contacts()[n], known.lift_of(n))));
    return on;
}

double median_steepness(std::vector<double> steepness) {
    const auto middle = steepness.begin() + static_cast<std::ptrdiff_t>(steepness.size() / 2);
    std::nth_element(steepness.begin(), middle, steepness.end());
    return std::max(*middle, 1e-9);
}

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
                const std::size_t combination = places_.size() % known.data().slits.combinations;
                places_.push_back(
                    {known.frame().to_local(at), lifts_at(known, std::span(&at, 1), combination)});
            }
        }
    }
}

std::vector<Vec3> EvenSteepness::directions(const Spline& spline) const {
    const std::vector<double> levels = FrameFunction(known_, spline).levels();
    const std::vector<double> steep =
        transformed(steepness_on_surfaces(known_, spline, contacts_), median_steepness);
    std::vector<Vec3> out;
    for (const SteepnessSample& place : places_) {
        const Vec3 rise = spline.gradient(place.at, place.lift);
        const double slope = length(rise);
        const double expected = steepness_at(spline.value(place.at, place.lift), levels, steep);
        out.push_back(slope > kFlat * expected ? times(1 / (expected * slope), rise) : Vec3{});
    }
    return out;
}

std::vector<Functional> EvenSteepness::rows(std::span<const Vec3> directions, int order,
                                            double variance) const {
    assert(directions.size() == places_.size());
    std::vector<Functional> out;
    for (std::size_t n = 0; n < places_.size() && std::isfinite(variance); ++n) {
        if (!(length(directions[n]) > 0)) continue;
        const SteepnessSample& place = places_[n];
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
