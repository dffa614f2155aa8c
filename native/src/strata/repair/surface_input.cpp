// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/surface_input.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "base/parallel_counts.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/array.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/limits.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kRange = 1 << 12;  // looked at at a time

std::array<double, 3> vertex_of(const TriangleView& surface, std::int64_t v) {
    const auto i = static_cast<std::size_t>(v) * 3;
    return {surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]};
}

/// Looks at the coordinates of vertices.
void check_vertices(const TriangleView& surface, int index, std::size_t begin, std::size_t end) {
    for (auto v = static_cast<std::int64_t>(begin); v < static_cast<std::int64_t>(end); ++v) {
        for (const double c : vertex_of(surface, v)) {
            if (!is_within_limits(c)) {
                throw InputError("not_finite",
                                 "vertex " + std::to_string(v) +
                                     " has a coordinate that is not a number or is beyond 1e50",
                                 index, {v});
            }
        }
    }
}

/// Looks at the corners of triangles.
void check_corners(const TriangleView& surface, int index, std::size_t begin, std::size_t end) {
    const std::size_t count = surface.vertices.size() / 3;
    for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
        const std::int32_t v = surface.triangles[i];
        if (v >= 0 && static_cast<std::size_t>(v) < count) continue;
        const auto t = static_cast<std::int64_t>(i / 3);
        throw InputError("bad_index",
                         "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                             " of " + std::to_string(count),
                         index, {t});
    }
}

/// What the triangles of a range are used as, and which of them have no area.
struct RangeOfTriangles {
    struct Used {
        std::int64_t number;
        std::array<std::int32_t, 3> vertex;  ///< of the surface, counter-clockwise in plan
    };
    std::vector<Used> used;
    std::vector<std::int64_t> flat;
};

/// Triangles with an area, counter-clockwise; marks their vertices.
RangeOfTriangles triangles_with_area(const TriangleView& surface, int index,
                                     const PlanSnapping& snapping, std::size_t begin,
                                     std::size_t end, std::vector<std::uint8_t>& is_used) {
    RangeOfTriangles found;
    found.used.reserve(end - begin);
    for (std::size_t t = begin; t < end; ++t) {
        std::array<std::int32_t, 3> v;
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = surface.triangles[t * 3 + i];
            p[i] = vertex_of(surface, v[i]);
            p[i][0] = snapping.x(p[i][0]);
            p[i][1] = snapping.y(p[i][1]);
        }
        const int turn =
            exact::orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
        const auto number = static_cast<std::int64_t>(t);
        if (turn == 0) {
            if (!in_one_line(p[0], p[1], p[2])) {
                throw InputError("vertical_triangle",
                                 "triangle " + std::to_string(t) +
                                     " is vertical: a surface may have only one height at each "
                                     "point in plan; tilt or remove it",
                                 index, {number}, p[0]);
            }
            found.flat.push_back(number);
            continue;
        }
        if (turn < 0) std::swap(v[1], v[2]);
        for (const std::int32_t i : v)
            mark(is_used[static_cast<std::size_t>(i)]);
        found.used.push_back({number, v});
    }
    return found;
}

/// What the vertices of a surface were entered as, none where no triangle uses them.
struct EnteredVertices {
    std::vector<exact::SpaceId> space;
    std::vector<exact::VertexId> plan;
};

/// Enters the used vertices in their order, each fetched some rounds before it is needed.
EnteredVertices enter_vertices(PlanArrangement& geometry, const TriangleView& surface,
                               const PlanSnapping& snapping,
                               const std::vector<std::uint8_t>& is_used, Progress* progress) {
    constexpr std::size_t kAhead = 12;
    struct Entering {
        double x, y, z;
        exact::VertexId plan;
    };
    std::array<Entering, 2 * kAhead> ahead{};  // of vertices, in turn
    const std::size_t count = is_used.size();
    EnteredVertices entered{std::vector<exact::SpaceId>(count, kNone),
                            std::vector<exact::VertexId>(count, kNone)};
    const auto is_to_enter = [&](std::size_t round, std::size_t behind) {
        return round >= behind && round - behind < count && is_used[round - behind] != 0;
    };
    for (std::size_t round = 0; round < count + 2 * kAhead; ++round) {
        poll(progress, round);
        // the space vertex of one, the plan vertex of a later one, the slot of an even later one
        if (is_to_enter(round, 2 * kAhead)) {
            const Entering& e = ahead[round % ahead.size()];
            entered.plan[round - 2 * kAhead] = e.plan;
            entered.space[round - 2 * kAhead] = geometry.add_space_vertex(e.plan, e.z);
        }
        if (is_to_enter(round, kAhead)) {
            Entering& e = ahead[(round - kAhead) % ahead.size()];
            e.plan = geometry.add_vertex(e.x, e.y);
            geometry.prefetch_space_vertex(e.plan, e.z);
        }
        if (is_to_enter(round, 0)) {
            const auto [x, y, z] = vertex_of(surface, static_cast<std::int64_t>(round));
            Entering& e = ahead[round % ahead.size()];
            e = {snapping.x(x), snapping.y(y), z, kNone};
            geometry.prefetch_vertex(e.x, e.y);
        }
    }
    return entered;
}

/// A surface on its way in: what has to be done with it, in four steps, each in chunks that several
/// threads may do at once. Nothing but entering looks at the geometry.
class SurfaceEntry {
public:
    SurfaceEntry(const TriangleView& surface, int index, const PlanSnapping& snapping)
        : surface_(surface),
          index_(index),
          snapping_(snapping),
          triangles_(surface.triangles.size() / 3),
          vertices_(surface.vertices.size() / 3) {}

