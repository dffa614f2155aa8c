// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "interpolation/kriging/decay.hpp"

namespace realmodel::fields {

/// A linear map of space, by its rows.
using Map3 = std::array<Vec3, 3>;

inline Vec3 mapped(const Map3& map, const Vec3& v) {
    return {dot(map[0], v), dot(map[1], v), dot(map[2], v)};
}

/// Further coordinates of a place: by these the two sides of a fault that dies out are apart
/// (variably scaled kernels with discontinuities: De Marchi, Erb, Marchetti, Perracchione and
/// Rossini 2020). Without such faults there are none.
using Lift = std::vector<double>;

inline double product(const Lift& a, const Lift& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
/// Of a - b.
inline double squared(const Lift& a, const Lift& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}
inline Lift scaled(double factor, Lift lift) {
    for (double& coordinate : lift)
        coordinate *= factor;
    return lift;
}
/// Adds to a sum, which has no coordinates at first.
inline void add_lift(Lift& sum, double weight, const Lift& lift) {
    sum.resize(lift.size());
    for (std::size_t k = 0; k < lift.size(); ++k)
        sum[k] += weight * lift[k];
}
/// The product of a - b with a way.
inline double along(const Lift& a, const Lift& b, const Lift& way) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        sum += (a[k] - b[k]) * way[k];
    return sum;
}

struct ValueAtom {
    Vec3 at;
    double weight;
    bool measured = false;  ///< of the value as it was measured here, with its error
    Lift lift{};
};

/// A place or a way as a spline has it: moved by so much for each unit of each further coordinate
/// (none: not at all), then mapped.
inline Vec3 mapped(const Map3& map, Vec3 v, std::span<const double> lift,
                   std::span<const Vec3> throws) {
    for (std::size_t k = 0; k < throws.size() && k < lift.size(); ++k)
        v = moved(v, lift[k], throws[k]);
    return mapped(map, v);
}

/// Of functions of which derivatives of one order are least, integrated over all of space, with the
/// variance of measured values: -r for the second derivatives, r^3 for the third. With order 5 the
/// sum of all derivatives up to the fifth is least, each times a power of the range: this is the
/// covariance of Matern with smoothness 7/2, of distances in ranges (Rasmussen and Williams 2006,
/// equation 4.14).
struct SplineKernel {
    static double decayed(double r) { return interpolation::decay(r); }
    template <class Lanes>
    static Lanes decayed(const Lanes& r) {
        Lanes out;
        for (Eigen::Index n = 0; n < r.size(); ++n)
            out(n) = interpolation::decay(r(n));
        return out;
    }

    int order = 3;  ///< 2, 3 or 5
    double error = 0;

    /// At a distance, or at many.
    template <class Number>
    Number value(const Number& r) const {
        if (order == 2) return -r;
        if (order == 3) return r * r * r;
        return decayed(r) * (1 + r * (1 + r * (0.4 + r / 15)));
    }
    /// Its derivative by the distance, divided by this.
    template <class Number>
    Number rise(const Number& r) const {
        if (order == 2) return -1 / r;
        if (order == 3) return 3 * r;
        return -decayed(r) * (0.2 + r * (0.2 + r / 15));
    }
    /// The derivative of rise(), divided by the distance: of the orders 3 and 5.
    double bend(double r) const { return order == 3 ? 3 / r : decayed(r) * (1 + r) / 15; }
};

/// The derivative along a vector, which says its weight by its length.
struct SlopeAtom {
    Vec3 at, along;
    Lift lift{}, along_lift{};
};

/// What is known of a function f: a sum of values and of derivatives is `right`. The weights of
/// values sum to 0, since a constant may be added to f.
struct Functional {
    std::vector<ValueAtom> values;
    std::vector<SlopeAtom> slopes;
    double right = 0;
    bool measured_slope = false;  ///< it has the error of slopes
    double error = 0;             ///< else the variance of an error, in units of the kernel

    /// f(at) - f(from), both measured
    static Functional difference(const Vec3& at, const Vec3& from, const Lift& lift = {},
                                 const Lift& from_lift = {}) {
        return {{{at, 1.0, true, lift}, {from, -1.0, true, from_lift}}, {}, 0, false};
    }
    static Functional slope(const Vec3& at, const Vec3& along, bool measured = false) {
        return {{}, {{at, along}}, 0, measured};
    }

    /// @param lift  by how much further coordinates are scaled
    /// @param throws  by how much places move for each unit of each of these
    Functional mapped_by(const Map3& map, double lift = 1, std::span<const Vec3> throws = {}) const;
    /// With differences of values, `step` to both sides, in the place of derivatives: what the
    /// kernel -r needs, whose functions have none at a point.
    Functional by_differences(double step) const;

    /// Of the three coordinates.
    Vec3 of_coordinates() const;
    /// Of the further coordinates.
    Lift of_lift() const;

    /// Of the kernel, in both of its arguments.
    double with(const Functional& other, const SplineKernel& kernel) const;
};

}  // namespace realmodel::fields
