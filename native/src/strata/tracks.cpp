// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "conforming.hpp"
#include "parallel_sort.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

constexpr std::size_t kChunk = 4096;

/// Gives every line in use its track: rounded slope and offset are equal for lines that run through
/// the same places, and among those with equal ones the exact test decides.
void join_lines(const PlanGeometry& geometry, const std::vector<std::uint8_t>& used, Tracks& tracks,
                int threads, const Progress* progress) {
    std::vector<LineId> lines;
    for (std::size_t l = 0; l < used.size(); ++l) {
        if (used[l] != 0) lines.push_back(static_cast<LineId>(l));
    }
    struct Keyed {
        std::array<double, 3> key;
        LineId line;
    };
    std::vector<Keyed> keyed(lines.size());
    tracks.against.assign(geometry.line_count(), 0);
    parallel_chunks((lines.size() + kChunk - 1) / kChunk, threads, progress,
                    [&](std::size_t chunk) {
                        Scope scope(geometry);
                        for (std::size_t i = chunk * kChunk;
                             i < std::min(lines.size(), (chunk + 1) * kChunk); ++i) {
                            keyed[i] = {scope.line_key(lines[i]), lines[i]};
                            const auto [x, y] = scope.direction_signs(lines[i]);
                            tracks.against[static_cast<std::size_t>(lines[i])] =
                                x < 0 || (x == 0 && y < 0) ? 1 : 0;
                        }
                    });
    const auto in_order = [](const Keyed& a, const Keyed& b) {
        return std::tie(a.key, a.line) < std::tie(b.key, b.line);
    };
    parallel_sort(keyed, in_order, threads, progress);
    std::vector<std::size_t> group_begin;
    for (std::size_t i = 0; i < keyed.size(); ++i) {
        if (i == 0 || keyed[i].key != keyed[i - 1].key) group_begin.push_back(i);
    }
    group_begin.push_back(keyed.size());
    const std::size_t groups = group_begin.size() - 1;
    std::vector<LineId> first_there(keyed.size());
    parallel_chunks((groups + kChunk - 1) / kChunk, threads, progress, [&](std::size_t chunk) {
        Scope scope(geometry);
        for (std::size_t g = chunk * kChunk; g < std::min(groups, (chunk + 1) * kChunk); ++g) {
            for (std::size_t i = group_begin[g]; i < group_begin[g + 1]; ++i) {
                first_there[i] = keyed[i].line;
                for (std::size_t j = group_begin[g]; j < i; ++j) {
                    if (first_there[j] == keyed[j].line &&
                        scope.same_line(keyed[i].line, keyed[j].line)) {
                        first_there[i] = keyed[j].line;
                        break;
                    }
                }
            }
        }
    });
    tracks.of_line.assign(geometry.line_count(), -1);
    for (std::size_t i = 0; i < keyed.size(); ++i) {
        auto& track = tracks.of_line[static_cast<std::size_t>(keyed[i].line)];
        if (first_there[i] == keyed[i].line) {
            track = static_cast<std::int32_t>(tracks.representative.size());
            tracks.representative.push_back(keyed[i].line);
        } else {
            track = tracks.of_line[static_cast<std::size_t>(first_there[i])];
        }
    }
}

/// Whether place a comes before place b along a track that runs to rising x (and rising or falling
/// y): rounded coordinates keep the order, exact ones break ties.
bool before(Scope& scope, const Places& places, int rise, PlaceId a, PlaceId b) {
    const PointId p = places.representative[static_cast<std::size_t>(a)];
    const PointId q = places.representative[static_cast<std::size_t>(b)];
    const auto &pa = scope.point(p), &pb = scope.point(q);
    if (pa.x != pb.x) return pa.x < pb.x;
    if (pa.y != pb.y && rise != 0) return (pa.y < pb.y) == (rise > 0);
    const int x = scope.compare(0, p, q);
    if (x != 0) return x > 0;
    return scope.compare(1, p, q) * rise > 0;
}

}  // namespace

