// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/frame_function.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fields/lattice_values.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::fields {

namespace {

/// The mean of |u|, u being a coordinate of directions in a space of so many dimensions.
double mean_coordinate(std::size_t dimensions) {
    double mean = dimensions % 2 == 1 ? 0.5 : 4 / (3 * std::numbers::pi);
    for (std::size_t n = dimensions % 2 == 1 ? 3 : 4; n < dimensions; n += 2)
        mean *= static_cast<double>(n) / static_cast<double>(n + 1);
    return mean;
}

}  // namespace

RandomFunction::RandomFunction(const Smoothness& smoothness, double scale, double reach,
                               double rough, const DrawnNumbers& drawn)
    : smoothness_(smoothness),
      reach_(reach + rough),
      rough_(rough),
      dimensions_(drawn.dimensions),
      lines_(drawn.directions.size() / drawn.dimensions),
      steps_(drawn.steps.size() / lines_),
      step_(2 * reach_ / static_cast<double>(steps_)),
      directions_(drawn.directions.begin(), drawn.directions.end()),
      values_(lines_ * (steps_ + 1)),
      integrals_(lines_ * (steps_ + 1)) {
    assert(dimensions_ >= 3);
    // A kernel |t|^a on lines is one of r^a times the mean of |u|^a. That of a Brownian motion is
    // -|t| / 2, of its integral |t|^3 / 12.
    const double mean = mean_coordinate(dimensions_);
    const double variance = smoothness.order == 5 ? 1
                            : smoothness.order == 2
                                ? 2 / mean
                                : 12 / (mean * 2 / static_cast<double>(dimensions_ + 1));
    factor_ = std::sqrt(scale * variance / static_cast<double>(lines_));
    const double size = std::sqrt(step_);
    const std::size_t middle = steps_ / 2;
    for (std::size_t line = 0; line < lines_; ++line) {
        double* const direction = &directions_[line * dimensions_];
        const double squared =
            std::inner_product(direction, direction + dimensions_, direction, 0.0);
        for (std::size_t k = 0; k < dimensions_; ++k)
            direction[k] /= std::sqrt(squared);
        const double* const by = &drawn.steps[line * steps_];
        double* const value = &values_[line * (steps_ + 1)];
        double* const integral = &integrals_[line * (steps_ + 1)];
        if (smoothness.order == 5) {
            wave(std::sqrt(squared), by, {value, steps_ + 1});
        } else {
            for (std::size_t n = middle; n < steps_; ++n)
                value[n + 1] = value[n] + size * by[n];
            for (std::size_t n = middle; n-- > 0;)
                value[n] = value[n + 1] - size * by[n];
        }
        for (std::size_t n = middle; n < steps_; ++n)
            integral[n + 1] = integral[n] + 0.5 * step_ * (value[n] + value[n + 1]);
        for (std::size_t n = middle; n-- > 0;)
            integral[n] = integral[n + 1] - 0.5 * step_ * (value[n] + value[n + 1]);
    }
}

/// The derivative of a wave along a line, at its steps.
/// @param size  of the normal numbers that are the line's direction
void RandomFunction::wave(double size, const double* normal, std::span<double> rises) const {
    double chi = 0;
    for (int n = 0; n < 7; ++n)
        chi += normal[n] * normal[n];
    const double frequency = size / std::sqrt(chi);
    for (std::size_t n = 0; n < rises.size(); ++n) {
        const double t = frequency * (step_ * static_cast<double>(n) - reach_);
        rises[n] = frequency * (normal[7] * elementary::cos(t) - normal[8] * elementary::sin(t));
    }
}

/// Where a place is on a line.
double RandomFunction::along(std::size_t line, const Vec3& at, const Lift& lift) const {
    const double* const direction = &directions_[line * dimensions_];
    const double t = at[0] * direction[0] + at[1] * direction[1] + at[2] * direction[2];
    return std::inner_product(lift.begin(), lift.end(), direction + 3, t);
}

double RandomFunction::integral(std::size_t line, double t) const {
    const double place = (t + reach_) / step_;
    const double first = std::clamp(std::floor(place), 0.0, static_cast<double>(steps_ - 1));
    const std::size_t n = line * (steps_ + 1) + static_cast<std::size_t>(first);
    const double share = place - first;
    return integrals_[n] +
           step_ * share * (values_[n] + 0.5 * share * (values_[n + 1] - values_[n]));
}

