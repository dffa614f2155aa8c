// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fields/functional.hpp"
#include "interpolation/kriging/tiled_cholesky.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::fields {

/// Variances of errors of measurement, in units of the kernel; 0: data are met.
struct Errors {
    double value = 0, slope = 0;
};

/// What kind of function a spline is.
struct Smoothness {
    Map3 map{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< of space: it bends less along some directions
    Errors errors{};
    int order = 3;    ///< of the derivatives that are least: 2 (no slopes are known), 3 or 5
    double lift = 1;  ///< of further coordinates
    std::vector<Vec3> throws{};  ///< by how much places move for each unit of each of these

    SplineKernel kernel() const { return {order, errors.value}; }
};

/// The function in space that meets functionals and whose derivatives are least (see Kernel),
/// integrated over all of space: sum w_i L_i K + b . x with the kernel K (Duchon 1977; with
/// derivatives as data: Wahba 1990, "Spline models for observational data", sections 1.3 and 2.4).
/// Space is mapped first. Where data have errors it passes near them, as likely as the errors are.
class Spline {
public:
    /// What is known, in the coordinates before the map; the least coordinates that
    /// determine a tilt are among it.
    Spline(std::span<const Functional> known, const Smoothness& smoothness,
           const Execution& execution);

    /// The same data with other right sides.
    void set_right(std::span<const Functional> known);

    /// The logarithm of the restricted likelihood of what is known, if the function is a random one
    /// with the kernel as generalized covariance, less a constant (Patterson and Thompson 1971;
    /// Kitanidis 1983). To compare maps by. None where the system is singular to rounding.
    /// @param error  of values, as a standard deviation: theirs, times the scale, is no less
    std::optional<double> log_likelihood(double error = 0) const;

    /// How much force a functional takes: 0 where the function would meet it anyhow.
    double force(std::size_t functional) const { return forces_[functional]; }
    /// How well functionals fit those around them: the square of what each would be missed by if it
    /// were left out, by its variance per unit of the kernel. In the mean it is scale().
    std::vector<double> misfits_without(std::span<const std::size_t> functionals) const;
    /// How much what is known counts for the value of a functional that is not: the weights of
    /// kriging, in units of the standard deviation of each.
    std::vector<double> weights_for(const Functional& functional) const;
    /// Whether a functional follows from those before it, and was left out.
    bool left_out(std::size_t functional) const;

    double value(const Vec3& at, const Lift& lift = {}) const {
        double out = 0;
        blocks_at<1>({&at, 1}, lift, {&out, 1});
        return out;
    }
    /// Where further coordinates do not change.
    Vec3 gradient(const Vec3& at, const Lift& lift = {}) const;
    /// With the errors of measured values.
    double of(const Functional& functional) const;
    /// How much the function bends.
    double energy() const;
    /// The variance of the random function per unit of the kernel, as the data have it.
    double scale() const;

    /// The same as value() of each, faster.
    /// @param lifts  further coordinates, those of one position together
    void values_at(std::span<const Vec3> positions, std::span<const double> lifts,
                   std::span<double> values) const {
        blocks_at<64>(positions, lifts, values);
    }

private:
    using Place = std::pair<Vec3, Lift>;

    template <std::size_t kWidth>
    void blocks_at(std::span<const Vec3> positions, std::span<const double> lifts,
                   std::span<double> values) const;

    void factor(const Execution& execution);
    void solve(const Execution& execution);
    void collect_centers();
    /// The gradient in the mapped coordinates, with the derivatives by the further ones.
    std::pair<Vec3, Lift> mapped_gradient(const Vec3& at, const Lift& lift) const;
    Vec3 place(const Vec3& at, std::span<const double> lift) const;
    double error_at(const Vec3& at, const Lift& lift) const;

    Smoothness smoothness_;
    std::vector<Functional> known_;  // mapped
    Eigen::VectorXd scales_;         // of the rows, so that the diagonal is 1
    std::optional<interpolation::TiledCholesky> factor_;
    Eigen::MatrixXd coordinates_;  // of the rows, times L^-1
    Eigen::Matrix4d products_;     // of the right side and the coordinates, by the inverse
    double coordinates_log_determinant_ = 0;
    std::vector<double> forces_;
    Vec3 tilt_{};
    std::map<Place, double> measured_;  // weights of measured values
    Lift lift_tilt_;                    // what the products of further coordinates amount to
    std::vector<ValueAtom> value_centers_;
    std::vector<SlopeAtom> slope_centers_;
};

}  // namespace realmodel::fields
