// SPDX-License-Identifier: GPL-3.0-or-later
#include "small_builds.hpp"

#include <array>
#include <cmath>

#include "digest.hpp"
#include "random_source.hpp"
#include "realmodel/booleans/intersect.hpp"
#include "realmodel/cutting/cut.hpp"
#include "realmodel/fields/field.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/simulation/filled_mesh.hpp"
#include "realmodel/strata/stack.hpp"
#include "realmodel/structures/structures.hpp"

namespace realmodel::fuzz {

namespace {

struct SmallSurface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
    TriangleView view() const { return {vertices, triangles}; }
};

/// Over a square with sides of 4, of 4 x 4 x 2 triangles, near a height.
SmallSurface uneven(RandomSource& random, double height) {
    SmallSurface made;
    for (int i = 0; i <= 4; ++i) {
        for (int j = 0; j <= 4; ++j)
            made.vertices.insert(made.vertices.end(),
                                 {1.0 * i, 1.0 * j, height + random.uniform(-0.4, 0.4)});
    }
    for (std::int32_t i = 0; i < 4; ++i) {
        for (std::int32_t j = 0; j < 4; ++j) {
            const std::int32_t a = 5 * i + j, b = a + 5, c = b + 1, d = a + 1;
            made.triangles.insert(made.triangles.end(), {a, b, c, a, c, d});
        }
    }
    return made;
}

/// An inclined rectangle across it.
SmallSurface inclined(RandomSource& random) {
    const double x = random.uniform(1, 3), lean = random.uniform(-0.5, 0.5);
    return {{x - 9 * lean, -9, -9, x - 9 * lean, 9, -9, x + 9 * lean, -9, 9, x + 9 * lean, 9, 9},
            {0, 1, 3, 0, 3, 2}};
}

SmallSurface random_tetrahedron(RandomSource& random) {
    SmallSurface made{{}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}};
    for (const std::array<double, 3>& p :
         {std::array{0., 0., 0.}, {4., 0., 0.}, {0., 4., 0.}, {0., 0., 4.}}) {
        for (const double x : p)
            made.vertices.push_back(x + random.uniform());
    }
    return made;
}

strata::CellComplex stack_of(const std::vector<SmallSurface>& sheets, int threads,
                             strata::CellKind cells) {
    strata::StackInput input;
    for (const SmallSurface& s : sheets)
        input.surfaces.push_back(s.view());
    return strata::build_rock_masses({&input, 1}, {threads, nullptr}, cells);
}

}  // namespace

std::vector<SmallBuild> small_builds(std::uint64_t seed) {
    RandomSource random(seed);
    std::vector<SmallSurface> sheets;
    for (int k = 0; k < 3; ++k)
        sheets.push_back(uneven(random, 0.5 * k));
    const SmallSurface fault = inclined(random), one = random_tetrahedron(random),
                       other = random_tetrahedron(random);
    std::vector<std::array<double, 3>> points;
    std::vector<std::int32_t> surfaces;
    for (int i = 0; i < 24; ++i) {
        const double x = random.uniform(0, 4), y = random.uniform(0, 4);
        points.push_back({x, y, 1.5 + i % 2 + 0.3 * std::sin(x) + 0.1 * y});
        surfaces.push_back(i % 2);
    }
    const auto columns = [sheets](int threads) {
        return stack_of(sheets, threads, strata::CellKind::kColumns);
    };
    const auto add = [](Digest& sum, const cutting::Cut& cut) {
        const std::array both{digest(cut.below), digest(cut.above)};
        return sum.add(both).value();
    };
    return {
        {"columns", [columns](int threads) { return digest(columns(threads)); }},
        {"blocks",
         [sheets](int threads) {
             return digest(stack_of(sheets, threads, strata::CellKind::kBlocks));
         }},
        {"Boolean",
         [one, other](int threads) {
             const auto made = booleans::intersect(one.view(), other.view(), {threads, nullptr});
             return Digest().add(made.vertices).add(made.triangles).add(made.source).value();
         }},
        {"cut by a plane",
         [columns, add](int threads) {
             Digest sum;
             return add(sum,
                        cutting::cut_by_plane(columns(threads), {{2.1, 2.2, 0.6}, {0.9, 0.1, 0.3}},
                                              {threads, nullptr}));
         }},
        {"cut by a surface",
         [columns, fault, add](int threads) {
             Digest sum;
             return add(
                 sum, cutting::cut_by_surface(columns(threads), fault.view(), {threads, nullptr}));
         }},
        {"fault",
         [columns, fault](int threads) {
             const strata::CellComplex model = columns(threads);
             ComplexView with_fault = model;
             with_fault.blocks += 1;
             const std::array structures{structures::Structure{fault.view(), false, {}, false}};
             const std::array models{structures::CompartmentModel{with_fault, {-1}},
                                     structures::CompartmentModel{with_fault, {1}}};
             const std::vector<std::uint8_t> acts(with_fault.blocks, 1);
             return digest(
                 structures::join_models(models, structures, acts, {threads, nullptr}).complex);
         }},
        {"field",
         [points, surfaces](int threads) {
             const std::array<std::array<double, 3>, 1> dips{{{2, 2, 2}}}, normals{{{0, 0, 1}}};
             fields::FieldData data{};
             data.surfaces = 2;
             data.contacts = points;
             data.contact_surfaces = surfaces;
             data.dips = dips;
             data.normals = normals;
             const auto made = fields::solve_field({{-1, -1, -1}, {1, 1, 1}, {7, 7, 7}}, data, {},
                                                   {threads, nullptr});
             return Digest().add(made.values).add(made.levels).value();
         }},
        {"kriging",
         [points, sheets](int threads) {
             const interpolation::Variogram variogram{.range = 3, .sill = 1, .nugget = 0.1};
             std::vector<std::array<double, 2>> nodes;
             for (std::size_t i = 0; i < sheets[0].vertices.size(); i += 3)
                 nodes.push_back({sheets[0].vertices[i], sheets[0].vertices[i + 1]});
             const auto made = interpolation::krige(points, nodes, variogram,
                                                    interpolation::KrigingOptions{{8}}, {threads});
             return Digest().add(made.z).add(made.variance).value();
         }},
        {"region mesh",
         [](int) {
             const std::vector<meshing::Ring> rings{{{0, 0}, {4, 0}, {4, 4}, {1, 4}}};
             const auto made = meshing::mesh_region(rings, {.edge_length = 0.9});
             return Digest().add(made.vertices).add(made.triangles).value();
         }},
        {"tetrahedra",
         [sheets](int threads) {
             strata::CellComplex model =
                 stack_of({sheets[0], sheets[2]}, threads, strata::CellKind::kColumns);
             const std::vector<std::int32_t> regions(model.cell_block.size(), 0);
             const std::vector<std::uint8_t> kept(model.volumes.size(), 0);
             const auto made =
                 simulation::filled_mesh(model, regions, kept, 2.0, 0.05, {}, {threads, nullptr});
             return Digest().add(made.tetrahedra).add(made.region).value();
         }},
    };
}

}  // namespace realmodel::fuzz
