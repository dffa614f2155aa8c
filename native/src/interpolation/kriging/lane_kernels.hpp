// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace realmodel::interpolation {

struct CovarianceStructure;

/// Kriging systems are solved side by side, each in a lane of vector registers; number k of system
/// s is element kLanes * k + s of an array.
inline constexpr int kLanes = 8;

/// The most points of a system, and terms of a drift.
inline constexpr int kMostLanePoints = 256;
inline constexpr std::size_t kMostLaneTerms = 6;

/// Kriging systems of the same size. `rows` holds, each number for all lanes: the rows of the lower
/// triangle of the covariances of the points, nearest first, diagonal included; then of all points
/// the covariances with the node, the terms of the drift (ones are the first), and the values less
/// the first of them. Elimination overwrites it.
struct LaneSystems {
    int points;
    double* rows;  ///< numbers(points, terms), aligned to 64 bytes
    int terms = 1;

    static constexpr std::size_t row(std::size_t number) { return number * (number + 1) / 2; }
    static constexpr std::size_t numbers(std::size_t points, std::size_t terms = 1) {
        return (row(points) + (2 + terms) * points) * kLanes;
    }
};

/// The kernels for one width of registers. All give the same bytes, those of NeighborKriging.
struct LaneKernels {
    const char* name;

    /// out[i]: covariance of positions that differ by dx[i], dy[i]; count a multiple of kLanes,
    /// arrays aligned to 64 bytes.
    void (*covariances)(const CovarianceStructure* structures, std::size_t structure_count,
                        const double* dx, const double* dy, double* out, std::size_t count);

    /// sum[i]: share * structure[i], added to what is there unless it is the first.
    void (*add_scaled)(double share, const double* structure, bool is_first, double* sum,
                       std::size_t count);

    /// Of one coordinate of systems of points and of a node after these, in the order of the
    /// covariances of LaneSystems: of each point less each up to it, and of the node less each.
    void (*differences)(const double* coordinates, std::size_t points, double* out);

    /// Estimates less the first value, and variances in units of the sill; of ordinary kriging.
    void (*krige)(const LaneSystems& systems, double* estimates, double* variances);

    /// The same about a drift whose terms but the first are 0 at the node. well_posed: 1, or 0 for
    /// a system in which a point is redundant or the points hardly distinguish the terms: its
    /// estimate means nothing.
    void (*krige_about_drift)(const LaneSystems& systems, double* estimates, double* variances,
                              double* well_posed);
};

/// Those that this processor can run, best first.
std::span<const LaneKernels> lane_kernels();

}  // namespace realmodel::interpolation
