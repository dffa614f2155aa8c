// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "fields/likely_field.hpp"
#include "fields/spline.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::fields {

namespace {

// So much the logarithm of the likelihood has to rise for a ratio and a direction more.
constexpr double kWorth = 4;
constexpr double kLeastRatio = 0.01;
// Of the fifth order one over the least range.
constexpr double kLargestRatio = 8;
// Of the fifth order, of whose variance they are: without them its systems would be singular to
// rounding where ranges are long. A hundred thousandth of how much folds rise and fall.
constexpr Errors kLeastErrors{1e-10, 1e-8};
// That of slopes is as large as they are. Where data are nothing but errors, larger ones would be
// likelier without end.
constexpr Errors kLargestErrors{0.01, 1};
// Scales of further coordinates: with the least one the sides of a fault hardly differ but by its
// throw, with the largest one says little of the other.
constexpr double kLeastLift = 1.0 / 64;
constexpr std::size_t kLifts = 10;
// Throws that are tried, for each fault in turn, so many times; then what is near the best, until
// steps are so short.
constexpr std::array kThrows{0.02, 0.05, 0.1, 0.16, 0.24};
constexpr int kSweeps = 2;
constexpr double kLeastThrow = 0.002;
constexpr double kFirstError = 1e-6;  // of values, in units of the kernel, where they have some
// Of dips, of the fifth order: with none at first the search ends at ranges so short that the
// errors are taken for folds.
constexpr double kFirstSlopeError = 1e-3;

struct AnisotropyCandidate {
    Likely what;
    double likelihood = -HUGE_VAL;
};

/// Compares anisotropies.
class Search {
public:
    Search(std::span<const Functional> known, double error, const Execution& execution)
        : known_(known), error_(error), execution_(execution) {}

    /// Whether values have errors in any case.
    bool has_errors() const { return error_ > 0; }

    /// The best of some; the first of equal ones.
    AnisotropyCandidate best(std::span<const Likely> of) const {
        const std::vector<double> likelihood = log_likelihoods(known_, of, error_, execution_);
        const auto at = std::max_element(likelihood.begin(), likelihood.end()) - likelihood.begin();
        return {of[at], likelihood[at]};
    }
    /// The best of some with the anisotropies in the place of theirs.
    AnisotropyCandidate best(std::span<const AxisRatios> of, const Likely& rest) const {
        std::vector<Likely> all(of.size(), rest);
        for (std::size_t n = 0; n < of.size(); ++n)
            all[n].anisotropy = of[n];
        return best(all);
    }

