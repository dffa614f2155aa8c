// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/conformed_faces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kLinearSearch = 24;  // up to here looking through all is quickest

}  // namespace

CornerOffsets::CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners,
                             const Execution& execution)
    : corners_(corners) {
    const std::size_t blocks = corners / kBlock + 1;  // the number of corners itself has one, too
    const auto produce = [&](std::size_t chunk, const auto& put) {
        for (const PassedVertices::PassingEdge& edge : passed[chunk].edges)
            put(edge.corner / kBlock, Passing{edge.corner, edge.count});
    };
    passing_ = sorted_in_buckets<Passing>(blocks, passed.size(), produce, execution);
    entry_of_block_ = Array<std::uint32_t>(blocks + 1);
    parallel_for_each(blocks, execution, [&](std::size_t block) {
        std::size_t entries = std::min(kBlock, corners - block * kBlock);
        for (const Passing& passing : passing_[block])
            entries += passing.vertices;
        entry_of_block_[block] = static_cast<std::uint32_t>(entries);
    });
    running_totals(entry_of_block_, UINT32_MAX, execution);
}

void VertexHeights::find(PointId point, std::span<std::int32_t> planes) {
    if (find_single(point, planes)) return;
    find_distinct(point, planes);
    rank_levels(point);
    if (!tentative_.empty()) settle_tentative(point);
    separate();
    for (std::int32_t& code : planes) {
        const PlaneId plane = plane_of(code);
        if (!is_tentative(code)) {
            code = rank_of(plane);
            continue;
        }
        const auto at = std::find_if(tentative_.begin(), tentative_.end(),
                                     [&](const LeveledPlane& p) { return p.plane == plane; });
        code = at->level < 0 ? -1 : levels_[static_cast<std::size_t>(at->level)].rank;
    }
}

/// Where what the plan vertex is made of tells that all planes are equally high, as on most plan
/// vertices, there is nothing to put in order.
/// @return whether that is so, and all is done
bool VertexHeights::find_single(PointId point, std::span<std::int32_t> planes) {
    if (planes.empty() || is_tentative(planes[0])) return false;
    const PlaneId first = plane_of(planes[0]);
    HeightLevel level{scope_.height_name(first, point), first, 0.0, 0};
    std::array known{planes[0], planes[0]};
    for (const std::int32_t code : planes.subspan(1)) {
        if (code == known[0] || code == known[1]) continue;
        if (is_tentative(code)) return false;
        const PlaneId plane = plane_of(code);
        if (scope_.height_name(plane, point) != level.name) return false;
        known = {code, known[0]};
        level.plane = std::min(level.plane, plane);
    }
    heights_.assign(
        1, scope_.rounded_height(level.plane, level.name, point, scope_.approximate(point)));
    std::fill(planes.begin(), planes.end(), 0);
    return true;
}

std::int32_t VertexHeights::rank_of(PlaneId plane) const {
    const auto at =
        planes_.size() <= kLinearSearch
            ? std::find_if(planes_.begin(), planes_.end(),
                           [&](const LeveledPlane& p) { return p.plane == plane; })
            : std::lower_bound(planes_.begin(), planes_.end(), plane,
                               [](const LeveledPlane& p, PlaneId q) { return p.plane < q; });
    return levels_[static_cast<std::size_t>(at->level)].rank;
}

void VertexHeights::find_distinct(PointId point, std::span<const std::int32_t> planes) {
    planes_.clear();
    tentative_.clear();
    levels_.clear();
    for (const std::int32_t code : planes) {
        std::vector<LeveledPlane>& kind = is_tentative(code) ? tentative_ : planes_;
        const PlaneId plane = plane_of(code);
        const std::size_t near =
            is_tentative(code) ? kind.size() : std::min(kind.size(), kLinearSearch);
        bool known = false;
        for (std::size_t i = 0; i < near && !known; ++i)
            known = kind[i].plane == plane;
        if (!known) kind.push_back({plane, -1});
    }
    // The order in which planes come is left to chance where threads share the work.
    const auto in_order = [](const LeveledPlane& a, const LeveledPlane& b) {
        return a.plane < b.plane;
    };
    std::sort(planes_.begin(), planes_.end(), in_order);
    std::sort(tentative_.begin(), tentative_.end(), in_order);
    if (planes_.size() > kLinearSearch) {
        const auto same = [](const LeveledPlane& a, const LeveledPlane& b) {
            return a.plane == b.plane;
        };
        planes_.erase(std::unique(planes_.begin(), planes_.end(), same), planes_.end());
    }
    for (LeveledPlane& plane : planes_)
        plane.level = level_of(point, plane.plane);
}

