// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "fields/frame_function.hpp"
#include "fields/known_data.hpp"
#include "fields/likely_field.hpp"
#include "fields/spline.hpp"
#include "fields/spline_constraints.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::fields {

namespace {

constexpr std::size_t kMostContacts = 200, kMostDips = 60, kMostForDistance = 2000;
constexpr int kFolds = 6;
// Data are divided among so many places at most, by which is nearest.
constexpr std::size_t kMostPlaces = 24;
// In the frame, and radians: what is missed by more counts as much; less counts for nothing, as
// data are hardly better.
constexpr double kFar = 0.5, kTooNear = 1e-4, kLeastAngle = 1e-3;
constexpr int kRounds = 3;  // in which inequalities become active
constexpr double kHeld = 1e-9;

/// The fold of each position: places are spread over them, each as far from those before it as it
/// can be.
std::vector<int> folds_of(std::span<const Vec3> at) {
    const std::size_t half = std::max<std::size_t>(at.size() / 2, kFolds);
    std::vector<double> away(at.size(), HUGE_VAL);
    std::vector<int> fold(at.size(), 0);
    std::size_t next = 0;
    for (std::size_t place = 0; place < std::min({kMostPlaces, half, at.size()}); ++place) {
        for (std::size_t n = 0; n < at.size(); ++n) {
            const Vec3 d = minus(at[n], at[next]);
            if (!(dot(d, d) < away[n])) continue;
            away[n] = dot(d, d);
            fold[n] = static_cast<int>(place % kFolds);
        }
        next = static_cast<std::size_t>(std::ranges::max_element(away) - away.begin());
    }
    return fold;
}

double log_of_mean(double squares, std::size_t count, double least) {
    const auto n = static_cast<double>(count);
    return count == 0 ? 0 : n * elementary::log(squares / n + least);
}

}  // namespace

CrossValidation::CrossValidation(const KnownData& known, std::span<const double> gaps)
    : known_(known), gaps_(gaps.begin(), gaps.end()), even_(known) {
    std::vector<Vec3> at;
    for (const std::size_t n : thinned(known, kMostContacts)) {
        if (n == known.reference(known.surface_of(n))) continue;
        contacts_.push_back(n);
        at.push_back(known.contacts()[n]);
    }
    const FieldData& data = known.data();
    const std::size_t stride = (data.dips.size() + kMostDips - 1) / kMostDips;
    for (std::size_t n = 0; n < data.dips.size(); n += stride) {
        dips_.push_back(n);
        at.push_back(known.frame().to_local(data.dips[n]));
    }
    const std::vector<int> folds = folds_of(at);
    const auto first_dip = folds.begin() + static_cast<std::ptrdiff_t>(contacts_.size());
    contact_folds_.assign(folds.begin(), first_dip);
    dip_folds_.assign(first_dip, folds.end());
    if (data.surfaces < 2) return;
    const auto sum = [](std::span<const double> of) {
        return std::accumulate(of.begin(), of.end(), 0.0);
    };
    steepness_ = (gaps.empty() ? known.total_gap() : sum(gaps)) /
                 sum(distances_between(known, kMostForDistance));
}

std::vector<double> CrossValidation::costs(std::span<const Likely> kinds,
                                           const Execution& execution) const {
    std::vector<Missed> all(kinds.size() * kFolds);
    parallel_chunks(all.size(), execution, [&](std::size_t n) {
        all[n] = missed(kinds[n / kFolds], static_cast<int>(n % kFolds));
    });
    std::vector<double> out;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        Missed sum;
        for (std::size_t fold = k * kFolds; fold < (k + 1) * kFolds; ++fold) {
            sum.distances += all[fold].distances;
            sum.angles += all[fold].angles;
        }
        out.push_back(log_of_mean(sum.distances, contacts_.size(), kTooNear) +
                      log_of_mean(sum.angles, dips_.size(), kLeastAngle));
    }
    return out;
}

std::vector<Functional> CrossValidation::rows_without(int fold, int order) const {
    const std::vector<Functional> fixed = known_.fixed(gaps_, order);
    std::vector<Functional> rows;
    for (std::size_t k = 0; k < dips_.size(); ++k) {
        if (dip_folds_[k] == fold) continue;
        rows.push_back(fixed[2 * dips_[k]]);
        rows.push_back(fixed[2 * dips_[k] + 1]);
    }
    rows.insert(rows.end(), fixed.begin() + 2 * std::ssize(known_.data().dips), fixed.end());
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        if (contact_folds_[k] != fold) rows.push_back(known_.on_surface(contacts_[k]));
    }
    return rows;
}

std::vector<Inequality> CrossValidation::inequalities_without(int fold, int order) const {
    std::vector<std::uint8_t> is_used(known_.data().dips.size(), 0);
    for (std::size_t k = 0; k < dips_.size(); ++k)
        is_used[dips_[k]] = dip_folds_[k] == fold ? 0 : 1;
    std::vector<Inequality> out;
    for (Inequality& inequality : known_.inequalities(order)) {
        if (inequality.kind == Inequality::Origin::kBound) continue;  // may contradict other data
        if (inequality.kind == Inequality::Origin::kPolarity &&
            is_used[static_cast<std::size_t>(inequality.item)] == 0)
            continue;
        out.push_back(std::move(inequality));
    }
    return out;
}

Spline CrossValidation::solved(const Likely& kind, std::vector<Functional> rows,
                               ActiveInequalities& active) const {
    const Execution alone{1, nullptr};
    const std::size_t known = rows.size();
    active.append_to(rows);
    Spline spline(rows, kind.smoothness(), alone);
    for (int round = 0; round < kRounds && active.activate(spline, kHeld); ++round) {
        rows.resize(known);
        active.append_to(rows);
        spline = Spline(rows, kind.smoothness(), alone);
    }
    return spline;
}

CrossValidation::Missed CrossValidation::missed(const Likely& kind, int fold) const {
    const std::vector<Functional> rows = rows_without(fold, kind.order);
    ActiveInequalities active(inequalities_without(fold, kind.order));
    Spline spline = solved(kind, rows, active);
    const double variance = EvenSteepness::variance(spline);
    for (int round = 0; kind.is_even && round < EvenSteepness::kRounds; ++round) {
        std::vector<Functional> all = rows;
        for (Functional& row : even_.rows(even_.directions(spline), kind.order, variance))
            all.push_back(std::move(row));
        spline = solved(kind, std::move(all), active);
    }
    const std::vector<double> levels = FrameFunction(known_, spline).levels();
    Missed out;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        if (contact_folds_[k] != fold) continue;
        const std::size_t n = contacts_[k];
        const Vec3& at = known_.contacts()[n];
        const Lift lift = known_.lift_of(n);
        const double off = std::abs(spline.value(at, lift) - levels[known_.surface_of(n)]);
        // where it is steep it may be so because it folds back: then levels are near everywhere
        const double steep = std::min(length(spline.gradient(at, lift)), steepness_);
        const double away = off < kFar * steep ? off / steep : kFar;
        out.distances += away;
    }
    for (std::size_t k = 0; k < dips_.size(); ++k) {
        if (dip_folds_[k] != fold) continue;
        const std::size_t n = dips_[k];
        const Vec3 at = known_.frame().to_local(known_.data().dips[n]);
        const Vec3 rise = spline.gradient(at, known_.lift_of_dip(n));
        const double steep = length(rise);
        const double cosine = steep > 0 ? dot(rise, known_.data().normals[n]) / steep : -1;
        out.angles += std::sqrt(2 * std::max(0.0, 1 - cosine));
    }
    return out;
}

}  // namespace realmodel::fields
