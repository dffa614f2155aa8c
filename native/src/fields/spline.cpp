// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/spline.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>

namespace realmodel::fields {

namespace {

// Added to the kernel as products of coordinates: it changes nothing, since forces have no moment,
// and makes the matrix positive definite.
constexpr double kProducts = 100;
// Of a row's variance: what the rows before it leave of a row that follows from them.
constexpr double kRedundant = 1e-13;
constexpr Eigen::Index kBlock = 64;

}  // namespace

Spline::Spline(std::span<const Functional> known, const Map3& map, const Execution& execution)
    : map_(map) {
    known_.reserve(known.size());
    for (const Functional& f : known)
        known_.push_back(f.mapped_by(map));
    factor(execution);
    collect_centers();
}

void Spline::factor(const Execution& execution) {
    const auto n = static_cast<Eigen::Index>(known_.size());
    Eigen::MatrixXd sides(n, 4);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3 terms = known_[i].of_coordinates();
        sides.row(i) << known_[i].right, terms[0], terms[1], terms[2];
    }
    const auto entry = [&](Eigen::Index i, Eigen::Index j) {
        return known_[i].with(known_[j]) +
               kProducts * (sides(i, 1) * sides(j, 1) + sides(i, 2) * sides(j, 2) +
                            sides(i, 3) * sides(j, 3));
    };
    scales_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double own = entry(i, i);
        scales_(i) = own > 0 ? 1 / std::sqrt(own) : 0;
    }
    const Eigen::Matrix3d moments = sides.rightCols<3>().transpose() * sides.rightCols<3>();
    const auto scaled = [&](Eigen::Index i, Eigen::Index j) {
        return scales_(i) * scales_(j) * entry(i, j);
    };
    factor_.emplace(n, scaled, kRedundant, execution, 0.0);
    sides = scales_.asDiagonal() * sides;
    factor_->solve(sides, execution.progress);
    products_ = sides.transpose() * sides;
    const Eigen::Matrix3d inner = products_.bottomRightCorner<3, 3>();
    coordinates_log_determinant_ =
        elementary::log(std::max(inner.determinant() / moments.determinant(), 1e-300));
    const Eigen::Vector3d tilt = inner.ldlt().solve(products_.block<3, 1>(1, 0));
    tilt_ = {tilt(0), tilt(1), tilt(2)};
    Eigen::MatrixXd forces = sides.col(0) - sides.rightCols<3>() * tilt;
    factor_->solve_transposed(forces, execution.progress);
    forces_.resize(known_.size());
    for (Eigen::Index i = 0; i < n; ++i)
        forces_[i] = scales_(i) * forces(i, 0);
    if (execution.progress != nullptr) execution.progress->check();
}

std::optional<double> Spline::log_likelihood() const {
    const auto n = static_cast<Eigen::Index>(known_.size());
    double scales = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        if (factor_->left_out(i)) return std::nullopt;
        scales += elementary::log(scales_(i));
    }
    const Eigen::Vector3d tilt(tilt_[0], tilt_[1], tilt_[2]);
    const double misfit = products_(0, 0) - products_.block<1, 3>(0, 1).dot(tilt);
    const auto free = static_cast<double>(n - 3);
    if (!(misfit > 0) || !(free > 0)) return std::nullopt;
    return -0.5 * (free * elementary::log(misfit / free) + factor_->log_determinant() - 2 * scales +
                   coordinates_log_determinant_);
}

bool Spline::left_out(std::size_t functional) const {
    return factor_->left_out(static_cast<Eigen::Index>(functional));
}

/// Atoms at one place become one.
void Spline::collect_centers() {
    std::map<Vec3, double> values;
    std::map<Vec3, Vec3> slopes;
    for (std::size_t i = 0; i < known_.size(); ++i) {
        for (const ValueAtom& atom : known_[i].values)
            values[atom.at] += forces_[i] * atom.weight;
        for (const SlopeAtom& atom : known_[i].slopes) {
            Vec3& sum = slopes[atom.at];
            sum = moved(sum, forces_[i], atom.along);
        }
    }
    for (const auto& [at, weight] : values)
        value_centers_.push_back({at, weight});
    for (const auto& [at, along] : slopes)
        slope_centers_.push_back({at, along});
}

double Spline::value(const Vec3& at) const {
    const Vec3 p = mapped(map_, at);
    double sum = dot(tilt_, p);
    for (const ValueAtom& atom : value_centers_) {
        const Vec3 d = minus(p, atom.at);
        const double squared = dot(d, d);
        sum += atom.weight * squared * std::sqrt(squared);
    }
    for (const SlopeAtom& atom : slope_centers_) {
        const Vec3 d = minus(p, atom.at);
        sum -= 3 * length(d) * dot(d, atom.along);
    }
    return sum;
}

void Spline::values_at(std::span<const Vec3> positions, std::span<double> values) const {
    using Lanes = Eigen::Array<double, kBlock, 1>;
    for (std::size_t first = 0; first < positions.size(); first += kBlock) {
        const std::size_t count = std::min<std::size_t>(kBlock, positions.size() - first);
        Lanes x = Lanes::Zero(), y = Lanes::Zero(), z = Lanes::Zero();
        for (std::size_t n = 0; n < count; ++n) {
            const Vec3 p = mapped(map_, positions[first + n]);
            x(n) = p[0];
            y(n) = p[1];
            z(n) = p[2];
        }
        Lanes sum = tilt_[0] * x + tilt_[1] * y + tilt_[2] * z;
        for (const ValueAtom& atom : value_centers_) {
            const Lanes squared =
                (x - atom.at[0]).square() + (y - atom.at[1]).square() + (z - atom.at[2]).square();
            sum += atom.weight * squared * squared.sqrt();
        }
        for (const SlopeAtom& atom : slope_centers_) {
            const Lanes dx = x - atom.at[0], dy = y - atom.at[1], dz = z - atom.at[2];
            sum -= (dx.square() + dy.square() + dz.square()).sqrt() *
                   (dx * (3 * atom.along[0]) + dy * (3 * atom.along[1]) + dz * (3 * atom.along[2]));
        }
        std::copy_n(sum.data(), count, values.data() + first);
    }
}

Vec3 Spline::gradient(const Vec3& at) const {
    const Vec3 p = mapped(map_, at);
    Vec3 sum = tilt_;
    for (const ValueAtom& atom : value_centers_) {
        const Vec3 d = minus(p, atom.at);
        sum = moved(sum, 3 * atom.weight * length(d), d);
    }
    for (const SlopeAtom& atom : slope_centers_) {
        const Vec3 d = minus(p, atom.at);
        const double r = length(d);
        if (r > 0) sum = moved(sum, -3 * dot(d, atom.along) / r, d);
        sum = moved(sum, -3 * r, atom.along);
    }
    Vec3 out{};  // by the transposed map
    for (std::size_t row = 0; row < 3; ++row)
        out = moved(out, sum[row], map_[row]);
    return out;
}

double Spline::of(const Functional& functional) const {
    double sum = 0;
    for (const ValueAtom& atom : functional.values)
        sum += atom.weight * value(atom.at);
    for (const SlopeAtom& atom : functional.slopes)
        sum += dot(gradient(atom.at), atom.along);
    return sum;
}

}  // namespace realmodel::fields