RandomFunction::OnLine RandomFunction::on_line(std::size_t line, double t) const {
    if (smoothness_.order == 2) {
        const double mean = integral(line, t + 0.5 * rough_) - integral(line, t - 0.5 * rough_);
        return {mean / rough_, 0};
    }
    const double place = (t + reach_) / step_;
    const double first = std::clamp(std::floor(place), 0.0, static_cast<double>(steps_ - 1));
    const std::size_t n = line * (steps_ + 1) + static_cast<std::size_t>(first);
    return {integral(line, t), values_[n] + (place - first) * (values_[n + 1] - values_[n])};
}

double RandomFunction::value(const Vec3& at, const Lift& lift) const {
    double sum = 0;
    add_values({&at, 1}, lift, {&sum, 1});
    return sum;
}

void RandomFunction::add_values(std::span<const Vec3> positions, std::span<const double> lifts,
                                std::span<double> values) const {
    const std::size_t further = dimensions_ - 3;
    std::vector<Vec3> places(positions.size());
    std::vector<Lift> lifts_of(positions.size(), Lift(further));
    for (std::size_t n = 0; n < positions.size(); ++n) {
        places[n] = mapped(smoothness_.map, positions[n], lifts.subspan(n * further, further),
                           smoothness_.throws);
        for (std::size_t k = 0; k < further; ++k)
            lifts_of[n][k] = smoothness_.lift * lifts[n * further + k];
    }
    std::vector<double> sums(positions.size());
    for (std::size_t line = 0; line < lines_; ++line) {  // one of them is in the nearest memory
        for (std::size_t n = 0; n < positions.size(); ++n)
            sums[n] += on_line(line, along(line, places[n], lifts_of[n])).value;
    }
    for (std::size_t n = 0; n < positions.size(); ++n)
        values[n] += factor_ * sums[n];
}

double RandomFunction::of(const Functional& functional) const {
    double sum = 0;
    for (const ValueAtom& atom : functional.values)
        sum += atom.weight * value(atom.at, atom.lift);
    const Functional here =
        functional.mapped_by(smoothness_.map, smoothness_.lift, smoothness_.throws);
    for (const SlopeAtom& atom : here.slopes) {
        assert(smoothness_.order != 2);
        double rise = 0;
        for (std::size_t line = 0; line < lines_; ++line)
            rise += on_line(line, along(line, atom.at, atom.lift)).rise *
                    along(line, atom.along, atom.along_lift);
        sum += factor_ * rise;
    }
    return sum;
}

double FrameFunction::level(std::int32_t surface) const {
    const std::size_t contact = known_.reference(surface);
    const Vec3& at = known_.contacts()[contact];
    const Lift lift = known_.lift_of(contact);
    const double value = spline_.of({{{at, 1, true, lift}}, {}, 0, false});
    return drawn_ == nullptr ? value : value + drawn_->value(at, lift);
}

std::vector<double> FrameFunction::levels() const {
    std::vector<double> out;
    for (std::int32_t k = 0; k < known_.data().surfaces; ++k)
        out.push_back(level(k));
    return out;
}

void FrameFunction::values_at(std::span<const Vec3> places, std::span<const double> lifts,
                              std::span<double> values) const {
    spline_.values_at(places, lifts, values);
    if (drawn_ != nullptr) drawn_->add_values(places, lifts, values);
}

std::vector<double> FrameFunction::at_nodes(const Lattice& lattice, std::size_t combination,
                                            const Execution& execution) const {
    return lattice_values(
        lattice,
        [&](std::span<const Vec3> positions, std::span<double> values) {
            std::vector<Vec3> places(positions.size());
            std::transform(positions.begin(), positions.end(), places.begin(),
                           [&](const Vec3& at) { return known_.frame().to_local(at); });
            values_at(places, lifts_at(known_, positions, combination), values);
        },
        execution, known_.data().slits.count == 0 && drawn_ == nullptr);
}

std::vector<double> lifts_at(const KnownData& known, std::span<const Vec3> positions,
                             std::size_t combination) {
    const Slits& slits = known.data().slits;
    std::vector<double> out;
    if (slits.count == 0) return out;
    const std::size_t first = combination * known.lattice().nodes();
    for (const Vec3& at : positions) {
        const auto corners = corners_at(known.lattice(), at);
        for (std::size_t k = 0; k < slits.count; ++k) {
            double sum = 0;
            for (const auto& [node, weight] : corners)
                sum += weight * slits.nodes[(first + node) * slits.count + k];
            out.push_back(sum);
        }
    }
    return out;
}

}  // namespace realmodel::fields
