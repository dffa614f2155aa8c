// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/spline.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <map>

namespace realmodel::fields {

namespace {

// Added to the kernel as products of coordinates: it changes nothing, since forces have no moment,
// and makes the matrix positive definite. Of further coordinates forces have moments: across a
// fault that dies out a jump is not for free, or it would be anything where there are data on one
// side only.
constexpr double kProducts = 100;
// Of a row's variance: what the rows before it leave of a row that follows from them.
constexpr double kRedundant = 1e-13;
constexpr Eigen::Index kBlock = 64;

}  // namespace

Spline::Spline(std::span<const Functional> known, const Smoothness& smoothness,
               const Execution& execution)
    : smoothness_(smoothness) {
    assert(smoothness.order == 2 || smoothness.order == 3 || smoothness.order == 5);
    known_.reserve(known.size());
    for (const Functional& f : known)
        known_.push_back(f.mapped_by(smoothness.map, smoothness.lift, smoothness.throws));
    factor(execution);
    solve(execution);
    collect_centers();
}

void Spline::set_right(std::span<const Functional> known) {
    assert(known.size() == known_.size());
    for (std::size_t i = 0; i < known.size(); ++i)
        known_[i].right = known[i].right;
    solve({});
    collect_centers();
}

void Spline::factor(const Execution& execution) {
    const auto n = static_cast<Eigen::Index>(known_.size());
    Eigen::MatrixXd terms(n, 3);
    std::vector<Lift> lifts(known_.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3 of = known_[i].of_coordinates();
        terms.row(i) << of[0], of[1], of[2];
        lifts[static_cast<std::size_t>(i)] = known_[i].of_lift();
    }
    const SplineKernel kernel = smoothness_.kernel();
    const auto entry = [&](Eigen::Index i, Eigen::Index j) {
        double error = 0;
        if (i == j) error = known_[i].measured_slope ? smoothness_.errors.slope : known_[i].error;
        return known_[i].with(known_[j], kernel) + error +
               kProducts * (terms(i, 0) * terms(j, 0) + terms(i, 1) * terms(j, 1) +
                            terms(i, 2) * terms(j, 2) +
                            product(lifts[static_cast<std::size_t>(i)],
                                    lifts[static_cast<std::size_t>(j)]));
    };
    scales_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double diagonal = entry(i, i);
        scales_(i) = diagonal > 0 ? 1 / std::sqrt(diagonal) : 0;
    }
    const Eigen::Matrix3d moments = terms.transpose() * terms;
    const auto scaled = [&](Eigen::Index i, Eigen::Index j) {
        return scales_(i) * scales_(j) * entry(i, j);
    };
    factor_.emplace(n, scaled, kRedundant, execution, 0.0);
    coordinates_ = scales_.asDiagonal() * terms;
    factor_->solve(coordinates_, execution.progress);
    const Eigen::Matrix3d inner = coordinates_.transpose() * coordinates_;
    coordinates_log_determinant_ =
        elementary::log(std::max(inner.determinant() / moments.determinant(), 1e-300));
}

void Spline::solve(const Execution& execution) {
    const auto n = static_cast<Eigen::Index>(known_.size());
    Eigen::MatrixXd right(n, 1);
    for (Eigen::Index i = 0; i < n; ++i)
        right(i, 0) = scales_(i) * known_[i].right;
    factor_->solve(right, execution.progress);
    Eigen::MatrixXd right_hand_sides(n, 4);
    right_hand_sides << right, coordinates_;
    products_ = right_hand_sides.transpose() * right_hand_sides;
    const Eigen::Matrix3d inner = products_.bottomRightCorner<3, 3>();
    const Eigen::Vector3d tilt = inner.ldlt().solve(products_.block<3, 1>(1, 0));
    tilt_ = {tilt(0), tilt(1), tilt(2)};
    Eigen::MatrixXd forces = right - coordinates_ * tilt;
    factor_->solve_transposed(forces, execution.progress);
    forces_.resize(known_.size());
    for (Eigen::Index i = 0; i < n; ++i)
        forces_[i] = scales_(i) * forces(i, 0);
    if (execution.progress != nullptr) execution.progress->check();
}

std::optional<double> Spline::log_likelihood(double error) const {
    const auto n = static_cast<Eigen::Index>(known_.size());
    double scales = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        if (factor_->left_out(i)) return std::nullopt;
        scales += elementary::log(scales_(i));
    }
    const auto free = static_cast<double>(n - 3);
    if (!(scale() > 0) || (error > 0 && !(smoothness_.errors.value > 0))) return std::nullopt;
    double largest = scale(), beyond = 0;
    if (error > 0 && error * error > smoothness_.errors.value * largest) {
        largest = error * error / smoothness_.errors.value;
        beyond = energy() / largest - free;
    }
    return -0.5 * (free * elementary::log(largest) + beyond + factor_->log_determinant() -
                   2 * scales + coordinates_log_determinant_);
}