Tracks find_tracks(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   const std::vector<ExtraPoint>& extra, int threads, const Progress* progress) {
    Tracks tracks;
    const auto& corners = faces.polygons.corners;
    std::vector<std::uint8_t> used(geometry.line_count(), 0);
    for (const Corner& corner : corners)
        used[static_cast<std::size_t>(exact::line_of(corner.line))] = 1;
    join_lines(geometry, used, tracks, threads, progress);

    const auto track_of = [&](LineId line) {
        return static_cast<std::size_t>(tracks.of_line[static_cast<std::size_t>(line)]);
    };
    tracks.edge_offsets.assign(tracks.size() + 1, 0);
    tracks.forward.resize(corners.size());
    for (std::size_t e = 0; e < corners.size(); ++e) {
        poll(progress, e);
        const LineId line = exact::line_of(corners[e].line);
        ++tracks.edge_offsets[track_of(line) + 1];
        tracks.forward[e] = exact::is_reversed(corners[e].line) ==
                            (tracks.against[static_cast<std::size_t>(line)] != 0);
    }
    for (std::size_t t = 0; t < tracks.size(); ++t)
        tracks.edge_offsets[t + 1] += tracks.edge_offsets[t];
    tracks.edges.resize(corners.size());
    {
        auto free = tracks.edge_offsets;
        for (std::size_t e = 0; e < corners.size(); ++e) {
            poll(progress, e);
            const std::size_t t = track_of(exact::line_of(corners[e].line));
            tracks.edges[static_cast<std::size_t>(free[t]++)] = static_cast<std::int64_t>(e);
        }
    }
    // the corner at the far end of each edge
    std::vector<PointId> to(corners.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        poll(progress, f);
        const auto begin = static_cast<std::size_t>(faces.polygons.offsets[f]);
        const auto end = static_cast<std::size_t>(faces.polygons.offsets[f + 1]);
        for (std::size_t e = begin; e < end; ++e)
            to[e] = corners[e + 1 < end ? e + 1 : begin].point;
    }
    std::vector<std::vector<PlaceId>> extra_places(extra.empty() ? 0 : tracks.size());
    for (const ExtraPoint& e : extra) {
        extra_places[track_of(e.line)].push_back(
            places.of_point[static_cast<std::size_t>(e.point)]);
    }

    tracks.low.resize(corners.size());
    tracks.high.resize(corners.size());
    const std::size_t chunks = (tracks.size() + kChunk - 1) / kChunk;
    std::vector<std::vector<PlaceId>> places_of_chunk(chunks);
    std::vector<std::int64_t> place_count(tracks.size());
    parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
        Scope scope(geometry);
        std::vector<PlaceId> on_track;
        for (std::size_t t = chunk * kChunk; t < std::min(tracks.size(), (chunk + 1) * kChunk);
             ++t) {
            on_track.clear();
            if (!extra.empty()) on_track = extra_places[t];
            for (auto i = tracks.edge_offsets[t]; i < tracks.edge_offsets[t + 1]; ++i) {
                const auto e = static_cast<std::size_t>(tracks.edges[static_cast<std::size_t>(i)]);
                on_track.push_back(places.of_point[static_cast<std::size_t>(corners[e].point)]);
                on_track.push_back(places.of_point[static_cast<std::size_t>(to[e])]);
            }
            std::sort(on_track.begin(), on_track.end());
            on_track.erase(std::unique(on_track.begin(), on_track.end()), on_track.end());
            const LineId line = tracks.representative[t];
            const auto [x, y] = scope.direction_signs(line);
            const int rise = x == 0 ? 1 : x * y;
            const auto precedes = [&](PlaceId a, PlaceId b) {
                return before(scope, places, rise, a, b);
            };
            std::sort(on_track.begin(), on_track.end(), precedes);
            const auto rank = [&](PointId p) {
                const PlaceId place = places.of_point[static_cast<std::size_t>(p)];
                return static_cast<std::int32_t>(
                    std::lower_bound(on_track.begin(), on_track.end(), place, precedes) -
                    on_track.begin());
            };
            for (auto i = tracks.edge_offsets[t]; i < tracks.edge_offsets[t + 1]; ++i) {
                const auto e = static_cast<std::size_t>(tracks.edges[static_cast<std::size_t>(i)]);
                const std::int32_t from = rank(corners[e].point), end = rank(to[e]);
                tracks.low[e] = std::min(from, end);
                tracks.high[e] = std::max(from, end);
            }
            place_count[t] = static_cast<std::int64_t>(on_track.size());
            auto& all = places_of_chunk[chunk];
            all.insert(all.end(), on_track.begin(), on_track.end());
        }
    });
    tracks.place_offsets.assign(1, 0);
    for (const std::int64_t count : place_count) {
        tracks.place_offsets.push_back(tracks.place_offsets.back() + count);
    }
    for (const auto& all : places_of_chunk)
        tracks.places.insert(tracks.places.end(), all.begin(), all.end());
    return tracks;
}

}  // namespace realmodel::strata
