// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/kriging.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <span>
#include <vector>

#include "base/algorithms.hpp"
#include "interpolation/drift_basis.hpp"
#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"
#include "interpolation/kriging/lane_kernels.hpp"
#include "interpolation/kriging/lane_kriging.hpp"
#include "interpolation/kriging/neighbor_kriging.hpp"
#include "interpolation/kriging/tiled_cholesky.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/device.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::interpolation {

namespace {

constexpr Eigen::Index kNodesAtOnce = 64;             // right sides: matrix products are fast
constexpr std::size_t kNodesInOrder = 1U << 22;       // put in order at a time: some tens of ms
constexpr std::size_t kNeighborsOnDevice = 1U << 24;  // found for a device at a time: 64 MB
constexpr int kMostOthers = 200;  // from which a point is estimated that the factor cannot estimate

/// What all ways of kriging need: the data, the nodes and room for the estimates.
struct KrigingTask {
    const LinearData& data;
    const spatial::NearestPoints& tree;
    const Covariance& covariance;
    const KrigingOptions& options;
    std::span<const PlanPosition>
        nodes;  ///< without any each point is left out and estimated instead
    bool leaves_out;
    double sill;
    const Execution& execution;
    Kriged& out;

    std::size_t count() const { return leaves_out ? data.point_count() : nodes.size(); }
    /// In local coordinates.
    PlanPosition node(std::size_t i) const {
        return leaves_out ? data.position(static_cast<std::int32_t>(i))
                          : data.points().to_local(nodes[i]);
    }
    std::int32_t left_out(std::size_t i) const {
        return leaves_out ? static_cast<std::int32_t>(i) : NeighborSearch::kNobody;
    }
    std::int32_t sheet(std::size_t i) const {
        return leaves_out ? data.sheet(static_cast<std::int32_t>(i)) : options.sheets.asked;
    }
    /// The point of a sheet at a position, if there is one among the nearest points; else kNobody.
    std::int32_t point_at_node(std::span<const spatial::Neighbor> nearest,
                               std::int32_t sheet) const {
        for (const spatial::Neighbor& near : nearest) {
            if (near.squared_distance > 0 || !data.is_point(near.point)) break;
            if (data.sheet(near.point) == sheet) return near.point;
        }
        return NeighborSearch::kNobody;
    }
    void set(std::size_t node, const Estimate& estimate) const {
        out.z[node] = estimate.value;
        out.variance[node] = estimate.variance * sill;
    }
};

/// A single point that is left out: nothing is known of its value.
Estimate unknown(double value) {
    return {value, std::numeric_limits<double>::infinity()};
}

std::vector<PlanPosition> positions_of(const LinearData& data) {
    std::vector<PlanPosition> positions;
    for (std::size_t i = 0; i < data.size(); ++i)
        positions.push_back(data.position(static_cast<std::int32_t>(i)));
    return positions;
}

std::int32_t number(Eigen::Index datum) {
    return static_cast<std::int32_t>(datum);
}

/// Kriging of every node from all data, whose covariances are factored once.
class UniqueNeighborhood {
public:
    /// @param task          must outlive this
    /// @param factor_share  the progress goes up to this
    /// @throws Cancelled
    UniqueNeighborhood(const KrigingTask& task, double factor_share);

    /// What one thread works with.
    struct UniqueScratch {
        Eigen::MatrixXd u;
        Eigen::VectorXd column;
        std::vector<spatial::Neighbor> near;
        NeighborKriging others;
    };
    UniqueScratch scratch() const {
        return {{}, {}, {}, NeighborKriging(task_.data, task_.covariance, task_.options.drift)};
    }

    /// Estimates the nodes begin .. end - 1 of the task at once, at most kNodesAtOnce.
    void krige(std::size_t begin, std::size_t end, UniqueScratch& scratch) const;

