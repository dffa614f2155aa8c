// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/closed_form.hpp"

#include <algorithm>
#include <cmath>

#include "exact/local_arrangement.hpp"
#include "exact/orientation.hpp"

namespace realmodel::validation {

using exact::LocalArrangement;
using exact::PlanArrangement;
using exact::PlaneId;
using strata::Rule;

namespace {

/// The planes of a rock mass's surfaces above one place.
class PlaneColumn {
public:
    PlaneColumn(const strata::StackInput& rock, std::span<const std::int32_t> triangles,
                const PlanPosition& place, ClosedColumn& column) {
        point_ = geometry_.add_vertex(place[0], place[1]);
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k)
            plane_.push_back(triangles[k] < 0 ? kNone
                                              : add(rock.surfaces[k], triangles[k], column));
        if (rock.base_elevation && lowest_ <= *rock.base_elevation) {
            std::array<exact::SpaceId, 3> corner;
            for (std::size_t i = 0; i < 3; ++i)
                corner[i] = geometry_.add_space_vertex(corner_[i], *rock.base_elevation);
            base_ = geometry_.add_plane(corner);
        }
        geometry_.freeze_vertices();
    }

    /// e_k and the rest, as the rules say it, going forward in time and back.
    void replay(const strata::StackInput& rock, std::span<const std::int32_t> block,
                ClosedColumn& column) {
        LocalArrangement scope(geometry_);
        const auto higher = [&](PlaneId a, PlaneId b) {
            return scope.compare_heights(a, b, point_) >= 0 ? a : b;
        };
        const std::size_t count = plane_.size();
        std::vector<PlaneId> level(count, kNone), before(count, kNone);
        PlaneId top = kNone, floor = kNone;
        for (std::size_t k = 0; k < count; ++k) {
            column.surface_height.push_back(std::nullopt);
            PlaneId e = plane_[k];
            if (e == kNone) continue;
            column.surface_height.back() = scope.rounded_height(e, point_);
            if (base_ != kNone) e = higher(e, base_);
            const Rule rule = rock.rules.empty() ? Rule::kErosional : rock.rules[k];
            before[k] = top;
            if (!meaning(rule).cuts && top != kNone) e = higher(e, top);
            if (floor != kNone) e = higher(e, floor);
            level[k] = top = e;
            if (meaning(rule).protects) floor = e;
        }
        std::vector<PlaneId> upper(count, kNone);
        PlaneId lowest = kNone;
        for (std::size_t k = count; k-- > 0;) {
            if (level[k] == kNone) continue;
            lowest = lowest == kNone || higher(lowest, level[k]) == lowest ? level[k] : lowest;
            upper[k] = lowest;
        }
        for (std::size_t k = 0; k < count; ++k) {
            if (upper[k] == kNone) continue;
            const double high = scope.rounded_height(upper[k], point_);
            if (k == 0 && rock.base_elevation) {
                if (high > *rock.base_elevation)
                    column.intervals.push_back({block[k], *rock.base_elevation, high});
            } else if (before[k] != kNone &&
                       scope.compare_heights(before[k], upper[k], point_) < 0) {
                column.intervals.push_back(
                    {block[k], scope.rounded_height(before[k], point_), high});
            }
        }
    }

private:
    PlaneId add(const TriangleView& surface, std::int32_t triangle, ClosedColumn& column) {
        std::array<const double*, 3> row;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t v = surface.triangles[3 * static_cast<std::size_t>(triangle) + i];
            row[i] = &surface.vertices[3 * static_cast<std::size_t>(v)];
            column.highest = std::max(column.highest, std::abs(row[i][2]));
            lowest_ = std::min(lowest_, row[i][2]);
        }
        if (exact::orient2d({row[0][0], row[0][1]}, {row[1][0], row[1][1]},
                            {row[2][0], row[2][1]}) < 0)
            std::swap(row[1], row[2]);
        std::array<exact::SpaceId, 3> corner;
        for (std::size_t i = 0; i < 3; ++i) {
            corner_[i] = geometry_.add_vertex(row[i][0], row[i][1]);
            corner[i] = geometry_.add_space_vertex(corner_[i], row[i][2]);
        }
        const PlaneId plane = geometry_.add_plane(corner);
        const exact::PlaneFilter& slope = geometry_.plane_filter(plane);
        column.slope = std::max(column.slope, std::abs(slope.gx) + std::abs(slope.gy));
        return plane;
    }

    PlanArrangement geometry_;
    exact::VertexId point_;
    std::vector<PlaneId> plane_;
    std::array<exact::VertexId, 3> corner_;  ///< of some triangle, counter-clockwise
    double lowest_ = HUGE_VAL;
    PlaneId base_ = kNone;  ///< the flat base, where a surface may be below it
};

}  // namespace

ClosedColumn closed_column(const ModelInput& input, std::span<const std::int32_t> triangles,
                           const PlanPosition& place) {
    ClosedColumn column;
    std::size_t first = 0;
    for (const strata::StackInput& rock : input.rocks) {
        const std::size_t count = rock.surfaces.size();
        const auto of_rock = triangles.subspan(first, count);
        if (std::all_of(of_rock.begin(), of_rock.end(), [](std::int32_t t) { return t < 0; })) {
            column.surface_height.resize(first + count);
        } else {
            PlaneColumn planes(rock, of_rock, place, column);
            planes.replay(rock, input.block_of_surface.subspan(first, count), column);
            if (rock.base_elevation)
                column.highest = std::max(column.highest, std::abs(*rock.base_elevation));
        }
        first += count;
    }
    return column;
}

}  // namespace realmodel::validation
