// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/conformed_faces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/parallel_counts.hpp"
#include "strata/conform/vertex_heights.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kFaces = 1 << 12, kEntries = 1 << 15,
                      kTogether = ConformedFaces::kVerticesTogether;  // at a time

/// The plan vertices that faces pass, entry by entry; their complement where they are passed
/// tentatively.
Array<PlanVertexId> vertices_of_entries(const FaceList& faces, const PlanVertices& plan_vertices,
                                        const CollinearEdges& collinear,
                                        const ConformedFaces& conformed,
                                        const Execution& execution) {
    const auto& points = faces.polygons.points;
    Array<PlanVertexId> plan_vertex(conformed.entries.first(points.size()));
    parallel_ranges(points.size(), 4 * kFaces, execution, [&](std::size_t begin, std::size_t end) {
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
/// as much memory as the faces' corners.
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
        count();
        conformed_.vertex_offsets = Array<std::int32_t>(plan_vertices_.size() + 1);
        conformed_.heights.resize((plan_vertices_.size() + kTogether - 1) / kTogether);
        const std::size_t heights = conformed_.heights.size();
        const std::size_t ranges = std::clamp<std::size_t>(heights / kLeast, 1, kMostRanges);
        std::size_t vertices = 0;
        for (std::size_t r = 0; r < ranges; ++r) {
            share_ = 0.2 / static_cast<double>(ranges - r);
            begin_ = heights * r / ranges * kTogether;
            end_ = std::min(heights * (r + 1) / ranges * kTogether, plan_vertices_.size());
            planes_.resize(offsets_[end_] - offsets_[begin_]);
            sort_planes();
            find_heights();
            number_vertices(vertices);
            take_vertices();
        }
        conformed_.vertex_offsets[plan_vertices_.size()] = static_cast<std::int32_t>(vertices);
    }

private:
    /// How many ranges of plan vertices at most, and how much of kTogether is in one at least.
    static constexpr std::size_t kMostRanges = 8, kLeast = 32;
    /// Instead of an entry's number: it has a larger one; it says where its plane is; it has its
    /// vertex.
    static constexpr std::uint8_t kLarge = 253, kSorted = 254, kDone = 255;

    /// The entries of kFaces faces. Their numbers on their plan vertices: which comes first depends
    /// on threads, and few plan vertices have more than a byte can count.
    struct Run {
        std::size_t lowest = SIZE_MAX, highest = 0;  ///< of their plan vertices
        std::vector<std::uint8_t> number;
        std::vector<std::pair<std::size_t, std::uint32_t>> large;

        std::uint32_t number_of(std::size_t i) const {
            if (number[i] < kLarge) return number[i];
            return std::lower_bound(large.begin(), large.end(), std::pair(i, 0U))->second;
        }
    };

    std::size_t first_entry(std::size_t face) const {
        return conformed_.entries.first(faces_.polygons.offsets[face]);
    }
    static std::size_t plan_vertex(std::int32_t value) {
        return static_cast<std::size_t>(value < 0 ? ~value : value);
    }

    /// Counts the entries on each plan vertex.
    void count() {
        offsets_ = zeros<std::uint32_t>(plan_vertices_.size() + 1, execution_);
        parallel_ranges(faces_.size(), kFaces, execution_, [&](std::size_t begin, std::size_t end) {
            Run& run = runs_[begin / kFaces];
            const std::int32_t* const value = conformed_.vertices.begin() + first_entry(begin);
            run.number.resize(first_entry(end) - first_entry(begin));
            for (std::size_t i = 0; i < run.number.size(); ++i) {
                prefetch(&offsets_[plan_vertex(value[std::min(i + 32, run.number.size() - 1)])]);
                const std::size_t at = plan_vertex(value[i]);
                const std::uint32_t before = count_one(offsets_[at]);
                run.number[i] = static_cast<std::uint8_t>(std::min<std::uint32_t>(before, kLarge));
                if (before >= kLarge) run.large.emplace_back(i, before);
                run.lowest = std::min(run.lowest, at);
                run.highest = std::max(run.highest, at);
            }
        });
        running_totals(offsets_, UINT32_MAX, execution_);
    }

    /// Calls visit(run, first entry, begin, end) for runs of faces that have plan vertices of the
    /// range.
    template <class Visit>
    void for_each_run(const Visit& visit) {
        parallel_ranges(
            faces_.size(), kFaces, execution_,
            [&](std::size_t begin, std::size_t end) {
                Run& run = runs_[begin / kFaces];
                if (run.lowest < end_ && run.highest >= begin_) visit(run, begin, end);
            },
            share_);
    }

    /// Sorts the planes by plan vertex; an entry says where its plane is.
    void sort_planes() {
        const std::uint32_t before = offsets_[begin_];
        for_each_run([&](Run& run, std::size_t begin, std::size_t end) {
            const std::size_t first = first_entry(begin), last = run.number.size() - 1;
            std::int32_t* const value = conformed_.vertices.begin() + first;
            const auto offset = [&](std::size_t i) -> const std::uint32_t& {
                return offsets_[std::min(plan_vertex(value[std::min(i, last)]), end_)];
            };
            std::size_t i = 0;
            for (std::size_t f = begin; f < end; ++f) {
                for (const std::size_t next = first_entry(f + 1) - first; i < next; ++i) {
                    prefetch(&offset(i + 32));
                    prefetch(planes_.begin() + (offset(i + 16) - before));
                    const std::size_t p = plan_vertex(value[i]);
                    if (run.number[i] > kLarge || p < begin_ || p >= end_) continue;
                    const std::uint32_t at = offsets_[p] - before + run.number_of(i);
                    planes_[at] = code_of(faces_.plane[f], value[i] < 0);
                    value[i] = static_cast<std::int32_t>(at);
                    run.number[i] = kSorted;
                }
            }
        });
    }

    /// The planes on a plan vertex of the range.
    std::span<std::int32_t> planes_on(std::size_t p) {
        return {planes_.begin() + (offsets_[p] - offsets_[begin_]), offsets_[p + 1] - offsets_[p]};
    }

    /// Finds the heights on the plan vertices and replaces planes by ranks.
    void find_heights() {
        parallel_ranges(
            end_ - begin_, kTogether, execution_,
            [&](std::size_t first, std::size_t last) {
                VertexHeights heights_there(geometry_);
                std::vector<double> all;
                all.reserve(2 * kTogether);
                for (std::size_t p = begin_ + first; p < begin_ + last; ++p) {
                    prefetch_points(geometry_, plan_vertices_, p);
                    heights_there.find(plan_vertices_.representative[p], planes_on(p));
                    const auto& found = heights_there.heights();
                    all.insert(all.end(), found.begin(), found.end());
                    conformed_.vertex_offsets[p] = static_cast<std::int32_t>(found.size());
                }
                conformed_.heights[(begin_ + first) / kTogether].assign(
                    all.begin(), all.end());  // without room for more
            },
            2 * share_);
    }

    /// Replaces ranks by vertices.
    /// @param vertices  how many there are of the plan vertices before, and then of these, too
    void number_vertices(std::size_t& vertices) {
        std::vector<std::size_t> before;
        for (std::size_t p = begin_; p < end_; p += kTogether) {
            before.push_back(vertices);
            vertices += conformed_.heights[p / kTogether].size();
        }
        check_total(vertices, INT32_MAX);
        parallel_ranges(
            end_ - begin_, kTogether, execution_,
            [&](std::size_t first, std::size_t last) {
                auto vertex = static_cast<std::int32_t>(before[first / kTogether]);
                for (std::size_t p = begin_ + first; p < begin_ + last; ++p) {
                    for (std::int32_t& rank : planes_on(p))
                        rank += rank < 0 ? 0 : vertex;
                    vertex += std::exchange(conformed_.vertex_offsets[p], vertex);
                }
            },
            share_);
    }

    /// Gives the entries that say where their planes were the vertices that are there now.
    void take_vertices() {
        for_each_run([&](Run& run, std::size_t begin, std::size_t) {
            std::int32_t* const value = conformed_.vertices.begin() + first_entry(begin);
            for (std::size_t i = 0; i < run.number.size(); ++i) {
                const std::size_t ahead = std::min(i + 32, run.number.size() - 1);
                if (run.number[ahead] == kSorted)
                    prefetch(&planes_[static_cast<std::uint32_t>(value[ahead])]);
                if (run.number[i] != kSorted) continue;
                value[i] = planes_[static_cast<std::uint32_t>(value[i])];
                run.number[i] = kDone;
            }
            if (run.highest < end_) run = {};
        });
    }

    const PlanArrangement& geometry_;
    const FaceList& faces_;
    const PlanVertices& plan_vertices_;
    ConformedFaces& conformed_;
    Execution execution_;
    std::vector<Run> runs_;
    Array<std::uint32_t> offsets_;     ///< of each plan vertex, how many entries come before
    std::size_t begin_ = 0, end_ = 0;  ///< the range of plan vertices
    double share_ = 0;                 ///< of the progress, of a loop over it
    /// Of the range, by plan vertex: first the codes of the faces' planes, tentative where they
    /// pass tentatively, then which of the heights there those have, at last vertices; -1 for what
    /// takes up none.
    Array<std::int32_t> planes_;
};

/// What follows asks for faces, not for their corners.
void number_faces(const FaceList& faces, ConformedFaces& conformed, const Execution& execution) {
    conformed.face_offsets = Array<std::uint32_t>(faces.size() + 1);
    parallel_ranges(faces.size() + 1, kFaces, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
            conformed.face_offsets[f] = conformed.entries.first(faces.polygons.offsets[f]);
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
