// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/dsi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "base/vectors.hpp"
#include "interpolation/dsi/smooth_system.hpp"
#include "interpolation/dsi/spline_grid.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/mesh_locator.hpp"

namespace realmodel::interpolation {

namespace {

using Triangle = OrderedMesh::Triangle;
using Relation = Constraint::Relation;

// Strength of constraints that are met exactly, in units of the mesh's stiffness: a larger one
// needs fewer rounds of multipliers, and makes each round slower.
constexpr double kExactStrength = 8;
// The same of rises, which bend a triangle against its neighbors alone: these are stiffer.
constexpr double kExactRiseStrength = 32;
// A round of multipliers that leaves more than this of what was missing ends them: points
// contradict each other on the mesh. With dips, which are met more slowly, it has to leave more.
constexpr double kStalled = 0.5, kStalledWithDips = 0.9;
constexpr double kTolerance = 1e-8;  // of the range of heights
constexpr int kMostRounds = 30;
// The same where the bounds that count are settled first; rounds for that before each; and how many
// rounds in turn may bring little: bounds contradict each other on the mesh.
constexpr int kMostCarefulRounds = 100, kMostSettling = 20, kMostStalled = 6;
constexpr double kFirstTolerance = 1e-4, kLastTolerance = 1e-9, kWeightedTolerance = 1e-9;
// Of the mesh's stiffness against a tilt: what holds a tilt that the points leave open.
constexpr double kTiltStrength = 1e-6;

void check_node_heights(std::span<const double> heights, std::size_t nodes, const char* what) {
    if (!heights.empty() && heights.size() != nodes) {
        throw InputError("option", std::string(what) + " has " + std::to_string(heights.size()) +
                                       " heights for " + std::to_string(nodes) + " nodes");
    }
    for (std::size_t i = 0; i < heights.size(); ++i) {
        if (!std::isinf(heights[i])) continue;
        throw InputError(
            "not_finite",
            std::string(what) + " of node " + std::to_string(i) + " is infinite; NaN means none",
            -1, {static_cast<std::int64_t>(i)});
    }
}

void check_constraints(const DsiConstraints& c, std::size_t nodes) {
    check_node_heights(c.equal, nodes, "the fixed height");
    check_node_heights(c.least, nodes, "the lower bound");
    check_node_heights(c.most, nodes, "the upper bound");
    const auto refuse = [](std::size_t i, double low, double high) {
        throw InputError("option",
                         "node " + std::to_string(i) + " should be at or above " +
                             std::to_string(low) + " and at or below " + std::to_string(high),
                         -1, {static_cast<std::int64_t>(i)});
    };
    for (std::size_t i = 0; i < nodes; ++i) {
        const auto at = [&](std::span<const double> of) {
            return of.empty() ? std::nan("") : of[i];
        };
        if (at(c.least) > at(c.most)) refuse(i, at(c.least), at(c.most));
        if (at(c.least) > at(c.equal)) refuse(i, at(c.least), at(c.equal));
        if (at(c.equal) > at(c.most)) refuse(i, at(c.equal), at(c.most));
    }
}

void check_bounds(std::span<const std::array<double, 3>> bounds) {
    for (std::size_t i = 0; i < bounds.size(); ++i)
        require_usable(bounds[i], "bound", i);
}

/// Everything between input and heights.
class Interpolation {
public:
    Interpolation(std::span<const std::array<double, 3>> points,
                  std::span<const PlanPosition> nodes, std::span<const Triangle> triangles,
                  const spatial::MeshLocator& locator, const DsiConstraints& constraints,
                  double weight, const Execution& execution)
        : weight_(weight), progress_(execution.progress), mesh_(ordered_mesh(nodes, triangles)) {
        report(0.01, "triangles and their neighbors");
        check();
        const std::vector<Hinge> of_mesh = hinges(mesh_.nodes, mesh_.triangles);
        check();
        system_.emplace(mesh_.nodes, mesh_.first_in_cell, of_mesh, mesh_.grid,
                        thread_count(execution.threads), [this] { check(); });
        report(0.1, "points on the mesh");
        add_points(points, locator, triangles);
        add_nodes(constraints.equal, Relation::kEqual);
        if (constraints_.empty()) {
            throw InputError("no_points",
                             "no point lies on the mesh and no node has a given height");
        }
        add_dips(constraints.dips, locator, triangles, nodes);
        subtract_plane();
        add_nodes(constraints.least, Relation::kLeast);
        add_nodes(constraints.most, Relation::kMost);
        add_bounds(constraints.lower, Relation::kLeast, locator, triangles);
        add_bounds(constraints.upper, Relation::kMost, locator, triangles);
        tighten_bounds();
        hold_tilt();
    }

