// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "../strata/complex_checks.hpp"
#include "../validation/small_complex.hpp"
#include "structures/structure_sides.hpp"

namespace realmodel::structures {

/// Two unit cubes, cell 1 on cell 0, and structures through them.
struct FaultedCubes {
    /// @param faults  so many of the surfaces; the others are bodies
    FaultedCubes(std::vector<strata::OwnedSurface> given, std::size_t faults)
        : surfaces(std::move(given)), structures(structures_of(surfaces, faults)) {}
    static std::vector<Structure> structures_of(const std::vector<strata::OwnedSurface>& surfaces,
                                                std::size_t faults) {
        std::vector<Structure> all;
        for (const strata::OwnedSurface& s : surfaces)
            all.push_back({{s.vertices, s.triangles}, all.size() >= faults, {}, false});
        return all;
    }
    /// The rectangle x = at, which faces along x, far beyond the cubes.
    static strata::OwnedSurface upright(double at) {
        strata::OwnedSurface s;
        for (const double z : {-9, 9}) {
            for (const double y : {-9, 9})
                s.vertex(at, y, z);
        }
        s.triangle(0, 1, 3);
        s.triangle(0, 3, 2);
        return s;
    }
    static spatial::Box around() {
        spatial::Box box;
        box.include(Position{0, 0, 0});
        box.include(Position{1, 1, 2});
        return box;
    }
    static std::int8_t side(bool is_above) { return is_above ? 1 : -1; }
    Position inner(std::size_t region) {
        return overlay.points().rounded(overlay.inner_point(region));
    }
    template <class Visit>
    void each_region(bool of_surface, const Visit& visit) {
        for (std::size_t r = 0; r < overlay.size(); ++r) {
            if (overlay.of_cutter(r) == of_surface &&
                (!of_surface || (winding.counts(r) && winding.touches_model(r))))
                visit(r);
        }
    }

    validation::OwnedComplex cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    std::vector<strata::OwnedSurface> surfaces;
    std::vector<Structure> structures;
    StructureCutter cutter = structure_cutter(structures, around());
    CutterOverlay overlay{model, cutter.combined, {1, nullptr}};
    CutterWinding winding{overlay, nullptr};
    std::vector<cutting::NearestSide> nearest{cutter.single.begin(), cutter.single.end()};
    StructureSides sides{overlay, winding, cutter, structures, nearest, nullptr};
};

}  // namespace realmodel::structures
