// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/functional.hpp"

#include <cmath>
#include <utility>

namespace realmodel::fields {

namespace {

double between(const ValueAtom& a, const ValueAtom& b, const SplineKernel& kernel) {
    const Vec3 d = minus(a.at, b.at);
    const double r2 = dot(d, d) + squared(a.lift, b.lift);
    const double error = !(r2 > 0) && a.measured && b.measured ? kernel.error : 0;
    return a.weight * b.weight * (kernel.value(std::sqrt(r2)) + error);
}

double between(const ValueAtom& a, const SlopeAtom& b, const SplineKernel& kernel) {
    const Vec3 d = minus(a.at, b.at);
    const double r = std::sqrt(dot(d, d) + squared(a.lift, b.lift));
    return -a.weight * kernel.rise(r) * (dot(d, b.along) + along(a.lift, b.lift, b.along_lift));
}

double between(const SlopeAtom& a, const SlopeAtom& b, const SplineKernel& kernel) {
    const Vec3 d = minus(a.at, b.at);
    const double r = std::sqrt(dot(d, d) + squared(a.lift, b.lift));
    const double straight =
        kernel.rise(r) * (dot(a.along, b.along) + product(a.along_lift, b.along_lift));
    if (!(r > 0)) return -straight;
    return -(straight + kernel.bend(r) * (dot(d, a.along) + along(a.lift, b.lift, a.along_lift)) *
                            (dot(d, b.along) + along(a.lift, b.lift, b.along_lift)));
}

}  // namespace

Functional Functional::mapped_by(const Map3& map, double lift, std::span<const Vec3> throws) const {
    Functional out = *this;
    for (ValueAtom& atom : out.values) {
        atom.at = mapped(map, atom.at, atom.lift, throws);
        atom.lift = scaled(lift, std::move(atom.lift));
    }
    for (SlopeAtom& atom : out.slopes) {
        atom.at = mapped(map, atom.at, atom.lift, throws);
        atom.along = mapped(map, atom.along, atom.along_lift, throws);
        atom.lift = scaled(lift, std::move(atom.lift));
        atom.along_lift = scaled(lift, std::move(atom.along_lift));
    }
    return out;
}

Vec3 Functional::of_coordinates() const {
    Vec3 sum{};
    for (const ValueAtom& atom : values)
        sum = moved(sum, atom.weight, atom.at);
    for (const SlopeAtom& atom : slopes)
        sum = plus(sum, atom.along);
    return sum;
}

Lift Functional::of_lift() const {
    Lift sum;
    for (const ValueAtom& atom : values)
        add_lift(sum, atom.weight, atom.lift);
    for (const SlopeAtom& atom : slopes)
        add_lift(sum, 1, atom.along_lift);
    return sum;
}

Functional Functional::by_differences(double step) const {
    Functional out = *this;
    out.slopes.clear();
    for (const SlopeAtom& atom : slopes) {
        const double size = length(atom.along);
        const Vec3 ahead = times(step / size, atom.along);
        const double weight = size / (2 * step);
        Lift up = atom.lift, down = atom.lift;
        for (std::size_t k = 0; k < up.size(); ++k) {
            up[k] += step / size * atom.along_lift[k];
            down[k] -= step / size * atom.along_lift[k];
        }
        out.values.push_back({plus(atom.at, ahead), weight, false, std::move(up)});
        out.values.push_back({minus(atom.at, ahead), -weight, false, std::move(down)});
    }
    return out;
}

double Functional::with(const Functional& other, const SplineKernel& kernel) const {
    double sum = 0;
    for (const ValueAtom& a : values) {
        for (const ValueAtom& b : other.values)
            sum += between(a, b, kernel);
        for (const SlopeAtom& b : other.slopes)
            sum += between(a, b, kernel);
    }
    for (const SlopeAtom& a : slopes) {
        for (const ValueAtom& b : other.values)
            sum += between(b, a, kernel);
        for (const SlopeAtom& b : other.slopes)
            sum += between(a, b, kernel);
    }
    return sum;
}

}  // namespace realmodel::fields
