// SPDX-License-Identifier: GPL-3.0-or-later
// Ordinary kriging of nodes from given neighbors, one system for each block of threads. Each number
// is computed as LaneKriging does it, by the same operations in the same order.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/host_device.hpp"
#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"
#include "realmodel/base/device.hpp"

namespace realmodel::cuda {

/// Systems of n points: where numbers are in the memory of a block. Rows of the lower triangle,
/// then three rows of all points (covariances with the node, ones, values), then five sums.
struct SystemLayout {
    std::size_t points;
    REALMODEL_HOST_DEVICE std::size_t row(std::size_t r) const {
        return r < points ? r * (r + 1) / 2 : points * (points + 1) / 2 + (r - points) * points;
    }
    REALMODEL_HOST_DEVICE std::size_t rows() const { return points + 3; }
    REALMODEL_HOST_DEVICE std::size_t sums() const { return row(points + 3); }
    REALMODEL_HOST_DEVICE std::size_t numbers() const { return sums() + 5; }
};

/// The estimate of a node. The arrays of the systems are in memory of the backend.
struct KrigeNode {
    KrigingSystems systems;

    template <class Block>
    REALMODEL_HOST_DEVICE void operator()(const Block& block, std::size_t node,
                                          double* memory) const {
        const SystemLayout layout{systems.neighbor_count};
        const std::int32_t* const neighbors = systems.neighbors + node * layout.points;
        const double x = systems.nodes[2 * node], y = systems.nodes[2 * node + 1];
        const double base = systems.values[neighbors[0]];
        double* const estimate = systems.estimates + 2 * node;
        if (systems.takes_points) {
            const double *const at = systems.points + 2 * neighbors[0], dx = x - at[0],
                                dy = y - at[1];
            if (dx * dx + dy * dy == 0) {  // for all threads of the block
                if (block.thread == 0) {
                    estimate[0] = base;
                    estimate[1] = 0;
                }
                return;
            }
        }
        assemble(block, layout, neighbors, x, y, base, memory);
        eliminate(block, layout, memory);
        add_products(block, layout, memory);
        if (block.thread == 0) {
            const double* const sum = memory + layout.sums();
            const interpolation::Estimate kriged =
                interpolation::ordinary_kriging(sum[0], sum[1], sum[2], sum[3], sum[4]);
            estimate[0] = base + kriged.value;
            estimate[1] = kriged.variance;
        }
    }

private:
    REALMODEL_HOST_DEVICE double covariance(double dx, double dy) const {
        return interpolation::covariance_of(systems.structures, systems.structure_count, dx, dy);
    }

    template <class Block>
    REALMODEL_HOST_DEVICE void assemble(const Block& block, const SystemLayout& layout,
                                        const std::int32_t* neighbors, double x, double y,
                                        double base, double* memory) const {
        const std::size_t n = layout.points;
        std::size_t i = 0, j = block.thread;  // of the triangle's number that is this thread's next
        for (std::size_t k = block.thread; k < layout.row(n); k += block.threads) {
            for (; j > i; ++i)
                j -= i + 1;
            const double *const a = systems.points + 2 * neighbors[i], *const b = systems.points +
                                                                                  2 * neighbors[j];
            memory[k] = i == j ? 1 : covariance(a[0] - b[0], a[1] - b[1]);
            j += block.threads;
        }
        for (std::size_t k = block.thread; k < n; k += block.threads) {
            const double* const a = systems.points + 2 * neighbors[k];
            memory[layout.row(n) + k] = covariance(x - a[0], y - a[1]);
            memory[layout.row(n + 1) + k] = 1;
            memory[layout.row(n + 2) + k] = systems.values[neighbors[k]] - base;
        }
        block.sync();
    }

    template <class Block>
    REALMODEL_HOST_DEVICE static void eliminate(const Block& block, const SystemLayout& layout,
                                                double* memory) {
        for (std::size_t k = 0; k < layout.points; ++k) {
            double* const pivot_row = memory + layout.row(k);
            const double pivot = pivot_row[k];
            // A point that the nearer ones determine is passed over.
            const double scale =
                pivot < interpolation::kRedundantVariance ? 0 : 1 / std::sqrt(pivot);
            for (std::size_t r = k + 1 + block.thread; r < layout.rows(); r += block.threads)
                memory[layout.row(r) + k] *= scale;
            block.sync();
            for (std::size_t r = k + 1 + block.thread; r < layout.rows(); r += block.threads) {
                double* const row = memory + layout.row(r);
                const std::size_t end = r < layout.points ? r + 1 : layout.points;
                for (std::size_t c = k + 1; c < end; ++c)
                    row[c] -= row[k] * memory[layout.row(c) + k];
            }
            block.sync();
        }
    }

    /// u u, u s, u t, s s and s t, with u, s and t what elimination makes of the last three rows.
    template <class Block>
    REALMODEL_HOST_DEVICE static void add_products(const Block& block, const SystemLayout& layout,
                                                   double* memory) {
        for (std::size_t number = block.thread; number < 5; number += block.threads) {
            const std::size_t first = number < 3 ? 0 : 1, second = number < 3 ? number : number - 2;
            const double *const a = memory + layout.row(layout.points + first),
                                *const b = memory + layout.row(layout.points + second);
            double sum = 0;
            for (std::size_t k = 0; k < layout.points; ++k)
                sum += a[k] * b[k];
            memory[layout.sums() + number] = sum;
        }
        block.sync();
    }
};

/// Data of systems in memory of the backend, for tiles of nodes.
template <class Backend>
class SystemsOnDevice {
public:
    /// @throws OutOfDeviceMemory
    SystemsOnDevice(Backend& backend, const KrigingSystems& systems)
        : backend_(backend),
          host_(systems),
          points_(backend, 2 * systems.point_count),
          values_(backend, systems.point_count),
          structures_(backend, systems.structure_count) {
        backend.upload(points_, systems.points);
        backend.upload(values_, systems.values);
        backend.upload(structures_, systems.structures);
    }

    /// Estimates the nodes begin .. begin + count - 1.
    /// @throws OutOfDeviceMemory
    void krige(std::size_t begin, std::size_t count) {
        const std::size_t of_node = host_.neighbor_count;
        Array<double> nodes(backend_, 2 * count), estimates(backend_, 2 * count);
        Array<std::int32_t> neighbors(backend_, of_node * count);
        backend_.upload(nodes, host_.nodes + 2 * begin);
        backend_.upload(neighbors, host_.neighbors + of_node * begin);
        KrigingSystems tile = host_;
        tile.points = points_.data();
        tile.values = values_.data();
        tile.structures = structures_.data();
        tile.nodes = nodes.data();
        tile.neighbors = neighbors.data();
        tile.estimates = estimates.data();
        const SystemLayout layout{of_node};
        constexpr std::size_t kWarp = 32;
        const std::size_t threads = (layout.rows() + kWarp - 1) / kWarp * kWarp;  // a row for each
        backend_.each_block(count, threads, layout.numbers(), KrigeNode{tile});
        backend_.download(host_.estimates + 2 * begin, estimates);
    }

private:
    template <class Element>
    using Array = typename Backend::template Array<Element>;
    Backend& backend_;
    KrigingSystems host_;
    Array<double> points_, values_;
    Array<interpolation::CovarianceStructure> structures_;
};

}  // namespace realmodel::cuda
