// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>

#include "base/parallel_counts.hpp"
#include "strata/conform/collinear_lines.hpp"
#include "strata/conform/conforming.hpp"
#include "strata/conform/line_buckets.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// The places on one track, put in order. Rounded coordinates keep the order of places along a
/// line, and exact ones decide where they are equal.
class PlacesOnTrack {
public:
    PlacesOnTrack(const PlanArrangement& geometry, const PlanVertices& places)
        : scope_(geometry), places_(places) {}

    void clear() {
        added_.clear();
        known_.clear();
    }

    /// Adds a place, which may be there already.
    /// @return a number to ask rank() with
    std::int32_t add(PlanVertexId place) {
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
    const std::vector<PlanVertexId>& in_order() const { return known_; }
    /// Which of them was added under a number.
    std::int32_t rank(std::int32_t number) const { return rank_[static_cast<std::size_t>(number)]; }
    /// Which of them a place is, where no two have the same x.
    std::int32_t number_of(PlanVertexId place) const {
        return static_cast<std::int32_t>(std::lower_bound(known_.begin(), known_.end(), place) -
                                         known_.begin());
    }

private:
    static constexpr std::size_t kFew = 16;

    PlanVertexId added(std::int32_t i) const { return added_[static_cast<std::size_t>(i)]; }
    const PlanPosition& position(PlanVertexId place) const {
        return places_.position[static_cast<std::size_t>(place)];
    }

    /// Whether two different places have the same x.
    bool same_x() const {
        for (std::size_t i = 1; i < order_.size(); ++i) {
            const PlanVertexId a = added(order_[i - 1]), b = added(order_[i]);
            if (places_.has_same_x_next(a) && a != b && position(a)[0] == position(b)[0])
                return true;
        }
        return false;
    }

    /// Whether place a comes before place b along a track that runs to rising x (and rising or
    /// falling y).
    bool before(int rise, PlanVertexId a, PlanVertexId b) {
        const PlanPosition &p = position(a), &q = position(b);
        if (p[0] != q[0]) return p[0] < q[0];
        if (p[1] != q[1] && rise != 0) return (p[1] < q[1]) == (rise > 0);
        const PointId from = places_.representative[static_cast<std::size_t>(a)];
        const PointId to = places_.representative[static_cast<std::size_t>(b)];
        const int x = scope_.compare(0, from, to);
        if (x != 0) return x > 0;
        return scope_.compare(1, from, to) * rise > 0;
    }

    LocalArrangement scope_;
    const PlanVertices& places_;
    std::vector<PlanVertexId> added_;  ///< some of them twice, where there are many
    std::vector<PlanVertexId> known_;  ///< along the track
    std::vector<std::int32_t> order_, rank_;
};

/// Lines that are not paired.
struct KeptTracks {
    std::vector<LineId> representative;
    std::vector<std::uint32_t> edge_counts;
    GrowingArray<LineEdge> edges;

    void add(LineId line, std::span<const LineEdge> of_track) {
        representative.push_back(line);
        edge_counts.push_back(static_cast<std::uint32_t>(of_track.size()));
        edges.append(of_track.begin(), of_track.end());
    }
};

/// Puts the tracks that are left together, which are given back on the way.
void join_kept(std::vector<KeptTracks> kept, CollinearEdges& tracks, int threads,
               const Progress* progress) {
    std::vector<std::size_t> first_track, first_edge;
    for (const KeptTracks& some : kept) {
        first_track.push_back(some.representative.size());
        first_edge.push_back(some.edges.size());
    }
    tracks.representative = FlatArray<LineId>(count_before(first_track));
    tracks.edge_offsets = FlatArray<std::uint32_t>(tracks.size() + 1);
    tracks.edges = FlatArray<LineEdge>(count_before(first_edge));
    tracks.edge_offsets[tracks.size()] = static_cast<std::uint32_t>(tracks.edges.size());
    parallel_chunks(kept.size(), threads, progress, [&](std::size_t i) {
        std::size_t track = first_track[i], edge = first_edge[i];
        std::copy(kept[i].edges.begin(), kept[i].edges.end(), tracks.edges.begin() + edge);
        for (std::size_t t = 0; t < kept[i].representative.size(); ++t, ++track) {
            tracks.representative[track] = kept[i].representative[t];
            tracks.edge_offsets[track] = static_cast<std::uint32_t>(edge);
            edge += kept[i].edge_counts[t];
        }
        kept[i] = {};
    });
}

/// Pairs the edges of some tracks, or puts their places in order, and finds which of them edges
/// pass.
class TrackChunk {
public:
    TrackChunk(const PlanArrangement& geometry, const FaceList& faces, const PlanVertices& places,
               PassedVertices& passed)
        : faces_(faces),
          places_(places),
          passed_(passed),
          on_track_(geometry, places),
          pairing_(geometry, faces) {}

    /// Begins with a track.
    /// @param edges  its edges, whose ends are places
    void begin(std::span<LineEdge> edges, LineId line) {
        edges_ = edges;
        line_ = line;
        is_ranked_ = false;
    }

    /// Numbers the ends of the edges along the track; an edge passes all places between its ends.
    /// @param extra  places that the track must pass besides the ends of its edges
    void pass_all(std::span<const std::pair<std::int32_t, PlanVertexId>> extra) {
        if (!is_ranked_) put_in_order(extra);
        for (const LineEdge& edge : edges_)
            pass(edge, edge.from, edge.to, 1);
    }

