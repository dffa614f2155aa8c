// SPDX-License-Identifier: GPL-3.0-or-later
// Kriging systems solved several at once, each in a lane of vector registers. Private.
#pragma once

#include <cstddef>
#include <span>

namespace realmodel::interpolation {

struct CovariancePart;

/// Systems side by side; number k of system s is element lanes * k + s of an array.
inline constexpr int lanes = 8;

/// Ordinary kriging systems of the same size. `rows` holds, each number for all lanes: the rows of
/// the lower triangle of the covariances of the points, nearest first, diagonal included; then of
/// all points the covariances with the place, ones, and values less the first of them. Elimination
/// overwrites it.
struct LaneSystems {
    int points;
    double* rows;  ///< (points (points + 1) / 2 + 3 points) * lanes numbers, aligned to 64 bytes

    static constexpr std::size_t row(std::size_t number) { return number * (number + 1) / 2; }
    static constexpr std::size_t numbers(std::size_t points) {
        return (row(points) + 3 * points) * lanes;
    }
};

/// What a processor has registers for. All give the same bytes, those of LocalKriging.
struct LaneKernels {
    const char* name;

    /// out[i]: covariance of places that differ by dx[i], dy[i]; count a multiple of `lanes`,
    /// arrays aligned to 64 bytes.
    void (*covariances)(const CovariancePart* parts, std::size_t part_count, const double* dx,
                        const double* dy, double* out, std::size_t count);

    /// Estimates less the first value, and variances in units of the sill.
    void (*krige)(const LaneSystems& systems, double* estimates, double* variances);
};

/// Those that this processor can run, best first.
std::span<const LaneKernels> lane_kernels();

}  // namespace realmodel::interpolation
