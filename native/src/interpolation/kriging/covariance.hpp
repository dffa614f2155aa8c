// SPDX-License-Identifier: GPL-3.0-or-later
// Covariances of a variogram, in units of its sill. Private.
#pragma once

#include <cmath>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/kriging/decay.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// One structure of a variogram, ready to be reckoned with: a difference of places in plan counts
/// t = |(xx dx + xy dy, yx dx + yy dy)| ranges.
struct CovariancePart {
    VariogramModel model;
    double xx, xy, yx, yy;
    double share;  ///< of the sill
};

/// share (1 - f(t)). Same bytes as the lanes of lane_kernels.hpp.
inline double covariance_of(const CovariancePart& part, double dx, double dy) {
    const double along = part.xx * dx + part.xy * dy;
    const double across = part.yx * dx + part.yy * dy;
    const double square = along * along + across * across;
    const double t = std::sqrt(square);
    switch (part.model) {
        case VariogramModel::spherical:
            return part.share * (t < 1 ? 1 - t * (1.5 - 0.5 * square) : 0);
        case VariogramModel::exponential:
            return part.share * decay(3 * t);
        case VariogramModel::gaussian:
            return part.share * decay(3 * square);
        case VariogramModel::cubic:
            return part.share *
                   (t < 1 ? 1 - square * (7 - t * (8.75 - square * (3.5 - 0.75 * square))) : 0);
        case VariogramModel::matern32: {
            const double s = matern32_scale * t;
            return part.share * ((1 + s) * decay(s));
        }
        case VariogramModel::matern52: {
            const double s = matern52_scale * t;
            return part.share * ((1 + s * (1 + s * third)) * decay(s));
        }
    }
    return 0;
}

/// 1 - gamma(h) / sill: kriging with it gives the same weights as with gamma, and the matrix of the
/// data is positive definite (Chiles and Delfiner 2012, section 3.4).
class Covariance {
public:
    explicit Covariance(const Variogram& variogram) {
        add(variogram.model, variogram.range, variogram.first_sill() / variogram.sill,
            variogram.anisotropy);
        for (const NestedStructure& nested : variogram.further)
            add(nested.model, nested.range, nested.sill / variogram.sill, nested.anisotropy);
    }

    /// Between two different places. (At one place it is 1, whatever the nugget.)
    double operator()(const Place& a, const Place& b) const {
        const double dx = a[0] - b[0], dy = a[1] - b[1];
        double sum = covariance_of(parts_[0], dx, dy);
        for (std::size_t part = 1; part < parts_.size(); ++part)
            sum += covariance_of(parts_[part], dx, dy);
        return sum;
    }

    /// At least one.
    const std::vector<CovariancePart>& parts() const { return parts_; }

private:
    void add(VariogramModel model, double range, double share, const Anisotropy& anisotropy) {
        const AnisotropicLength length(anisotropy);
        const auto [xx, xy] = length.along();
        const auto [yx, yy] = length.across();
        parts_.push_back({model, xx / range, xy / range, yx / range, yy / range, share});
    }
    std::vector<CovariancePart> parts_;
};

/// What kriging says of a place.
struct Estimate {
    double value;
    double variance;  ///< in units of the sill
};

/// A point adds nothing where the others tell its value with a variance below this share of the
/// sill: it is left out of a system, which stays well-conditioned. Without a nugget the Gaussian
/// model comes here soon; the others only where points nearly coincide.
inline constexpr double redundant_variance = 1e-10;

/// The estimate from what elimination leaves: with C = L L^T the covariance matrix of the data,
/// u = L^-1 c (c: covariances with the place), s = L^-1 1, t = L^-1 (values - base), given as
/// scalar products (Chiles and Delfiner 2012, section 3.4.1, the Lagrange multiplier eliminated).
inline Estimate ordinary_kriging(double base, double uu, double us, double ut, double ss,
                                 double st) {
    const double excess = us - 1;
    const double variance = 1 - uu + excess * excess / ss;
    return {base + (ut - excess / ss * st), variance > 0 ? variance : 0};
}

}  // namespace realmodel::interpolation