    DsiHeights heights() {
        Vector z(mesh_.nodes.size(), 0.0);
        solve(z);
        settle(z);
        DsiHeights out;
        out.z.resize(z.size());
        for (std::size_t i = 0; i < z.size(); ++i)
            out.z[mesh_.old_number[i]] = z[i] + plane_at(mesh_.nodes[i]);
        out.outside = outside_;
        out.dips_outside = dips_outside_;
        out.iterations = iterations_;
        out.converged = system_->converged();
        for (const Constraint& c : constraints_) {
            if (c.is_bound() && !c.of_node && c.violation(z) > 2 * kTolerance * range_)
                ++out.bounds_missed;
            const bool exact_point = c.kind == Relation::kEqual && !c.of_node;
            if (!exact_point || c.violation(z) <= 1e3 * kTolerance * range_) continue;
            if (c.is_rise()) {
                ++out.dips_missed;
                continue;
            }
            ++out.missed;
            out.misfit = std::max(out.misfit, c.violation(z));
        }
        return out;
    }

private:
    void check() const {
        if (progress_ != nullptr) progress_->check();
    }
    void report(double share, const char* text) const {
        if (progress_ != nullptr) progress_->report(share, text);
    }

    void add_points(std::span<const std::array<double, 3>> points,
                    const spatial::MeshLocator& locator, std::span<const Triangle> triangles) {
        const bool weighted = weight_ > 0;
        for (const auto& [x, y, height] : points) {
            const auto position = locator.find({x, y});
            if (!position) {
                ++outside_;
                continue;
            }
            add_height(*position, triangles, weighted ? Relation::kWeighted : Relation::kEqual,
                       height);
        }
    }

    Constraint& add_height(const spatial::MeshLocator::BarycentricPosition& position,
                           std::span<const Triangle> triangles, Relation kind, double height) {
        Constraint c{{}, position.weights, 0, kind, height};
        for (std::size_t k = 0; k < 3; ++k)
            c.nodes[k] = mesh_.new_number[triangles[position.triangle][k]];
        const auto most = std::max_element(c.weights.begin(), c.weights.end());
        if (*most > 1 - 1e-12) {
            c.nodes.fill(c.nodes[most - c.weights.begin()]);
            c.weights = {1, 0, 0};
        }
        const double strength = kind == Relation::kWeighted ? weight_ : kExactStrength;
        c.strength = strength * system_->stiffness(c.nodes);
        constraints_.push_back(c);
        return constraints_.back();
    }

    /// Bounds outside the mesh say nothing.
    void add_bounds(std::span<const std::array<double, 3>> bounds, Relation kind,
                    const spatial::MeshLocator& locator, std::span<const Triangle> triangles) {
        for (const auto& [x, y, height] : bounds) {
            const auto position = locator.find({x, y});
            if (!position) continue;
            Constraint& c = add_height(*position, triangles, kind, height);
            c.height -= plane_at(c.position(mesh_.nodes));
            range_ = std::max(range_, std::abs(c.height));
        }
    }

    /// Bounds of points are kept to the last digit: what the rounds leave is kept on their side.
    void tighten_bounds() {
        for (Constraint& c : constraints_) {
            if (c.of_node || c.is_rise()) continue;
            if (c.kind == Relation::kLeast) c.height += kTolerance * range_;
            if (c.kind == Relation::kMost) c.height -= kTolerance * range_;
        }
    }