/// Whether a plane is as high as one of some levels, or so near that this would have to be asked
/// exactly. There is room between what takes up a vertex here and what passes by.
bool VertexHeights::is_near(PointId id, PlaneId plane, std::span<const HeightLevel> levels) const {
    const exact::PlanArrangement& geometry = scope_.shared();
    const exact::SpaceVertex& corner = geometry.space(geometry.plane(plane).corner[0]);
    const exact::Point &from = geometry.point(corner.plan), &to = geometry.point(id);
    const exact::PlaneFilter& gradient = geometry.plane_filter(plane);
    const double dx = to.x - from.x, dy = to.y - from.y;
    const double rise_x = gradient.gx * dx, rise_y = gradient.gy * dy;
    const double z = corner.z + rise_x + rise_y;
    const double size = std::abs(corner.z) + std::abs(rise_x) + std::abs(rise_y);
    const double error = gradient.error_x * std::abs(dx) + gradient.error_y * std::abs(dy) +
                         (std::abs(gradient.gx) + std::abs(gradient.gy)) * to.error() +
                         exact::kPlaneHeight * size + exact::kTermUnderflow;
    return std::any_of(levels.begin(), levels.end(), [&](const HeightLevel& level) {
        const double margin =
            exact::kFarTimes * error + geometry.clear_height(size + std::abs(level.z));
        return !(std::abs(z - level.z) > margin);
    });
}

/// Gives tentative planes the level that they take up, if there is one. A plane that counts after
/// all may be near to the next, so they are asked until none is.
void VertexHeights::settle_tentative(PointId point) {
    for (bool again = true; again;) {
        again = false;
        const std::size_t known = levels_.size();
        for (LeveledPlane& plane : tentative_) {
            if (plane.level >= 0 || !is_near(point, plane.plane, {levels_.data(), known})) continue;
            plane.level = level_of(point, plane.plane);
            again = true;
        }
        if (levels_.size() > known) rank_levels(point);
    }
}

std::int32_t VertexHeights::level_of(PointId point, PlaneId plane) {
    const auto name = scope_.height_name(plane, point);
    for (std::size_t i = 0; i < std::min(levels_.size(), kLinearSearch); ++i) {
        if (levels_[i].name == name) return static_cast<std::int32_t>(i);
    }
    levels_.push_back({name, plane, 0.0, 0});
    return static_cast<std::int32_t>(levels_.size()) - 1;
}

void VertexHeights::rank_levels(PointId point) {
    const exact::NearPoint near = scope_.approximate(point);
    for (HeightLevel& level : levels_)
        level.z = scope_.rounded_height(level.plane, level.name, point, near);
    const auto level = [&](std::int32_t i) -> HeightLevel& {
        return levels_[static_cast<std::size_t>(i)];
    };
    const auto lower = [&](std::int32_t i, std::int32_t j) {
        const HeightLevel &a = level(i), &b = level(j);
        if (a.z != b.z) return a.z < b.z;
        return i != j && scope_.compare_heights(b.plane, a.plane, point) > 0;
    };
    order_.resize(levels_.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), lower);  // equally high ones have one rank in any order
    heights_.clear();
    for (std::size_t i = 0; i < order_.size(); ++i) {
        if (i == 0 || lower(order_[i - 1], order_[i])) heights_.push_back(level(order_[i]).z);
        level(order_[i]).rank = static_cast<std::int32_t>(heights_.size()) - 1;
    }
}

