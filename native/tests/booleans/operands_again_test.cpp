// SPDX-License-Identifier: GPL-3.0-or-later
// A result, intersected again with what it was made of: its facets lie in the planes of those of
// its operands, up to the rounding of their vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../sanitized.hpp"
#include "realmodel/booleans/intersect.hpp"
#include "refined_meshes.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

/// A bumpy ball, as a scan: edges of all directions and no planes in common.
Mesh scan(int rings) {
    Mesh mesh = sphere({0.1, -0.2, 0.3}, 1, rings);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
        double* p = &mesh.vertices[i];
        const double by =
            1 + 0.1 * std::sin(5 * p[0] + 1) * std::cos(4 * p[1]) * std::sin(3 * p[2]);
        for (std::size_t k = 0; k < 3; ++k)
            p[k] *= by;
    }
    return mesh;
}

/// A copy of which every vertex is moved anyhow by less than so much.
Mesh jittered(Mesh mesh, double by) {
    std::mt19937 random(5);
    for (double& x : mesh.vertices)
        x += by * (static_cast<double>(random()) / 2147483648.0 - 1);
    return mesh;
}

struct Moved {
    std::string name;
    Mesh mesh;
};

/// Copies that are moved by less than the edges, which are 0.25 long.
std::vector<Moved> copies(const Mesh& mesh) {
    std::vector<Moved> made;
    for (const double by : {1e-12, 1e-9, 1e-6, 1e-3, 0.02}) {
        if (!kSanitized || by == 1e-9)
            made.push_back({"jittered by " + std::to_string(by), jittered(mesh, by)});
        if (kSanitized && by != 1e-3) continue;
        Mesh turned = mesh;
        rotate(turned, by, 2);
        made.push_back({"turned by " + std::to_string(by), std::move(turned)});
    }
    return made;
}

constexpr std::array kOperations{Operation::kUnion, Operation::kIntersection,
                                 Operation::kDifference, Operation::kReverseDifference};

TEST(OperandsAgain, AUnionSwallowsItsOperands) {
    const Mesh a = scan(kSanitized ? 5 : 8);
    for (const auto& [name, b] : copies(a)) {
        SCOPED_TRACE(name);
        const Refinement first = intersect(a.view(), b.view());
        const Mesh both = mesh_of(first, first.boundary(Operation::kUnion));
        for (const Mesh* operand : {&a, &b}) {
            const Refinement again = intersect(both.view(), operand->view());
            const Mesh result = mesh_of(again, again.boundary(Operation::kUnion));
            EXPECT_NEAR(result.volume(), both.volume(), 1e-12);
            // the operand gets the edges of the union, and nothing else is divided
            EXPECT_LE(again.triangles.size(), 1.2 * static_cast<double>(first.triangles.size()));
            expect_settled(again);
        }
    }
}

TEST(OperandsAgain, EveryResultWithEveryOperand) {
    const Mesh a = scan(kSanitized ? 4 : 6);
    for (const auto& [name, b] : copies(a)) {
        SCOPED_TRACE(name);
        const Refinement first = intersect(a.view(), b.view());
        for (const Operation operation : kOperations) {
            const Mesh result = mesh_of(first, first.boundary(operation));
            for (const Mesh* operand : {&a, &b}) {
                const Refinement again = intersect(result.view(), operand->view());
                expect_sums(again, result.volume(), operand->volume(), 1e-11);
                EXPECT_LE(again.triangles.size(), 2 * first.triangles.size());
            }
        }
    }
}

TEST(OperandsAgain, TheSameForAnyNumberOfThreads) {
    const Mesh a = scan(8), b = jittered(a, 1e-6);
    const Refinement first = intersect(a.view(), b.view());
    const Mesh both = mesh_of(first, first.boundary(Operation::kUnion));
    const Refinement one = intersect(both.view(), a.view(), {1}),
                     five = intersect(both.view(), a.view(), {5});
    EXPECT_EQ(one.vertices, five.vertices);
    EXPECT_EQ(one.triangles, five.triangles);
    EXPECT_EQ(one.is_in, five.is_in);
}

/// What doubles can give is not rounded: a cube moved by one unit in the last place.
TEST(OperandsAgain, LayersThatDoublesCanGiveStay) {
    const Mesh a = cube({1, 1, 1}, 1);
    Mesh b = a;
    for (double& x : b.vertices)
        x += 4.440892098500626e-16;
    const Refinement r = intersect(a.view(), b.view());
    EXPECT_GT(mesh_of(r, r.boundary(Operation::kDifference)).triangles.size(), 0U);
    const Mesh both = mesh_of(r, r.boundary(Operation::kUnion));
    double highest = 0;
    for (const double x : both.vertices)
        highest = std::max(highest, x);
    EXPECT_EQ(highest, 2 + 4.440892098500626e-16);
}

/// A facet of many pieces: the end of a beam that is turned, with a scan let into it.
TEST(OperandsAgain, ALargeFacetInManyPieces) {
    Mesh beam = cube({-2, -2, 0}, 4);
    rotate(beam, 0.3, 0);
    rotate(beam, 0.2, 1);
    const Mesh ball = scan(16);
    const Refinement first = intersect(beam.view(), ball.view());
    const Mesh cut = mesh_of(first, first.boundary(Operation::kDifference));
    for (const Mesh* operand : std::array<const Mesh*, 2>{&beam, &ball}) {
        const Refinement again = intersect(cut.view(), operand->view());
        expect_sums(again, cut.volume(), operand->volume(), 1e-10);
        expect_settled(again);
    }
}

}  // namespace
}  // namespace realmodel::booleans
