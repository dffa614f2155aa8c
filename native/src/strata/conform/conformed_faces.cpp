// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/conformed_faces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "strata/conform/vertex_heights.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kFaces = 1 << 12, kEntries = 1 << 15,
                      kTogether = ConformedFaces::kVerticesTogether;  // at a time

/// What faces have on plan vertices, sorted by plan vertex.
struct FacesAtVertices {
    Array<std::uint32_t> offsets;  ///< of each plan vertex
    /// First the codes of the faces' planes, tentative where they pass tentatively, then which of
    /// the heights there those have, at last vertices; -1 for what takes up none.
    Array<std::int32_t> values;
};

/// The plan vertices that faces pass, entry by entry; their complement where they are passed
/// tentatively.
Array<PlanVertexId> vertices_of_entries(const FaceList& faces, const PlanVertices& plan_vertices,
                                        const CollinearEdges& collinear,
                                        const ConformedFaces& conformed,
                                        const Execution& execution) {
    const auto& corners = faces.polygons.corners;
    Array<PlanVertexId> plan_vertex(conformed.entries.first(corners.size()));
    parallel_ranges(corners.size(), 4 * kFaces, execution, [&](std::size_t begin, std::size_t end) {
        conformed.entries.for_each(begin, end, [&](std::size_t c, std::size_t entry) {
            plan_vertex[entry] = plan_vertices.of_point[index(corners[c].point)];
        });
    });
    parallel_chunks(collinear.passed.size(), execution, [&](std::size_t chunk) {
        const PassedVertices& passed = collinear.passed[chunk];
        auto next = passed.vertices.begin();
        for (const PassedVertices::Edge& edge : passed.edges) {
            PlanVertexId* to = plan_vertex.begin() + conformed.entries.first(edge.corner);
            for (std::uint32_t n = edge.count; n > 0; --n, ++next)
                *++to = edge.is_tentative != 0 ? ~*next : *next;
        }
        assert(next == passed.vertices.end());
    });
    return plan_vertex;
}

std::uint32_t first_entry(const FaceList& faces, const ConformedFaces& conformed,
                          std::size_t face) {
    return conformed.entries.first(faces.polygons.offsets[face]);
}

/// Counts entries on each plan vertex. Which of a plan vertex's entries comes first depends on
/// threads, and few plan vertices have more than a byte can count.
class VertexCounts {
public:
    VertexCounts(std::size_t plan_vertices, std::size_t entries, const Execution& execution)
        : counts_(zeros<std::uint32_t>(plan_vertices + 1, execution)),
          number_(entries),
          more_((entries + kEntries - 1) / kEntries) {}

    void prefetch(std::size_t plan_vertex) const { realmodel::prefetch(&counts_[plan_vertex]); }
    /// Counts an entry; all of kEntries by one thread, in order.
    void count(std::size_t entry, std::size_t plan_vertex) {
        const std::uint32_t before = count_one(counts_[plan_vertex]);
        number_[entry] = static_cast<std::uint8_t>(std::min(before, kMore));
        if (before >= kMore) more_[entry / kEntries].push_back({entry, before});
    }
    /// How many of its plan vertex were counted before an entry.
    std::uint32_t number(std::size_t entry) const {
        if (number_[entry] < kMore) return number_[entry];
        const auto& more = more_[entry / kEntries];
        return std::lower_bound(more.begin(), more.end(), std::pair(entry, 0U))->second;
    }
    Array<std::uint32_t>& counts() { return counts_; }

private:
    static constexpr std::uint32_t kMore = 255;

    Array<std::uint32_t> counts_;
    Array<std::uint8_t> number_;
    std::vector<std::vector<std::pair<std::size_t, std::uint32_t>>> more_;
};

/// Sorts the entries by plan vertex.
/// @param plan_vertex  of each entry; replaced by its index among the sorted ones
FacesAtVertices sort_by_vertex(const FaceList& faces, Array<PlanVertexId>& plan_vertex,
                               std::size_t plan_vertices, const ConformedFaces& conformed,
                               const Execution& execution) {
    VertexCounts counts(plan_vertices, plan_vertex.size(), execution);
    const auto vertex_of = [&](std::size_t entry) {
        const PlanVertexId p = plan_vertex[entry];
        return static_cast<std::size_t>(p < 0 ? ~p : p);
    };
    parallel_ranges(plan_vertex.size(), kEntries, execution,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            counts.prefetch(vertex_of(std::min(i + 32, end - 1)));
                            counts.count(i, vertex_of(i));
                        }
                    });
    running_totals(counts.counts(), UINT32_MAX, execution);
    FacesAtVertices on;
    on.values = Array<std::int32_t>(plan_vertex.size());
    parallel_ranges(faces.size(), kFaces, execution, [&](std::size_t begin, std::size_t end) {
        std::size_t i = first_entry(faces, conformed, begin);
        const std::size_t last = first_entry(faces, conformed, end) - 1;
        for (std::size_t f = begin; f < end; ++f) {
            const PlaneId plane = faces.plane[f];
            for (const std::size_t next = first_entry(faces, conformed, f + 1); i < next; ++i) {
                counts.prefetch(vertex_of(std::min(i + 32, last)));
                prefetch(&on.values[counts.counts()[vertex_of(std::min(i + 16, last))]]);
                const std::uint32_t at = counts.counts()[vertex_of(i)] + counts.number(i);
                on.values[at] = code_of(plane, plan_vertex[i] < 0);
                plan_vertex[i] = static_cast<std::int32_t>(at);
            }
        }
    });
    on.offsets = std::move(counts.counts());
    return on;
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