/// Whether a height is known to be a double: that of an input vertex, of a level edge or plane.
bool VertexHeights::is_double(std::size_t rank) const {
    const auto& geometry = scope_.shared();
    const auto z = [&](exact::SpaceId s) { return geometry.space(s).z; };
    return std::any_of(levels_.begin(), levels_.end(), [&](const HeightLevel& level) {
        if (level.rank != static_cast<std::int32_t>(rank)) return false;
        if (level.name.is_edge()) return z(level.name.from()) == z(level.name.to());
        const auto& corner = geometry.plane(level.plane).corner;
        return z(corner[0]) == z(corner[1]) && z(corner[1]) == z(corner[2]);
    });
}

void VertexHeights::separate() {
    for (std::size_t i = 1; i < heights_.size(); ++i) {
        if (heights_[i] > heights_[i - 1]) continue;
        std::size_t low = i;  // from here to i all are different
        if (is_double(i)) {
            for (; low > 0 && heights_[low - 1] >= heights_[low] && !is_double(low - 1); --low)
                heights_[low - 1] = std::nextafter(heights_[low], -HUGE_VAL);
        }
        // up with all that is left no room below
        for (; low > 0 && low <= i && heights_[low] <= heights_[low - 1]; ++low)
            heights_[low] = std::nextafter(heights_[low - 1], HUGE_VAL);
    }
}

namespace {

constexpr std::size_t kFaces = 1 << 10, kEntries = 1 << 15,
                      kGrain = ConformedFaces::kVertexGrain;  // at a time

/// The plan vertices that faces pass, entry by entry; their complement where they are passed
/// tentatively.
Array<PlanVertexId> vertices_of_entries(const FaceList& faces, const PlanVertices& plan_vertices,
                                        const CollinearEdges& collinear,
                                        const ConformedFaces& conformed,
                                        const Execution& execution) {
    const auto& points = faces.polygons.points;
    Array<PlanVertexId> plan_vertex(conformed.entries.first(points.size()));
    parallel_ranges(points.size(), kEntries, execution, [&](std::size_t begin, std::size_t end) {
        conformed.entries.for_each(begin, end, [&](std::size_t c, std::size_t entry) {
            plan_vertex[entry] = plan_vertices.of_point[index(points[c])];
        });
    });
    parallel_chunks(collinear.passed.size(), execution, [&](std::size_t chunk) {
        const PassedVertices& passed = collinear.passed[chunk];
        auto next = passed.vertices.begin();
        for (const PassedVertices::PassingEdge& edge : passed.edges) {
            PlanVertexId* to = plan_vertex.begin() + conformed.entries.first(edge.corner);
            for (std::uint32_t n = edge.count; n > 0; --n, ++next)
                *++to = edge.is_tentative != 0 ? ~*next : *next;
        }
        assert(next == passed.vertices.end());
    });
    return plan_vertex;
}

/// Asks for what is known of the plan vertices after one. They come in order of position, what they
/// are made of in the order in which it was made.
[[gnu::always_inline]] inline void prefetch_points(const PlanArrangement& geometry,
                                                   const PlanVertices& plan_vertices,
                                                   std::size_t plan_vertex) {
    const auto point = [&](std::size_t ahead) -> const exact::Point& {
        return geometry.point(
            plan_vertices.representative[std::min(plan_vertex + ahead, plan_vertices.size() - 1)]);
    };
    prefetch(&point(24));
    for (const LineId line : {point(16).first, point(16).second}) {
        if (line != kNone) prefetch(&geometry.line(line));
    }
    for (const LineId id : {point(8).first, point(8).second}) {
        if (id == kNone || !geometry.line(id).is_edge()) continue;
        for (const exact::VertexId end : geometry.line(id).ends())
            prefetch(&geometry.point(end));
    }
}

/// Finds the heights on each plan vertex and gives entries their vertices. For that the planes of
/// faces are sorted by plan vertex, those of some plan vertices at a time: all of them would take
/// as much memory as the faces' corners. The last plan vertices come first, and numbers of vertices
/// fall from the largest: so no entry's vertex is taken for one of the plan vertices to come.
class VertexNumbering {
public:
    /// @param conformed  whose `vertices` are the plan vertices of entries; replaced
    VertexNumbering(const PlanArrangement& geometry, const FaceList& faces,
                    const PlanVertices& plan_vertices, ConformedFaces& conformed,
                    const Execution& execution)
        : geometry_(geometry),
          faces_(faces),
          plan_vertices_(plan_vertices),
          conformed_(conformed),
          execution_(execution),
          runs_((faces.size() + kFaces - 1) / kFaces) {}

