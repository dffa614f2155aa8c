// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/kriging.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "interpolation/kriging/drift_kriging.hpp"
#include "interpolation/kriging/lane_kriging.hpp"
#include "interpolation/kriging/local_kriging.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "interpolation/node_order.hpp"
#include "interpolation/kriging/tiled_cholesky.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t nodes_at_once = 64;  // right sides solved together: matrix products are fast
constexpr int others_at_most = 200;        // tell a point that the factor of all points left out

void require_room(double bytes, double points, const char* what) {
    const double room = 0.9 * static_cast<double>(available_memory());
    if (bytes <= room) return;
    char text[300];
    std::snprintf(
        text, sizeof text,
        "%s %.0f points would take %.3g GB; there are %.3g GB: use fewer neighbours, e.g. "
        "neighbours = 16",
        what, points, bytes / 1e9, room / 1e9);
    throw InputError("too_large", text);
}

/// Everything that kriging needs. The nodes are places in local coordinates; or the data's own
/// places, each to be told by the others.
struct Task {
    const DataPoints& data;
    const spatial::NearestPoints& tree;
    const Covariance& covariance;
    const KrigingOptions& options;
    std::span<const Place> nodes;  // empty where points are left out
    double sill;
    Progress* progress;
    Kriged& out;

    bool leaves_out() const { return nodes.data() == nullptr; }
    std::size_t count() const { return leaves_out() ? data.local.size() : nodes.size(); }
    Place node(std::size_t i) const {
        return leaves_out() ? data.local[i] : data.to_local(nodes[i]);
    }
    std::int32_t left_out(std::size_t i) const {
        return leaves_out() ? static_cast<std::int32_t>(i) : NeighbourSearch::nobody;
    }
    Neighbourhood neighbourhood() const {
        return {options.neighbours, options.octants, options.radius};
    }
    void set(std::size_t node, const Estimate& estimate) const {
        out.z[node] = estimate.value;
        out.variance[node] = estimate.variance * sill;
    }
};

template <class LocalSystem>
void krige_from_nearest(const Task& task, const LocalSystem& system) {
    const auto n = static_cast<double>(
        std::min(task.options.neighbours > 0 ? static_cast<std::size_t>(task.options.neighbours)
                                             : task.data.local.size(),
                 task.data.local.size()));
    require_room(thread_count(task.options.threads) * n * (n + 8) * sizeof(double), n,
                 "kriging each node from its nearest");
    std::atomic<std::int64_t> alone{0};
    const auto make = [&](const StopSign& stop) {
        return
            [&, kriging = system,
             search = NeighbourSearch(task.data, task.tree, task.neighbourhood()),
             near = std::vector<spatial::Neighbour>()](std::size_t begin, std::size_t end) mutable {
                for (std::size_t i = begin; i < end && !stop(); ++i) {
                    const Place node = task.node(i);
                    if (!search.find(node, near, task.left_out(i))) ++alone;
                    if (near.empty()) {
                        task.set(i, {task.data.values[i], std::numeric_limits<double>::infinity()});
                    } else if (near[0].squared_distance == 0) {
                        task.set(i, {task.data.values[static_cast<std::size_t>(near[0].point)], 0});
                    } else {
                        task.set(i, kriging.at(node, near, stop));
                    }
                }
            };
    };
    for_chunks(task.count(), 256, task.options.threads, task.progress, 0, "kriging", make);
    task.out.alone = alone;
}

constexpr std::size_t nodes_in_order = 1U << 22;  // put in order at a time: some tens of ms

/// Nodes between two looks at whether to stop: some hundredths of a second, however large the
/// systems.
std::size_t nodes_in_piece(std::size_t neighbours) {
    return neighbours <= 64 ? 512 : neighbours <= 128 ? 128 : 64;
}

