// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/conformed_faces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/parallel_counts.hpp"
#include "strata/conform/vertex_heights.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kFaces = 1 << 10, kEntries = 1 << 15,
                      kTogether = ConformedFaces::kVerticesTogether;  // at a time

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
        for (const PassedVertices::Edge& edge : passed.edges) {
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
        conformed_.heights.resize((plan_vertices_.size() + kTogether - 1) / kTogether);
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
    /// How many ranges of plan vertices at most, and how much of kTogether is in one at least.
    static constexpr std::size_t kMostRanges = 8, kLeast = 32, kMostChunks = 64;
    /// What vertices are counted down from, and what an entry has that takes up none.
    static constexpr std::int32_t kEnd = INT32_MAX, kNoVertex = ~kEnd;

    /// The plan vertices of the entries of kFaces faces.
    struct Run {
        std::size_t lowest = SIZE_MAX, highest = 0;
    };
    /// An entry on a plan vertex.
    struct Entry {
        std::uint32_t number;
        std::uint32_t plan_vertex;  ///< of kTogether; then where its plane is among theirs
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

    /// The entries on `count` times kTogether plan vertices, by kTogether of these.
    Buckets<Entry> entries_on(std::size_t count) const {
        const std::size_t first = first_ * kTogether, size = count * kTogether;
        const std::size_t chunks = std::min(runs_.size(), kMostChunks);
        const auto produce = [&](std::size_t chunk, const auto& put) {
            for (std::size_t r = runs_.size() * chunk / chunks;
                 r < runs_.size() * (chunk + 1) / chunks; ++r) {
                if (runs_[r].lowest < first + size && runs_[r].highest >= first)
                    put_entries(r, first, size, put);
            }
        };
        return bucketize_in_order<Entry>(count, chunks, produce, execution_, share_);
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
                put(p / kTogether, Entry{e, static_cast<std::uint32_t>(p % kTogether),
                                         code_of(planes[f], values[e] < 0)});
            }
        }
    }

    /// Finds the heights on kTogether plan vertices, and which of them entries have.
    void find_heights(std::size_t number, std::span<Entry> entries) {
        const std::size_t first = number * kTogether,
                          count = std::min(kTogether, plan_vertices_.size() - first);
        std::vector<std::uint32_t> ends(count + 1);  // the beginnings, until they are filled
        for (const Entry& entry : entries)
            ++ends[entry.plan_vertex + 1];
        for (std::size_t p = 1; p <= count; ++p)
            ends[p] += ends[p - 1];
        std::vector<std::int32_t> planes(entries.size());
        for (Entry& entry : entries) {
            const std::uint32_t at = ends[entry.plan_vertex]++;
            planes[at] = entry.value;
            entry.plan_vertex = at;
        }
        VertexHeights heights_there(geometry_);
        std::vector<double> all;
        all.reserve(2 * kTogether);
        std::size_t begin = 0;
        for (std::size_t p = 0; p < count; begin = ends[p++]) {
            prefetch_points(geometry_, plan_vertices_, first + p);
            const std::span<std::int32_t> there(&planes[begin], ends[p] - begin);
            heights_there.find(plan_vertices_.representative[first + p], there);
            const auto before = static_cast<std::int32_t>(all.size());
            conformed_.vertex_offsets[first + p] = before;
            for (std::int32_t& rank : there)
                rank += rank < 0 ? 0 : before;
            const auto& found = heights_there.heights();
            all.insert(all.end(), found.begin(), found.end());
        }
        for (Entry& entry : entries)
            entry.value = planes[entry.plan_vertex];
        conformed_.heights[number].assign(all.begin(), all.end());  // without room for more
    }

    /// Numbers the vertices of `count` times kTogether plan vertices.
    void number_vertices(std::size_t count) {
        Buckets<Entry> on = entries_on(count);
        parallel_chunks(
            count, execution_, [&](std::size_t i) { find_heights(first_ + i, on[i]); }, 2 * share_);
        std::vector<std::int32_t> before(count);
        for (std::size_t i = count; i-- > 0;) {
            const std::size_t own = conformed_.heights[first_ + i].size();
            // those that are left are larger than any plan vertex
            check_total(own + plan_vertices_.size(), static_cast<std::uint64_t>(next_));
            before[i] = next_ -= static_cast<std::int32_t>(own);
        }
        parallel_chunks(
            count, execution_,
            [&](std::size_t i) {
                std::int32_t* const vertices = conformed_.vertices.begin();
                const std::int32_t own = before[i];
                for (const Entry& entry : on[i])
                    vertices[entry.number] = entry.value < 0 ? kNoVertex : own + entry.value;
                const std::size_t begin = (first_ + i) * kTogether;
                for (std::size_t p = begin; p < std::min(begin + kTogether, plan_vertices_.size());
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
    std::size_t first_ = 0;     ///< of the range of plan vertices: which kTogether begin it
    std::int32_t next_ = kEnd;  ///< the number given last
    double share_ = 0;          ///< of the progress, of a loop over a range
};

/// What follows asks for faces, not for their corners.
void number_faces(const FaceList& faces, ConformedFaces& conformed, const Execution& execution) {
    conformed.face_offsets = Array<std::uint32_t>(faces.size() + 1);
    parallel_each(faces.size() + 1, execution, [&](std::size_t f) {
        conformed.face_offsets[f] = conformed.entries.first(faces.polygons.offsets[f]);
    });
}

/// From here on the edges on lines name their first entries: what follows asks for nothing else of
/// a corner.
void name_entries(CollinearEdges& collinear, const ConformedFaces& conformed,
                  const Execution& execution) {
    parallel_each(collinear.edges.size(), execution, [&](std::size_t e) {
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