double Spline::energy() const {
    const Eigen::Vector3d tilt(tilt_[0], tilt_[1], tilt_[2]);
    return products_(0, 0) - products_.block<1, 3>(0, 1).dot(tilt);
}

double Spline::scale() const {
    if (known_.size() <= 3) return 0;
    return std::max(0.0, energy()) / static_cast<double>(known_.size() - 3);  // rounding
}

/// With the inverse V of the matrix and the weights w these are w_i^2 / V_ii (Dubrule 1983, "Cross
/// validation of kriging in a unique neighborhood").
std::vector<double> Spline::misfits_without(std::span<const std::size_t> functionals) const {
    const auto n = static_cast<Eigen::Index>(known_.size());
    std::vector<double> out;
    for (std::size_t first = 0; first < functionals.size(); first += kBlock) {
        const auto count =
            static_cast<Eigen::Index>(std::min<std::size_t>(kBlock, functionals.size() - first));
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(n, count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const std::size_t row = functionals[first + static_cast<std::size_t>(k)];
            columns(static_cast<Eigen::Index>(row), k) = scales_(static_cast<Eigen::Index>(row));
        }
        factor_->solve(columns, nullptr);
        for (Eigen::Index k = 0; k < count; ++k) {
            const double force = forces_[functionals[first + static_cast<std::size_t>(k)]];
            const double inverse = columns.col(k).squaredNorm();
            out.push_back(inverse > 0 ? force * force / inverse : 0);
        }
    }
    return out;
}

std::vector<double> Spline::weights_for(const Functional& functional) const {
    const Functional f =
        functional.mapped_by(smoothness_.map, smoothness_.lift, smoothness_.throws);
    const Vec3 of = f.of_coordinates();
    const Lift lift = f.of_lift();
    const auto n = static_cast<Eigen::Index>(known_.size());
    Eigen::MatrixXd right_hand_side(n, 1);
    for (Eigen::Index i = 0; i < n; ++i) {
        right_hand_side(i, 0) = scales_(i) * (known_[i].with(f, smoothness_.kernel()) +
                                              kProducts * (dot(known_[i].of_coordinates(), of) +
                                                           product(known_[i].of_lift(), lift)));
    }
    factor_->solve(right_hand_side, nullptr);
    const Eigen::Matrix3d inner = products_.bottomRightCorner<3, 3>();
    const Eigen::Vector3d drift =
        coordinates_.transpose() * right_hand_side.col(0) - Eigen::Vector3d(of[0], of[1], of[2]);
    right_hand_side.col(0) -= coordinates_ * inner.ldlt().solve(drift);
    factor_->solve_transposed(right_hand_side, nullptr);
    return {right_hand_side.data(), right_hand_side.data() + n};
}

bool Spline::left_out(std::size_t functional) const {
    return factor_->left_out(static_cast<Eigen::Index>(functional));
}

/// Atoms at one place become one.
void Spline::collect_centers() {
    value_centers_.clear();
    slope_centers_.clear();
    measured_.clear();
    lift_tilt_.clear();
    std::map<Place, double> values;
    std::map<Place, Place> slopes;
    for (std::size_t i = 0; i < known_.size(); ++i) {
        for (const ValueAtom& atom : known_[i].values) {
            values[{atom.at, atom.lift}] += forces_[i] * atom.weight;
            if (atom.measured) measured_[{atom.at, atom.lift}] += forces_[i] * atom.weight;
        }
        // the kernel -r has no derivatives at its center
        assert(smoothness_.order != 2 || known_[i].slopes.empty());
        for (const SlopeAtom& atom : known_[i].slopes) {
            auto& [along, up] = slopes[{atom.at, atom.lift}];
            along = moved(along, forces_[i], atom.along);
            add_lift(up, forces_[i], atom.along_lift);
        }
        add_lift(lift_tilt_, kProducts * forces_[i], known_[i].of_lift());
    }
    for (const auto& [place, weight] : values)
        value_centers_.push_back({place.first, weight, false, place.second});
    for (const auto& [place, along] : slopes)
        slope_centers_.push_back({place.first, along.first, place.second, along.second});
}

Vec3 Spline::place(const Vec3& at, std::span<const double> lift) const {
    return mapped(smoothness_.map, at, lift, smoothness_.throws);
}