/// The nearest of all directions and distances, few enough: several systems at once. Those that are
/// not well posed - points in one line and a drift across it - one by one.
void krige_in_lanes(const Task& task) {
    const auto neighbours = static_cast<std::size_t>(task.options.neighbours);
    const std::size_t count = task.count();
    std::vector<Place> places;
    for (std::size_t first = 0; first < count; first += nodes_in_order) {
        const std::size_t here = std::min(nodes_in_order, count - first);
        places.resize(here);
        for (std::size_t i = 0; i < here; ++i)
            places[i] = task.node(first + i);
        const std::vector<std::uint32_t> order = along_curve(places);
        const auto make = [&](const StopSign& stop) {
            return [&, nodes = std::vector<LaneKriging::Node>(),
                    kriging =
                        LaneKriging(task.data, task.tree, task.covariance, neighbours,
                                    task.leaves_out(), lane_kernels().front(), task.options.drift),
                    hard = DriftKriging(task.data, task.covariance, task.options.drift),
                    search = NeighbourSearch(task.data, task.tree, task.neighbourhood()),
                    near = std::vector<spatial::Neighbour>()](std::size_t begin,
                                                              std::size_t end) mutable {
                nodes.clear();
                for (std::size_t k = begin; k < end; ++k) {
                    const std::size_t i = first + order[k];
                    nodes.push_back(
                        {places[order[k]], static_cast<std::uint32_t>(i), task.left_out(i)});
                }
                kriging.krige(
                    nodes,
                    [&](std::uint32_t i, const Estimate& estimate) { task.set(i, estimate); },
                    [&](std::uint32_t i) {
                        search.find(task.node(i), near, task.left_out(i));
                        task.set(i, hard.at(task.node(i), near, stop));
                    });
            };
        };
        for_chunks(here, nodes_in_piece(neighbours), task.options.threads, task.progress,
                   static_cast<double>(first) / static_cast<double>(count), "kriging", make);
    }
}

/// All points, factored once.
class UniqueNeighbourhood {
public:
    UniqueNeighbourhood(const Task& task, double factor_share)
        : task_(task),
          places_(task.data.local),
          count_(static_cast<Eigen::Index>(places_.size())),
          base_(task.data.values[0]),
          frame_(places_, task.options.drift),
          factor_(
              count_,
              [&](Eigen::Index i, Eigen::Index j) {
                  return i == j ? 1.0 : task.covariance(place(i), place(j));
              },
              redundant_variance, task.options.threads, task.progress, factor_share) {
        const Eigen::Index terms = drift_terms(task.options.drift);
        Eigen::MatrixXd plain(count_, terms), given(count_, terms + 1);
        for (Eigen::Index p = 0; p < count_; ++p) {
            plain.row(p) = frame_.terms(place(p));
            given(p, terms) = task.data.values[static_cast<std::size_t>(p)] - base_;
        }
        given.leftCols(terms) = plain;
        for (Eigen::Index p = 0; p < count_; ++p) {
            if (factor_.left_out(p)) plain.row(p).setZero();
        }
        factor_.solve(given, StopSign(task.progress));
        basis_.make(plain, given.leftCols(terms));
        t_ = given.col(terms);
        qt_ = basis_.project(t_);
    }

    /// Nodes begin .. end at once.
    void krige(std::size_t begin, std::size_t end, const StopSign& stop, Eigen::MatrixXd& u,
               std::vector<spatial::Neighbour>& near) const {
        u.resize(count_, static_cast<Eigen::Index>(end - begin));
        for (std::size_t i = begin; i < end; ++i) {
            const Place node = task_.node(i);
            const auto column = static_cast<Eigen::Index>(i - begin);
            for (Eigen::Index p = 0; p < count_; ++p)
                u(p, column) = task_.covariance(node, place(p));
            if (stop()) return;
        }
        factor_.solve(u, stop);
        for (std::size_t i = begin; i < end && !stop(); ++i) {
            const Place node = task_.node(i);
            task_.tree.find(node, 1, near);
            task_.set(i,
                      near[0].squared_distance == 0
                          ? Estimate{task_.data.values[static_cast<std::size_t>(near[0].point)], 0}
                          : estimate(node, u.col(static_cast<Eigen::Index>(i - begin))));
        }
    }

    /// Points begin .. end, each from the others: with B = C^-1 - C^-1 F (F^T C^-1 F)^-1 F^T C^-1
    /// the error is (B z)_i / B_ii and its variance 1 / B_ii (Dubrule 1983); column i of L^-1 gives
    /// both.
    void leave_out(std::size_t begin, std::size_t end, const StopSign& stop, Eigen::MatrixXd& u,
                   DriftKriging& others, std::vector<spatial::Neighbour>& near) const {
        u.setZero(count_, static_cast<Eigen::Index>(end - begin));
        for (std::size_t i = begin; i < end; ++i)
            u(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i - begin)) = 1;
        factor_.solve(u, stop);
        for (std::size_t i = begin; i < end && !stop(); ++i) {
            const auto column = u.col(static_cast<Eigen::Index>(i - begin));
            const DriftBasis::Coefficients qu = basis_.project(column);
            const double whole = column.squaredNorm(), b = whole - qu.squaredNorm();
            if (b > 1e-9 * whole) {
                const double error = (column.dot(t_) - qu.dot(qt_)) / b;
                task_.set(i, {task_.data.values[i] - error, 1 / b});
                continue;
            }
            // The point alone tells a term of the drift, or others tell the point.
            NeighbourSearch search(task_.data, task_.tree, {others_at_most, 0, 0});
            search.find(task_.node(i), near, static_cast<std::int32_t>(i));
            task_.set(i, near.empty() ? Estimate{task_.data.values[i],
                                                 std::numeric_limits<double>::infinity()}
                                      : others.at(task_.node(i), near, stop));
        }
    }