    /// The rises of the dips' triangles along x and along y, over about an edge.
    void add_dips(const Dips& dips, const spatial::MeshLocator& locator,
                  std::span<const Triangle> triangles, std::span<const PlanPosition> nodes) {
        for (std::size_t i = 0; i < dips.positions.size(); ++i) {
            const auto position = locator.find(dips.positions[i]);
            if (!position) {
                ++dips_outside_;
                continue;
            }
            const Triangle& triangle = triangles[position->triangle];
            Triangle ordered{};
            for (std::size_t k = 0; k < 3; ++k)
                ordered[k] = mesh_.new_number[triangle[k]];
            const double strength =
                (weight_ > 0 ? weight_ : kExactRiseStrength) * system_->stiffness(ordered);
            const auto area_of = [](std::span<const PlanPosition> of, const Triangle& t) {
                return twice_area(of[t[0]], of[t[1]], of[t[2]]);
            };
            const double twice = area_of(mesh_.nodes, ordered);
            const double length = std::sqrt(std::abs(twice));
            const double length_before = std::sqrt(std::abs(area_of(nodes, triangle)));
            for (std::size_t axis = 0; axis < 2; ++axis) {
                Constraint c{ordered,
                             {},
                             strength,
                             weight_ > 0 ? Relation::kWeighted : Relation::kEqual,
                             length_before * dips.slopes[i][axis]};
                c.along[axis] = length;
                for (std::size_t k = 0; k < 3; ++k) {
                    const PlanPosition& a = mesh_.nodes[ordered[(k + 1) % 3]];
                    const PlanPosition& b = mesh_.nodes[ordered[(k + 2) % 3]];
                    const double component = axis == 0 ? a[1] - b[1] : b[0] - a[0];
                    c.weights[k] = length * component / twice;
                }
                constraints_.push_back(c);
            }
        }
    }

    double stiffness(std::size_t node) const {
        const auto number = static_cast<std::int32_t>(node);
        return system_->stiffness({number, number, number});
    }

    void add_nodes(std::span<const double> heights, Relation kind) {
        if (heights.empty()) return;
        for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
            const double height = heights[mesh_.old_number[i]];
            if (std::isnan(height)) continue;
            constraints_.push_back(Constraint::at_node(
                i, kExactStrength * stiffness(i), kind,
                kind == Relation::kEqual ? height : height - plane_at(mesh_.nodes[i])));
        }
    }

    /// The solution is heights above the plane that fits best: a plane comes out exactly.
    void subtract_plane() {
        std::vector<PlanPosition> positions;
        for (const Constraint& c : constraints_)
            positions.push_back(c.position(mesh_.nodes));
        frame_.emplace(positions, Drift::kLinear);
        Eigen::MatrixXd terms = frame_->terms(std::span<const PlanPosition>(positions));
        Eigen::VectorXd heights(terms.rows());
        base_ = constraints_[0].height;
        for (Eigen::Index k = 0; k < heights.size(); ++k) {
            const Constraint& c = constraints_[k];
            heights(k) = c.is_rise() ? c.height : c.height - base_;
            if (c.is_rise()) terms.row(k) = rise_of_terms(c);
        }
        plane_.make(terms, terms);
        fitted_ = plane_.project(heights);
        const auto [low, high] = subtract_from_heights(positions);
        range_ = std::max(high - low, 1e-9 * std::max(std::abs(low), std::abs(high)));
        if (!(range_ > 0)) range_ = 1;
    }

    DriftFrame::Terms rise_of_terms(const Constraint& c) const {
        DriftFrame::Terms sum = DriftFrame::Terms::Zero(drift_terms(Drift::kLinear));
        for (std::size_t k = 0; k < 3; ++k)
            sum += c.weights[k] * frame_->terms(mesh_.nodes[c.nodes[k]]);
        sum(0) = 0;
        return sum;
    }

