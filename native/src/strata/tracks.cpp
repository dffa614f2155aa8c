// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>

#include "conforming.hpp"
#include "parallel_counts.hpp"
#include "same_lines.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

constexpr std::size_t kFaces = 1 << 12, kTracks = 1 << 10;  // worked on at a time
constexpr std::uint64_t kMostEdges = 2000000000;  // so that places on tracks can be numbered

/// The places on one track, put in order. Rounded coordinates keep the order of places along a
/// line, and exact ones decide where they are equal.
class PlacesOnTrack {
public:
    PlacesOnTrack(const PlanGeometry& geometry, const Places& places)
        : scope_(geometry), places_(places) {}

    void clear() {
        added_.clear();
        known_.clear();
    }

    /// Adds a place, which may be there already.
    /// @return a number to ask rank() with
    std::int32_t add(PlaceId place) {
        // Most tracks have a handful of places, each the end of several edges, and the last ones
        // are met again soonest.
        for (std::size_t i = added_.size(), least = i > kFew ? i - kFew : 0; i > least; --i) {
            if (added_[i - 1] == place) return static_cast<std::int32_t>(i - 1);
        }
        added_.push_back(place);
        return static_cast<std::int32_t>(added_.size()) - 1;
    }

    /// To be called when all are there, with a line of the track.
    void sort(LineId line) {
        order_.resize(added_.size());
        std::iota(order_.begin(), order_.end(), 0);
        // places are in order of x, so only where two have the same x more is to be asked
        std::sort(order_.begin(), order_.end(),
                  [&](std::int32_t a, std::int32_t b) { return added(a) < added(b); });
        if (same_x()) {
            const auto [x, y] = scope_.direction_signs(line);
            const int rise = x == 0 ? 1 : x * y;
            std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
                return added(a) != added(b) && before(rise, added(a), added(b));
            });
        }
        rank_.resize(added_.size());
        for (const std::int32_t i : order_) {
            if (known_.empty() || known_.back() != added(i)) known_.push_back(added(i));
            rank_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(known_.size()) - 1;
        }
    }

    /// The places in order along the track, each once.
    const std::vector<PlaceId>& in_order() const { return known_; }
    /// Which of them was added under a number.
    std::int32_t rank(std::int32_t number) const { return rank_[static_cast<std::size_t>(number)]; }

private:
    static constexpr std::size_t kFew = 16;

    PlaceId added(std::int32_t i) const { return added_[static_cast<std::size_t>(i)]; }
    const PlanPosition& position(PlaceId place) const {
        return places_.position[static_cast<std::size_t>(place)];
    }

    /// Whether two different places have the same x.
    bool same_x() const {
        for (std::size_t i = 1; i < order_.size(); ++i) {
            const PlaceId a = added(order_[i - 1]), b = added(order_[i]);
            const bool perhaps = places_.same_x_next[static_cast<std::size_t>(a)] != 0;
            if (perhaps && a != b && position(a)[0] == position(b)[0]) return true;
        }
        return false;
    }

    /// Whether place a comes before place b along a track that runs to rising x (and rising or
    /// falling y).
    bool before(int rise, PlaceId a, PlaceId b) {
        const PlanPosition &p = position(a), &q = position(b);
        if (p[0] != q[0]) return p[0] < q[0];
        if (p[1] != q[1] && rise != 0) return (p[1] < q[1]) == (rise > 0);
        const PointId from = places_.representative[static_cast<std::size_t>(a)];
        const PointId to = places_.representative[static_cast<std::size_t>(b)];
        const int x = scope_.compare(0, from, to);
        if (x != 0) return x > 0;
        return scope_.compare(1, from, to) * rise > 0;
    }

    Scope scope_;
    const Places& places_;
    std::vector<PlaceId> added_;  ///< some of them twice, where there are many
    std::vector<PlaceId> known_;  ///< along the track
    std::vector<std::int32_t> order_, rank_;
};

