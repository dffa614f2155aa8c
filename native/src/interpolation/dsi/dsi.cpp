// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/dsi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "interpolation/drift_basis.hpp"
#include "interpolation/dsi/smooth_system.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/interpolation/mesh_locator.hpp"

namespace realmodel::interpolation {

namespace {

using Triangle = std::array<std::int32_t, 3>;

// What has to hold pulls this many times as hard as the mesh is stiff: harder pulls need fewer
// rounds of multipliers, and make each round slower.
constexpr double hold = 8;
constexpr double met = 1e-8;  // of the range of heights
constexpr int kMostRounds = 30;
constexpr double kFirstTolerance = 1e-4, kLastTolerance = 1e-9, kWeightedTolerance = 1e-9;
// Of the mesh's stiffness against a tilt: what holds the tilt that the points leave open.
constexpr double kTiltHold = 1e-6;

enum class Kind { weighted, equal, least, most };

struct Condition {
    Wish wish;
    Kind kind;
    double height;
    double multiplier = 0;
    bool active = true;
    bool of_node = false;  ///< and not of a point

    /// What the pull is after the present heights are seen: strength * (height - z) on top of it.
    double force(const Vector& z) const {
        const double sum = multiplier + wish.strength * (height - wish.of(z));
        if (kind == Kind::kLeast) return std::max(0.0, sum);
        if (kind == Kind::kMost) return std::min(0.0, sum);
        return sum;
    }
    double violation(const Vector& z) const {
        const double below = height - wish.of(z);
        if (kind == Kind::kLeast) return std::max(0.0, below);
        if (kind == Kind::kMost) return std::max(0.0, -below);
        return std::abs(below);
    }
};

/// The mesh in units of its edges, its nodes in the order of the splines' cells.
struct Mesh {
    std::vector<std::int32_t> old_number;
    std::vector<Place> nodes;
    std::vector<Triangle> triangles;
    SplineGrid grid;
    double unit;
    Place origin;

    Place to_mesh(const Place& place) const {
        return {(place[0] - origin[0]) / unit, (place[1] - origin[1]) / unit};
    }
};

double mean_edge(std::span<const Place> nodes, std::span<const Triangle> triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Place &a = nodes[static_cast<std::size_t>(t[k])],
                        &b = nodes[static_cast<std::size_t>(t[(k + 1) % 3])];
            sum += std::hypot(a[0] - b[0], a[1] - b[1]);
        }
    }
    const double mean = sum / (3 * static_cast<double>(triangles.size()));
    return mean > 0 ? mean : 1;
}

Mesh ordered_mesh(std::span<const Place> nodes, std::span<const Triangle> triangles) {
    constexpr double kCellInEdges = 2;
    Place low = nodes[0], high = nodes[0];
    for (const Place& p : nodes) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    const double unit = mean_edge(nodes, triangles);
    const Place extent{(high[0] - low[0]) / unit, (high[1] - low[1]) / unit};
    // No more cells than nodes, where the region fills little of its box.
    double cell = std::max(kCellInEdges,
                           std::sqrt(extent[0] * extent[1] / static_cast<double>(nodes.size())));
    cell = std::max(cell, std::max(extent[0], extent[1]) / static_cast<double>(nodes.size()));
    const auto cells = [&](double length) {
        return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / cell)));
    };
    Mesh mesh{{}, {}, {}, SplineGrid({0, 0}, cell, cells(extent[0]), cells(extent[1])), unit, low};
    std::vector<std::size_t> cell_of(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
        cell_of[i] = mesh.grid.cell_of(mesh.to_mesh(nodes[i]));
    mesh.old_number.resize(nodes.size());
    std::iota(mesh.old_number.begin(), mesh.old_number.end(), 0);
    std::stable_sort(
        mesh.old_number.begin(), mesh.old_number.end(), [&](std::int32_t a, std::int32_t b) {
            return cell_of[static_cast<std::size_t>(a)] < cell_of[static_cast<std::size_t>(b)];
        });
    std::vector<std::int32_t> new_number(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const auto old = static_cast<std::size_t>(mesh.old_number[i]);
        new_number[old] = static_cast<std::int32_t>(i);
        mesh.nodes.push_back(mesh.to_mesh(nodes[old]));
    }
    for (const Triangle& t : triangles) {
        mesh.triangles.push_back({new_number[static_cast<std::size_t>(t[0])],
                                  new_number[static_cast<std::size_t>(t[1])],
                                  new_number[static_cast<std::size_t>(t[2])]});
    }
    return mesh;
}

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