    void run() {
        find_runs();
        conformed_.vertex_offsets = Array<std::int32_t>(plan_vertices_.size() + 1);
        conformed_.heights.resize((plan_vertices_.size() + kGrain - 1) / kGrain);
        const std::size_t heights = conformed_.heights.size();
        const std::size_t ranges = std::clamp<std::size_t>(heights / kLeast, 1, kMostRanges);
        for (std::size_t r = ranges; r-- > 0;) {
            share_ = 0.2 / static_cast<double>(r + 1);
            first_ = heights * r / ranges;
            number_vertices(heights * (r + 1) / ranges - first_);
        }
        conformed_.vertex_offsets[plan_vertices_.size()] = kEnd;
        count_from_zero();
    }

private:
    /// How many ranges of plan vertices at most, and how much of kGrain is in one at least.
    static constexpr std::size_t kMostRanges = 8, kLeast = 32, kMostChunks = 64;
    /// What vertices are counted down from, and what an entry has that takes up none.
    static constexpr std::int32_t kEnd = INT32_MAX, kNoVertex = ~kEnd;

    /// The plan vertices of the entries of kFaces faces.
    struct Run {
        std::size_t lowest = SIZE_MAX, highest = 0;
    };
    /// An entry on a plan vertex.
    struct VertexEntry {
        std::uint32_t number;
        std::uint32_t plan_vertex;  ///< of kGrain; then where its plane is among theirs
        std::int32_t value;         ///< code of its plane; then its vertex of theirs, or -1
    };

    std::uint32_t first_entry(std::size_t face) const {
        return conformed_.entries.first(faces_.polygons.offsets[face]);
    }
    static std::size_t plan_vertex(std::int32_t value) {
        return static_cast<std::size_t>(value < 0 ? ~value : value);
    }

    void find_runs() {
        parallel_ranges(faces_.size(), kFaces, execution_, [&](std::size_t begin, std::size_t end) {
            Run run;
            const std::int32_t* const values = conformed_.vertices.begin();
            std::for_each(values + first_entry(begin), values + first_entry(end),
                          [&](std::int32_t value) {
                              run.lowest = std::min(run.lowest, plan_vertex(value));
                              run.highest = std::max(run.highest, plan_vertex(value));
                          });
            runs_[begin / kFaces] = run;
        });
    }

    /// The entries on `count` times kGrain plan vertices, by kGrain of these.
    Buckets<VertexEntry> entries_on(std::size_t count) const {
        const std::size_t first = first_ * kGrain, size = count * kGrain;
        const std::size_t chunks = std::min(runs_.size(), kMostChunks);
        const auto produce = [&](std::size_t chunk, const auto& put) {
            for (std::size_t r = runs_.size() * chunk / chunks;
                 r < runs_.size() * (chunk + 1) / chunks; ++r) {
                if (runs_[r].lowest < first + size && runs_[r].highest >= first)
                    put_entries(r, first, size, put);
            }
        };
        return bucketize_in_order<VertexEntry>(count, chunks, produce, execution_, share_);
    }
    template <class Put>
    void put_entries(std::size_t run, std::size_t first, std::size_t size, const Put& put) const {
        const std::int32_t* const values = conformed_.vertices.begin();
        const PlaneId* const planes = faces_.plane.begin();
        const std::size_t last = std::min((run + 1) * kFaces, faces_.size());
        std::uint32_t e = first_entry(run * kFaces);
        for (std::size_t f = run * kFaces; f < last; ++f) {
            for (const std::uint32_t end = first_entry(f + 1); e < end; ++e) {
                const std::size_t p = plan_vertex(values[e]) - first;  // huge, where before
                if (p >= size) continue;
                put(p / kGrain, VertexEntry{e, static_cast<std::uint32_t>(p % kGrain),
                                            code_of(planes[f], values[e] < 0)});
            }
        }
    }

