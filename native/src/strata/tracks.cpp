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

/// Asks for what pairing will want to know of the edges after one.
[[gnu::always_inline]] inline void prefetch_edge(const FaceList& faces, const Tracks& tracks,
                                                 std::size_t edge) {
    const auto far =
        static_cast<std::size_t>(tracks.edges[std::min(edge + 32, tracks.edges.size() - 1)].face);
    prefetch(&faces.plane[far]);
    prefetch(&faces.above[far]);
    prefetch(&faces.below[far]);
    prefetch(&faces.polygons.offsets[far]);
}

/// Leaves only the tracks that are not paired.
void leave_out_paired(Tracks& tracks, const FlatArray<std::uint8_t>& is_paired, int threads,
                      const Progress* progress) {
    std::vector<std::size_t> first_track((tracks.size() + kTracks - 1) / kTracks),
        first_edge(first_track.size());
    const auto for_kept = [&](std::size_t begin, std::size_t end, const auto& visit) {
        for (std::size_t t = begin; t < end; ++t) {
            if (is_paired[t] == 0) visit(t, tracks.edge_offsets[t], tracks.edge_offsets[t + 1]);
        }
    };
    parallel_ranges(tracks.size(), kTracks, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for_kept(begin, end, [&](std::size_t, auto first, auto last) {
                            ++first_track[begin / kTracks];
                            first_edge[begin / kTracks] += last - first;
                        });
                    });
    Tracks kept;
    kept.representative = FlatArray<LineId>(count_before(first_track));
    kept.edge_offsets = FlatArray<std::uint32_t>(kept.size() + 1);
    kept.edges = FlatArray<TrackEdge>(count_before(first_edge));
    kept.edge_offsets[kept.size()] = static_cast<std::uint32_t>(kept.edges.size());
    parallel_ranges(
        tracks.size(), kTracks, threads, progress, [&](std::size_t begin, std::size_t end) {
            std::size_t track = first_track[begin / kTracks], edge = first_edge[begin / kTracks];
            for_kept(begin, end, [&](std::size_t t, auto first, auto last) {
                kept.representative[track] = tracks.representative[t];
                kept.edge_offsets[track++] = static_cast<std::uint32_t>(edge);
                std::copy(tracks.edges.begin() + first, tracks.edges.begin() + last,
                          kept.edges.begin() + edge);
                edge += last - first;
            });
        });
    tracks.representative = std::move(kept.representative);
    tracks.edge_offsets = std::move(kept.edge_offsets);
    tracks.edges = std::move(kept.edges);
}

/// Puts the places of some tracks in order, and finds which of them edges pass.
class TrackChunk {
public:
    TrackChunk(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
               Tracks& tracks, PassedPlaces& passed)
        : faces_(faces),
          tracks_(tracks),
          passed_(passed),
          on_track_(geometry, places),
          pairing_(geometry, faces) {}

    /// @param extra  places that the track must pass besides the ends of its edges
    void put_in_order(std::size_t track, std::span<const std::pair<std::int32_t, PlaceId>> extra) {
        on_track_.clear();
        for (const auto& [_, place] : extra)
            on_track_.add(place);
        for (TrackEdge& edge : edges(track)) {
            edge.from = on_track_.add(edge.from);
            edge.to = on_track_.add(edge.to);
        }
        on_track_.sort(tracks_.representative[track]);
        for (TrackEdge& edge : edges(track)) {
            edge.from = on_track_.rank(edge.from);
            edge.to = on_track_.rank(edge.to);
        }
    }

    void pass_all(std::size_t track) {
        for (const TrackEdge& edge : edges(track))
            pass(edge, 1);
    }

    /// Where the cells on both sides of a pair are thick, no other face is as high as the pair
    /// where it passes a place: around it all columns have one of its two faces.
    /// @return whether all edges of the track are pairs
    bool pass_in_pairs(std::size_t track, const GrowingArray<std::uint8_t>& cell_is_thick,
                       PairedEdges& paired) {
        if (!pairing_.pair(edges(track), tracks_.representative[track])) return false;
        pairing_.add_walls(paired);
        for (const auto& [left, right] : pairing_.pairs()) {
            const bool none = left->to - left->from == 1 || (is_between(*left, cell_is_thick) &&
                                                             is_between(*right, cell_is_thick));
            pass(*left, none ? 0 : -1);
            pass(*right, 0);
            if (!none) paired.passing.push_back({left->begin, right->begin});
        }
        return true;
    }

