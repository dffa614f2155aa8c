// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/kriging.hpp"

#include <algorithm>
#include <atomic>

#include "interpolation/kriging/kriging_task.hpp"
#include "interpolation/kriging/lane_kriging.hpp"
#include "interpolation/kriging/neighbor_kriging.hpp"
#include "interpolation/kriging/unique_neighborhood.hpp"
#include "interpolation/node_loop.hpp"
#include "spatial/hilbert_order.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kNodesAtOnce = UniqueNeighborhood::kNodesAtOnce;
constexpr std::size_t kNodesInOrder = 1U << 22;  // put in order at a time: some tens of ms

/// One system after another: neighbors in octants or within a radius, or more than the lanes take.
void krige_one_by_one(const KrigingTask& task) {
    const std::size_t points = task.data.point_count();
    const auto wanted = static_cast<std::size_t>(task.options.neighborhood.neighbors);
    const auto n = static_cast<double>((wanted > 0 ? std::min(wanted, points) : points) +
                                       2 * task.data.dips_at_node());
    require_memory(thread_count(task.execution.threads) * n * (n + 8) * sizeof(double), n,
                   "kriging each node from its nearest", 16);
    struct Scratch {
        NeighborKriging kriging;
        DataSearch search;
        std::vector<spatial::Neighbor> near;
    };
    std::atomic<std::int64_t> alone{0};
    NodeLoop{task.count(), 256, task.execution, "kriging"}.over_nodes(
        [&] {
            return Scratch{NeighborKriging(task.data, task.covariance, task.options.drift),
                           DataSearch(task.data, task.tree, task.options.neighborhood),
                           {}};
        },
        [&](Scratch& own, std::size_t i) {
            const Position node = task.node(i);
            if (!own.search.find(node, own.near, task.left_out(i))) ++alone;
            const std::int32_t sheet = task.sheet(i), there = task.point_there(own.near, sheet);
            if (own.near.empty()) {
                task.set(i, unknown(task.data.points().values[i]));
            } else if (there != NeighborSearch::kNobody) {
                task.set(i, {task.data.points().values[there], 0});
            } else {
                task.set(i, own.kriging.at(node, own.near, sheet, task.execution.progress));
            }
        });
    task.out.alone = alone;
}

/// Nodes between two looks at whether to stop: some hundredths of a second, however large the
/// systems.
std::size_t nodes_in_chunk(std::size_t neighbors) {
    return neighbors <= 64 ? 512 : neighbors <= 128 ? 128 : 64;
}

/// The nearest of all directions and distances, few enough: several systems at once. Those that are
/// not well posed - points in one line and a drift across it - one by one.
void krige_in_lanes(const KrigingTask& task) {
    const std::size_t points = task.data.point_count() - (task.leaves_out ? 1 : 0);
    const auto wanted = static_cast<std::size_t>(task.options.neighborhood.neighbors);
    const std::size_t neighbors = std::min(wanted, points), count = task.count();
    struct Scratch {
        std::vector<LaneKriging::Node> nodes;
        LaneKriging lanes;
        NeighborKriging single;
        DataSearch search;
        std::vector<spatial::Neighbor> near;
    };
    const auto make = [&] {
        return Scratch{{},
                       LaneKriging(task.data, task.tree, task.covariance, neighbors,
                                   task.leaves_out, lane_kernels().front(), task.options.drift),
                       NeighborKriging(task.data, task.covariance, task.options.drift),
                       DataSearch(task.data, task.tree, task.options.neighborhood),
                       {}};
    };
    std::vector<Position> positions;
    for (std::size_t first = 0; first < count; first += kNodesInOrder) {
        const std::size_t here = std::min(kNodesInOrder, count - first);
        positions.resize(here);
        for (std::size_t i = 0; i < here; ++i)
            positions[i] = task.node(first + i);
        const std::vector<std::uint32_t> order = spatial::along_hilbert_curve(positions);
        const auto share = [&](std::size_t done) {
            return static_cast<double>(done) / static_cast<double>(count);
        };
        NodeLoop{here,           nodes_in_chunk(neighbors + 2 * task.data.dips_at_node()),
                 task.execution, "kriging",
                 share(first),   share(first + here)}
            .over_chunks(make, [&](Scratch& own, std::size_t begin, std::size_t end) {
                own.nodes.clear();
                for (std::size_t k = begin; k < end; ++k) {
                    own.nodes.push_back(
                        {positions[order[k]], order[k], task.left_out(first + order[k])});
                }
                own.lanes.krige(
                    own.nodes,
                    [&](std::uint32_t i, const Estimate& found) { task.set(first + i, found); },
                    [&](std::uint32_t i) {
                        own.search.find(positions[i], own.near, task.left_out(first + i));
                        task.set(first + i,
                                 own.single.at(positions[i], own.near, 0, task.execution.progress));
                    });
            });
    }
}

