// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "strata/conform/conforming.hpp"
#include "strata/conform/vertex_heights.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kFaces = 1 << 12, kEntries = 1 << 15,
                      kPlaces = ConformedFaces::kVerticesTogether;  // at a time

/// What faces have on places, sorted by place.
struct FacesOnPlaces {
    FlatArray<std::uint32_t> offsets;  ///< of each place
    /// First the planes of the faces (complements of those that pass tentatively), then which of
    /// the heights there those have, at last vertices; -1 for what takes up none.
    FlatArray<std::int32_t> values;
};

/// The places that faces pass, entry by entry; their complement where they are passed tentatively.
FlatArray<PlanVertexId> places_of_entries(const FaceList& faces, const PlanVertices& places,
                                          const CollinearEdges& tracks, const ConformedFaces& loops,
                                          int threads, const Progress* progress) {
    const auto& corners = faces.polygons.corners;
    FlatArray<PlanVertexId> place(loops.entries.first(corners.size()));
    parallel_ranges(
        corners.size(), 4 * kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            loops.entries.for_each(begin, end, [&](std::size_t c, std::size_t entry) {
                place[entry] = places.of_point[static_cast<std::size_t>(corners[c].point)];
            });
        });
    parallel_chunks(tracks.passed.size(), threads, progress, [&](std::size_t chunk) {
        const PassedVertices& passed = tracks.passed[chunk];
        for (std::size_t i = 0; i < passed.size();) {
            const auto corner = static_cast<std::size_t>(passed[i++]);
            const std::int32_t count = passed[i++];
            PlanVertexId* to = place.begin() + loops.entries.first(corner);
            for (std::int32_t n = std::abs(count); n > 0; --n, ++i)
                *++to = count < 0 ? ~passed[i] : passed[i];
        }
    });
    return place;
}

std::uint32_t first_entry(const FaceList& faces, const ConformedFaces& loops, std::size_t face) {
    return loops.entries.first(static_cast<std::size_t>(faces.polygons.offsets[face]));
}

/// Counts entries on each place. Which of a place's entries comes first is left to chance, and few
/// places have more than a byte can count.
class PlaceCounts {
public:
    PlaceCounts(std::size_t places, std::size_t entries, int threads, const Progress* progress)
        : counts_(zeros<std::uint32_t>(places + 1, threads, progress)),
          number_(entries),
          more_((entries + kEntries - 1) / kEntries) {}

    void prefetch(std::size_t place) const { realmodel::prefetch(&counts_[place]); }
    /// Counts an entry; all of kEntries by one thread, in order.
    void count(std::size_t entry, std::size_t place) {
        const std::uint32_t before = count_one(counts_[place]);
        number_[entry] = static_cast<std::uint8_t>(std::min(before, kMore));
        if (before >= kMore) more_[entry / kEntries].push_back({entry, before});
    }
    /// How many of its place were counted before an entry.
    std::uint32_t number(std::size_t entry) const {
        if (number_[entry] < kMore) return number_[entry];
        const auto& more = more_[entry / kEntries];
        return std::lower_bound(more.begin(), more.end(), std::pair(entry, 0U))->second;
    }
    FlatArray<std::uint32_t>& counts() { return counts_; }

private:
    static constexpr std::uint32_t kMore = 255;

    FlatArray<std::uint32_t> counts_;
    FlatArray<std::uint8_t> number_;
    std::vector<std::vector<std::pair<std::size_t, std::uint32_t>>> more_;
};

/// Sorts the entries by place.
/// @param place  of each entry; turned to where it stands among the others
FacesOnPlaces sort_by_place(const FaceList& faces, FlatArray<PlanVertexId>& place,
                            std::size_t places, const ConformedFaces& loops, int threads,
                            const Progress* progress) {
    PlaceCounts counts(places, place.size(), threads, progress);
    const auto place_of = [&](std::size_t entry) {
        const PlanVertexId p = place[entry];
        return static_cast<std::size_t>(p < 0 ? ~p : p);
    };
    parallel_ranges(place.size(), kEntries, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            counts.prefetch(place_of(std::min(i + 32, end - 1)));
                            counts.count(i, place_of(i));
                        }
                    });
    running_totals(counts.counts(), UINT32_MAX, threads, progress);
    FacesOnPlaces on;
    on.values = FlatArray<std::int32_t>(place.size());
    parallel_ranges(
        faces.size(), kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            std::size_t i = first_entry(faces, loops, begin);
            const std::size_t last = first_entry(faces, loops, end) - 1;
            for (std::size_t f = begin; f < end; ++f) {
                const PlaneId plane = faces.plane[f];
                for (const std::size_t next = first_entry(faces, loops, f + 1); i < next; ++i) {
                    counts.prefetch(place_of(std::min(i + 32, last)));
                    const std::uint32_t at = counts.counts()[place_of(i)] + counts.number(i);
                    on.values[at] = place[i] < 0 ? ~plane : plane;
                    place[i] = static_cast<std::int32_t>(at);
                }
            }
        });
    on.offsets = std::move(counts.counts());
    return on;
}

/// Asks for what is known of the places after one. They come in order of position, what they are
/// made of in the order in which it was made.
[[gnu::always_inline]] inline void prefetch_points(const PlanArrangement& geometry,
                                                   const PlanVertices& places, std::size_t place) {
    const auto point = [&](std::size_t ahead) -> const exact::Point& {
        return geometry.point(places.representative[std::min(place + ahead, places.size() - 1)]);
    };
    prefetch(&point(24));
    for (const LineId line : {point(16).first, point(16).second}) {
        if (line >= 0) prefetch(&geometry.line(line));
    }
    for (const LineId id : {point(8).first, point(8).second}) {
        if (id < 0) continue;
        const exact::Line& line = geometry.line(id);
        if (line.kind != exact::Line::Kind::kEdge) continue;
        prefetch(&geometry.point(line.first));
        prefetch(&geometry.point(line.second));
    }
}