    /// Where the cells on both sides of a pair are thick, no other face is as high as the pair
    /// where it passes a place: around it all columns have one of its two faces.
    /// @return whether all edges of the track are pairs; if not, nothing was passed
    bool pass_in_pairs(const GrowingArray<std::uint8_t>& cell_is_thick, MatchedEdges& paired) {
        // Plan vertices have numbers in order of x, and hardly ever the same x. Each end of a pair
        // is where an edge begins.
        bool same_x = false;
        for (const LineEdge& edge : edges_)
            same_x |= places_.has_same_x_next(edge.from);
        if (same_x) put_in_order({});
        if (!pairing_.pair(edges_, line_)) return false;
        pairing_.add_walls(paired);
        bool all_known = is_ranked_;
        for (const auto& [left, right] : pairing_.pairs()) {
            if (is_between(*left, cell_is_thick) && is_between(*right, cell_is_thick)) continue;
            if (!all_known) find_places_of_pairs();
            all_known = true;
            const std::int32_t from = is_ranked_ ? left->from : on_track_.number_of(left->from);
            const std::int32_t to = is_ranked_ ? left->to : on_track_.number_of(left->to);
            if (to - from == 1) continue;
            pass(*left, from, to, -1);
            paired.passing.push_back({left->begin, right->begin});
        }
        return true;
    }

private:
    void put_in_order(std::span<const std::pair<std::int32_t, PlanVertexId>> extra) {
        on_track_.clear();
        for (const auto& [_, place] : extra)
            on_track_.add(place);
        for (LineEdge& edge : edges_) {
            edge.from = on_track_.add(edge.from);
            edge.to = on_track_.add(edge.to);
        }
        on_track_.sort(line_);
        for (LineEdge& edge : edges_) {
            edge.from = on_track_.rank(edge.from);
            edge.to = on_track_.rank(edge.to);
        }
        is_ranked_ = true;
    }
    void find_places_of_pairs() {
        on_track_.clear();
        for (const LineEdge& edge : edges_)
            on_track_.add(edge.from);
        on_track_.sort(line_);
    }

    /// @param from, to  the ends of the edge, counted along the track
    /// @param sign  that of the count of the places between them
    void pass(const LineEdge& edge, std::int32_t from, std::int32_t to, std::int32_t sign) {
        const std::int32_t between = std::abs(to - from) - 1;
        if (between == 0) return;
        passed_.push_back(static_cast<std::int32_t>(edge.begin));
        passed_.push_back(sign * between);
        const PlanVertexId* place = on_track_.in_order().data() + from;
        for (std::int32_t i = 0, step = from < to ? 1 : -1; i < between; ++i)
            passed_.push_back(*(place += step));
    }

    /// Whether a face lies between thick cells, or those and the outside.
    bool is_between(const LineEdge& edge, const GrowingArray<std::uint8_t>& cell_is_thick) const {
        const auto face = static_cast<std::size_t>(edge.face);
        const auto is_thick = [&](std::int32_t cell) {
            return cell == kOutsideCell || cell_is_thick[static_cast<std::size_t>(cell)] != 0;
        };
        return is_thick(faces_.above[face]) && is_thick(faces_.below[face]);
    }

    const FaceList& faces_;
    const PlanVertices& places_;
    PassedVertices& passed_;
    PlacesOnTrack on_track_;
    TrackPairing pairing_;
    std::span<LineEdge> edges_;
    LineId line_ = -1;
    bool is_ranked_ = false;  ///< whether ends of edges are counted along the track
};

}  // namespace

CollinearEdges find_collinear_edges(const PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& places,
                                    const std::vector<ExtraPoint>& extra,
                                    const GrowingArray<std::uint8_t>* cell_is_thick, int threads,
                                    const Progress* progress) {
    const CollinearLines lines = join_lines(geometry, faces, threads, progress);
    std::vector<std::pair<std::int32_t, PlanVertexId>> extra_places;  // track and place, ascending
    for (const ExtraPoint& e : extra) {
        extra_places.emplace_back(lines.of_line[static_cast<std::size_t>(e.line)],
                                  places.of_point[static_cast<std::size_t>(e.point)]);
    }
    std::sort(extra_places.begin(), extra_places.end());
    const auto extra_from = [&](std::size_t track) {
        const auto first = std::pair(static_cast<std::int32_t>(track), PlanVertexId{-1});
        return static_cast<std::size_t>(
            std::lower_bound(extra_places.begin(), extra_places.end(), first) -
            extra_places.begin());
    };
    CollinearEdges tracks;
    const LineBuckets buckets(faces, lines, threads, progress);
    tracks.passed.resize(buckets.size());
    tracks.paired.resize(buckets.size());
    std::vector<KeptTracks> kept(buckets.size());
    parallel_chunks(
        buckets.size(), threads, progress,
        [&](std::size_t bucket) {
            BucketEdges edges;
            buckets.collect(bucket, places, edges);
            TrackChunk chunk(geometry, faces, places, tracks.passed[bucket]);
            MatchedEdges paired;
            const std::size_t begin = buckets.first_track(bucket);
            std::size_t next_extra = extra_from(begin);
            for (std::size_t t = begin; t < buckets.first_track(bucket + 1); ++t) {
                const std::size_t first_extra = next_extra;
                while (next_extra < extra_places.size() &&
                       extra_places[next_extra].first == static_cast<std::int32_t>(t))
                    ++next_extra;
                const std::span<LineEdge> of_track = edges[t - begin];
                chunk.begin(of_track, lines.representative[t]);
                if (cell_is_thick != nullptr && first_extra == next_extra &&
                    chunk.pass_in_pairs(*cell_is_thick, paired))
                    continue;
                chunk.pass_all(
                    {extra_places.begin() + first_extra, extra_places.begin() + next_extra});
                kept[bucket].add(lines.representative[t], of_track);
            }
            tracks.paired[bucket] = paired;  // without room for more
        },
        0.5);
    join_kept(std::move(kept), tracks, threads, progress);
    return tracks;
}

}  // namespace realmodel::strata
