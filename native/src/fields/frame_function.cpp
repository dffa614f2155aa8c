// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/frame_function.hpp"

#include <algorithm>

#include "fields/lattice_values.hpp"
#include "fields/lattice_weights.hpp"

namespace realmodel::fields {

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

std::vector<double> FrameFunction::at_nodes(const Lattice& lattice, std::size_t side,
                                            const Execution& execution) const {
    return lattice_values(
        lattice,
        [&](std::span<const Vec3> positions, std::span<double> values) {
            std::vector<Vec3> places(positions.size());
            std::transform(positions.begin(), positions.end(), places.begin(),
                           [&](const Vec3& at) { return known_.frame().to_local(at); });
            values_at(places, lifts_at(known_, positions, side), values);
        },
        execution, known_.data().slits.count == 0 && drawn_ == nullptr);
}

std::vector<double> lifts_at(const KnownData& known, std::span<const Vec3> positions,
                             std::size_t side) {
    const Slits& slits = known.data().slits;
    std::vector<double> out;
    if (slits.count == 0) return out;
    const std::size_t first = side * known.lattice().nodes();
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
