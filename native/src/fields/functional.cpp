// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/functional.hpp"

namespace realmodel::fields {

namespace {

double between(const ValueAtom& a, const ValueAtom& b, const Kernel& kernel) {
    const Vec3 d = minus(a.at, b.at);
    const double squared = dot(d, d);
    if (!(squared > 0)) return a.measured && b.measured ? kernel.error * a.weight * b.weight : 0;
    return a.weight * b.weight * kernel.of_squared(squared);
}

double between(const ValueAtom& a, const SlopeAtom& b) {
    const Vec3 d = minus(a.at, b.at);
    return -3 * a.weight * length(d) * dot(d, b.along);
}

double between(const SlopeAtom& a, const SlopeAtom& b) {
    const Vec3 d = minus(a.at, b.at);
    const double r = length(d);
    if (!(r > 0)) return 0;
    return -3 * (r * dot(a.along, b.along) + dot(d, a.along) * dot(d, b.along) / r);
}

}  // namespace

Functional Functional::mapped_by(const Map3& map) const {
    Functional out = *this;
    for (ValueAtom& atom : out.values)
        atom.at = mapped(map, atom.at);
    for (SlopeAtom& atom : out.slopes)
        atom = {mapped(map, atom.at), mapped(map, atom.along)};
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

Functional Functional::by_differences(double step) const {
    Functional out = *this;
    out.slopes.clear();
    for (const SlopeAtom& atom : slopes) {
        const double size = length(atom.along);
        const Vec3 ahead = times(step / size, atom.along);
        const double weight = size / (2 * step);
        out.values.push_back({plus(atom.at, ahead), weight});
        out.values.push_back({minus(atom.at, ahead), -weight});
    }
    return out;
}

double Functional::with(const Functional& other, const Kernel& kernel) const {
    double sum = 0;
    for (const ValueAtom& a : values) {
        for (const ValueAtom& b : other.values)
            sum += between(a, b, kernel);
        for (const SlopeAtom& b : other.slopes)
            sum += between(a, b);
    }
    for (const SlopeAtom& a : slopes) {
        for (const ValueAtom& b : other.values)
            sum += between(b, a);
        for (const SlopeAtom& b : other.slopes)
            sum += between(a, b);
    }
    return sum;
}

}  // namespace realmodel::fields