    /// Estimates the points begin .. end - 1, each from the others.
    void leave_out(std::size_t begin, std::size_t end, UniqueScratch& scratch) const;

private:
    const KrigingTask& task_;
    Eigen::Index count_;
    double base_;
    DriftFrame frame_;
    TiledCholesky factor_;
    DriftBasis basis_;
    Eigen::VectorXd t_;
    DriftBasis::Coefficients qt_;
};

UniqueNeighborhood::UniqueNeighborhood(const KrigingTask& task, double factor_share)
    : task_(task),
      count_(static_cast<Eigen::Index>(task.data.size())),
      base_(task.data.points().values[0]),
      frame_(positions_of(task.data), task.options.drift),
      factor_(
          count_,
          [&](Eigen::Index i, Eigen::Index j) {
              return i == j ? 1.0 : task.data.between(number(i), number(j), task.covariance);
          },
          kRedundantVariance, task.execution, factor_share) {
    const Eigen::Index terms = drift_terms(task.options.drift);
    Eigen::MatrixXd plain(count_, terms), right_hand_sides(count_, terms + 1);
    for (Eigen::Index p = 0; p < count_; ++p) {
        plain.row(p) = task.data.terms(number(p), frame_);
        right_hand_sides.row(p).head(terms) = plain.row(p);
        right_hand_sides(p, terms) = task.data.value(number(p), base_);
        if (factor_.left_out(p)) plain.row(p).setZero();
    }
    factor_.solve(right_hand_sides, task.execution.progress);
    basis_.make(plain, right_hand_sides.leftCols(terms));
    t_ = right_hand_sides.col(terms);
    qt_ = basis_.project(t_);
}

void UniqueNeighborhood::krige(std::size_t begin, std::size_t end, UniqueScratch& scratch) const {
    Eigen::MatrixXd& u = scratch.u;
    // Always of one width, and columns at one alignment: sums are added in the same order then,
    // whichever nodes are estimated together.
    u.setZero(count_, kNodesAtOnce);
    for (std::size_t i = begin; i < end; ++i) {
        const PlanPosition node = task_.node(i);
        const auto column = static_cast<Eigen::Index>(i - begin);
        for (Eigen::Index p = 0; p < count_; ++p)
            u(p, column) =
                task_.data.with_height(node, number(p), task_.covariance, task_.sheet(i));
        if (cancelled(task_.execution.progress)) return;
    }
    factor_.solve(u, task_.execution.progress);
    for (std::size_t i = begin; i < end && !cancelled(task_.execution.progress); ++i) {
        const PlanPosition node = task_.node(i);
        const std::int32_t sheet = task_.sheet(i);
        task_.tree.find(node, task_.data.sheet_count(), scratch.near);
        const std::int32_t at_node = task_.point_at_node(scratch.near, sheet);
        if (at_node != NeighborSearch::kNobody) {
            task_.set(i, {task_.data.points().values[at_node], 0});
            continue;
        }
        Eigen::VectorXd& column = scratch.column;
        column = u.col(static_cast<Eigen::Index>(i - begin));
        const auto estimate = [&](double from) {
            return universal_kriging(from, column.squaredNorm(), column.dot(t_), basis_,
                                     task_.data.terms(node, sheet, frame_), basis_.project(column),
                                     qt_);
        };
        task_.set(i, task_.data.has_sheets()
                         ? in_heights(base_, task_.data.unit(sheet), estimate(0))
                         : estimate(base_));
    }
}

/// With B = C^-1 - C^-1 F (F^T C^-1 F)^-1 F^T C^-1 the error is (B z)_i / B_ii and its variance
/// 1 / B_ii (Dubrule 1983); column i of L^-1 gives both.
void UniqueNeighborhood::leave_out(std::size_t begin, std::size_t end,
                                   UniqueScratch& scratch) const {
    Eigen::MatrixXd& u = scratch.u;
    u.setZero(count_, static_cast<Eigen::Index>(end - begin));
    for (std::size_t i = begin; i < end; ++i)
        u(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i - begin)) = 1;
    factor_.solve(u, task_.execution.progress);
    for (std::size_t i = begin; i < end && !cancelled(task_.execution.progress); ++i) {
        const auto column = u.col(static_cast<Eigen::Index>(i - begin));
        const DriftBasis::Coefficients qu = basis_.project(column);
        const double whole = column.squaredNorm(), b = whole - qu.squaredNorm();
        const double value = task_.data.points().values[i];
        const double unit = task_.data.unit(task_.sheet(i));
        if (b > 1e-9 * whole) {
            task_.set(i, {value - unit * (column.dot(t_) - qu.dot(qt_)) / b, unit * unit / b});
            continue;
        }
        // The point alone determines a term of the drift, or others determine the point.
        DataSearch search(task_.data, task_.tree, {kMostOthers, 0, 0});
        search.find(task_.node(i), scratch.near, task_.left_out(i));
        task_.set(i, scratch.near.empty()
                         ? unknown(value)
                         : scratch.others.at(task_.node(i), scratch.near, task_.sheet(i),
                                             task_.execution.progress));
    }
}

