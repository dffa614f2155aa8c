// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan_snapping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "parallel_sort.hpp"
#include "realmodel/exact/turn.hpp"

namespace realmodel::strata {

namespace {

using PlanPosition = std::array<double, 2>;

/// All plan positions and triangles of the input, of surfaces and regions alike; what the builder
/// refuses later (numbers that are not finite, indices out of range) is passed over.
template <class VisitVertex, class VisitTriangle>
void for_each(std::span<const StackInput> rocks, const Progress* progress,
              const VisitVertex& vertex, const VisitTriangle& triangle) {
    const auto mesh = [&](std::span<const double> vertices, std::size_t columns,
                          std::span<const std::int32_t> triangles) {
        const std::size_t count = vertices.size() / columns;
        const auto position = [&](std::size_t v) {
            return PlanPosition{vertices[v * columns], vertices[v * columns + 1]};
        };
        for (std::size_t v = 0; v < count; ++v) {
            poll(progress, v);
            const PlanPosition p = position(v);
            if (std::isfinite(p[0]) && std::isfinite(p[1])) vertex(p);
        }
        for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
            poll(progress, t);
            std::array<PlanPosition, 3> corners;
            bool sound = true;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t v = triangles[t + i];
                sound = sound && v >= 0 && static_cast<std::size_t>(v) < count;
                if (!sound) break;
                corners[i] = position(static_cast<std::size_t>(v));
                sound = std::isfinite(corners[i][0]) && std::isfinite(corners[i][1]);
            }
            if (sound) triangle(corners);
        }
    };
    for (const StackInput& rock : rocks) {
        for (const SurfaceView& s : rock.surfaces)
            mesh(s.vertices, 3, s.triangles);
        if (rock.region) mesh(rock.region->vertices, 2, rock.region->triangles);
    }
}

/// Runs of sorted values no further apart than `reach`: each of several values becomes the most
/// frequent of them (of equally frequent ones the lowest), unless one of them is to be left alone.
AxisSnapping join_close(const std::vector<double>& sorted, double reach,
                        const std::set<double>& left_alone) {
    std::vector<std::pair<double, double>> changes;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t end = i + 1;
        while (end < sorted.size() && sorted[end] - sorted[end - 1] <= reach)
            ++end;
        if (sorted[i] != sorted[end - 1]) {
            double common = sorted[i];
            std::size_t most = 0;
            bool alone = false;
            std::vector<double> values;
            for (std::size_t j = i; j < end;) {
                std::size_t same = j;
                while (same < end && sorted[same] == sorted[j])
                    ++same;
                values.push_back(sorted[j]);
                alone |= left_alone.contains(sorted[j]);
                if (same - j > most) {
                    most = same - j;
                    common = sorted[j];
                }
                j = same;
            }
            for (const double v : values) {
                if (!alone && v != common) changes.emplace_back(v, common);
            }
        }
        i = end;
    }
    return AxisSnapping(std::move(changes));
}

}  // namespace

bool share_one_plan(std::span<const StackInput> rocks) {
    std::vector<std::pair<std::span<const double>, std::size_t>> meshes;  // coordinates, columns
    for (const StackInput& rock : rocks) {
        for (const SurfaceView& s : rock.surfaces)
            meshes.emplace_back(s.vertices, 3);
        if (rock.region) meshes.emplace_back(rock.region->vertices, 2);
    }
    const auto same = [&](const auto& mesh) {
        const auto& [first, first_columns] = meshes.front();
        const auto& [other, columns] = mesh;
        const std::size_t count = other.size() / columns;
        if (first.size() / first_columns != count) return false;
        for (std::size_t v = 0; v < count; ++v) {
            if (first[v * first_columns] != other[v * columns] ||
                first[v * first_columns + 1] != other[v * columns + 1]) {
                return false;
            }
        }
        return true;
    };
    return std::all_of(meshes.begin(), meshes.end(), same);
}

double AxisSnapping::operator()(double value) const {
    const auto at = std::lower_bound(changes_.begin(), changes_.end(), value,
                                     [](const auto& change, double v) { return change.first < v; });
    return at != changes_.end() && at->first == value ? at->second : value;
}

PlanSnapping find_snapping(std::span<const StackInput> rocks, int threads,
                           const Progress* progress) {
    std::array<std::vector<double>, 2> values;
    std::array<double, 2> largest{0, 0};
    for_each(
        rocks, progress,
        [&](const PlanPosition& p) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                values[axis].push_back(p[axis]);
                largest[axis] = std::max(largest[axis], std::abs(p[axis]));
            }
        },
        [](const std::array<PlanPosition, 3>&) {});
    std::array<double, 2> reach;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        parallel_sort(values[axis], std::less<>(), threads, progress);
        reach[axis] = largest[axis] * 0x1p-51;  // two to four units in the last place
    }
    // Values whose joining would turn a triangle are left alone, until none is turned. Input so
    // fine that this does not settle soon is taken as it is.
    constexpr int kRounds = 8;
    std::array<std::set<double>, 2> left_alone;
    for (int round = 0; round < kRounds; ++round) {
        PlanSnapping snapping{join_close(values[0], reach[0], left_alone[0]),
                              join_close(values[1], reach[1], left_alone[1])};
        if (snapping.empty()) return snapping;
        bool turned = false;
        for_each(
            rocks, progress, [](const PlanPosition&) {},
            [&](const std::array<PlanPosition, 3>& p) {
                std::array<PlanPosition, 3> q;
                for (std::size_t i = 0; i < 3; ++i)
                    q[i] = {snapping.x(p[i][0]), snapping.y(p[i][1])};
                if (p == q || exact::turn(p[0], p[1], p[2]) == exact::turn(q[0], q[1], q[2]))
                    return;
                turned = true;
                for (std::size_t i = 0; i < 3; ++i) {
                    for (std::size_t axis = 0; axis < 2; ++axis)
                        left_alone[axis].insert(p[i][axis]);
                }
            });
        if (!turned) return snapping;
    }
    return {};
}

}  // namespace realmodel::strata