    void prefetch(std::size_t track) const {
        for (auto e = tracks_.edge_offsets[track]; e < tracks_.edge_offsets[track + 1]; ++e)
            prefetch_edge(faces_, tracks_, e);
    }

private:
    std::span<TrackEdge> edges(std::size_t track) {
        return {tracks_.edges.begin() + tracks_.edge_offsets[track],
                tracks_.edges.begin() + tracks_.edge_offsets[track + 1]};
    }
    /// @param sign  0 where the places between the ends of the edge are left out, or that of their
    ///     count
    void pass(const TrackEdge& edge, std::int32_t sign) {
        const std::int32_t between = sign == 0 ? 0 : std::abs(edge.to - edge.from) - 1;
        if (between == 0) return;
        passed_.push_back(static_cast<std::int32_t>(edge.begin));
        passed_.push_back(sign * between);
        const PlaceId* place = on_track_.in_order().data() + edge.from;
        for (std::int32_t i = 0, step = edge.from < edge.to ? 1 : -1; i < between; ++i)
            passed_.push_back(*(place += step));
    }

    /// Whether a face lies between thick cells, or those and the outside.
    bool is_between(const TrackEdge& edge, const GrowingArray<std::uint8_t>& cell_is_thick) const {
        const auto face = static_cast<std::size_t>(edge.face);
        const auto is_thick = [&](std::int32_t cell) {
            return cell == kOutsideCell || cell_is_thick[static_cast<std::size_t>(cell)] != 0;
        };
        return is_thick(faces_.above[face]) && is_thick(faces_.below[face]);
    }

    const FaceList& faces_;
    Tracks& tracks_;
    PassedPlaces& passed_;
    PlacesOnTrack on_track_;
    TrackPairing pairing_;
};

}  // namespace

Tracks find_tracks(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   const std::vector<ExtraPoint>& extra,
                   const GrowingArray<std::uint8_t>* cell_is_thick, int threads,
                   const Progress* progress) {
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
    const auto extra_from = [&](std::size_t track) {
        const auto first = std::pair(static_cast<std::int32_t>(track), PlaceId{-1});
        return static_cast<std::size_t>(
            std::lower_bound(extra_places.begin(), extra_places.end(), first) -
            extra_places.begin());
    };
    tracks.passed.resize((tracks.size() + kTracks - 1) / kTracks);
    tracks.paired.resize(tracks.passed.size());
    const bool pairs = cell_is_thick != nullptr;
    FlatArray<std::uint8_t> is_paired(pairs ? tracks.size() : 0);
    parallel_ranges(
        tracks.size(), kTracks, threads, progress, [&](std::size_t begin, std::size_t end) {
            TrackChunk chunk(geometry, faces, places, tracks, tracks.passed[begin / kTracks]);
            std::size_t next_extra = extra_from(begin);
            for (std::size_t t = begin; t < end; ++t) {
                const std::size_t first_extra = next_extra;
                while (next_extra < extra_places.size() &&
                       extra_places[next_extra].first == static_cast<std::int32_t>(t))
                    ++next_extra;
                if (pairs) chunk.prefetch(t);
                chunk.put_in_order(
                    t, {extra_places.begin() + first_extra, extra_places.begin() + next_extra});
                const bool in_pairs =
                    pairs && first_extra == next_extra &&
                    chunk.pass_in_pairs(t, *cell_is_thick, tracks.paired[begin / kTracks]);
                if (!in_pairs) chunk.pass_all(t);
                if (pairs) is_paired[t] = in_pairs ? 1 : 0;
            }
        });
    if (pairs) leave_out_paired(tracks, is_paired, threads, progress);
    return tracks;
}

}  // namespace realmodel::strata
