// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/chunk_joining.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/overlay/shared_polygons.hpp"

namespace realmodel::strata {

namespace {

/// Room that most facets leave unused, each list of polygons for itself.
constexpr std::size_t kPolygonsOfFacet = 8, kCornersOfFacet = 32, kSome = 4096;

void pass(PoolStart& start, const PolygonPool& pool) {
    start.polygon += pool.size();
    start.corner += pool.corners.size();
}

/// Lists as long as the faces, facets or pieces that they are of.
auto lists_of(FaceList& faces) {
    return std::array{&faces.plane, &faces.layer, &faces.above, &faces.below};
}
auto lists_of(LoweredPieces& lowered) {
    return std::array{&lowered.polygon, &lowered.cell_above};
}
auto lists_of(Envelope& envelope) {
    return std::array{&envelope.plane, &envelope.layer, &envelope.pending};
}

template <class Array>
void make_room(Array& array, std::size_t more) {
    const std::size_t size = array.size() + more;
    if (size > array.capacity()) array.reserve(std::max(size, 2 * array.capacity()));
}
void make_room(PolygonPool& pool, std::size_t facets) {
    make_room(pool.offsets, facets * kPolygonsOfFacet + kSome);
    make_room(pool.corners, facets * kCornersOfFacet + kSome);
}

/// Makes memory ready for so many elements where there is room for them without moving any.
template <class Array>
bool has_room(Array& array, std::size_t size) {
    if (size > array.capacity()) return false;
    array.make_ready(size);
    return true;
}
/// The same for the polygons up to somewhere, and for the lists that go with them.
template <class Lists>
bool has_room(PolygonPool& pool, const Lists& lists, const PoolStart& end) {
    return has_room(pool.offsets, end.polygon + 1) && has_room(pool.corners, end.corner) &&
           std::all_of(lists.begin(), lists.end(),
                       [&](auto* list) { return has_room(*list, end.polygon); });
}

void resize(PolygonPool& pool, const PoolStart& end) {
    pool.offsets.resize(end.polygon + 1);
    pool.corners.resize(end.corner);
}

template <class Element, class From>
void put(GrowingArray<Element>& to, std::size_t at, const From& from) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Puts polygons of a scope that was handed over.
void put(PolygonPool& to, const PoolStart& at, const PolygonPool& from, LocalArrangement& scope) {
    share(scope, from, to.corners.begin() + static_cast<std::ptrdiff_t>(at.corner));
    for (std::size_t i = 1; i < from.offsets.size(); ++i)
        to.offsets[at.polygon + i] = static_cast<std::int64_t>(at.corner) + from.offsets[i];
}

}  // namespace

ChunkResult::ChunkResult(const exact::PlanArrangement& geometry, std::size_t facets)
    : scope(std::make_unique<LocalArrangement>(geometry)) {
    // on surfaces of much the same resolution
    constexpr std::size_t kPoints = 4, kPolygons = 6, kCorners = 4;
    scope->expect_points(kPoints * facets);
    for (PolygonPool* pool : {&faces.polygons, &lowered_outlines}) {
        pool->offsets.reserve(kPolygons * facets);
        pool->corners.reserve(kPolygons * kCorners * facets);
    }
    for (auto* list : lists_of(faces))
        list->reserve(kPolygons * facets);
    lowered.reserve(kPolygons * facets);
}

void ChunkStart::pass(const ChunkResult& chunk) {
    cell += static_cast<std::int64_t>(chunk.cell_block.size());
    strata::pass(face, chunk.faces.polygons);
    strata::pass(lowered, chunk.lowered_outlines);
    strata::pass(facet, chunk.kept.outlines);
    strata::pass(facet_face, chunk.kept.face_polygons);
}

ChunkJoining::ChunkJoining(std::vector<std::unique_ptr<ChunkResult>>& chunks, std::size_t facets,
                           Construction& construction, Envelope& next, LoweredPieces& lowered)
    : chunks_(chunks),
      construction_(construction),
      next_(next),
      lowered_(lowered),
      start_(chunks.size()),
      fits_(chunks.size()) {
    end_.cell = static_cast<std::int64_t>(construction.cell_block.size());
    strata::pass(end_.face, construction.faces.polygons);
    for (PolygonPool* pool :
         {&construction.faces.polygons, &lowered.outlines, &next.outlines, &next.face_polygons})
        make_room(*pool, facets);
    const std::size_t polygons = facets * kPolygonsOfFacet + kSome;
    make_room(construction.cell_block, polygons);
    make_room(construction.cell_is_thick, polygons);
    for (auto* list : lists_of(construction.faces))
        make_room(*list, polygons);
    for (auto* list : lists_of(lowered))
        make_room(*list, polygons);
    for (auto* list : lists_of(next))
        make_room(*list, polygons);
    make_room(next.face_offsets, polygons);
    make_room(next.face_above, polygons);
}

bool ChunkJoining::has_room() {
    const auto cells = static_cast<std::size_t>(end_.cell);
    return strata::has_room(construction_.cell_block, cells) &&
           strata::has_room(construction_.cell_is_thick, cells) &&
           strata::has_room(next_.face_offsets, end_.facet.polygon + 1) &&
           strata::has_room(construction_.faces.polygons, lists_of(construction_.faces),
                            end_.face) &&
           strata::has_room(lowered_.outlines, lists_of(lowered_), end_.lowered) &&
           strata::has_room(next_.outlines, lists_of(next_), end_.facet) &&
           strata::has_room(next_.face_polygons, std::array{&next_.face_above}, end_.facet_face);
}

void ChunkJoining::find_place(std::size_t chunk) {
    start_[chunk] = end_;
    end_.pass(*chunks_[chunk]);
    if (end_.cell > INT32_MAX) {
        throw InputError("too_large",
                         "the model has more than 2147 million cells; use coarser surfaces");
    }
    fits_[chunk] = has_room() ? 1 : 0;
}

void ChunkJoining::put_where_room(std::size_t chunk) {
    if (fits_[chunk] != 0) put(chunk);
}

void ChunkJoining::finish(int threads, const Progress* progress) {
    construction_.cell_block.resize(static_cast<std::size_t>(end_.cell));
    construction_.cell_is_thick.resize(static_cast<std::size_t>(end_.cell));
    resize(construction_.faces.polygons, end_.face);
    for (auto* list : lists_of(construction_.faces))
        list->resize(end_.face.polygon);
    resize(lowered_.outlines, end_.lowered);
    for (auto* list : lists_of(lowered_))
        list->resize(end_.lowered.polygon);
    resize(next_.outlines, end_.facet);
    for (auto* list : lists_of(next_))
        list->resize(end_.facet.polygon);
    next_.face_offsets.resize(end_.facet.polygon + 1);
    resize(next_.face_polygons, end_.facet_face);
    next_.face_above.resize(end_.facet_face.polygon);
    parallel_chunks(chunks_.size(), threads, progress, [&](std::size_t c) {
        if (chunks_[c]) put(c);
    });
}

void ChunkJoining::put(std::size_t c) {
    const ChunkResult& chunk = *chunks_[c];
    const ChunkStart& at = start_[c];
    LocalArrangement& scope = *chunk.scope;
    const auto shared_cell = [&](std::int32_t cell) {
        return cell == kOutsideCell ? cell : cell + static_cast<std::int32_t>(at.cell);
    };
    FaceList& faces = construction_.faces;
    strata::put(construction_.cell_block, static_cast<std::size_t>(at.cell), chunk.cell_block);
    strata::put(construction_.cell_is_thick, static_cast<std::size_t>(at.cell),
                chunk.cell_is_thick);
    strata::put(faces.polygons, at.face, chunk.faces.polygons, scope);
    strata::put(faces.plane, at.face.polygon, chunk.faces.plane);
    strata::put(faces.layer, at.face.polygon, chunk.faces.layer);
    strata::put(faces.above, at.face.polygon, chunk.faces.above);
    std::transform(chunk.faces.below.begin(), chunk.faces.below.end(),
                   faces.below.begin() + static_cast<std::ptrdiff_t>(at.face.polygon), shared_cell);
    strata::put(lowered_.outlines, at.lowered, chunk.lowered_outlines, scope);
    for (std::size_t i = 0; i < chunk.lowered.size(); ++i) {
        lowered_.polygon[at.lowered.polygon + i] = chunk.lowered[i].polygon;
        lowered_.cell_above[at.lowered.polygon + i] = shared_cell(chunk.lowered[i].cell_above);
    }
    strata::put(next_.outlines, at.facet, chunk.kept.outlines, scope);
    strata::put(next_.plane, at.facet.polygon, chunk.kept.plane);
    strata::put(next_.layer, at.facet.polygon, chunk.kept.layer);
    strata::put(next_.pending, at.facet.polygon, chunk.kept.pending);
    for (std::size_t f = 1; f < chunk.kept.face_offsets.size(); ++f) {
        next_.face_offsets[at.facet.polygon + f] =
            static_cast<std::int64_t>(at.facet_face.polygon) + chunk.kept.face_offsets[f];
    }
    strata::put(next_.face_polygons, at.facet_face, chunk.kept.face_polygons, scope);
    strata::put(next_.face_above, at.facet_face.polygon, chunk.kept.face_above);
    chunks_[c].reset();
}

}  // namespace realmodel::strata