/// Finds the heights on each place and turns planes into ranks.
void find_heights(const PlanArrangement& geometry, const PlanVertices& places, FacesOnPlaces& on,
                  ConformedFaces& loops, int threads, const Progress* progress) {
    loops.place_offsets = FlatArray<std::int32_t>(places.size() + 1);
    loops.heights.resize((places.size() + kPlaces - 1) / kPlaces);
    parallel_ranges(
        places.size(), kPlaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            PlaceHeights of_place(geometry);
            std::vector<double> all;
            all.reserve(2 * kPlaces);
            for (std::size_t p = begin; p < end; ++p) {
                prefetch_points(geometry, places, p);
                of_place.find(places.representative[p], {on.values.begin() + on.offsets[p],
                                                         on.values.begin() + on.offsets[p + 1]});
                const auto& found = of_place.heights();
                all.insert(all.end(), found.begin(), found.end());
                loops.place_offsets[p] = static_cast<std::int32_t>(found.size());
            }
            loops.heights[begin / kPlaces].assign(all.begin(), all.end());  // without room for more
        });
    running_totals(loops.place_offsets, INT32_MAX, threads, progress);
}

/// What follows asks for faces, not for their corners.
void number_faces(const FaceList& faces, ConformedFaces& loops, int threads,
                  const Progress* progress) {
    loops.face_offsets = FlatArray<std::uint32_t>(faces.size() + 1);
    parallel_ranges(faces.size() + 1, kFaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t f = begin; f < end; ++f)
                            loops.face_offsets[f] = first_entry(faces, loops, f);
                    });
}

/// From here on the edges on tracks name their first entries: what follows asks for nothing else of
/// a corner.
void name_entries(CollinearEdges& tracks, const ConformedFaces& loops, int threads,
                  const Progress* progress) {
    parallel_ranges(tracks.edges.size(), kEntries, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t e = begin; e < end; ++e)
                            tracks.edges[e].begin = loops.entries.first(tracks.edges[e].begin);
                    });
}

/// The vertices that the left edge of a pair took up, for the right one.
void add_late_vertices(const CollinearEdges& tracks, ConformedFaces& loops, int threads,
                       const Progress* progress) {
    std::vector<std::vector<InsertedVertex>> found(tracks.paired.size());
    parallel_chunks(found.size(), threads, progress, [&](std::size_t chunk) {
        for (const EdgePair& pair : tracks.paired[chunk].passing) {
            const std::uint32_t first = loops.entries.first(pair.left) + 1;
            for (std::uint32_t e = loops.entries.first(pair.left + 1); e-- > first;) {
                if (loops.vertices[e] >= 0)
                    found[chunk].push_back({loops.entries.first(pair.right), loops.vertices[e]});
            }
        }
    });
    for (const auto& some : found)
        loops.late.insert(loops.late.end(), some.begin(), some.end());
    std::stable_sort(
        loops.late.begin(), loops.late.end(),
        [](const InsertedVertex& a, const InsertedVertex& b) { return a.entry < b.entry; });
}

}  // namespace

ConformedFaces conform_faces(const PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& places, CollinearEdges& tracks, int threads,
                             const Progress* progress) {
    ConformedFaces loops;
    loops.entries = CornerOffsets(tracks.passed, faces.polygons.corners.size(), threads, progress);
    loops.vertices = places_of_entries(faces, places, tracks, loops, threads, progress);
    tracks.passed = {};
    name_entries(tracks, loops, threads, progress);
    FacesOnPlaces on =
        sort_by_place(faces, loops.vertices, places.size(), loops, threads, progress);
    find_heights(geometry, places, on, loops, threads, progress);
    parallel_ranges(places.size(), kPlaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t p = begin; p < end; ++p) {
                            for (auto i = on.offsets[p]; i < on.offsets[p + 1]; ++i)
                                on.values[i] += on.values[i] < 0 ? 0 : loops.place_offsets[p];
                        }
                    });
    parallel_ranges(loops.vertices.size(), kEntries, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        const auto vertex = [&](std::size_t i) -> const std::int32_t& {
                            return on.values[static_cast<std::uint32_t>(loops.vertices[i])];
                        };
                        for (std::size_t i = begin; i < end; ++i) {
                            prefetch(&vertex(std::min(i + 32, end - 1)));
                            loops.vertices[i] = vertex(i);
                        }
                    });
    on = {};
    number_faces(faces, loops, threads, progress);
    add_late_vertices(tracks, loops, threads, progress);
    return loops;
}

void set_vertex_positions(const PlanVertices& places, ConformedFaces& loops, int threads,
                          const Progress* progress) {
    loops.positions.resize(static_cast<std::size_t>(loops.place_offsets[places.size()]));
    parallel_ranges(
        places.size(), kPlaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            auto& heights = loops.heights[begin / kPlaces];
            auto z = heights.begin();
            for (std::size_t p = begin; p < end; ++p) {
                const auto [x, y] = places.position[p];
                for (auto v = loops.place_offsets[p]; v < loops.place_offsets[p + 1]; ++v)
                    loops.positions[static_cast<std::size_t>(v)] = {x, y, *z++};
            }
            heights = {};
        });
    loops.heights = {};
}

}  // namespace realmodel::strata