    /// `other` where it is better by `worth`.
    static void improve(AnisotropyCandidate& best, const AnisotropyCandidate& other, double worth) {
        if (other.likelihood > best.likelihood + worth) best = other;
    }

private:
    std::span<const Functional> known_;
    double error_;
    Execution execution_;
};

/// The direction to which the normals are most nearly perpendicular.
Vec3 fold_axis(std::span<const Vec3> normals) {
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    for (const Vec3& n : normals) {
        const Eigen::Vector3d v(n[0], n[1], n[2]);
        tensor += v * v.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
    const Eigen::Vector3d axis = solver.eigenvectors().col(0);
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    const double sign = axis(largest) < 0 ? -1 : 1;
    return unit({sign * axis(0), sign * axis(1), sign * axis(2)});
}

AxisRatios along_axis(const Vec3& axis, double ratio) {
    const Vec3 second = perpendicular(axis);
    return {{axis, second, cross(axis, second)}, {ratio, 1, 1}};
}

/// Turned about one of its axes.
AxisRatios turned_about(AxisRatios of, std::size_t axis, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    Vec3& second = of.axes[(axis + 1) % 3];
    Vec3& third = of.axes[(axis + 2) % 3];
    second =
        unit(plus(times(elementary::cos(angle), second), times(elementary::sin(angle), third)));
    third = cross(of.axes[axis], second);
    return of;
}

/// With its second axis turned about the first, and another ratio along it.
AxisRatios turned(const AxisRatios& of, double degrees, double ratio) {
    AxisRatios out = turned_about(of, 0, degrees);
    out.ratios = {of.ratios[0], ratio, 1};
    return out;
}

std::vector<Vec3> main_directions() {
    std::vector<Vec3> out;
    for (int code = 14; code < 27; ++code) {
        out.push_back(unit({code % 3 - 1.0, code / 3 % 3 - 1.0, code / 9 - 1.0}));
    }
    return out;
}

void search_first(const Search& search, std::span<const Vec3> normals, AnisotropyCandidate& best) {
    const Likely rest = best.what;
    std::vector<AxisRatios> tried;
    if (normals.size() >= 3) {
        const Vec3 axis = fold_axis(normals);
        for (const double ratio : {0.5, 0.25, 0.1, 0.05, 0.02, kLeastRatio})
            tried.push_back(along_axis(axis, ratio));
        Search::improve(best, search.best(tried, rest), kWorth);
    }
    if (best.what.anisotropy.ratios[0] < 1) return;
    tried.clear();
    for (const Vec3& direction : main_directions())
        tried.push_back(along_axis(direction, 0.5));
    const Vec3 direction = search.best(tried, rest).what.anisotropy.axes[0];
    tried.clear();
    for (const double ratio : {0.7, 0.5, 0.35, 0.25, 0.1})
        tried.push_back(along_axis(direction, ratio));
    Search::improve(best, search.best(tried, rest), kWorth);
}

void search_second(const Search& search, AnisotropyCandidate& best) {
    const Likely rest = best.what;
    std::vector<AxisRatios> tried;
    const AxisRatios first = best.what.anisotropy;
    for (int degrees = 0; degrees < 180; degrees += 20) {
        for (const double ratio : {0.6, 0.3})
            tried.push_back(turned(first, degrees, ratio));
    }
    AnisotropyCandidate candidate = search.best(tried, rest);
    double step = 12, factor = 0.6;
    for (int round = 0; round < 8; ++round) {
        const AxisRatios at = candidate.what.anisotropy;
        const double ratio = at.ratios[1];
        tried = {turned(at, step, ratio), turned(at, -step, ratio),
                 turned(at, 0, std::max(kLeastRatio, ratio * factor)),
                 turned(at, 0, std::min(1.0, ratio / factor))};
        const double before = candidate.likelihood;
        Search::improve(candidate, search.best(tried, rest), 0);
        if (candidate.likelihood > before) continue;
        step /= 2;
        factor = std::sqrt(factor);
    }
    Search::improve(best, candidate, kWorth);
}

/// Those near one: turned about each axis, with other ratios along two of them, or with ranges
/// along three, and with other errors.
std::vector<Likely> near(const Likely& of, double degrees, double factor) {
    const bool has_ranges = of.order == 5;
    const std::size_t ratios = has_ranges ? 3 : 2;
    const double largest = has_ranges ? kLargestRatio : 1;
    const Errors least = has_ranges ? kLeastErrors : Errors{};
    std::vector<Likely> out;
    for (const double turn : {degrees, -degrees}) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            out.emplace_back(of).anisotropy = turned_about(of.anisotropy, axis, turn);
    }
    for (const double times : {factor, 1 / factor}) {
        for (std::size_t axis = 0; axis < ratios; ++axis) {
            double& ratio = out.emplace_back(of).anisotropy.ratios[axis];
            ratio = std::clamp(ratio * times, kLeastRatio, largest);
        }
        // variances: squares of lengths, too
        double& value = out.emplace_back(of).errors.value;
        value = std::clamp(value * times * times, least.value, kLargestErrors.value);
        double& slope = out.emplace_back(of).errors.slope;
        slope = std::clamp(slope * times * times, least.slope, kLargestErrors.slope);
    }
    return out;
}

/// With its axes in the order of their ratios, right-handed.
AxisRatios sorted(const AxisRatios& of) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::stable_sort(order, {}, [&](std::size_t axis) { return of.ratios[axis]; });
    AxisRatios out;
    for (std::size_t n = 0; n < 3; ++n) {
        out.axes[n] = of.axes[order[n]];
        out.ratios[n] = of.ratios[order[n]];
    }
    out.axes[2] = cross(Vec3{out.axes[0]}, Vec3{out.axes[1]});
    return out;
}

/// The best near one: smaller and smaller steps as long as they pay.
AnisotropyCandidate climbed(const Search& search, AnisotropyCandidate candidate) {
    double step = 20, factor = 0.5;
    while (step > 2) {
        const double before = candidate.likelihood;
        Search::improve(candidate, search.best(near(candidate.what, step, factor)), 0);
        if (candidate.likelihood > before) continue;
        step /= 2;
        factor = std::sqrt(factor);
    }
    candidate.what.anisotropy = sorted(candidate.what.anisotropy);
    return candidate;
}

/// Any directions: rocks that are folded twice have no fold axis in common, but beds may have been
/// moved along one direction.
void search_any(const Search& search, AnisotropyCandidate& best) {
    std::vector<AxisRatios> tried;
    for (const double second : {1.0, 0.3}) {
        for (const Vec3& direction : main_directions()) {
            tried.push_back(along_axis(direction, 0.3));
            tried.back().ratios[1] = second;
        }
    }
    const AnisotropyCandidate other = climbed(search, search.best(tried, best.what));
    Search::improve(best, other, 2 * kWorth);
    Search::improve(best, climbed(search, best), 2 * kWorth);
}

/// Other errors with the anisotropy of the best.
void search_errors(const Search& search, AnisotropyCandidate& best) {
    std::vector<Likely> tried;
    std::vector<double> values{0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5};
    if (search.has_errors()) values.insert(values.end(), {1e-4, 1e-3, 1e-2});
    for (const double value : values) {
        for (const double slope : {0.0, 1e-4, 1e-3, 1e-2, 1e-1}) {
            tried.push_back(best.what);
            tried.back().errors = {value, slope};
        }
    }
    Search::improve(best, search.best(tried), search.has_errors() ? 0 : kWorth);
}