void check_constraints(const NodeConstraints& c, std::size_t nodes) {
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

/// Everything between input and heights.
class Interpolation {
public:
    Interpolation(std::span<const std::array<double, 3>> points, std::span<const Place> nodes,
                  std::span<const Triangle> triangles, const MeshLocator& locator,
                  const NodeConstraints& constraints, const DsiOptions& options, Progress* progress)
        : options_(options),
          threads_(thread_count(options.threads)),
          progress_(progress),
          mesh_(ordered_mesh(nodes, triangles)) {
        report(0.01, "triangles and their neighbors");
        check();
        const std::vector<Hinge> of_mesh = hinges(mesh_.nodes, mesh_.triangles);
        check();
        system_.emplace(mesh_.nodes, of_mesh, mesh_.grid, threads_, [this] { check(); });
        report(0.1, "points on the mesh");
        add_points(points, locator, triangles);
        add_nodes(constraints.equal, Kind::kEqual);
        take_plane_off();
        add_nodes(constraints.least, Kind::kLeast);
        add_nodes(constraints.most, Kind::kMost);
        hold_tilt();
    }

    DsiHeights heights() {
        Vector z(mesh_.nodes.size(), 0.0);
        solve(z);
        settle(z);
        DsiHeights out;
        out.z.resize(z.size());
        for (std::size_t i = 0; i < z.size(); ++i)
            out.z[static_cast<std::size_t>(mesh_.old_number[i])] = z[i] + plane_at(mesh_.nodes[i]);
        out.outside = outside_;
        out.iterations = iterations_;
        out.converged = system_->converged();
        for (const Condition& c : conditions_) {
            const bool point = c.kind == Kind::kEqual && !c.of_node;
            if (!point || c.violation(z) <= 1e3 * met * range_) continue;
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

    void add(const Wish& wish, Kind kind, double height) {
        conditions_.push_back({wish, kind, height});
    }

    void add_points(std::span<const std::array<double, 3>> points, const MeshLocator& locator,
                    std::span<const Triangle> triangles) {
        std::vector<std::int32_t> new_number(mesh_.nodes.size());
        for (std::size_t i = 0; i < new_number.size(); ++i)
            new_number[static_cast<std::size_t>(mesh_.old_number[i])] =
                static_cast<std::int32_t>(i);
        for (const auto& [x, y, height] : points) {
            const auto found = locator.find({x, y});
            if (!found) {
                ++outside_;
                continue;
            }
            Wish wish{{}, found->weights, 1};
            const Triangle& corners = triangles[static_cast<std::size_t>(found->triangle)];
            for (std::size_t k = 0; k < 3; ++k)
                wish.nodes[k] = new_number[static_cast<std::size_t>(corners[k])];
            const auto most = std::max_element(wish.weights.begin(), wish.weights.end());
            if (*most > 1 - 1e-12) {
                wish.nodes = {wish.nodes[static_cast<std::size_t>(most - wish.weights.begin())]};
                wish.nodes[1] = wish.nodes[2] = wish.nodes[0];
                wish.weights = {1, 0, 0};
            }
            const bool weighted = options_.weight > 0;
            wish.strength = (weighted ? options_.weight : hold) * system_->stiffness(wish.nodes);
            add(wish, weighted ? Kind::kWeighted : Kind::kEqual, height);
        }
    }

    void add_nodes(std::span<const double> heights, Kind kind) {
        if (heights.empty()) return;
        for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
            const double height = heights[static_cast<std::size_t>(mesh_.old_number[i])];
            if (std::isnan(height)) continue;
            const auto node = static_cast<std::int32_t>(i);
            Wish wish{{node, node, node}, {1, 0, 0}, 0};
            wish.strength = hold * system_->stiffness(wish.nodes);
            add(wish, kind, kind == Kind::kEqual ? height : height - plane_at(mesh_.nodes[i]));
            conditions_.back().of_node = true;
        }
    }

    Place place_of(const Wish& wish) const {
        Place place{};
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                place[axis] +=
                    wish.weights[k] * mesh_.nodes[static_cast<std::size_t>(wish.nodes[k])][axis];
            }
        }
        return place;
    }

    /// What is solved for are heights above the plane that fits best: a plane comes out as one.
    void take_plane_off() {
        if (conditions_.empty()) {
            throw InputError("no_points",
                             "no point lies on the mesh and no node has a given height");
        }
        std::vector<Place> places;
        for (const Condition& c : conditions_)
            places.push_back(place_of(c.wish));
        frame_.emplace(places, Drift::kLinear);
        const auto count = static_cast<Eigen::Index>(places.size());
        Eigen::MatrixXd terms(count, drift_terms(Drift::kLinear));
        Eigen::VectorXd heights(count);
        base_ = conditions_[0].height;
        for (Eigen::Index k = 0; k < count; ++k) {
            terms.row(k) = frame_->terms(places[static_cast<std::size_t>(k)]);
            heights(k) = conditions_[static_cast<std::size_t>(k)].height - base_;
        }
        DriftBasis basis;
        basis.make(terms, terms);
        const DriftBasis::Coefficients fitted = basis.project(heights);
        plane_ = [this, basis, fitted](const Place& place) {
            return base_ + basis.solve(frame_->terms(place)).dot(fitted);
        };
        tilt_open_ = basis.size() < drift_terms(Drift::kLinear);
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t k = 0; k < places.size(); ++k) {
            low = std::min(low, conditions_[k].height);
            high = std::max(high, conditions_[k].height);
            conditions_[k].height -= plane_at(places[k]);
            // What is rounding only is no roughness: a plane stays one to the last digit but one.
            if (std::abs(conditions_[k].height) <=
                1e-15 * (std::abs(base_) + std::abs(low) + std::abs(high))) {
                conditions_[k].height = 0;
            }
        }
        range_ = std::max(high - low, 1e-9 * std::max(std::abs(low), std::abs(high)));
        if (!(range_ > 0)) range_ = 1;
    }

    double plane_at(const Place& place) const { return plane_(place); }

    /// Points in one line leave a tilt about it open: that of the plane is kept, at the far
    /// corners.
    void hold_tilt() {
        if (!tilt_open_) return;
        const double reach = static_cast<double>(std::max(mesh_.grid.columns(), mesh_.grid.rows()));
        for (const auto& [x, y] : {Place{-1, -1}, Place{1, -1}, Place{1, 1}, Place{-1, 1}}) {
            std::size_t far = 0;
            for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
                const Place &p = mesh_.nodes[i], &q = mesh_.nodes[far];
                if (x * p[0] + y * p[1] > x * q[0] + y * q[1]) far = i;
            }
            const auto node = static_cast<std::int32_t>(far);
            Wish wish{{node, node, node}, {1, 0, 0}, 0};
            wish.strength = kTiltHold * system_->stiffness(wish.nodes) / (reach * reach);
            add(wish, Kind::kWeighted, 0);
        }
    }

    /// Rounds of multipliers: what has to hold is pulled at, and pulled harder by what is missing.
    void solve(Vector& z) {
        bool holds = false, bounded = false;
        double largest = 0;
        for (Condition& c : conditions_) {
            holds = holds || c.kind != Kind::kWeighted;
            bounded = bounded || c.kind == Kind::kLeast || c.kind == Kind::kMost;
            c.active = c.kind == Kind::kWeighted || c.kind == Kind::kEqual || c.force(z) != 0;
            largest = std::max(largest, c.active ? std::abs(c.height) : 0.0);
        }
        if (largest == 0) return;  // the plane obeys everything
        double before = std::numeric_limits<double>::infinity();
        double tolerance = holds ? kFirstTolerance : kWeightedTolerance;
        bool changed = true;
        for (int round = 0; round < kMostRounds; ++round) {
            if (changed) take_active();
            Vector right(z.size(), 0.0);
            for (const Condition& c : conditions_) {
                if (!c.active) continue;
                const double pull = c.wish.strength * c.height + c.multiplier;
                for (std::size_t k = 0; k < (c.wish.at_node() ? 1U : 3U); ++k)
                    right[static_cast<std::size_t>(c.wish.nodes[k])] += pull * c.wish.weights[k];
            }
            iterations_ += system_->solve(z, right, tolerance, [&](double share) {
                const double rounds = holds ? 4 : 1;
                report(
                    0.15 + 0.85 * std::min(0.99, (round + share) / std::max(rounds, round + 1.0)),
                    "smoothing");
            });
            if (!holds) return;
            double missing = 0;
            changed = false;
            for (Condition& c : conditions_) {
                missing = std::max(missing, c.kind == Kind::kWeighted ? 0.0 : c.violation(z));
                if (c.kind == Kind::kWeighted) continue;
                c.multiplier = c.force(z);
                const bool active = c.kind == Kind::kEqual || c.multiplier != 0;
                changed = changed || active != c.active;
                c.active = active;
            }
            if (missing <= met * range_ && !changed) return;
            // Points that contradict each other on this mesh are met as well as can be.
            if (!changed && !bounded && round > 2 && missing > 0.5 * before) return;
            before = missing;
            tolerance = std::max(kLastTolerance, std::min(0.1 * tolerance, missing / range_));
        }
    }

    /// What holds at nodes to the last digit: after the rounds only little is missing.
    void settle(Vector& z) const {
        for (const Kind kind : {Kind::kLeast, Kind::kMost, Kind::kEqual}) {
            for (const Condition& c : conditions_) {
                if (c.kind == kind && c.of_node && c.violation(z) > 0)
                    z[static_cast<std::size_t>(c.wish.nodes[0])] = c.height;
            }
        }
    }

    void take_active() {
        std::vector<Wish> wishes;
        for (const Condition& c : conditions_) {
            if (c.active) wishes.push_back(c.wish);
        }
        system_->set_wishes(wishes);
    }

    DsiOptions options_;
    int threads_;
    Progress* progress_;
    Mesh mesh_;
    std::optional<SmoothSystem> system_;
    std::vector<Condition> conditions_;
    std::optional<DriftFrame> frame_;
    std::function<double(const Place&)> plane_ = [](const Place&) { return 0.0; };
    double base_ = 0, range_ = 1;
    bool tilt_open_ = false;
    std::int64_t outside_ = 0;
    int iterations_ = 0;
};

}  // namespace

DsiHeights dsi(std::span<const std::array<double, 3>> points, std::span<const Place> nodes,
               std::span<const Triangle> triangles, const NodeConstraints& constraints,
               const DsiOptions& options, Progress* progress) {
    if (!(options.weight >= 0) || !std::isfinite(options.weight)) {
        throw InputError("option",
                         "the weight of points is negative or infinite; 0 makes them hold");
    }
    require_finite_nodes(nodes);
    check_constraints(constraints, nodes.size());
    if (nodes.empty() || triangles.empty()) {
        throw InputError("option",
                         "there is no mesh: discrete smooth interpolation needs triangles");
    }
    std::vector<std::array<double, 3>> distinct;
    if (!points.empty()) {
        const DataPoints data = prepare_points(points);
        for (std::size_t i = 0; i < data.places.size(); ++i)
            distinct.push_back({data.places[i][0], data.places[i][1], data.values[i]});
    }
    const MeshLocator locator(nodes, triangles);
    Interpolation interpolation(distinct, nodes, triangles, locator, constraints, options,
                                progress);
    DsiHeights out = interpolation.heights();
    // To the last digit: the plane was taken off and put back.
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