/// One system after another: neighbors in octants or within a radius, or more than the lanes take.
void krige_one_by_one(const KrigingTask& task) {
    const std::size_t points = task.data.point_count();
    const auto wanted = static_cast<std::size_t>(task.options.neighborhood.neighbors);
    const auto n = static_cast<double>((wanted > 0 ? std::min(wanted, points) : points) +
                                       2 * task.data.dips_at_node());
    require_memory(thread_count(task.execution.threads) * n * (n + 8) * sizeof(double), n,
                   "kriging each node from its nearest", 16);
    struct SingleScratch {
        NeighborKriging kriging;
        DataSearch search;
        std::vector<spatial::Neighbor> near;
    };
    std::atomic<std::int64_t> alone{0};
    NodeLoop{task.count(), 256, task.execution, "kriging"}.over_nodes(
        [&] {
            return SingleScratch{NeighborKriging(task.data, task.covariance, task.options.drift),
                                 DataSearch(task.data, task.tree, task.options.neighborhood),
                                 {}};
        },
        [&](SingleScratch& scratch, std::size_t i) {
            const PlanPosition node = task.node(i);
            if (!scratch.search.find(node, scratch.near, task.left_out(i))) ++alone;
            const std::int32_t sheet = task.sheet(i),
                               at_node = task.point_at_node(scratch.near, sheet);
            if (scratch.near.empty()) {
                task.set(i, unknown(task.data.points().values[i]));
            } else if (at_node != NeighborSearch::kNobody) {
                task.set(i, {task.data.points().values[at_node], 0});
            } else {
                task.set(i, scratch.kriging.at(node, scratch.near, sheet, task.execution.progress));
            }
        });
    task.out.alone = alone;
}

/// Nodes between two looks at whether to stop: some hundredths of a second, however large the
/// systems.
std::size_t nodes_in_chunk(std::size_t neighbors) {
    return neighbors <= 64 ? 512 : neighbors <= 128 ? 128 : 64;
}

/// Of nodes that follow one another along a curve: of each its nearest points, all but itself where
/// it is left out.
std::vector<std::int32_t> nearest_points(const KrigingTask& task, std::size_t neighbors,
                                         std::span<const PlanPosition> nodes,
                                         std::span<const std::int32_t> left_out) {
    std::vector<std::int32_t> nearest(nodes.size() * neighbors);
    NodeLoop{nodes.size(), 512, task.execution}.over_chunks(
        [&] { return spatial::BlockNeighbors(task.tree, neighbors + (task.leaves_out ? 1 : 0)); },
        [&](spatial::BlockNeighbors& block, std::size_t i, std::size_t end) {
            constexpr std::size_t kMostInBlock = 64;
            for (std::size_t count = kMostInBlock; i < end; count *= 2) {
                count = std::min({count, kMostInBlock, end - i});
                while (!block.prepare(nodes.subspan(i, count)))
                    count /= 2;
                for (const std::size_t last = i + count; i < last; ++i) {
                    auto found = block.nearest(nodes[i]).begin();
                    for (std::size_t k = 0; k < neighbors; ++found) {
                        const std::int32_t point = block.candidates()[*found];
                        if (point != left_out[i]) nearest[i * neighbors + k++] = point;
                    }
                }
            }
        });
    return nearest;
}

