// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// A plane as a number, which is below 0 where it is tentative.
inline std::int32_t code_of(PlaneId plane, bool is_tentative) {
    return is_tentative ? ~plane.number() : plane.number();
}
inline bool is_tentative(std::int32_t code) {
    return code < 0;
}
inline PlaneId plane_of(std::int32_t code) {
    return PlaneId(code < 0 ? ~code : code);
}

/// The different heights of planes at one plan vertex, ascending. Planes that are known to be
/// equally high there by what the plan vertex is made of share a name and are asked once; rounded
/// heights keep the order of the others, and where they are equal, the exact test decides.
class VertexHeights {
public:
    explicit VertexHeights(const exact::PlanArrangement& geometry) : scope_(geometry) {}

    /// Finds the heights of planes above a point.
    /// @param planes  code_of each of them; in its stead comes which of the heights it has.
    ///     Tentative ones make no height, but take up that of another plane which is as high, and
    ///     where they are so near to one that rounding could make a difference they count like the
    ///     others. What takes up none gets -1.
    void find(PointId point, std::span<std::int32_t> planes);

    /// The heights, rounded, each a different double. Where several round to one, those that are
    /// doubles themselves keep theirs (what is level, as a flat base, stays so) and the others move
    /// to the next ones.
    const std::vector<double>& heights() const { return heights_; }

private:
    /// Planes that are known to be equally high.
    struct Level {
        exact::HeightName name;
        PlaneId plane;  ///< one of them
        double z;
        std::int32_t rank;
    };
    struct Plane {
        PlaneId plane;
        std::int32_t level;
    };

    bool find_single(PointId point, std::span<std::int32_t> planes);
    double rounded(const Level& level, PointId point, std::optional<exact::NearPoint>& near);
    std::int32_t level_of(PointId point, PlaneId plane);
    void find_distinct(PointId point, std::span<const std::int32_t> planes);
    void rank_levels(PointId point);
    void settle_tentative(PointId point);
    bool is_near(PointId point, PlaneId plane, std::span<const Level> levels) const;
    std::int32_t rank_of(PlaneId plane) const;
    bool is_double(std::size_t rank) const;
    void separate();

    LocalArrangement scope_;
    std::vector<Plane> planes_;     ///< each once, ascending
    std::vector<Plane> tentative_;  ///< each once; without a level until they take up one
    std::vector<Level> levels_;
    std::vector<std::int32_t> order_;  ///< of the levels, ascending
    std::vector<double> heights_;
};

}  // namespace realmodel::strata
