// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement.hpp"

#include <cmath>

namespace realmodel::fuzz {

Placement::Placement(RandomSource& random, Place place) : identity_(place == Place::kLattice) {
    if (identity_) return;
    if (place == Place::kRotated) {
        cosine_ = std::sqrt(0.75);
        sine_ = 0.5;
    }
    if (place == Place::kDecimal) {
        step_ = random.one_of({0.1, 1.0 / 3, 1e-3, 700.1});
    } else {
        step_ = random.one_of({0.1, 1.0, 12.34, 40.115, 1.0 / 3});
        origin_ = {4.5e6 + random.uniform(), 5.3e6 + random.uniform()};
    }
    constexpr std::array<double, 2> kHeights[] = {{0, 1}, {-1700, 0.1}, {0, 0.01}, {311.7, 1}};
    const auto [lift, stretch] = random.one_of(kHeights);
    lift_ = lift;
    stretch_ = stretch;
}

PlanPoint Placement::plan(double x, double y) const {
    if (identity_) return {x, y};
    x *= step_;
    y *= step_;
    return {origin_[0] + cosine_ * x - sine_ * y, origin_[1] + sine_ * x + cosine_ * y};
}

void Placement::apply(Mesh& mesh) const {
    if (identity_) return;
    for (Point& p : mesh.vertices) {
        const auto [x, y] = plan(p[0], p[1]);
        p = {x, y, lift_ + stretch_ * p[2]};
    }
}

void Placement::apply(PlanMesh& mesh) const {
    for (PlanPoint& p : mesh.vertices)
        p = plan(p[0], p[1]);
}

void Placement::apply(StackCase& stack) const {
    for (RockCase& rock : stack.rocks) {
        for (Mesh& surface : rock.surfaces)
            apply(surface);
        if (rock.region) apply(*rock.region);
        if (rock.base_elevation) rock.base_elevation = lift_ + stretch_ * *rock.base_elevation;
    }
}

}  // namespace realmodel::fuzz