    /// Finds the heights on kGrain plan vertices, and which of them entries have.
    void find_heights(std::size_t number, std::span<VertexEntry> entries) {
        const std::size_t first = number * kGrain,
                          count = std::min(kGrain, plan_vertices_.size() - first);
        std::vector<std::uint32_t> ends(count + 1);  // the beginnings, until they are filled
        for (const VertexEntry& entry : entries)
            ++ends[entry.plan_vertex + 1];
        for (std::size_t p = 1; p <= count; ++p)
            ends[p] += ends[p - 1];
        std::vector<std::int32_t> planes(entries.size());
        for (VertexEntry& entry : entries) {
            const std::uint32_t at = ends[entry.plan_vertex]++;
            planes[at] = entry.value;
            entry.plan_vertex = at;
        }
        VertexHeights finder(geometry_);
        std::vector<double> all;
        all.reserve(2 * kGrain);
        std::size_t begin = 0;
        for (std::size_t p = 0; p < count; begin = ends[p++]) {
            prefetch_points(geometry_, plan_vertices_, first + p);
            const std::span<std::int32_t> on_vertex(&planes[begin], ends[p] - begin);
            finder.find(plan_vertices_.representative[first + p], on_vertex);
            const auto before = static_cast<std::int32_t>(all.size());
            conformed_.vertex_offsets[first + p] = before;
            for (std::int32_t& rank : on_vertex)
                rank += rank < 0 ? 0 : before;
            const auto& heights = finder.heights();
            all.insert(all.end(), heights.begin(), heights.end());
        }
        for (VertexEntry& entry : entries)
            entry.value = planes[entry.plan_vertex];
        conformed_.heights[number].assign(all.begin(), all.end());  // without room for more
    }

    /// Numbers the vertices of `count` times kGrain plan vertices.
    void number_vertices(std::size_t count) {
        Buckets<VertexEntry> on = entries_on(count);
        parallel_chunks(
            count, execution_, [&](std::size_t i) { find_heights(first_ + i, on[i]); }, 2 * share_);
        std::vector<std::int32_t> before(count);
        for (std::size_t i = count; i-- > 0;) {
            const std::size_t vertex_count = conformed_.heights[first_ + i].size();
            // those that are left are larger than any plan vertex
            check_total(vertex_count + plan_vertices_.size(), static_cast<std::uint64_t>(next_));
            before[i] = next_ -= static_cast<std::int32_t>(vertex_count);
        }
        parallel_chunks(
            count, execution_,
            [&](std::size_t i) {
                std::int32_t* const vertices = conformed_.vertices.begin();
                const std::int32_t first = before[i];
                for (const VertexEntry& entry : on[i])
                    vertices[entry.number] = entry.value < 0 ? kNoVertex : first + entry.value;
                const std::size_t begin = (first_ + i) * kGrain;
                for (std::size_t p = begin; p < std::min(begin + kGrain, plan_vertices_.size());
                     ++p)
                    conformed_.vertex_offsets[p] += before[i];
            },
            share_);
    }

    void count_from_zero() {
        for (Array<std::int32_t>* numbers : {&conformed_.vertices, &conformed_.vertex_offsets}) {
            parallel_ranges(
                numbers->size(), kEntries, execution_, [&](std::size_t begin, std::size_t end) {
                    std::transform(numbers->begin() + begin, numbers->begin() + end,
                                   numbers->begin() + begin, [lowest = next_](std::int32_t number) {
                                       return number < 0 ? -1 : number - lowest;
                                   });
                });
        }
    }

