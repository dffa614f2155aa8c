// SPDX-License-Identifier: GPL-3.0-or-later
// Kriging systems solved several at once, each in a lane of vector registers. Private.
#pragma once

#include <cstddef>
#include <span>

namespace realmodel::interpolation {

struct CovariancePart;

/// Systems side by side; number k of system s is element lanes * k + s of an array.
inline constexpr int lanes = 8;

/// The most terms of a drift.
inline constexpr std::size_t most_lane_terms = 6;

/// Kriging systems of the same size. `rows` holds, each number for all lanes: the rows of the lower
/// triangle of the covariances of the points, nearest first, diagonal included; then of all points
/// the covariances with the place, the terms of the drift (ones are the first), and values less the
/// first of them. Elimination overwrites it.
struct LaneSystems {
    int points;
    double* rows;  ///< numbers(points, terms), aligned to 64 bytes
    int terms = 1;

    static constexpr std::size_t row(std::size_t number) { return number * (number + 1) / 2; }
    static constexpr std::size_t numbers(std::size_t points, std::size_t terms = 1) {
        return (row(points) + (2 + terms) * points) * lanes;
    }
};

/// What a processor has registers for. All give the same bytes, those of LocalKriging.
struct LaneKernels {
    const char* name;

    /// out[i]: covariance of places that differ by dx[i], dy[i]; count a multiple of `lanes`,
    /// arrays aligned to 64 bytes.
    void (*covariances)(const CovariancePart* parts, std::size_t part_count, const double* dx,
                        const double* dy, double* out, std::size_t count);

    /// Estimates less the first value, and variances in units of the sill; of ordinary kriging.
    void (*krige)(const LaneSystems& systems, double* estimates, double* variances);

    /// The same about a drift whose terms but the first are 0 at the place. well_posed: 1, or 0
    /// for a system in which a point tells nothing or the points hardly tell the terms apart: what
    /// is said of that means nothing.
    void (*krige_about_drift)(const LaneSystems& systems, double* estimates, double* variances,
                              double* well_posed);
};

/// Those that this processor can run, best first.
std::span<const LaneKernels> lane_kernels();

}  // namespace realmodel::interpolation
