// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dump.hpp"

#include <map>
#include <string>
#include <vector>

#include "base/obj_file.hpp"
#include "base/vectors.hpp"

namespace realmodel::simulation {

namespace {

Vec3 at_height(const PlanPoint& p, double z) {
    return {p[0], p[1], z};
}

/// A front of a triangle in space.
std::array<Vec3, 3> corners_of(const PlanTopology& plan, const PostLevels& levels, std::size_t t,
                               const Front& front) {
    std::array<Vec3, 3> found;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t node = plan.corners(t)[i];
        found[i] = at_height(plan.point(node), levels.heights(node)[index(front[i])]);
    }
    return found;
}

}  // namespace

void dump_plan(const PlanTopology& plan, const char* path) {
    ObjFile file(path);
    for (const PlanPoint& p : plan.mesh().points)
        file.add_vertex(at_height(p, 0));
    std::map<std::int32_t, std::vector<std::size_t>> of_rock;
    for (std::size_t t = 0; t < plan.triangles(); ++t)
        of_rock[plan.rock(t)].push_back(t);
    for (const auto& [rock, triangles] : of_rock) {
        file.begin_group(rock < 0 ? "outside" : "rock_" + std::to_string(rock));
        for (const std::size_t t : triangles)
            file.add_face(plan.corners(t));
    }
    for (const bool is_step : {true, false}) {
        file.begin_group(is_step ? "steps" : "lines");
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (plan.segment(t, i) < 0 || plan.is_inner_step(t, i) != is_step) continue;
                const auto end = [&](std::size_t k) {
                    return at_height(plan.point(plan.corners(t)[k % 3]), 0);
                };
                file.add('l', std::array{end(i), end(i + 1)});
            }
        }
    }
}

void dump_posts(const PlanTopology& plan, const PostLevels& levels, const char* path) {
    constexpr double kAside = 0.05;
    ObjFile file(path);
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        const auto [a, b, c] = plan.corners(t);
        const PlanPoint middle = middle_of(plan.point(a), plan.point(b), plan.point(c));
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t post = plan.post(t, i);
            const std::int32_t node = plan.corners(t)[i];
            const PlanPoint p = moved(plan.point(node), kAside, minus(middle, plan.point(node)));
            std::vector<Vec3> line;
            for (const std::int32_t level : levels.levels(post))
                line.push_back(at_height(p, levels.heights(node)[index(level)]));
            if (line.empty()) continue;
            file.begin_group("post_" + std::to_string(post));
            file.add('l', line);
        }
    }
}

void dump_columns(const PlanTopology& plan, const PostLevels& levels, const ColumnFronts& columns,
                  const char* path) {
    ObjFile file(path);
    std::map<std::int32_t, std::vector<std::array<std::size_t, 2>>> of_block;
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t e = columns.offset[t]; e < columns.offset[t] + columns.elements(t); ++e)
            of_block[columns.blocks[e]].push_back({t, e});
    }
    for (const auto& [block, elements] : of_block) {
        file.begin_group("block_" + std::to_string(block));
        for (const auto& [t, e] : elements) {
            for (const std::size_t front : {e, e + 1})
                file.add('f', corners_of(plan, levels, t, columns.fronts[front]));
        }
    }
}

void dump_change(const EditableComplex& complex, const Change& change, const char* path) {
    ObjFile file(path);
    const auto add = [&](std::span<const std::int32_t> loop) {
        std::vector<Vec3> corners;
        for (const std::int32_t v : loop)
            corners.push_back(complex.point(v));
        file.add('f', corners);
    };
    file.begin_group("before");
    for (const std::int32_t f : change.removed)
        add(complex.corners(f));
    for (std::size_t i = 0; i < change.added.size(); ++i) {
        file.begin_group("after_" + std::to_string(i));
        add(change.loop(change.added[i]));
    }
}

}  // namespace realmodel::simulation