    const PlanArrangement& geometry_;
    const FaceList& faces_;
    const PlanVertices& plan_vertices_;
    ConformedFaces& conformed_;
    Execution execution_;
    std::vector<Run> runs_;
    std::size_t first_ = 0;     ///< of the range of plan vertices: which kGrain begin it
    std::int32_t next_ = kEnd;  ///< the number given last
    double share_ = 0;          ///< of the progress, of a loop over a range
};

/// What follows asks for faces, not for their corners.
void number_faces(const FaceList& faces, ConformedFaces& conformed, const Execution& execution) {
    conformed.face_offsets = Array<std::uint32_t>(faces.size() + 1);
    parallel_for_each(faces.size() + 1, execution, [&](std::size_t f) {
        conformed.face_offsets[f] = conformed.entries.first(faces.polygons.offsets[f]);
    });
}

/// From here on the edges on lines name their first entries: what follows asks for nothing else of
/// a corner.
void name_entries(CollinearEdges& collinear, const ConformedFaces& conformed,
                  const Execution& execution) {
    parallel_for_each(collinear.edges.size(), execution, [&](std::size_t e) {
        collinear.edges[e].begin = conformed.entries.first(collinear.edges[e].begin);
    });
}

/// The vertices that the left edge of a pair took up, for the right one.
void add_inserted_vertices(const CollinearEdges& collinear, ConformedFaces& conformed,
                           const Execution& execution) {
    const auto find = [&](std::size_t chunk, std::size_t, auto& added) {
        for (const MatchedPair& pair : collinear.matched[chunk].passing) {
            const std::uint32_t first = conformed.entries.first(pair.left) + 1;
            for (std::uint32_t e = conformed.entries.first(pair.left + 1); e-- > first;) {
                if (conformed.vertices[e] >= 0)
                    added.push_back({conformed.entries.first(pair.right), conformed.vertices[e]});
            }
        }
    };
    conformed.inserted =
        collect_ranges<InsertedVertex>(collinear.matched.size(), 1, execution, find);
    std::ranges::stable_sort(conformed.inserted, {}, &InsertedVertex::entry);
}

}  // namespace

ConformedFaces conform_faces(const PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& plan_vertices, CollinearEdges& collinear,
                             const Execution& execution, Array<PointId>* points) {
    ConformedFaces conformed;
    conformed.entries = CornerOffsets(collinear.passed, faces.polygons.points.size(), execution);
    conformed.vertices = vertices_of_entries(faces, plan_vertices, collinear, conformed, execution);
    collinear.passed = {};
    if (points != nullptr) *points = {};
    name_entries(collinear, conformed, execution);
    VertexNumbering(geometry, faces, plan_vertices, conformed, execution).run();
    number_faces(faces, conformed, execution);
    add_inserted_vertices(collinear, conformed, execution);
    return conformed;
}

Array<PointId> points_of_corners(const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                                 const Execution& execution) {
    Array<PointId> of_vertex(index(conformed.vertex_offsets.back()));
    for (std::size_t p = 0; p < plan_vertices.size(); ++p) {
        std::fill(of_vertex.begin() + conformed.vertex_offsets[p],
                  of_vertex.begin() + conformed.vertex_offsets[p + 1],
                  plan_vertices.representative[p]);
    }
    Array<PointId> points(conformed.entries.corners());
    parallel_ranges(points.size(), kEntries, execution, [&](std::size_t begin, std::size_t end) {
        conformed.entries.for_each(begin, end, [&](std::size_t c, std::size_t entry) {
            points[c] = of_vertex[index(conformed.vertices[entry])];
        });
    });
    return points;
}

void set_vertex_positions(const PlanVertices& plan_vertices, ConformedFaces& conformed,
                          const Execution& execution) {
    conformed.positions.resize(
        static_cast<std::size_t>(conformed.vertex_offsets[plan_vertices.size()]));
    parallel_ranges(
        plan_vertices.size(), kGrain, execution, [&](std::size_t begin, std::size_t end) {
            auto& heights = conformed.heights[begin / kGrain];
            auto z = heights.begin();
            for (std::size_t p = begin; p < end; ++p) {
                const auto [x, y] = plan_vertices.position[p];
                for (auto v = conformed.vertex_offsets[p]; v < conformed.vertex_offsets[p + 1]; ++v)
                    conformed.positions[static_cast<std::size_t>(v)] = {x, y, *z++};
            }
            heights = {};
        });
    conformed.heights = {};
}

}  // namespace realmodel::strata