private:
    const Place& place(Eigen::Index p) const { return places_[static_cast<std::size_t>(p)]; }
    Estimate estimate(const Place& node, const Eigen::Ref<const Eigen::VectorXd>& u) const {
        return universal_kriging(base_, u.squaredNorm(), u.dot(t_), basis_, frame_.terms(node),
                                 basis_.project(u), qt_);
    }

    const Task& task_;
    const std::vector<Place>& places_;
    Eigen::Index count_;
    double base_;
    DriftFrame frame_;
    TiledCholesky factor_;
    DriftBasis basis_;
    Eigen::VectorXd t_;
    DriftBasis::Coefficients qt_;
};

void krige_from_all(const Task& task) {
    const auto n = static_cast<double>(task.data.local.size());
    const double solved_at_once = thread_count(task.options.threads) * nodes_at_once;
    require_room(TiledCholesky::bytes(n) + solved_at_once * n * sizeof(double), n,
                 "kriging from all of");
    const double factor_work = n * n * n / 3;
    const double solve_work = n * n * static_cast<double>(task.count());
    const double factor_share = factor_work / (factor_work + solve_work);
    const UniqueNeighbourhood all(task, factor_share);
    const auto make = [&](const StopSign& stop) {
        return [&, u = Eigen::MatrixXd(), near = std::vector<spatial::Neighbour>(),
                others = DriftKriging(task.data, task.covariance, task.options.drift)](
                   std::size_t begin, std::size_t end) mutable {
            if (task.leaves_out()) {
                all.leave_out(begin, end, stop, u, others, near);
            } else {
                all.krige(begin, end, stop, u, near);
            }
        };
    };
    for_chunks(task.count(), nodes_at_once, task.options.threads, task.progress, factor_share,
               "kriging from all points", make);
}

/// nodes: none to leave out each point instead.
Kriged krige_nodes(const DataPoints& data, std::span<const Place> nodes, const Variogram& variogram,
                   const KrigingOptions& options, Progress* progress) {
    const spatial::NearestPoints tree(data.local);
    const Covariance covariance(variogram);
    Kriged out;
    const Task task{data, tree, covariance, options, nodes, variogram.sill, progress, out};
    out.z.resize(task.count());
    out.variance.resize(task.count());
    const auto neighbours = static_cast<std::size_t>(options.neighbours);
    if (task.neighbourhood().plain() && (neighbours == 0 || neighbours >= data.local.size())) {
        krige_from_all(task);
    } else if (task.neighbourhood().plain() && neighbours <= LaneKriging::most_neighbours) {
        krige_in_lanes(task);
    } else if (options.drift == Drift::constant) {
        krige_from_nearest(task, LocalKriging(data, covariance));
    } else {
        krige_from_nearest(task, DriftKriging(data, covariance, options.drift));
    }
    return out;
}

void check_options(const Variogram& variogram, const KrigingOptions& options) {
    check_variogram(variogram);
    check_neighbourhood({options.neighbours, options.octants, options.radius});
}

}  // namespace

Kriged krige(std::span<const std::array<double, 3>> points,
             std::span<const std::array<double, 2>> nodes, const Variogram& variogram,
             const KrigingOptions& options, Progress* progress) {
    check_options(variogram, options);
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    if (nodes.empty()) return {};
    return krige_nodes(data, nodes, variogram, options, progress);
}

Kriged krige_left_out(std::span<const std::array<double, 3>> points, const Variogram& variogram,
                      const KrigingOptions& options, Progress* progress) {
    check_options(variogram, options);
    const DataPoints data = prepare_points(points);
    const Kriged of_places = krige_nodes(data, {}, variogram, options, progress);
    Kriged out{std::vector<double>(points.size()), std::vector<double>(points.size()),
               of_places.alone};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto place = static_cast<std::size_t>(data.place_of[i]);
        out.z[i] = of_places.z[place];
        out.variance[i] = of_places.variance[place];
    }
    return out;
}

}  // namespace realmodel::interpolation