    /// @return the least and the greatest height before
    std::pair<double, double> subtract_from_heights(std::span<const PlanPosition> positions) {
        double low = std::numeric_limits<double>::infinity(), high = -low, rise = 0;
        for (std::size_t k = 0; k < positions.size(); ++k) {
            double& height = constraints_[k].height;
            if (constraints_[k].is_rise()) {
                rise = std::max(rise, std::abs(height));
                height -= plane_.solve(rise_of_terms(constraints_[k])).dot(fitted_);
            } else {
                low = std::min(low, height);
                high = std::max(high, height);
                height -= plane_at(positions[k]);
            }
            // Rounding is no roughness: a plane stays one to the last digit but one.
            if (std::abs(height) <= 1e-15 * (std::abs(base_) + std::abs(low) + std::abs(high)))
                height = 0;
        }
        return {low, std::max(high, low + rise)};
    }

    double plane_at(const PlanPosition& position) const {
        return base_ + plane_.solve(frame_->terms(position)).dot(fitted_);
    }

    /// Points in one line leave a tilt about it open: that of the plane is kept, at the far
    /// corners.
    void hold_tilt() {
        if (plane_.size() == drift_terms(Drift::kLinear)) return;
        const auto reach = static_cast<double>(std::max(mesh_.grid.columns(), mesh_.grid.rows()));
        for (const auto& [x, y] :
             {PlanPosition{-1, -1}, PlanPosition{1, -1}, PlanPosition{1, 1}, PlanPosition{-1, 1}}) {
            std::size_t far = 0;
            for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
                const PlanPosition &p = mesh_.nodes[i], &q = mesh_.nodes[far];
                if (x * p[0] + y * p[1] > x * q[0] + y * q[1]) far = i;
            }
            const double strength = kTiltStrength * stiffness(far) / (reach * reach);
            constraints_.push_back(Constraint::at_node(far, strength, Relation::kWeighted, 0));
        }
    }

    /// The heights of the smoothest mesh. The set of bounds that count may run in circles, with
    /// ever larger multipliers, where bounds hold a tilt that points leave open: then once more,
    /// carefully.
    void solve(Vector& z) {
        if (rounds(z, false)) return;
        std::fill(z.begin(), z.end(), 0.0);
        for (Constraint& c : constraints_)
            c.multiplier = 0;
        rounds(z, true);
    }

    /// Rounds of multipliers: each adds to the force on a constraint what the round before missed.
    /// @param careful  whether the bounds that count are to be settled before each round
    /// @return false where bounds are not met after as many rounds as are allowed
    bool rounds(Vector& z, bool careful) {
        bool exact = false, bounded = false;
        double stalled = kStalled;
        double largest = 0;
        for (Constraint& c : constraints_) {
            exact = exact || c.kind != Relation::kWeighted;
            if (c.is_rise()) stalled = kStalledWithDips;
            bounded = bounded || c.is_bound();
            c.active = !c.is_bound() || c.next_multiplier(z) != 0;
            largest = std::max(largest, c.active ? std::abs(c.height) : 0.0);
        }
        if (largest == 0) return true;  // the plane meets all constraints
        double before = std::numeric_limits<double>::infinity();
        double tolerance = exact ? kFirstTolerance : kWeightedTolerance;
        bool changed = true;
        int settling = 0, stalls = 0;
        for (int round = 0; round < (careful ? kMostCarefulRounds : kMostRounds); ++round) {
            if (changed) system_->set_constraints(constraints_);
            iterations_ += system_->solve(z, right_hand_side(), tolerance, [&](double share) {
                const double rounds = exact ? 4 : 1;
                report(
                    0.15 + 0.85 * std::min(0.99, (round + share) / std::max(rounds, round + 1.0)),
                    "smoothing");
            });
            if (!exact) return true;
            if (careful && settling++ < kMostSettling && activate(z)) {
                changed = true;
                continue;
            }
            settling = 0;
            double missing = 0;
            std::tie(missing, changed) = update_multipliers(z);
            if (missing <= kTolerance * range_ && !changed) return true;
            // Points that contradict each other on this mesh are met as well as possible.
            if (!changed && !bounded && round > 2 && missing > stalled * before) return true;
            stalls = missing > kStalledWithDips * before ? stalls + 1 : 0;
            if (careful && stalls >= kMostStalled) return true;
            before = missing;
            tolerance = std::max(kLastTolerance, std::min(0.1 * tolerance, missing / range_));
        }
        return !bounded;
    }