/// Finds the face edges of each track; their ends are the places themselves for now.
void gather_edges(const FaceList& faces, const Places& places,
                  const FlatArray<std::int32_t>& track_of_line, Tracks& tracks, int threads,
                  const Progress* progress) {
    const auto& corners = faces.polygons.corners;
    const auto track_of = [&](const Corner& corner) {
        return static_cast<std::size_t>(
            track_of_line[static_cast<std::size_t>(exact::line_of(corner.line))]);
    };
    tracks.edge_offsets = zeros<std::uint32_t>(tracks.size() + 1, threads, progress);
    FlatArray<std::uint32_t> number(corners.size());  // of each edge on its track
    parallel_ranges(corners.size(), 4 * kFaces, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c)
                            number[c] = count_one(tracks.edge_offsets[track_of(corners[c])]);
                    });
    running_totals(tracks.edge_offsets, kMostEdges, threads, progress);
    tracks.edges = FlatArray<TrackEdge>(corners.size());
    parallel_ranges(
        faces.size(), kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                const auto first = static_cast<std::size_t>(faces.polygons.offsets[f]);
                const auto last = static_cast<std::size_t>(faces.polygons.offsets[f + 1]) - 1;
                PlaceId from = places.of_point[static_cast<std::size_t>(corners[last].point)];
                for (std::size_t next = first; next <= last; ++next) {
                    const std::size_t c = next > first ? next - 1 : last;
                    const PlaceId to =
                        places.of_point[static_cast<std::size_t>(corners[next].point)];
                    tracks.edges[tracks.edge_offsets[track_of(corners[c])] + number[c]] = {
                        from, to, static_cast<std::uint32_t>(c), static_cast<std::int32_t>(f)};
                    from = to;
                }
            }
        });
}

}  // namespace

Tracks find_tracks(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   const std::vector<ExtraPoint>& extra, int threads, const Progress* progress) {
    Tracks tracks;
    std::vector<std::pair<std::int32_t, PlaceId>> extra_places;  // track and place, ascending
    {
        LineTracks lines = join_lines(geometry, faces, threads, progress);
        tracks.representative = std::move(lines.representative);
        gather_edges(faces, places, lines.of_line, tracks, threads, progress);
        for (const ExtraPoint& e : extra) {
            extra_places.emplace_back(lines.of_line[static_cast<std::size_t>(e.line)],
                                      places.of_point[static_cast<std::size_t>(e.point)]);
        }
        std::sort(extra_places.begin(), extra_places.end());
    }
    // Each edge has two ends, so that many places have room; a chunk puts its own side by side.
    tracks.places = FlatArray<PlaceId>(2 * tracks.edges.size() + extra_places.size());
    tracks.passed = FlatArray<PassedPlaces>(tracks.edges.size());
    parallel_ranges(
        tracks.size(), kTracks, threads, progress, [&](std::size_t begin, std::size_t end) {
            PlacesOnTrack on_track(geometry, places);
            auto next_extra =
                std::lower_bound(extra_places.begin(), extra_places.end(),
                                 std::pair(static_cast<std::int32_t>(begin), PlaceId{-1}));
            std::size_t next = 2 * std::size_t{tracks.edge_offsets[begin]} +
                               static_cast<std::size_t>(next_extra - extra_places.begin());
            for (std::size_t t = begin; t < end; ++t) {
                on_track.clear();
                for (; next_extra != extra_places.end() &&
                       next_extra->first == static_cast<std::int32_t>(t);
                     ++next_extra)
                    on_track.add(next_extra->second);
                for (auto e = tracks.edge_offsets[t]; e < tracks.edge_offsets[t + 1]; ++e) {
                    TrackEdge& edge = tracks.edges[e];
                    edge.from = on_track.add(edge.from);
                    edge.to = on_track.add(edge.to);
                }
                on_track.sort(tracks.representative[t]);
                for (auto e = tracks.edge_offsets[t]; e < tracks.edge_offsets[t + 1]; ++e) {
                    TrackEdge& edge = tracks.edges[e];
                    edge.from = on_track.rank(edge.from);
                    edge.to = on_track.rank(edge.to);
                    tracks.passed[edge.begin] = {
                        static_cast<std::uint32_t>(next + static_cast<std::size_t>(edge.from)),
                        edge.to - edge.from};
                }
                const auto& in_order = on_track.in_order();
                std::copy(in_order.begin(), in_order.end(), tracks.places.begin() + next);
                next += in_order.size();
            }
        });
    return tracks;
}

}  // namespace realmodel::strata
