// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/likely_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "fields/frame_function.hpp"
#include "fields/known_data.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/fields/critical_points.hpp"

namespace realmodel::fields {

namespace {

constexpr int kGapRounds = 6;
// A field that is so much steeper between some surfaces than between others has drawn levels
// together.
constexpr double kUneven = 4;
// Levels that come out in the wrong order by more than this share of the mean gap are refused.
constexpr double kWrongOrder = 0.5;
// Of further coordinates: with this one side of a fault says little of the other.
constexpr double kFarLift = 8;
constexpr std::size_t kSampledPairs = 80, kSampledDips = 90, kFewContacts = 600,
                      kSampledForDistance = 2000;
// What a critical point of the field through the sample costs, as a logarithm of likelihood, and on
// how many nodes they are counted.
constexpr double kPerCriticalPoint = 20;
// By so much another kind has to predict better than the plainest.
constexpr double kBetter = 2;
// Errors that each shape is tried with, beside the likeliest. They are in units of the kernel:
// between those of contacts and of dips lie the ratios of a few meters and of some degrees, and
// with the largest ones what is left of a field are planes, one for each surface.
constexpr std::array<Errors, 3> kErrorsOfSecond{{{0, 0}, {0.1, 0}, {1, 100}}};
constexpr std::array<Errors, 8> kErrorsOfThird{
    {{0, 0}, {0, 0.01}, {0, 1}, {1e-3, 0.01}, {0.01, 0.1}, {0.1, 1}, {0.1, 10}, {1, 100}}};
constexpr std::array<Errors, 3> kErrorsOfFifth{{{1e-4, 1e-3}, {1e-3, 1e-2}, {1e-2, 0.1}}};
// Errors are ruled out with which the logarithm of likelihood is less by so much.
constexpr double kRuledOut = 20;
// By so much one kind predicts clearly better than another.
constexpr double kClearly = 10;
constexpr double kLayered = 0.1;  // of ratios
constexpr std::size_t kMostCounted = 50000;
// So many dips tell how the field runs between surfaces, on a lattice of so many nodes.
constexpr std::size_t kLeastDips = 10;
constexpr std::size_t kLeastNodes = 4000;

/// The box of a lattice with nodes farther apart, at most about `most` of them.
Lattice coarsened(const Lattice& lattice, std::size_t most) {
    Lattice out = lattice;
    for (int step = 2; out.nodes() > most; ++step) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int steps = lattice.counts[axis] - 1;
            out.counts[axis] = std::max(steps / step, 1) + 1;
            out.spacing[axis] = lattice.spacing[axis] * steps / (out.counts[axis] - 1);
        }
    }
    return out;
}

/// Inner nodes where a field turns back: its gradient is turned by more than 90 degrees from that
/// at the next node along an axis. Where it falls again behind its data, in a valley as wide as the
/// lattice, it has no critical point inside.
std::vector<std::int64_t> turning_points(const Lattice& lattice, std::span<const double> values,
                                         const Execution& execution) {
    const auto [nx, ny, nz] = lattice.counts;
    const std::array<std::int64_t, 3> steps{1, nx, static_cast<std::int64_t>(nx) * ny};
    const auto gradient = [&](std::int64_t node) {
        Vec3 out{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            out[axis] =
                (values[node + steps[axis]] - values[node - steps[axis]]) / lattice.spacing[axis];
        return out;
    };
    std::vector<std::vector<std::int64_t>> layers(static_cast<std::size_t>(nz));
    parallel_chunks(layers.size(), execution, [&, nx = nx, ny = ny, nz = nz](std::size_t layer) {
        const auto k = static_cast<std::int64_t>(layer);
        if (k == 0 || k >= nz - 1) return;
        for (std::int64_t j = 1; j < ny - 1; ++j) {
            for (std::int64_t i = 1; i < nx - 1; ++i) {
                const std::int64_t node = i + steps[1] * j + steps[2] * k;
                const Vec3 here = gradient(node);
                const std::array<bool, 3> has_next{i + 2 < nx, j + 2 < ny, k + 2 < nz};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (!has_next[axis] || dot(here, gradient(node + steps[axis])) >= 0) continue;
                    layers[layer].push_back(node);
                    break;
                }
            }
        }
    });
    return concatenated(layers);
}