    /// The bounds that count with these heights and multipliers do from now on.
    /// @return whether they are others than before
    bool activate(const Vector& z) {
        bool changed = false;
        for (Constraint& c : constraints_) {
            if (!c.is_bound()) continue;
            const bool active = c.next_multiplier(z) != 0;
            changed = changed || active != c.active;
            c.active = active;
        }
        return changed;
    }

    Vector right_hand_side() const {
        Vector right(mesh_.nodes.size(), 0.0);
        for (const Constraint& c : constraints_) {
            if (!c.active) continue;
            const double force = c.strength * c.height + c.multiplier;
            for (std::size_t k = 0; k < c.corners(); ++k)
                right[c.nodes[k]] += force * c.weights[k];
        }
        return right;
    }

    /// @return the largest violation, and whether other bounds are active now
    std::pair<double, bool> update_multipliers(const Vector& z) {
        double missing = 0;
        bool changed = false;
        for (Constraint& c : constraints_) {
            if (c.kind == Relation::kWeighted) continue;
            missing = std::max(missing, c.violation(z));
            c.multiplier = c.next_multiplier(z);
            const bool active = c.kind == Relation::kEqual || c.multiplier != 0;
            changed = changed || active != c.active;
            c.active = active;
        }
        return {missing, changed};
    }

    /// Meets the constraints of nodes to the last digit: after the rounds only little is missing.
    void settle(Vector& z) const {
        for (const Relation kind : {Relation::kLeast, Relation::kMost, Relation::kEqual}) {
            for (const Constraint& c : constraints_) {
                if (c.kind == kind && c.of_node && c.violation(z) > 0) z[c.nodes[0]] = c.height;
            }
        }
    }

    double weight_;
    Progress* progress_;
    OrderedMesh mesh_;
    std::optional<SmoothSystem> system_;
    std::vector<Constraint> constraints_;
    // The plane.
    std::optional<DriftFrame> frame_;
    DriftBasis plane_;
    DriftBasis::Coefficients fitted_;
    double base_ = 0;
    double range_ = 1;  // of the given heights
    std::int64_t outside_ = 0, dips_outside_ = 0;
    int iterations_ = 0;
};

}  // namespace

DsiHeights dsi(std::span<const std::array<double, 3>> points, std::span<const PlanPosition> nodes,
               std::span<const Triangle> triangles, const DsiConstraints& constraints,
               double weight, const Execution& execution) {
    if (!(weight >= 0) || !std::isfinite(weight)) {
        throw InputError("option",
                         "the weight of points is negative or infinite; 0 makes them hold");
    }
    require_finite_nodes(nodes);
    check_constraints(constraints, nodes.size());
    check_dips(constraints.dips);
    check_bounds(constraints.lower);
    check_bounds(constraints.upper);
    if (nodes.empty() || triangles.empty()) {
        throw InputError("option",
                         "there is no mesh: discrete smooth interpolation needs triangles");
    }
    require_countable(nodes.size(), "nodes");
    require_countable(3 * triangles.size(), "sides of triangles");
    std::vector<std::array<double, 3>> distinct;
    if (!points.empty()) {
        const DataPoints data = prepare_points(points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (std::cmp_equal(data.number_of[i], distinct.size())) distinct.push_back(points[i]);
        }
    }
    const spatial::MeshLocator locator(nodes, triangles);
    Interpolation interpolation(distinct, nodes, triangles, locator, constraints, weight,
                                execution);
    DsiHeights out = interpolation.heights();
    // To the last digit: the plane was subtracted and added again.
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!constraints.least.empty() && out.z[i] < constraints.least[i])
            out.z[i] = constraints.least[i];
        if (!constraints.most.empty() && out.z[i] > constraints.most[i])
            out.z[i] = constraints.most[i];
        if (!constraints.equal.empty() && !std::isnan(constraints.equal[i]))
            out.z[i] = constraints.equal[i];
    }
    return out;
}

}  // namespace realmodel::interpolation
