// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "conforming.hpp"
#include "parallel_counts.hpp"
#include "place_heights.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

constexpr std::size_t kFaces = 1 << 12, kEntries = 1 << 15, kPlaces = 1 << 11;  // at a time

/// What faces have on places, sorted by place: first their planes, then which of the heights
/// there those planes have.
struct FacesOnPlaces {
    FlatArray<PlaceId> place;               ///< of each entry
    FlatArray<std::uint32_t> offsets;       ///< of each place
    FlatArray<std::int32_t> plane_or_rank;  ///< in the order of places
};

/// Numbers the entries: each edge has one for each place on it but its far end.
void number_entries(const FaceList& faces, const Tracks& tracks, Loops& loops, int threads,
                    const Progress* progress) {
    loops.face_offsets = FlatArray<std::uint32_t>(faces.size() + 1);
    loops.edge_begin = FlatArray<std::uint32_t>(faces.polygons.corners.size());
    const auto& offsets = faces.polygons.offsets;
    parallel_ranges(faces.size(), kFaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t f = begin; f < end; ++f) {
                            std::uint32_t count = 0;
                            for (auto c = offsets[f]; c < offsets[f + 1]; ++c)
                                count += static_cast<std::uint32_t>(
                                    std::abs(tracks.passed[static_cast<std::size_t>(c)].steps));
                            loops.face_offsets[f] = count;
                        }
                    });
    running_totals(loops.face_offsets, UINT32_MAX, threads, progress);
    parallel_ranges(
        faces.size(), kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                std::uint32_t next = loops.face_offsets[f];
                for (auto i = offsets[f]; i < offsets[f + 1]; ++i) {
                    const auto c = static_cast<std::size_t>(i);
                    loops.edge_begin[c] = next;
                    next += static_cast<std::uint32_t>(std::abs(tracks.passed[c].steps));
                }
            }
        });
}

/// Sorts the entries by place. Which of a place's entries comes first is left to chance;
/// `loops.vertices` says where each stands among them.
FacesOnPlaces sort_by_place(const FaceList& faces, const Places& places, const Tracks& tracks,
                            Loops& loops, int threads, const Progress* progress) {
    const std::size_t entries = loops.face_offsets[faces.size()];
    FacesOnPlaces on;
    on.place = FlatArray<PlaceId>(entries);
    on.offsets = zeros<std::uint32_t>(places.size() + 1, threads, progress);
    loops.vertices = FlatArray<std::int32_t>(entries);
    parallel_ranges(loops.edge_begin.size(), 4 * kFaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c) {
                            const auto [first, steps] = tracks.passed[c];
                            const PlaceId* along = tracks.places.begin() + first;
                            PlaceId* to = on.place.begin() + loops.edge_begin[c];
                            const std::int32_t step = steps > 0 ? 1 : -1;
                            for (std::int32_t i = 0; i != steps; i += step)
                                *to++ = along[i];
                        }
                    });
    parallel_ranges(entries, kEntries, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            loops.vertices[i] = static_cast<std::int32_t>(
                count_one(on.offsets[static_cast<std::size_t>(on.place[i])]));
        }
    });
    running_totals(on.offsets, UINT32_MAX, threads, progress);
    on.plane_or_rank = FlatArray<std::int32_t>(entries);
    parallel_ranges(
        faces.size(), kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                const PlaneId plane = faces.plane[f];
                for (auto i = loops.face_offsets[f]; i < loops.face_offsets[f + 1]; ++i) {
                    on.plane_or_rank[on.offsets[static_cast<std::size_t>(on.place[i])] +
                                     static_cast<std::uint32_t>(loops.vertices[i])] = plane;
                }
            }
        });
    return on;
}

/// Finds the heights on each place and turns planes into ranks. Equal doubles among the heights of
/// one place are spread upward, so that all are different.
std::vector<std::vector<double>> find_heights(const PlanGeometry& geometry, const Places& places,
                                              FacesOnPlaces& on, Loops& loops, int threads,
                                              const Progress* progress) {
    loops.place_offsets = FlatArray<std::int32_t>(places.size() + 1);
    std::vector<std::vector<double>> heights((places.size() + kPlaces - 1) / kPlaces);
    parallel_ranges(places.size(), kPlaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        PlaceHeights of_place(geometry);
                        auto& all = heights[begin / kPlaces];
                        for (std::size_t p = begin; p < end; ++p) {
                            of_place.find(places.representative[p],
                                          {on.plane_or_rank.begin() + on.offsets[p],
                                           on.plane_or_rank.begin() + on.offsets[p + 1]});
                            const std::size_t first = all.size();
                            for (double z : of_place.heights()) {
                                if (all.size() > first && z <= all.back())
                                    z = std::nextafter(all.back(), HUGE_VAL);
                                all.push_back(z);
                            }
                            loops.place_offsets[p] = static_cast<std::int32_t>(all.size() - first);
                        }
                    });
    running_totals(loops.place_offsets, INT32_MAX, threads, progress);
    return heights;
}

}  // namespace

Loops find_loops(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
                 Tracks& tracks, int threads, const Progress* progress) {
    Loops loops;
    number_entries(faces, tracks, loops, threads, progress);
    FacesOnPlaces on = sort_by_place(faces, places, tracks, loops, threads, progress);
    tracks.places = {};
    tracks.passed = {};
    auto heights = find_heights(geometry, places, on, loops, threads, progress);
    parallel_ranges(loops.vertices.size(), kEntries, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const auto place = static_cast<std::size_t>(on.place[i]);
                            loops.vertices[i] =
                                loops.place_offsets[place] +
                                on.plane_or_rank[on.offsets[place] +
                                                 static_cast<std::uint32_t>(loops.vertices[i])];
                        }
                    });
    on = {};
    loops.positions.resize(static_cast<std::size_t>(loops.place_offsets[places.size()]));
    parallel_ranges(
        places.size(), kPlaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            auto& all = heights[begin / kPlaces];
            auto z = all.begin();
            for (std::size_t p = begin; p < end; ++p) {
                const auto [x, y] = places.position[p];
                for (auto v = loops.place_offsets[p]; v < loops.place_offsets[p + 1]; ++v)
                    loops.positions[static_cast<std::size_t>(v)] = {x, y, *z++};
            }
            all = {};
        });
    return loops;
}

}  // namespace realmodel::strata