/// How many connected components nodes are. Where the field hardly changes along an axis they
/// come in lines, of which a lattice shows a few: so they are next to each other whose distance in
/// the space that the field is the same in all directions of is no more than a cell's diagonal.
std::size_t connected_components(std::span<const std::int64_t> nodes, const Lattice& lattice,
                                 const AxisRatios& anisotropy) {
    Map3 map = map_of(anisotropy);
    const double most = std::ranges::max(anisotropy.ratios);
    for (Vec3& row : map)
        row = times(1 / most, row);
    std::vector<Vec3> left;  // in no component yet
    const auto nx = lattice.counts[0], ny = lattice.counts[1];
    for (const std::int64_t n : nodes) {
        const auto node = static_cast<int>(n);
        left.push_back(mapped(map, lattice.position(node % nx, node / nx % ny, node / nx / ny)));
    }
    const double next = (1 + 1e-9) * length(lattice.spacing);
    std::size_t components = 0;
    for (; !left.empty(); ++components) {
        std::vector<Vec3> reached{left.back()};
        left.pop_back();
        while (!reached.empty()) {
            const Vec3 from = reached.back();
            reached.pop_back();
            const auto near = std::partition(left.begin(), left.end(), [&](const Vec3& at) {
                return length(minus(at, from)) > next;
            });
            reached.insert(reached.end(), near, left.end());
            left.erase(near, left.end());
        }
    }
    return components;
}

/// Whether a field hardly changes but along one axis: where it turns back, critical points fill a
/// plane. Rough surfaces of few contacts look like such fields by chance: unless it predicts
/// clearly better than plain ones, each of these points counts.
bool is_layered(const Likely& likely) {
    std::array<double, 3> ratios = likely.anisotropy.ratios;
    std::ranges::sort(ratios);
    return ratios[1] < kLayered * ratios[2];
}

bool is_plain(const Likely& likely) {
    return likely.order < 5 && likely.anisotropy.ratios == kIsotropic.ratios;
}

/// The search for it, by samples of the data.
class LikelySearch {
public:
    LikelySearch(const KnownData& known, const Execution& execution)
        : known_(known),
          execution_(execution),
          coarse_(coarsened(known.lattice(), kMostCounted)),
          sample_(spread_pairs(known, kSampledPairs)) {}

    LikelyField likeliest() {
        refuse_wrong_order();
        look();
        if (known_.data().surfaces < 3) return result();
        const std::vector<double> apart = distances_between(known_, kSampledForDistance);
        if (!is_uneven(apart)) return result();
        const LikelySearch free = *this;
        find_gaps(apart, {kIsotropic, {1e-6, 1e-3}, 3, likely_.lift, likely_.throws});
        look();
        find_gaps(apart, likely_);
        look();
        return free.cost_ <= cost_ ? free.result() : result();
    }

    /// Whether the field predicts data better if beds keep their thickness.
    bool is_better_even(const LikelyField& field) const {
        if (!is_told_by_dips()) return false;
        std::vector<Likely> kinds{field.likely, field.likely};
        kinds[1].is_even = true;
        const auto costs = CrossValidation(known_, field.gaps).costs(kinds, execution_);
        return costs[1] + kBetter < costs[0];
    }

private:
    /// A field on a coarse lattice.
    struct CoarseField {
        std::vector<double> levels, values;
    };

    LikelyField result() const {
        LikelyField out{likely_, gaps_, {}};
        if (!is_plain(likely_) && plain_cost_ < cost_ + kClearly)
            out.plain_shares = shares_of(plain_field_ ? *plain_field_ : coarse_field(plain_));
        return out;
    }

    void refuse_wrong_order() const {
        const std::int32_t last = known_.data().surfaces - 1;
        if (last < 1) return;
        const Likely rough{kIsotropic, {1e-6, 1e-3}, 3, kFarLift};
        const Spline spline(sampled({}, rough.order), rough.smoothness(), execution_);
        const std::vector<double> levels = FrameFunction(known_, spline).levels();
        const double mean_gap = known_.total_gap() / last;
        for (std::int32_t k = 0; k < last; ++k) {
            if (levels[k + 1] - levels[k] >= -kWrongOrder * mean_gap) continue;
            const auto older = known_.reference(k), younger = known_.reference(k + 1);
            throw InputError("wrong_order",
                             "surface " + std::to_string(k + 1) +
                                 " lies on the older side of surface " + std::to_string(k),
                             k,
                             {static_cast<std::int64_t>(older), static_cast<std::int64_t>(younger)},
                             known_.data().contacts[younger]);
        }
    }

