// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/chunk_joining.hpp"

#include <algorithm>
#include <tuple>

#include "base/parallel_counts.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

namespace {

/// Room that most facets leave unused, each list of polygons for itself.
constexpr std::size_t kPolygonsOfFacet = 8, kCornersOfFacet = 32, kSome = 4096;

template <class Pool>
void pass(PoolStart& start, const Pool& pool) {
    start.polygon += pool.size();
    start.corner += pool.offsets.back();
}

/// Lists as long as the corners of polygons.
auto corners_of(PolygonPool& pool) {
    return std::tie(pool.corners);
}
auto corners_of(SplitPolygons& pool) {
    return std::tie(pool.points, pool.lines);
}

/// Lists as long as the faces, facets or pieces that they are of.
template <class Polygons>
auto lists_of(FacesOf<Polygons>& faces) {
    return std::tie(faces.plane, faces.surface, faces.above, faces.below);
}
auto lists_of(PiecesBelow& below) {
    return std::tie(below.polygon, below.node_above);
}
auto lists_of(Envelope& envelope) {
    return std::tie(envelope.plane, envelope.surface, envelope.block_beneath);
}
template <class Lists, class Do>
void for_each(const Lists& lists, const Do& act) {
    std::apply([&](auto&... list) { (act(list), ...); }, lists);
}

template <class Array>
void make_room(Array& array, std::size_t more) {
    const std::size_t size = array.size() + more;
    if (size > array.capacity()) array.reserve(std::max(size, 2 * array.capacity()));
}
template <class Pool>
void make_room_in_pool(Pool& pool, std::size_t facets) {
    make_room(pool.offsets, facets * kPolygonsOfFacet + kSome);
    for_each(corners_of(pool),
             [&](auto& list) { make_room(list, facets * kCornersOfFacet + kSome); });
}

/// Makes memory ready for so many elements where there is room for them without moving any.
template <class Array>
bool has_room(Array& array, std::size_t size) {
    if (size > array.capacity()) return false;
    array.make_ready(size);
    return true;
}
template <class... List>
bool have_room(const std::tuple<List&...>& lists, std::size_t size) {
    return std::apply([&](auto&... list) { return (has_room(list, size) && ...); }, lists);
}
/// The same for the polygons up to somewhere, and for the lists that go with them.
template <class Pool, class Lists>
bool has_room(Pool& pool, const Lists& lists, const PoolStart& end) {
    return has_room(pool.offsets, end.polygon + 1) && have_room(corners_of(pool), end.corner) &&
           have_room(lists, end.polygon);
}

template <class Pool, class Lists>
void resize(Pool& pool, const Lists& lists, const PoolStart& end) {
    pool.offsets.resize(end.polygon + 1);
    for_each(corners_of(pool), [&](auto& list) { list.resize(end.corner); });
    for_each(lists, [&](auto& list) { list.resize(end.polygon); });
}

template <class Element, class From>
void put(Array<Element>& to, std::size_t at, const From& from) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Puts polygons of a scope that was committed.
void put(PolygonPool& to, const PoolStart& at, const PolygonPool& from, LocalArrangement& scope) {
    share(scope, from, to.corners.begin() + at.corner);
    for (std::size_t i = 1; i < from.offsets.size(); ++i)
        to.offsets[at.polygon + i] = static_cast<std::uint32_t>(at.corner) + from.offsets[i];
}

}  // namespace

ChunkResult::ChunkResult(const exact::PlanArrangement& geometry, std::size_t facets)
    : scope(std::make_unique<LocalArrangement>(geometry)) {
    // on surfaces of much the same resolution
    constexpr std::size_t kPoints = 4, kPolygons = 6, kCorners = 4;
    scope->expect_points(kPoints * facets);
    for (PolygonPool* pool : {&faces.polygons, &below_outlines}) {
        pool->offsets.reserve(kPolygons * facets);
        pool->corners.reserve(kPolygons * kCorners * facets);
    }
    for_each(lists_of(faces), [&](auto& list) { list.reserve(kPolygons * facets); });
    below.reserve(kPolygons * facets);
}

void ChunkStart::pass(const ChunkResult& chunk) {
    node += static_cast<std::int64_t>(chunk.node_block.size());
    strata::pass(face, chunk.faces.polygons);
    face.polygon += chunk.closed_faces;
    face.corner += chunk.closed_corners;
    strata::pass(below, chunk.below_outlines);
    strata::pass(facet, chunk.remaining.outlines);
    strata::pass(facet_face, chunk.remaining.face_polygons);
}

ChunkJoining::ChunkJoining(std::vector<std::unique_ptr<ChunkResult>>& chunks,
                           const Envelope& envelope, Construction& construction, Envelope& next,
                           PiecesBelow& below)
    : chunks_(chunks),
      envelope_(envelope),
      construction_(construction),
      next_(next),
      below_(below),
      start_(chunks.size()),
      fits_(chunks.size()) {
    const std::size_t facets = envelope.size();
    end_.node = static_cast<std::int64_t>(construction.node_block.size());
    strata::pass(end_.face, construction.faces.polygons);
    make_room_in_pool(construction.faces.polygons, facets);
    for (PolygonPool* pool : {&below.outlines, &next.outlines, &next.face_polygons})
        make_room_in_pool(*pool, facets);
    const std::size_t polygons = facets * kPolygonsOfFacet + kSome;
    make_room(construction.node_block, polygons);
    make_room(construction.node_is_thick, polygons);
    const auto make_room_for_all = [&](auto& list) { make_room(list, polygons); };
    for_each(lists_of(construction.faces), make_room_for_all);
    for_each(lists_of(below), make_room_for_all);
    for_each(lists_of(next), make_room_for_all);
    make_room(next.face_offsets, polygons);
    make_room(next.face_above, polygons);
}

