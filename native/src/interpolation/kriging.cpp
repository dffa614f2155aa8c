// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/kriging.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "interpolation/covariance.hpp"
#include "interpolation/local_kriging.hpp"
#include "interpolation/node_chunks.hpp"
#include "interpolation/tiled_cholesky.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t nodes_at_once = 64;  // right sides solved together: matrix products are fast

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

/// Everything that kriging a node needs.
struct Task {
    const DataPoints& data;
    const spatial::NearestPoints& tree;
    const Covariance& covariance;
    std::span<const Place> nodes;
    double sill;
    Kriged& out;

    void set(std::size_t node, const Estimate& estimate) const {
        out.z[node] = estimate.value;
        out.variance[node] = estimate.variance * sill;
    }
};

void krige_from_nearest(const Task& task, std::size_t neighbours, int threads, Progress* progress) {
    const auto n = static_cast<double>(neighbours);
    require_room(thread_count(threads) * n * (n + 3) * sizeof(double), n,
                 "kriging each node from its nearest");
    const auto make = [&](const StopSign& stop) {
        return
            [&, kriging = LocalKriging(task.data, task.covariance),
             near = std::vector<spatial::Neighbour>()](std::size_t begin, std::size_t end) mutable {
                for (std::size_t i = begin; i < end && !stop(); ++i) {
                    const Place node = task.data.to_local(task.nodes[i]);
                    task.tree.find(node, neighbours, near);
                    task.set(i, near[0].squared_distance == 0
                                    ? Estimate{task.data.values[near[0].point], 0}
                                    : kriging.at(node, near, stop));
                }
            };
    };
    for_chunks(task.nodes.size(), 256, threads, progress, 0, "kriging", make);
}

void krige_from_all(const Task& task, int threads, Progress* progress) {
    const auto count = static_cast<Eigen::Index>(task.data.local.size());
    const auto n = static_cast<double>(count);
    require_room(
        TiledCholesky::bytes(n) + thread_count(threads) * n * nodes_at_once * sizeof(double), n,
        "kriging from all of");
    const double factor_work = n * n * n / 3;
    const double solve_work = n * n * static_cast<double>(task.nodes.size());
    const double factor_share = factor_work / (factor_work + solve_work);
    const auto& places = task.data.local;
    const TiledCholesky factor(
        count,
        [&](Eigen::Index i, Eigen::Index j) {
            return i == j ? 1.0
                          : task.covariance(places[static_cast<std::size_t>(i)],
                                            places[static_cast<std::size_t>(j)]);
        },
        redundant_variance, threads, progress, factor_share);

    const double base = task.data.values[0];
    Eigen::MatrixXd given(count, 2);
    for (Eigen::Index p = 0; p < count; ++p) {
        given(p, 0) = 1;
        given(p, 1) = task.data.values[static_cast<std::size_t>(p)] - base;
    }
    factor.solve(given, StopSign(progress));
    const Eigen::VectorXd s = given.col(0), t = given.col(1);
    const double ss = s.dot(s), st = s.dot(t);

    const auto make = [&](const StopSign& stop) {
        return [&, u = Eigen::MatrixXd(), near = std::vector<spatial::Neighbour>()](
                   std::size_t begin, std::size_t end) mutable {
            u.resize(count, static_cast<Eigen::Index>(end - begin));
            for (std::size_t i = begin; i < end; ++i) {
                const Place node = task.data.to_local(task.nodes[i]);
                for (Eigen::Index p = 0; p < count; ++p) {
                    u(p, static_cast<Eigen::Index>(i - begin)) =
                        task.covariance(node, places[static_cast<std::size_t>(p)]);
                }
                if (stop()) return;
            }
            factor.solve(u, stop);
            for (std::size_t i = begin; i < end && !stop(); ++i) {
                const auto column = u.col(static_cast<Eigen::Index>(i - begin));
                task.tree.find(task.data.to_local(task.nodes[i]), 1, near);
                task.set(i, near[0].squared_distance == 0
                                ? Estimate{task.data.values[near[0].point], 0}
                                : ordinary_kriging(base, column.dot(column), column.dot(s),
                                                   column.dot(t), ss, st));
            }
        };
    };
    for_chunks(task.nodes.size(), nodes_at_once, threads, progress, factor_share,
               "kriging from all points", make);
}

}  // namespace

Kriged krige(std::span<const std::array<double, 3>> points,
             std::span<const std::array<double, 2>> nodes, const Variogram& variogram,
             const KrigingOptions& options, Progress* progress) {
    check_variogram(variogram);
    if (options.neighbours < 0) {
        throw InputError("option", "the number of neighbours is negative; 0 means all points");
    }
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const spatial::NearestPoints tree(data.local);
    const Covariance covariance(variogram);
    Kriged out{std::vector<double>(nodes.size()), std::vector<double>(nodes.size())};
    const Task task{data, tree, covariance, nodes, variogram.sill, out};
    const auto neighbours = static_cast<std::size_t>(options.neighbours);
    if (neighbours == 0 || neighbours >= data.local.size()) {
        krige_from_all(task, options.threads, progress);
    } else {
        krige_from_nearest(task, neighbours, options.threads, progress);
    }
    return out;
}

}  // namespace realmodel::interpolation