    void look() {
        const std::vector<Functional> sample = sampled(gaps_, 3);
        const double error = known_.error();
        likely_ = most_likely(sample, known_.data().normals, known_.data().slits.normals, error,
                              execution_);
        std::vector<Likely> shapes{likely_};
        if (is_told_by_dips()) {
            shapes.push_back(most_likely_anywhere(sample, likely_, error, execution_));
            shapes.push_back(most_likely_smooth(sample, shapes[1], error, execution_));
        }
        choose(with_errors(shapes));
    }

    /// Contacts alone do not say how f runs between surfaces, nor do a few dips beside thousands of
    /// contacts. Live edits, whose lattices are coarse, are not to wait for a longer search.
    bool is_told_by_dips() const {
        const FieldData& data = known_.data();
        return data.dips.size() >= kLeastDips && data.contacts.size() <= kFewContacts &&
               known_.lattice().nodes() >= kLeastNodes;
    }

    /// @param apart  how far each surface is from the next
    bool is_uneven(const std::vector<double>& apart) const {
        const Spline spline(sampled(gaps_, likely_.order), likely_.smoothness(), execution_);
        const std::vector<double> levels = FrameFunction(known_, spline).levels();
        double low = 1e300, high = 0;
        for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
            const double steep = (levels[k + 1] - levels[k]) / apart[k];
            low = std::min(low, steep);
            high = std::max(high, steep);
        }
        return high > kUneven * low;
    }

    /// The fixed functionals, of many dips only some, and contacts.
    std::vector<Functional> with(std::span<const std::size_t> contacts,
                                 std::span<const double> gaps, int order) const {
        std::vector<Functional> fixed = known_.fixed(gaps, order);
        const std::size_t dips = known_.data().dips.size();
        const std::size_t stride = (dips + kSampledDips - 1) / kSampledDips;
        std::vector<Functional> out;
        for (std::size_t n = 0; n < fixed.size(); ++n) {
            if (n >= 2 * dips || n / 2 % stride == 0) out.push_back(std::move(fixed[n]));
        }
        for (const std::size_t n : contacts) {
            if (n != known_.reference(known_.surface_of(n))) out.push_back(known_.on_surface(n));
        }
        return out;
    }
    std::vector<Functional> sampled(std::span<const double> gaps, int order) const {
        return with(sample_, gaps, order);
    }

    /// Each shape as it is likeliest and with other errors; before them the third and the second
    /// order, the same in all directions. Between rough surfaces the function whose third
    /// derivatives are least overshoots, and has critical points. That whose second ones are least
    /// bends at contacts instead.
    std::vector<Likely> with_errors(const std::vector<Likely>& shapes) const {
        std::vector<Likely> out;
        const auto add = [&](Likely kind, std::span<const Errors> all) {
            std::vector<Likely> kinds;
            for (const Errors& errors : all) {
                kind.errors = errors;
                kinds.push_back(kind);
            }
            add_possible(std::move(kinds), out);
        };
        add({kIsotropic, {}, 3, likely_.lift, likely_.throws}, kErrorsOfThird);
        add({kIsotropic, {}, 2, likely_.lift, likely_.throws}, kErrorsOfSecond);
        for (const Likely& shape : shapes) {
            out.push_back(shape);
            if (shape.order == 5)
                add(shape, kErrorsOfFifth);
            else
                add(shape, kErrorsOfThird);
        }
        if (known_.error() > 0)
            std::erase_if(out, [](const Likely& kind) { return !(kind.errors.value > 0); });
        return out;
    }

    /// Of a shape those with errors that near contacts and dips allow: what is left out far from
    /// all others says little of errors.
    void add_possible(std::vector<Likely> kinds, std::vector<Likely>& to) const {
        const std::vector<double> likelihoods =
            log_likelihoods(sampled(gaps_, kinds[0].order), kinds, known_.error(), execution_);
        const double least = std::ranges::max(likelihoods) - kRuledOut;
        for (std::size_t n = 0; n < kinds.size(); ++n) {
            if (likelihoods[n] >= least) to.push_back(std::move(kinds[n]));
        }
    }

    /// That which predicts data best that are left out, unless it has critical points: where it
    /// has so many fewer of them another may predict them worse.
    void choose(const std::vector<Likely>& kinds) {
        std::vector<double> costs = CrossValidation(known_, gaps_).costs(kinds, execution_);
        for (std::size_t n = 1; n < kinds.size(); ++n)
            costs[n] += is_plain(kinds[n]) ? kBetter : 2 * kBetter;
        std::vector<std::size_t> ranked(kinds.size());
        std::iota(ranked.begin(), ranked.end(), 0);
        std::ranges::stable_sort(ranked, {}, [&](std::size_t n) { return costs[n]; });
        const auto plain = std::ranges::find_if(ranked, [&](auto n) { return is_plain(kinds[n]); });
        if (plain != ranked.end()) plain_ = kinds[*plain];
        plain_cost_ = plain != ranked.end() ? costs[*plain] : HUGE_VAL;
        plain_field_.reset();
        cost_ = HUGE_VAL;
        for (const std::size_t n : ranked) {
            if (!(costs[n] < cost_)) break;
            CoarseField field = coarse_field(kinds[n]);
            const std::size_t points = critical_points_of(kinds[n], costs[n], field.values);
            if (plain != ranked.end() && n == *plain) plain_field_ = std::move(field);
            const double cost = costs[n] + kPerCriticalPoint * static_cast<double>(points);
            if (!(cost < cost_)) continue;
            cost_ = cost;
            likely_ = kinds[n];
        }
    }

    /// Through some contacts: rough surfaces make critical points where these are close to one
    /// another.
    CoarseField coarse_field(const Likely& likely) const {
        const Spline spline(with(thinned(known_, kFewContacts), gaps_, likely.order),
                            likely.smoothness(), execution_);
        const FrameFunction f(known_, spline);
        return {f.levels(), f.at_nodes(coarse_, 0, execution_)};
    }

    /// @param cost    of what it predicts
    /// @param values  at the coarse nodes
    std::size_t critical_points_of(const Likely& likely, double cost,
                                   std::span<const double> values) const {
        const auto points = critical_points(coarse_, values, execution_);
        if (!is_told_by_dips()) return points.size();
        std::vector<std::int64_t> nodes;
        if (rises_one_way()) nodes = turning_points(coarse_, values, execution_);
        for (const CriticalPoint& point : points)
            nodes.push_back(point.node);
        if (is_layered(likely) && plain_cost_ < cost + kClearly) return nodes.size();
        return connected_components(nodes, coarse_, likely.anisotropy);
    }

    /// Whether dips say nothing of limbs that are overturned.
    bool rises_one_way() const {
        const auto& normals = known_.data().normals;
        Vec3 sum{};
        for (const Vec3& normal : normals)
            sum = plus(sum, normal);
        return std::ranges::all_of(normals, [&](const Vec3& n) { return dot(n, sum) > 0; });
    }

    /// How much of the lattice each block is.
    std::vector<double> shares_of(const CoarseField& field) const {
        const std::vector<double>& levels = field.levels;
        std::vector<double> out(levels.size() + 1);
        for (const double value : field.values)
            out[std::ranges::lower_bound(levels, value) - levels.begin()] +=
                1 / static_cast<double>(coarse_.nodes());
        return out;
    }

    /// Differences of levels with which the field is as steep between all surfaces.
    /// @param apart  how far each surface is from the next
    void find_gaps(const std::vector<double>& apart, const Likely& likely) {
        const std::int32_t last = known_.data().surfaces - 1;
        gaps_ = apart;
        Spline spline(sampled(gaps_, likely.order), likely.smoothness(), execution_);
        for (int round = 0; round < kGapRounds; ++round) {
            const std::vector<double> steep = steepness(spline);
            for (std::int32_t k = 0; k < last; ++k)
                gaps_[k] /= std::clamp(steep[k], 0.5, 2.0);
            spline.set_right(sampled(gaps_, likely.order));
        }
    }

    /// How steep a field is on the two surfaces of each layer.
    std::vector<double> steepness(const Spline& spline) const {
        const auto on = steepness_on_surfaces(known_, spline, sample_);
        std::vector<double> out;
        for (std::size_t k = 0; k + 1 < on.size(); ++k) {
            std::vector<double> both = on[k];
            both.insert(both.end(), on[k + 1].begin(), on[k + 1].end());
            if (both.empty()) both.push_back(1);
            out.push_back(median_steepness(std::move(both)));
        }
        return out;
    }

    const KnownData& known_;
    Execution execution_;
    Lattice coarse_;
    std::vector<std::size_t> sample_;
    Likely likely_, plain_;
    std::optional<CoarseField> plain_field_;  // of plain_, where critical points were counted
    double cost_ = 0, plain_cost_ = 0;
    std::vector<double> gaps_;
};

}  // namespace

LikelyField likely_field(const KnownData& known, std::optional<bool> is_even,
                         const Execution& execution) {
    LikelySearch search(known, execution);
    LikelyField out = search.likeliest();
    out.likely.is_even = is_even ? *is_even : search.is_better_even(out);
    return out;
}

}  // namespace realmodel::fields
