// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/thin_plate.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "interpolation/drift_basis.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::interpolation {

namespace {

/// r^2 log r from r^2.
double kernel(double squared) {
    return squared > 0 ? 0.5 * squared * std::log(squared) : 0;
}

double squared_distance(const Place& a, const Place& b) {
    const double dx = a[0] - b[0], dy = a[1] - b[1];
    return dx * dx + dy * dy;
}

/// The side of a square as large as each point's share of their box.
double mean_spacing(const std::vector<Place>& places) {
    Place low = places[0], high = places[0];
    for (const Place& p : places) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    const double width = high[0] - low[0], height = high[1] - low[1];
    const auto count = static_cast<double>(places.size());
    const double spacing =
        std::max(std::sqrt(width * height / count), std::max(width, height) / count);
    return spacing > 0 ? spacing : 1;
}

/// A spline through some points. Keeps its memory; one for each thread.
class Spline {
public:
    Spline(double spacing, double smoothing) : unit_(spacing), smoothing_(smoothing) {}

    /// Of these places (local coordinates) and values.
    void make(std::span<const Place> places, std::span<const double> values) {
        places_.assign(places.begin(), places.end());
        frame_.emplace(places_, Drift::linear);
        const auto n = static_cast<Eigen::Index>(places_.size());
        terms_.resize(n, drift_terms(Drift::linear));
        for (Eigen::Index i = 0; i < n; ++i)
            terms_.row(i) = frame_->terms(places_[static_cast<std::size_t>(i)]);
        basis_.make(terms_, terms_);
        const Eigen::Index terms = basis_.size();
        base_ = values[0];
        matrix_.setZero(n + terms, n + terms);
        right_.setZero(n + terms);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Place& a = places_[static_cast<std::size_t>(i)];
            for (Eigen::Index j = 0; j < i; ++j) {
                matrix_(i, j) = kernel(squared_distance(a, places_[static_cast<std::size_t>(j)]) /
                                       (unit_ * unit_));
                matrix_(j, i) = matrix_(i, j);
            }
            matrix_(i, i) = smoothing_;
            for (Eigen::Index k = 0; k < terms; ++k) {
                matrix_(i, n + k) = basis_.orthonormal(i, k);
                matrix_(n + k, i) = matrix_(i, n + k);
            }
            right_(i) = values[static_cast<std::size_t>(i)] - base_;
        }
        weights_ = matrix_.partialPivLu().solve(right_);
    }

    double at(const Place& place) const {
        const auto n = static_cast<Eigen::Index>(places_.size());
        const DriftBasis::Coefficients terms = basis_.solve(frame_->terms(place));
        double sum = 0;
        for (Eigen::Index k = 0; k < terms.size(); ++k)
            sum += weights_(n + k) * terms(k);
        for (Eigen::Index i = 0; i < n; ++i) {
            sum +=
                weights_(i) * kernel(squared_distance(place, places_[static_cast<std::size_t>(i)]) /
                                     (unit_ * unit_));
        }
        return base_ + sum;
    }

private:
    double unit_, smoothing_;
    double base_ = 0;
    std::vector<Place> places_;
    std::optional<DriftFrame> frame_;
    DriftBasis basis_;
    Eigen::MatrixXd terms_, matrix_;
    Eigen::VectorXd right_, weights_;
};

void check_options(const ThinPlateOptions& options) {
    if (!(options.smoothing >= 0) || !std::isfinite(options.smoothing)) {
        throw InputError("option", "the smoothing is negative or infinite; 0 makes points hold");
    }
    check_neighbourhood({options.neighbours, options.octants, options.radius});
}

void require_room(double points) {
    const double bytes = 3 * (points + 3) * (points + 3) * sizeof(double);
    const double room = 0.9 * static_cast<double>(available_memory());
    if (bytes <= room) return;
    char text[200];
    std::snprintf(text, sizeof text,
                  "a spline through all of %.0f points would take %.3g GB; there are %.3g GB: use "
                  "fewer neighbours, e.g. neighbours = 32",
                  points, bytes / 1e9, room / 1e9);
    throw InputError("too_large", text);
}

}  // namespace

std::vector<double> thin_plate(std::span<const std::array<double, 3>> points,
                               std::span<const std::array<double, 2>> nodes,
                               const ThinPlateOptions& options, Progress* progress) {
    check_options(options);
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const spatial::NearestPoints tree(data.local);
    const Neighbourhood neighbourhood{options.neighbours, options.octants, options.radius};
    const double spacing = mean_spacing(data.local);
    const auto wanted = static_cast<std::size_t>(options.neighbours);
    const bool all = neighbourhood.plain() && (wanted == 0 || wanted >= data.local.size());
    Spline whole(spacing, options.smoothing);
    if (all) {
        require_room(static_cast<double>(data.local.size()));
        if (progress != nullptr) progress->check();
        whole.make(data.local, data.values);
    }
    std::vector<double> z(nodes.size());
    const auto make = [&](const StopSign& stop) {
        return [&, spline = whole, search = NeighbourSearch(data, tree, neighbourhood),
                near = std::vector<spatial::Neighbour>(), places = std::vector<Place>(),
                values = std::vector<double>()](std::size_t begin, std::size_t end) mutable {
            for (std::size_t i = begin; i < end && !stop(); ++i) {
                const Place node = data.to_local(nodes[i]);
                tree.find(node, 1, near);
                const double nearest = data.values[static_cast<std::size_t>(near[0].point)];
                if (near[0].squared_distance == 0 && options.smoothing == 0) {
                    z[i] = nearest;
                    continue;
                }
                if (!all) {
                    search.find(node, near);
                    places.clear();
                    values.clear();
                    for (const spatial::Neighbour& n : near) {
                        places.push_back(data.local[static_cast<std::size_t>(n.point)]);
                        values.push_back(data.values[static_cast<std::size_t>(n.point)]);
                    }
                    spline.make(places, values);
                }
                z[i] = spline.at(node);
                // Points so near each other that their system is singular to the last digit.
                if (!std::isfinite(z[i])) z[i] = nearest;
            }
        };
    };
    for_chunks(nodes.size(), 256, options.threads, progress, 0, "thin plate spline", make);
    return z;
}

}  // namespace realmodel::interpolation