/// Other scales of further coordinates: the larger, the less one side says of the other.
void search_lift(const Search& search, AnisotropyCandidate& best) {
    std::vector<Likely> tried(kLifts, best.what);
    double lift = kLeastLift;
    for (Likely& kind : tried) {
        kind.lift = lift;
        lift *= 2;
    }
    Search::improve(best, search.best(tried), 0);
}

/// The same with another throw of a fault: `step` away in all directions in its plane.
std::vector<Likely> thrown(const Likely& of, std::size_t fault, const Vec3& normal, double step,
                           int directions) {
    const Vec3 first = perpendicular(normal), second = cross(normal, first);
    std::vector<Likely> out(static_cast<std::size_t>(directions), of);
    for (int n = 0; n < directions; ++n) {
        const double angle = 2 * std::numbers::pi * n / directions;
        Vec3& fault_throw = out[static_cast<std::size_t>(n)].throws[fault];
        fault_throw = moved(fault_throw, step * elementary::cos(angle), first);
        fault_throw = moved(fault_throw, step * elementary::sin(angle), second);
    }
    return out;
}

/// Throws of faults, in their planes. They are seen only if the two sides hardly differ otherwise.
void search_throws(const Search& search, std::span<const Vec3> normals, AnisotropyCandidate& best) {
    Likely start = best.what;
    const bool is_first = start.throws.empty();
    if (is_first) {
        start.throws.assign(normals.size(), Vec3{});
        start.lift = kLeastLift;
    }
    AnisotropyCandidate candidate = search.best(std::array{start});
    const auto look = [&](std::span<const double> steps, int directions) {
        for (std::size_t fault = 0; fault < normals.size(); ++fault) {
            std::vector<Likely> tried;
            for (const double step : steps) {
                for (Likely& kind : thrown(candidate.what, fault, normals[fault], step, directions))
                    tried.push_back(std::move(kind));
            }
            Search::improve(candidate, search.best(tried), 0);
        }
    };
    for (int sweep = 0; is_first && sweep < kSweeps; ++sweep)
        look(kThrows, 12);
    for (double step = 0.04; step > kLeastThrow; step /= 2)
        look(std::array{step}, 6);
    search_lift(search, candidate);
    Search::improve(best, candidate, is_first ? kWorth : 0);
}

}  // namespace

std::vector<double> log_likelihoods(std::span<const Functional> known,
                                    std::span<const Likely> kinds, double error,
                                    const Execution& execution) {
    std::vector<double> out(kinds.size());
    parallel_chunks(kinds.size(), execution, [&](std::size_t n) {
        const Spline spline(known, kinds[n].smoothness(), {1, nullptr});
        out[n] = spline.log_likelihood(error).value_or(-HUGE_VAL);
    });
    return out;
}

Map3 map_of(const AxisRatios& anisotropy) {
    Map3 map{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Vec3& direction = anisotropy.axes[axis];
        for (std::size_t row = 0; row < 3; ++row)
            map[row] = moved(map[row], anisotropy.ratios[axis] * direction[row], direction);
    }
    return map;
}

Likely most_likely(std::span<const Functional> known, std::span<const Vec3> normals,
                   std::span<const Vec3> faults, double error, const Execution& execution) {
    const Search search(known, error, execution);
    const auto climb = [&](AnisotropyCandidate best) {
        search_first(search, normals, best);
        search_second(search, best);
        if (!faults.empty()) {
            search_lift(search, best);
            search_throws(search, faults, best);
            search_first(search, normals, best);
            search_second(search, best);
            search_throws(search, faults, best);
        }
        search_errors(search, best);
        return best;
    };
    Likely plain;
    if (search.has_errors()) plain.errors.value = kFirstError;
    const AnisotropyCandidate start = search.best(std::array{plain});
    AnisotropyCandidate rough = start;
    search_errors(search, rough);
    AnisotropyCandidate best = climb(start);
    if (rough.likelihood > start.likelihood) Search::improve(best, climb(rough), kWorth);
    return best.what;
}

Likely most_likely_anywhere(std::span<const Functional> known, const Likely& likely, double error,
                            const Execution& execution) {
    const Search search(known, error, execution);
    AnisotropyCandidate best = search.best(std::array{likely});
    search_any(search, best);
    search_errors(search, best);
    return best.what;
}

Likely most_likely_smooth(std::span<const Functional> known, const Likely& likely, double error,
                          const Execution& execution) {
    const Search search(known, error, execution);
    std::vector<Likely> starts;
    for (const double slope : {kLeastErrors.slope, kFirstSlopeError}) {
        for (const AxisRatios& shape : {likely.anisotropy, kIsotropic}) {
            for (const double factor : {1.0, 2.0, 4.0, 8.0}) {
                Likely& start = starts.emplace_back(likely);
                start.order = 5;
                start.errors = {std::max(likely.errors.value, kLeastErrors.value),
                                std::max(likely.errors.slope, slope)};
                start.anisotropy = shape;
                for (double& ratio : start.anisotropy.ratios)
                    ratio *= factor;
                start.lift *= factor;
            }
        }
    }
    AnisotropyCandidate best = search.best(std::array{likely});
    Search::improve(best, climbed(search, search.best(starts)), 2 * kWorth);
    return best.what;
}

}  // namespace realmodel::fields