bool ChunkJoining::has_room() {
    const auto nodes = static_cast<std::size_t>(end_.node);
    return strata::has_room(construction_.node_block, nodes) &&
           strata::has_room(construction_.node_is_thick, nodes) &&
           strata::has_room(next_.face_offsets, end_.facet.polygon + 1) &&
           strata::has_room(construction_.faces.polygons, lists_of(construction_.faces),
                            end_.face) &&
           strata::has_room(below_.outlines, lists_of(below_), end_.below) &&
           strata::has_room(next_.outlines, lists_of(next_), end_.facet) &&
           strata::has_room(next_.face_polygons, std::tie(next_.face_above), end_.facet_face);
}

void ChunkJoining::find_offset(std::size_t chunk) {
    start_[chunk] = end_;
    end_.pass(*chunks_[chunk]);
    check_nodes(end_.node);
    for (const PoolStart& end : {end_.face, end_.below, end_.facet, end_.facet_face})
        check_total(end.corner, UINT32_MAX);
    fits_[chunk] = has_room() ? 1 : 0;
}

void ChunkJoining::put_where_room(std::size_t chunk) {
    if (fits_[chunk] != 0) put(chunk);
}

void ChunkJoining::finish(const Execution& execution) {
    construction_.node_block.resize(static_cast<std::size_t>(end_.node));
    construction_.node_is_thick.resize(static_cast<std::size_t>(end_.node));
    resize(construction_.faces.polygons, lists_of(construction_.faces), end_.face);
    resize(below_.outlines, lists_of(below_), end_.below);
    resize(next_.outlines, lists_of(next_), end_.facet);
    next_.face_offsets.resize(end_.facet.polygon + 1);
    resize(next_.face_polygons, std::tie(next_.face_above), end_.facet_face);
    parallel_chunks(chunks_.size(), execution, [&](std::size_t c) {
        if (chunks_[c]) put(c);
    });
}

/// Puts the faces of a chunk, and those of the envelope that go between them.
void ChunkJoining::put_faces(const ChunkResult& chunk, const ChunkStart& at) {
    FaceList& to = construction_.faces;
    PoolStart next = at.face;
    const auto put_face = [&](PolygonView polygon, PlaneId plane, std::int32_t surface,
                              std::int32_t above, std::int32_t below) {
        for (const Corner& corner : polygon) {
            to.polygons.points[next.corner] = chunk.scope->shared_point(corner.point);
            to.polygons.lines[next.corner++] = chunk.scope->shared_directed(corner.line);
        }
        to.plane[next.polygon] = plane;
        to.surface[next.polygon] = surface;
        to.above[next.polygon] = above;
        to.below[next.polygon] = below < 0 ? below : below + static_cast<std::int32_t>(at.node);
        to.polygons.offsets[++next.polygon] = static_cast<std::uint32_t>(next.corner);
    };
    std::size_t face = 0;
    const auto put_faces_up_to = [&](std::size_t end) {
        for (const auto& faces = chunk.faces; face < end; ++face)
            put_face(faces.polygons[face], faces.plane[face], faces.surface[face],
                     faces.above[face], faces.below[face]);
    };
    for (const ClosedFacet& closed : chunk.closed) {
        put_faces_up_to(closed.before);
        const auto [begin, end] = envelope_.faces_of(closed.facet);
        for (std::size_t f = begin; f < end; ++f)
            put_face(envelope_.face_polygons[f], envelope_.plane[closed.facet],
                     envelope_.surface[closed.facet], envelope_.face_above[f], closed.node);
    }
    put_faces_up_to(chunk.faces.size());
}

void ChunkJoining::put(std::size_t c) {
    const ChunkResult& chunk = *chunks_[c];
    const ChunkStart& at = start_[c];
    LocalArrangement& scope = *chunk.scope;
    const auto shared_node = [&](std::int32_t node) {
        return node < 0 ? node : node + static_cast<std::int32_t>(at.node);
    };
    strata::put(construction_.node_block, static_cast<std::size_t>(at.node), chunk.node_block);
    strata::put(construction_.node_is_thick, static_cast<std::size_t>(at.node),
                chunk.node_is_thick);
    put_faces(chunk, at);
    strata::put(below_.outlines, at.below, chunk.below_outlines, scope);
    for (std::size_t i = 0; i < chunk.below.size(); ++i) {
        below_.polygon[at.below.polygon + i] = chunk.below[i].polygon;
        below_.node_above[at.below.polygon + i] = shared_node(chunk.below[i].node_above);
    }
    strata::put(next_.outlines, at.facet, chunk.remaining.outlines, scope);
    strata::put(next_.plane, at.facet.polygon, chunk.remaining.plane);
    strata::put(next_.surface, at.facet.polygon, chunk.remaining.surface);
    strata::put(next_.block_beneath, at.facet.polygon, chunk.remaining.block_beneath);
    for (std::size_t f = 1; f < chunk.remaining.face_offsets.size(); ++f) {
        next_.face_offsets[at.facet.polygon + f] =
            static_cast<std::int64_t>(at.facet_face.polygon) + chunk.remaining.face_offsets[f];
    }
    strata::put(next_.face_polygons, at.facet_face, chunk.remaining.face_polygons, scope);
    strata::put(next_.face_above, at.facet_face.polygon, chunk.remaining.face_above);
    chunks_[c].reset();
}

}  // namespace realmodel::strata