/// Finds the heights on each plan vertex and replaces planes by ranks.
void find_heights(const PlanArrangement& geometry, const PlanVertices& plan_vertices,
                  FacesAtVertices& on, ConformedFaces& conformed, const Execution& execution) {
    conformed.vertex_offsets = Array<std::int32_t>(plan_vertices.size() + 1);
    conformed.heights.resize((plan_vertices.size() + kTogether - 1) / kTogether);
    parallel_ranges(
        plan_vertices.size(), kTogether, execution, [&](std::size_t begin, std::size_t end) {
            VertexHeights heights_there(geometry);
            std::vector<double> all;
            all.reserve(2 * kTogether);
            for (std::size_t p = begin; p < end; ++p) {
                prefetch_points(geometry, plan_vertices, p);
                heights_there.find(
                    plan_vertices.representative[p],
                    {on.values.begin() + on.offsets[p], on.values.begin() + on.offsets[p + 1]});
                const auto& found = heights_there.heights();
                all.insert(all.end(), found.begin(), found.end());
                conformed.vertex_offsets[p] = static_cast<std::int32_t>(found.size());
            }
            conformed.heights[begin / kTogether].assign(all.begin(),
                                                        all.end());  // without room for more
        });
    running_totals(conformed.vertex_offsets, INT32_MAX, execution);
}

/// What follows asks for faces, not for their corners.
void number_faces(const FaceList& faces, ConformedFaces& conformed, const Execution& execution) {
    conformed.face_offsets = Array<std::uint32_t>(faces.size() + 1);
    parallel_ranges(faces.size() + 1, kFaces, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
            conformed.face_offsets[f] = first_entry(faces, conformed, f);
    });
}

/// From here on the edges on lines name their first entries: what follows asks for nothing else of
/// a corner.
void name_entries(CollinearEdges& collinear, const ConformedFaces& conformed,
                  const Execution& execution) {
    parallel_ranges(
        collinear.edges.size(), kEntries, execution, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e)
                collinear.edges[e].begin = conformed.entries.first(collinear.edges[e].begin);
        });
}

/// The vertices that the left edge of a pair took up, for the right one.
void add_inserted_vertices(const CollinearEdges& collinear, ConformedFaces& conformed,
                           const Execution& execution) {
    std::vector<std::vector<InsertedVertex>> found(collinear.matched.size());
    parallel_chunks(found.size(), execution, [&](std::size_t chunk) {
        for (const MatchedPair& pair : collinear.matched[chunk].passing) {
            const std::uint32_t first = conformed.entries.first(pair.left) + 1;
            for (std::uint32_t e = conformed.entries.first(pair.left + 1); e-- > first;) {
                if (conformed.vertices[e] >= 0)
                    found[chunk].push_back(
                        {conformed.entries.first(pair.right), conformed.vertices[e]});
            }
        }
    });
    for (const auto& some : found)
        conformed.inserted.insert(conformed.inserted.end(), some.begin(), some.end());
    std::stable_sort(
        conformed.inserted.begin(), conformed.inserted.end(),
        [](const InsertedVertex& a, const InsertedVertex& b) { return a.entry < b.entry; });
}

}  // namespace

ConformedFaces conform_faces(const PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& plan_vertices, CollinearEdges& collinear,
                             const Execution& execution) {
    ConformedFaces conformed;
    conformed.entries = CornerOffsets(collinear.passed, faces.polygons.corners.size(), execution);
    conformed.vertices = vertices_of_entries(faces, plan_vertices, collinear, conformed, execution);
    collinear.passed = {};
    name_entries(collinear, conformed, execution);
    FacesAtVertices on =
        sort_by_vertex(faces, conformed.vertices, plan_vertices.size(), conformed, execution);
    find_heights(geometry, plan_vertices, on, conformed, execution);
    parallel_ranges(plan_vertices.size(), kTogether, execution,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t p = begin; p < end; ++p) {
                            for (auto i = on.offsets[p]; i < on.offsets[p + 1]; ++i)
                                on.values[i] += on.values[i] < 0 ? 0 : conformed.vertex_offsets[p];
                        }
                    });
    parallel_ranges(conformed.vertices.size(), kEntries, execution,
                    [&](std::size_t begin, std::size_t end) {
                        const auto vertex = [&](std::size_t i) -> const std::int32_t& {
                            return on.values[static_cast<std::uint32_t>(conformed.vertices[i])];
                        };
                        for (std::size_t i = begin; i < end; ++i) {
                            prefetch(&vertex(std::min(i + 32, end - 1)));
                            conformed.vertices[i] = vertex(i);
                        }
                    });
    on = {};
    number_faces(faces, conformed, execution);
    add_inserted_vertices(collinear, conformed, execution);
    return conformed;
}

void set_vertex_positions(const PlanVertices& plan_vertices, ConformedFaces& conformed,
                          const Execution& execution) {
    conformed.positions.resize(
        static_cast<std::size_t>(conformed.vertex_offsets[plan_vertices.size()]));
    parallel_ranges(
        plan_vertices.size(), kTogether, execution, [&](std::size_t begin, std::size_t end) {
            auto& heights = conformed.heights[begin / kTogether];
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
