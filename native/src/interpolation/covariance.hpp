// SPDX-License-Identifier: GPL-3.0-or-later
// Covariances of a variogram, in units of its sill. Private.
#pragma once

#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// 1 - gamma(h) / sill: kriging with it gives the same weights as with gamma, and the matrix of the
/// data is positive definite (Chiles and Delfiner 2012, section 3.4).
class Covariance {
public:
    explicit Covariance(const Variogram& variogram)
        : first_(variogram.model, variogram.range, variogram.first_sill() / variogram.sill,
                 variogram.anisotropy) {
        for (const NestedStructure& nested : variogram.further) {
            further_.emplace_back(nested.model, nested.range, nested.sill / variogram.sill,
                                  nested.anisotropy);
        }
    }

    /// Between two different places. (At one place it is 1, whatever the nugget.)
    double operator()(const Place& a, const Place& b) const {
        const double dx = a[0] - b[0], dy = a[1] - b[1];
        double sum = first_(dx, dy);
        for (const Part& part : further_)
            sum += part(dx, dy);
        return sum;
    }

private:
    struct Part {
        Part(VariogramModel of, double range, double sill_share, const Anisotropy& anisotropy)
            : model(of), length(anisotropy), reach(range), share(sill_share) {}
        double operator()(double dx, double dy) const {
            return share * (1 - structure(model, length(dx, dy) / reach));
        }
        VariogramModel model;
        AnisotropicLength length;
        double reach, share;
    };
    Part first_;
    std::vector<Part> further_;
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
    return {base + ut - excess / ss * st, variance > 0 ? variance : 0};
}

}  // namespace realmodel::interpolation
