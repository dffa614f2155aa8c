// SPDX-License-Identifier: GPL-3.0-or-later
// Two layers of rock and a normal fault: above the fault, which dips to the east, the bottom and
// the surface between the layers are 4 lower. The ground came after it. Prints the volumes of the
// layers, which can be worked out by hand: 98,000 and 97,600.
#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <vector>

#include "realmodel/base/errors.hpp"
#include "realmodel/structures/build_compartments.hpp"

namespace {

namespace structures = realmodel::structures;

/// Triangles that own their arrays.
struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles{0, 1, 2, 0, 2, 3};

    realmodel::TriangleView view() const { return {vertices, triangles}; }
};

Surface level(double z) {
    return {{0, 0, z, 100, 0, z, 100, 100, z, 0, 100, z}};
}

void print_volumes() {
    const double low = -10, high = 30;  // of the fault: it ends outside of the rock
    const auto x = [](double z) { return 60 - z / 2; };
    const Surface fault{
        {x(low), -10, low, x(low), 110, low, x(high), 110, high, x(high), -10, high}};

    structures::StructuredInput input;
    input.structures.push_back({fault.view()});
    input.surfaces = 3;
    input.blocks =
        3;  // each lies beneath the surface of its number; there is none below the oldest
    const std::vector<std::uint8_t> acts{1, 1, 0};  // the fault is older than the upper layer
    input.acts = acts;

    std::deque<Surface> surfaces;
    const std::array<std::array<double, 3>, 2> rock{{{0, 0, -4}, {100, 100, 18}}};
    for (const structures::Compartment& compartment :
         structures::compartments_of(rock, input.structures, {})) {
        const double displaced = compartment.sides[0] > 0 ? -4 : 0;
        structures::CompartmentStack stack;
        for (const double z : {0 + displaced, 10 + displaced, 18.0}) {
            const auto number = static_cast<std::int32_t>(stack.surfaces.size());
            stack.stack.surfaces.push_back(surfaces.emplace_back(level(z)).view());
            stack.surfaces.push_back({number, number == 0 ? -1 : number});
        }
        input.compartments.push_back({compartment.sides, {stack}});
    }
    const structures::Joined model = structures::build_compartments(input, {});

    std::printf("lower layer %.1f\n", model.complex.volumes[1]);
    std::printf("upper layer %.1f\n", model.complex.volumes[2]);
}

}  // namespace

int main() {
    try {
        print_volumes();
    } catch (const realmodel::InputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