    static constexpr std::size_t kSteps = 4;
    std::size_t chunks(std::size_t step) const {
        switch (step) {
            case 0:
                return ranges_of(vertices_) + ranges_of(triangles_);
            case 1:
                return ranges_of(triangles_);
            case 2:
                return 1;
            default:
                return 1 + ranges_of(triangles_);
        }
    }
    /// To be called before the chunks of a step, by one thread.
    void begin(std::size_t step) {
        if (step == 1) {
            is_used_.assign(vertices_, 0);
            ranges_.resize(ranges_of(triangles_));
        } else if (step == 3) {
            is_used_ = {};
            for (const RangeOfTriangles& range : ranges_)
                first_.push_back(range.used.size());
            result_.triangles.resize(count_before(first_));
        }
    }
    void run(std::size_t step, std::size_t chunk, PlanArrangement& geometry, Progress* progress) {
        if (step == 0) {
            check(chunk);
        } else if (step == 1) {
            ranges_[chunk] =
                triangles_with_area(surface_, index_, snapping_, chunk * kRange,
                                    std::min(triangles_, (chunk + 1) * kRange), is_used_);
        } else if (step == 2) {
            entered_ = enter_vertices(geometry, surface_, snapping_, is_used_, progress);
        } else if (chunk == 0) {
            link(progress);
        } else {
            use(chunk - 1);
        }
    }
    /// To be called when all is done.
    EnteredSurface finish(std::vector<Warning>& warnings) {
        Warning flat{"no_area", index_, {}, {}};
        for (const RangeOfTriangles& range : ranges_)
            flat.items.insert(flat.items.end(), range.flat.begin(), range.flat.end());
        if (!flat.items.empty()) {
            const char* what = flat.items.size() == 1 ? " triangle" : " triangles";
            flat.text = std::to_string(flat.items.size()) + what + " without area left out";
            warnings.push_back(std::move(flat));
        }
        ranges_ = {};
        entered_ = {};
        return std::move(result_);
    }

private:
    static std::size_t ranges_of(std::size_t count) { return (count + kRange - 1) / kRange; }

    void check(std::size_t chunk) const {
        const std::size_t of_vertices = ranges_of(vertices_);
        if (chunk < of_vertices) {
            check_vertices(surface_, index_, chunk * kRange,
                           std::min(vertices_, (chunk + 1) * kRange));
        } else {
            chunk -= of_vertices;
            check_corners(surface_, index_, chunk * kRange,
                          std::min(triangles_, (chunk + 1) * kRange));
        }
    }
    void link(Progress* progress) {
        Array<PlanTriangle> corners(result_.triangles.size());
        PlanTriangle* next = corners.begin();
        for (const RangeOfTriangles& range : ranges_) {
            for (const RangeOfTriangles::Used& triangle : range.used) {
                for (std::size_t i = 0; i < 3; ++i)
                    (*next)[i] = entered_.plan[index(triangle.vertex[i])];
                ++next;
            }
        }
        result_.links = link_triangles({corners.begin(), corners.size()}, progress);
    }
    void use(std::size_t range) {
        std::transform(ranges_[range].used.begin(), ranges_[range].used.end(),
                       result_.triangles.begin() + static_cast<std::ptrdiff_t>(first_[range]),
                       [&](const RangeOfTriangles::Used& triangle) {
                           UsedTriangle used{triangle.number, {}};
                           for (std::size_t i = 0; i < 3; ++i)
                               used.corner[i] = entered_.space[index(triangle.vertex[i])];
                           return used;
                       });
    }

    const TriangleView& surface_;
    int index_;
    const PlanSnapping& snapping_;
    std::size_t triangles_, vertices_;
    std::vector<std::uint8_t> is_used_;
    std::vector<RangeOfTriangles> ranges_;
    EnteredVertices entered_;
    std::vector<std::size_t> first_;
    EnteredSurface result_;
};

}  // namespace

bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c) {
    for (const auto& [i, j] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
        if (exact::orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) != 0) return false;
    }
    return true;
}

std::vector<EnteredSurface> enter_surfaces(PlanArrangement& geometry,
                                           std::span<const TriangleView> surfaces, int first_index,
                                           const PlanSnapping& snapping,
                                           std::vector<Warning>& warnings,
                                           const Execution& execution) {
    std::vector<SurfaceEntry> entries;
    for (std::size_t k = 0; k < surfaces.size(); ++k)
        entries.emplace_back(surfaces[k], first_index + static_cast<int>(k), snapping);
    std::vector<EnteredSurface> result;
    // Only one thread can enter vertices, one surface after another. Meanwhile the others look at
    // the next surfaces and link the one before. Older surfaces come first, so that what is wrong
    // with the oldest is heard of.
    struct Part {
        SurfaceEntry* entry;
        std::size_t step, first_chunk;
    };
    constexpr std::size_t kSteps = SurfaceEntry::kSteps;
    for (std::size_t round = 0; round + 1 < entries.size() + kSteps && !entries.empty(); ++round) {
        std::vector<Part> parts;
        std::size_t chunks = 0;
        for (std::size_t step = kSteps; step-- > 0;) {
            if (round < step || round - step >= entries.size()) continue;
            SurfaceEntry& entry = entries[round - step];
            entry.begin(step);
            parts.push_back({&entry, step, chunks});
            chunks += entry.chunks(step);
        }
        parallel_chunks(chunks, execution, [&](std::size_t chunk) {
            const auto after =
                std::upper_bound(parts.begin(), parts.end(), chunk,
                                 [](std::size_t c, const Part& p) { return c < p.first_chunk; });
            const Part& part = *std::prev(after);
            part.entry->run(part.step, chunk - part.first_chunk, geometry, execution.progress);
        });
        if (round + 1 >= kSteps) result.push_back(entries[round + 1 - kSteps].finish(warnings));
    }
    return result;
}

}  // namespace realmodel::strata