/// Has a device solve the systems of the nodes from `first` on, whose positions are given; whether
/// it did.
/// @param order  of the positions, along a curve
bool krige_on_device(const KrigingTask& task, std::size_t neighbors, std::size_t first,
                     std::span<const PlanPosition> positions,
                     std::span<const std::uint32_t> order) {
    const Device& device = *task.execution.device;
    const DataPoints& points = task.data.points();
    const auto& structures = task.covariance.structures();
    const std::size_t at_once = kNeighborsOnDevice / neighbors;
    for (std::size_t begin = 0; begin < order.size(); begin += at_once) {
        const auto numbers = order.subspan(begin, std::min(at_once, order.size() - begin));
        const auto nodes =
            transformed(numbers, [&](std::uint32_t number) { return positions[number]; });
        const auto left_out = transformed(
            numbers, [&](std::uint32_t number) { return task.left_out(first + number); });
        const std::vector<std::int32_t> nearest = nearest_points(task, neighbors, nodes, left_out);
        std::vector<Estimate> estimates(nodes.size());
        if (!device.krige(device.state,
                          {points.local[0].data(), points.values.data(), points.local.size(),
                           structures.data(), structures.size(), nodes[0].data(), nodes.size(),
                           nearest.data(), neighbors, !task.leaves_out, &estimates[0].value}))
            return false;
        for (std::size_t i = 0; i < numbers.size(); ++i)
            task.set(first + numbers[i], estimates[i]);
    }
    return true;
}

/// The nearest of all directions and distances, few enough: several systems at once. Those that are
/// not well posed - points in one line and a drift across it - one by one.
void krige_in_lanes(const KrigingTask& task) {
    const std::size_t points = task.data.point_count() - (task.leaves_out ? 1 : 0);
    const auto wanted = static_cast<std::size_t>(task.options.neighborhood.neighbors);
    const std::size_t neighbors = std::min(wanted, points), count = task.count();
    struct LaneScratch {
        std::vector<LaneKriging::KrigingNode> nodes;
        LaneKriging lanes;
        NeighborKriging single;
        DataSearch search;
        std::vector<spatial::Neighbor> near;
    };
    const auto make = [&] {
        return LaneScratch{{},
                           LaneKriging(task.data, task.tree, task.covariance, neighbors,
                                       task.leaves_out, lane_kernels().front(), task.options.drift),
                           NeighborKriging(task.data, task.covariance, task.options.drift),
                           DataSearch(task.data, task.tree, task.options.neighborhood),
                           {}};
    };
    bool on_device = task.execution.device != nullptr && task.options.drift == Drift::kConstant &&
                     task.data.dips_at_node() == 0 && neighbors <= Device::kMostNeighbors;
    std::vector<PlanPosition> positions;
    for (std::size_t first = 0; first < count; first += kNodesInOrder) {
        const std::size_t here = std::min(kNodesInOrder, count - first);
        positions.resize(here);
        for (std::size_t i = 0; i < here; ++i)
            positions[i] = task.node(first + i);
        const std::vector<std::uint32_t> order = spatial::along_hilbert_curve(positions);
        const auto share = [&](std::size_t done) {
            return static_cast<double>(done) / static_cast<double>(count);
        };
        begin_phase(task.execution.progress, share(first), share(first + here), "kriging");
        on_device = on_device && krige_on_device(task, neighbors, first, positions, order);
        if (on_device) continue;
        NodeLoop{here,           nodes_in_chunk(neighbors + 2 * task.data.dips_at_node()),
                 task.execution, "kriging",
                 share(first),   share(first + here)}
            .over_chunks(make, [&](LaneScratch& scratch, std::size_t begin, std::size_t end) {
                scratch.nodes.clear();
                for (std::size_t k = begin; k < end; ++k) {
                    scratch.nodes.push_back(
                        {positions[order[k]], order[k], task.left_out(first + order[k])});
                }
                scratch.lanes.krige(
                    scratch.nodes,
                    [&](std::uint32_t i, const Estimate& kriged) { task.set(first + i, kriged); },
                    [&](std::uint32_t i) {
                        scratch.search.find(positions[i], scratch.near, task.left_out(first + i));
                        task.set(first + i, scratch.single.at(positions[i], scratch.near, 0,
                                                              task.execution.progress));
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
        .over_chunks(
            [&] { return all.scratch(); },
            [&](UniqueNeighborhood::UniqueScratch& scratch, std::size_t begin, std::size_t end) {
                if (task.leaves_out) {
                    all.leave_out(begin, end, scratch);
                } else {
                    all.krige(begin, end, scratch);
                }
            });
}

/// @param leaves_out  the points instead of nodes
Kriged krige_nodes(const DataPoints& points, std::span<const PlanPosition> nodes, bool leaves_out,
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
    const Kriged kriged = krige_nodes(data, {}, true, variogram, options, execution);
    return {data.for_input_points(kriged.z), data.for_input_points(kriged.variance), kriged.alone};
}

}  // namespace realmodel::interpolation
