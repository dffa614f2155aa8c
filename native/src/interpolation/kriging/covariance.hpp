// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/host_device.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/kriging/decay.hpp"
#include "realmodel/interpolation/sheets.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// One structure of a variogram: positions that differ by (dx, dy) are
/// t = |(xx dx + xy dy, yx dx + yy dy)| ranges apart.
struct CovarianceStructure {
    VariogramModel model;
    double xx, xy, yx, yy;
    double share;  ///< of the sill
    double waves;  ///< crests in a range, across; of a wave
};

/// share (1 - f(t)), of doubles or of vectors of them: the same bytes.
/// @tparam Bits  as of decay()
/// @param root   the square root of a Number
template <class Bits = std::uint64_t, class Number, class Root>
REALMODEL_HOST_DEVICE __attribute__((always_inline)) inline Number covariance_of(
    const CovarianceStructure& structure, Number dx, Number dy, const Root& root) {
    const Number along = structure.xx * dx + structure.xy * dy;
    const Number across = structure.yx * dx + structure.yy * dy;
    const Number square = along * along + across * across;
    if (structure.model == VariogramModel::kGaussian)
        return structure.share * decay<Bits>(3 * square);
    if (structure.model == VariogramModel::kWave)
        return structure.share *
               (cosine_of_turns(structure.waves * across) * decay<Bits>(3 * square));
    const Number t = root(square);
    switch (structure.model) {
        case VariogramModel::kSpherical:
            return structure.share * (t < 1.0 ? 1 - t * (1.5 - 0.5 * square) : Number{});
        case VariogramModel::kExponential:
            return structure.share * decay<Bits>(3 * t);
        case VariogramModel::kCubic:
            return structure.share *
                   (t < 1.0 ? 1 - square * (7 - t * (8.75 - square * (3.5 - 0.75 * square)))
                            : Number{});
        case VariogramModel::kMatern32: {
            const Number s = kMatern32Scale * t;
            return structure.share * ((1 + s) * decay<Bits>(s));
        }
        default: {
            const Number s = kMatern52Scale * t;
            return structure.share * ((1 + s * (1 + s * kThird)) * decay<Bits>(s));
        }
    }
}

/// The covariance of positions that differ by (dx, dy), of all structures.
REALMODEL_HOST_DEVICE inline double covariance_of(const CovarianceStructure* structures,
                                                  std::size_t count, double dx, double dy) {
    struct Root {
        REALMODEL_HOST_DEVICE double operator()(double v) const { return std::sqrt(v); }
    };
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += covariance_of(structures[i], dx, dy, Root{});
    return sum;
}

/// 1 - gamma(h) / sill: kriging with it gives the same weights as with gamma, and the matrix of the
/// data is positive definite (Chiles and Delfiner 2012, section 3.4).
class Covariance {
public:
    /// @param sheets  with several the covariances of heights in their units
    explicit Covariance(const Variogram& variogram, const Sheets& sheets = {});

    /// Between two different positions. (At one position it is 1, whatever the nugget.)
    double operator()(const PlanPosition& a, const PlanPosition& b) const {
        return sum_of(structures_, a, b);
    }

    /// Between different positions, or different sheets.
    double operator()(const PlanPosition& a, std::int32_t on_a, const PlanPosition& b,
                      std::int32_t on_b) const {
        if (units_.empty()) return (*this)(a, b);
        const double shared = (*this)(a, b);
        const double under_both = variances_[std::min(on_a, on_b)];
        const double more = under_both > 0 ? under_both * sum_of(thickness_, a, b) : 0;
        return (shared + more) / (units_[on_a] * units_[on_b]);
    }

    /// Of the heights of each sheet, in units of the root of the sill; none where there is one.
    const std::vector<double>& units() const { return units_; }

    /// Scales of the differences of dips, along x and along y: each gets the variance 1. They are
    /// differences of the surface without its nugget, which is about points; 0 where nothing else
    /// is left.
    std::array<double, 2> scales_over(double baseline, std::int32_t sheet = 0) const;

    /// At least one.
    const std::vector<CovarianceStructure>& structures() const { return structures_; }

private:
    static double sum_of(const std::vector<CovarianceStructure>& structures, const PlanPosition& a,
                         const PlanPosition& b) {
        return covariance_of(structures.data(), structures.size(), a[0] - b[0], a[1] - b[1]);
    }

    std::vector<CovarianceStructure> structures_, thickness_;
    std::vector<double> variances_, units_;
};

}  // namespace realmodel::interpolation