/// So many positions at a time.
template <std::size_t kWidth>
void Spline::blocks_at(std::span<const Vec3> positions, std::span<const double> lifts,
                       std::span<double> values) const {
    using Lanes = Eigen::Array<double, static_cast<int>(kWidth), 1>;
    const std::size_t further = positions.empty() ? 0 : lifts.size() / positions.size();
    const SplineKernel kernel = smoothness_.kernel();
    std::vector<Lanes> up(further, Lanes::Zero());
    for (std::size_t first = 0; first < positions.size(); first += kWidth) {
        const std::size_t count = std::min(kWidth, positions.size() - first);
        Lanes x = Lanes::Zero(), y = Lanes::Zero(), z = Lanes::Zero();
        for (std::size_t n = 0; n < count; ++n) {
            const auto lift = lifts.subspan((first + n) * further, further);
            const Vec3 p = place(positions[first + n], lift);
            x(n) = p[0];
            y(n) = p[1];
            z(n) = p[2];
            for (std::size_t k = 0; k < further; ++k)
                up[k](n) = smoothness_.lift * lift[k];
        }
        Lanes sum = tilt_[0] * x + tilt_[1] * y + tilt_[2] * z;
        for (std::size_t k = 0; k < further; ++k)
            sum += lift_tilt_[k] * up[k];
        for (const ValueAtom& atom : value_centers_) {
            Lanes squared =
                (x - atom.at[0]).square() + (y - atom.at[1]).square() + (z - atom.at[2]).square();
            for (std::size_t k = 0; k < further; ++k)
                squared += (up[k] - atom.lift[k]).square();
            sum += atom.weight * kernel.value<Lanes>(squared.sqrt());
        }
        for (const SlopeAtom& atom : slope_centers_) {
            const Lanes dx = x - atom.at[0], dy = y - atom.at[1], dz = z - atom.at[2];
            Lanes squared = dx.square() + dy.square() + dz.square();
            Lanes along = dx * atom.along[0] + dy * atom.along[1] + dz * atom.along[2];
            for (std::size_t k = 0; k < further; ++k) {
                const Lanes dk = up[k] - atom.lift[k];
                squared += dk.square();
                along += dk * atom.along_lift[k];
            }
            sum -= kernel.rise<Lanes>(squared.sqrt()) * along;
        }
        std::copy_n(sum.data(), count, values.data() + first);
    }
}

template void Spline::blocks_at<1>(std::span<const Vec3>, std::span<const double>,
                                   std::span<double>) const;
template void Spline::blocks_at<64>(std::span<const Vec3>, std::span<const double>,
                                    std::span<double>) const;

std::pair<Vec3, Lift> Spline::mapped_gradient(const Vec3& at, const Lift& lift) const {
    const Vec3 p = place(at, lift);
    const Lift q = scaled(smoothness_.lift, lift);
    const SplineKernel kernel = smoothness_.kernel();
    Vec3 sum = tilt_;
    Lift rise = q.empty() ? Lift{} : lift_tilt_;
    const auto add = [&](double weight, const Vec3& d, const Lift& from) {
        sum = moved(sum, weight, d);
        for (std::size_t k = 0; k < rise.size(); ++k)
            rise[k] += weight * (q[k] - from[k]);
    };
    for (const ValueAtom& atom : value_centers_) {
        const Vec3 d = minus(p, atom.at);
        const double r = std::sqrt(dot(d, d) + squared(q, atom.lift));
        if (r > 0) add(atom.weight * kernel.rise(r), d, atom.lift);
    }
    for (const SlopeAtom& atom : slope_centers_) {
        const Vec3 d = minus(p, atom.at);
        const double r = std::sqrt(dot(d, d) + squared(q, atom.lift));
        if (r > 0)
            add(-kernel.bend(r) * (dot(d, atom.along) + along(q, atom.lift, atom.along_lift)), d,
                atom.lift);
        sum = moved(sum, -kernel.rise(r), atom.along);
        for (std::size_t k = 0; k < rise.size(); ++k)
            rise[k] -= kernel.rise(r) * atom.along_lift[k];
    }
    return {sum, rise};
}

Vec3 Spline::gradient(const Vec3& at, const Lift& lift) const {
    const Vec3 sum = mapped_gradient(at, lift).first;
    Vec3 out{};  // by the transposed map
    for (std::size_t row = 0; row < 3; ++row)
        out = moved(out, sum[row], smoothness_.map[row]);
    return out;
}

/// By how much what was measured differs from the function.
double Spline::error_at(const Vec3& at, const Lift& lift) const {
    const auto weight = measured_.find({place(at, lift), scaled(smoothness_.lift, lift)});
    return weight == measured_.end() ? 0 : smoothness_.errors.value * weight->second;
}

double Spline::of(const Functional& functional) const {
    double sum = 0;
    for (const ValueAtom& atom : functional.values) {
        sum += atom.weight * value(atom.at, atom.lift);
        if (atom.measured) sum += atom.weight * error_at(atom.at, atom.lift);
    }
    for (const SlopeAtom& atom : functional.slopes) {
        const auto [rise, up] = mapped_gradient(atom.at, atom.lift);
        sum += dot(rise, place(atom.along, atom.along_lift)) +
               product(up, scaled(smoothness_.lift, atom.along_lift));
    }
    return sum;
}

}  // namespace realmodel::fields
