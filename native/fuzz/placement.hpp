// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "random_source.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Where the lattice lies in the world.
enum class Place { kLattice, kDecimal, kUtm, kRotated };

/// A map from the lattice to model coordinates; its rounding is part of the test.
class Placement {
public:
    Placement(RandomSource& random, Place place);
    void apply(Mesh& mesh) const;
    void apply(PlanMesh& mesh) const;
    void apply(StackCase& stack) const;

private:
    PlanPoint plan(double x, double y) const;
    bool identity_ = true;
    double step_ = 1, cosine_ = 1, sine_ = 0, lift_ = 0, stretch_ = 1;
    PlanPoint origin_{0, 0};
};

}  // namespace realmodel::fuzz
