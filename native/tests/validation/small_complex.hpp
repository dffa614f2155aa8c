// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "realmodel/validation/topology.hpp"

namespace realmodel::validation {

/// A complex that owns its arrays, to be damaged.
struct OwnedComplex {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::vector<std::int32_t>> loops;
    std::vector<std::array<std::int32_t, 2>> cells;
    std::vector<std::int32_t> surface, block;
    std::vector<double> volume, base;
    std::int32_t surfaces = 0;
    bool blocks = false;

    // what the view points into
    std::vector<double> flat_vertices;
    std::vector<std::int64_t> offsets;
    std::vector<std::int32_t> corners, flat_cells;

    ComplexView view() {
        flat_vertices.clear();
        for (const auto& v : vertices)
            flat_vertices.insert(flat_vertices.end(), v.begin(), v.end());
        offsets.assign(1, 0);
        corners.clear();
        for (const auto& loop : loops) {
            corners.insert(corners.end(), loop.begin(), loop.end());
            offsets.push_back(static_cast<std::int64_t>(corners.size()));
        }
        flat_cells.clear();
        for (const auto& c : cells)
            flat_cells.insert(flat_cells.end(), c.begin(), c.end());
        return {.vertices = flat_vertices,
                .face_offsets = offsets,
                .face_vertices = corners,
                .face_cells = flat_cells,
                .face_surface = surface,
                .cell_block = block,
                .blocks = volume.size(),
                .surfaces = surfaces,
                .cell_kind = blocks ? CellKind::kBlocks : CellKind::kColumns,
                .block_volume = volume,
                .block_base = base};
    }

    void add_face(std::vector<std::int32_t> loop, std::int32_t owner, std::int32_t other,
                  std::int32_t on) {
        loops.push_back(std::move(loop));
        cells.push_back({owner, other});
        surface.push_back(on);
    }
};

/// What a built model is of.
inline OwnedComplex owned(const strata::CellComplex& c, bool blocks = false) {
    OwnedComplex o;
    o.vertices.assign(c.vertices.begin(), c.vertices.end());
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        o.add_face({c.face_vertices.begin() + c.face_offsets[f],
                    c.face_vertices.begin() + c.face_offsets[f + 1]},
                   c.face_cells[f][0], c.face_cells[f][1], c.face_surface[f]);
    }
    o.block.assign(c.cell_block.begin(), c.cell_block.end());
    o.volume = c.volumes;
    o.base.assign(c.volumes.size(), std::numeric_limits<double>::quiet_NaN());
    o.surfaces = static_cast<std::int32_t>(c.volumes.size());
    o.blocks = blocks;
    return o;
}

/// Two unit cubes one on the other: block 0 on a flat base at z = 0 under surface 0, block 1 under
/// surface 1. Faces 0, 1 and 2 are level, from below; then the walls of cell 0 and those of cell 1.
inline OwnedComplex two_cubes() {
    OwnedComplex o;
    for (const double z : {0.0, 1.0, 2.0}) {
        for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
            o.vertices.push_back({x, y, z});
    }
    o.add_face({3, 2, 1, 0}, 0, -1, strata::kBase);
    o.add_face({4, 5, 6, 7}, 0, 1, 0);
    o.add_face({8, 9, 10, 11}, 1, -1, 1);
    for (std::int32_t cell = 0; cell < 2; ++cell) {
        for (std::int32_t i = 0; i < 4; ++i) {
            const std::int32_t a = 4 * cell + i, b = 4 * cell + (i + 1) % 4;
            o.add_face({a, b, b + 4, a + 4}, cell, -1, strata::kWall);
        }
    }
    o.block = {0, 1};
    o.volume = {1.0, 1.0};
    o.base = {0.0, std::numeric_limits<double>::quiet_NaN()};
    o.surfaces = 2;
    return o;
}

inline const Findings& findings(const std::vector<TestResult>& results, const std::string& name) {
    for (const TestResult& test : results) {
        if (test.name == name) return test.findings;
    }
    static const Findings none;
    ADD_FAILURE() << "no test is called " << name;
    return none;
}

/// The names of the tests that failed, in their order.
inline std::vector<std::string> failed(const std::vector<TestResult>& results) {
    std::vector<std::string> names;
    for (const TestResult& test : results) {
        if (!test.findings.passed()) names.push_back(test.name);
    }
    return names;
}

}  // namespace realmodel::validation