void krige_from_all(const KrigingTask& task) {
    const auto n = static_cast<double>(task.data.size());
    const double solved_at_once = thread_count(task.execution.threads) * kNodesAtOnce;
    require_memory(TiledCholesky::bytes(n) + solved_at_once * n * sizeof(double), n,
                   "kriging from all of", 16);
    const double factor_work = n * n * n / 3;
    const double solve_work = n * n * static_cast<double>(task.count());
    const double factor_share = factor_work / (factor_work + solve_work);
    const UniqueNeighborhood all(task, factor_share);
    NodeLoop{task.count(), kNodesAtOnce, task.execution, "kriging from all points", factor_share}
        .over_chunks([&] { return all.scratch(); },
                     [&](UniqueNeighborhood::Scratch& own, std::size_t begin, std::size_t end) {
                         if (task.leaves_out) {
                             all.leave_out(begin, end, own);
                         } else {
                             all.krige(begin, end, own);
                         }
                     });
}

/// @param leaves_out  the points instead of nodes
Kriged krige_nodes(const DataPoints& points, std::span<const Position> nodes, bool leaves_out,
                   const Variogram& variogram, const KrigingOptions& options,
                   const Execution& execution) {
    const spatial::NearestPoints tree(points.local);
    const Covariance covariance(variogram, options.sheets);
    std::vector<std::array<double, 2>> scales;
    for (std::size_t sheet = 0; sheet == 0 || sheet < covariance.units().size(); ++sheet) {
        scales.push_back(
            covariance.scales_over(options.dips.baseline, static_cast<std::int32_t>(sheet)));
    }
    const LinearData data(points, options.dips, scales, covariance.units(), options.sheets.of_dips);
    Kriged out;
    const KrigingTask task{data,       tree,           covariance, options, nodes,
                           leaves_out, variogram.sill, execution,  out};
    out.z.resize(task.count());
    out.variance.resize(task.count());
    const auto neighbors = static_cast<std::size_t>(options.neighborhood.neighbors);
    const bool plain = options.neighborhood.plain();
    const bool all = neighbors >= data.point_count() && data.uses_all_dips();
    if (plain && (neighbors == 0 || all)) {
        krige_from_all(task);
    } else if (plain && !data.has_sheets() &&
               neighbors + 2 * data.dips_at_node() <= LaneKriging::kMostNeighbors &&
               data.point_count() > 1) {
        krige_in_lanes(task);
    } else {
        krige_one_by_one(task);
    }
    return out;
}

void check_options(const Variogram& variogram, const KrigingOptions& options) {
    check_variogram(variogram);
    check_neighborhood(options.neighborhood);
}

}  // namespace

Kriged krige(std::span<const std::array<double, 3>> points,
             std::span<const std::array<double, 2>> nodes, const Variogram& variogram,
             const KrigingOptions& options, const Execution& execution) {
    check_options(variogram, options);
    require_finite_nodes(nodes);
    check_sheets(options.sheets, points.size(), options.dips.positions.size());
    const DataPoints data = prepare_points(points, options.sheets.of_points);
    if (nodes.empty()) return {};
    return krige_nodes(data, nodes, false, variogram, options, execution);
}

Kriged krige_left_out(std::span<const std::array<double, 3>> points, const Variogram& variogram,
                      const KrigingOptions& options, const Execution& execution) {
    check_options(variogram, options);
    check_sheets(options.sheets, points.size(), options.dips.positions.size());
    const DataPoints data = prepare_points(points, options.sheets.of_points);
    const Kriged found = krige_nodes(data, {}, true, variogram, options, execution);
    return {data.for_given(found.z), data.for_given(found.variance), found.alone};
}

}  // namespace realmodel::interpolation
