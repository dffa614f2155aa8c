// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <atomic>
#include <memory>

#include "base/parallel.hpp"
#include "strata/overlay/chunk_joining.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/overlay/ordered_commit.hpp"
#include "strata/overlay/pieces.hpp"
#include "strata/overlay/shared_polygons.hpp"
#include "strata/overlay/surface_facets.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Facets worked on at a time: fixed, so that the result does not depend on the number of threads.
/// More find fewer points twice, on the edges between chunks, but have to stay in the cache.
constexpr std::size_t kChunk = 1024;

/// Works on the facets of one chunk.
class FacetOverlay {
public:
    FacetOverlay(const Envelope& envelope, const SurfaceTiling& layer, std::int32_t number,
                 std::vector<std::uint8_t>& whole, ChunkResult& result)
        : envelope_(envelope),
          layer_(layer),
          number_(number),
          whole_(whole),
          result_(result),
          finder_(*result.scope, layer),
          grouping_(*result.scope, layer),
          clipper_(*result.scope) {}

    void process(std::size_t facet) {
        const PolygonView outline = envelope_.outlines[facet];
        const PlaneId plane = envelope_.plane[facet];
        if (plane == kOutside) {
            for (const std::int32_t polygon : finder_.overlapping(outline))
                leave_in_parts(polygon);
            keep(facet, envelope_.pending[facet]);
            return;
        }
        const Pieces& pieces = finder_.find_for_split(outline, plane);
        std::size_t below = 0, not_below = 0;
        for (const Piece& piece : pieces.list) {
            below += piece.side == Side::kBelow;
            not_below += piece.side == Side::kNotBelow;
            if (piece.side == Side::kNotBelow) leave_in_parts(piece.polygon);
        }
        if (below == 0 && not_below == 0) {
            keep(facet, envelope_.pending[facet]);
        } else if (below == 0 && not_below == pieces.list.size()) {
            keep(facet, number_);
        } else if (plane == kSky) {
            split_sky(facet, pieces);
        } else {
            const bool all_below = below == pieces.list.size();
            if (all_below && is_one_cell(pieces)) {
                split(facet, pieces, 1, true);
                return;
            }
            const std::int32_t cells = below == 0 ? 0 : grouping_.group(outline, pieces, group_);
            split(facet, pieces, cells, all_below && cells == 1);
        }
    }

private:
    /// Whether pieces below make one cell without looking at their edges: nowhere as high as the
    /// facet, of triangles that go on in others all around.
    bool is_one_cell(const Pieces& pieces) const {
        return std::all_of(pieces.list.begin(), pieces.list.end(),
                           [&](const Piece& piece) {
                               return layer_.runs_on[static_cast<std::size_t>(piece.polygon)] != 0;
                           }) &&
               std::find(pieces.touches.begin(), pieces.touches.end(), 1) == pieces.touches.end();
    }

    // Several threads may say so of one polygon at once; they all write the same.
    void leave_in_parts(std::int32_t polygon) {
        std::atomic_ref<std::uint8_t>(whole_[static_cast<std::size_t>(polygon)])
            .store(0, std::memory_order_relaxed);
    }

    void lower(const Pieces& pieces, const Piece& piece, std::int32_t cell) {
        result_.lowered.push_back({piece.polygon, cell});
        result_.lowered_outlines.add(pieces.outline(piece));
    }

    void keep(std::size_t facet, std::int32_t pending) {
        Envelope& kept = result_.kept;
        kept.add_facet(envelope_.outlines[facet], envelope_.plane[facet], envelope_.layer[facet],
                       pending);
        for (auto f = envelope_.face_offsets[facet]; f < envelope_.face_offsets[facet + 1]; ++f) {
            const auto i = static_cast<std::size_t>(f);
            kept.add_face(envelope_.face_polygons[i], envelope_.face_above[i]);
        }
    }

    void split_sky(std::size_t facet, const Pieces& pieces) {
        for (const Piece& piece : pieces.list) {
            if (piece.side == Side::kBelow) {
                lower(pieces, piece, kOutsideCell);
            } else {
                result_.kept.add_facet(pieces.outline(piece), kSky, envelope_.layer[facet],
                                       envelope_.pending[facet]);
            }
        }
    }

    void split(std::size_t facet, const Pieces& pieces, std::int32_t cells, bool one_cell) {
        const auto first_cell = static_cast<std::int32_t>(result_.cell_block.size());
        result_.cell_block.resize(result_.cell_block.size() + static_cast<std::size_t>(cells),
                                  envelope_.pending[facet]);
        result_.cell_is_thick.resize(result_.cell_block.size(),
                                     one_cell && pieces.is_clear ? 1 : 0);
        const auto begin = static_cast<std::size_t>(envelope_.face_offsets[facet]);
        const auto end = static_cast<std::size_t>(envelope_.face_offsets[facet + 1]);
        if (one_cell) {
            for (std::size_t f = begin; f < end; ++f)
                close(facet, f, envelope_.face_polygons[f], first_cell);
            for (const Piece& piece : pieces.list)
                lower(pieces, piece, first_cell);
            return;
        }
        for (std::size_t i = 0; i < pieces.list.size(); ++i) {
            const Piece& piece = pieces.list[i];
            const PolygonView outline = pieces.outline(piece);
            const bool below = piece.side == Side::kBelow;
            const std::int32_t cell = below ? first_cell + group_[i] : kOutsideCell;
            if (below) {
                lower(pieces, piece, cell);
            } else {
                result_.kept.add_facet(
                    outline, envelope_.plane[facet], envelope_.layer[facet],
                    piece.side == Side::kNotBelow ? number_ : envelope_.pending[facet]);
            }
            const bool only_one = end - begin == 1;  // then it is the facet
            if (!only_one) clipper_.begin(outline);
            for (std::size_t f = begin; f < end; ++f) {
                const PolygonView part =
                    only_one ? outline : clipper_.intersect(envelope_.face_polygons[f]);
                if (part.empty()) continue;
                if (below) {
                    close(facet, f, part, cell);
                } else {
                    result_.kept.add_face(part, envelope_.face_above[f]);
                }
            }
        }
    }

    /// Finishes a face of the facet: the cell beneath it is known now.
    void close(std::size_t facet, std::size_t face, PolygonView outline, std::int32_t cell) {
        result_.faces.add(outline, envelope_.plane[facet], envelope_.layer[facet],
                          envelope_.face_above[face], cell);
    }

    const Envelope& envelope_;
    const SurfaceTiling& layer_;
    std::int32_t number_;
    std::vector<std::uint8_t>& whole_;
    ChunkResult& result_;
    PieceFinder finder_;
    PieceGrouping grouping_;
    FacetClipper clipper_;
    std::vector<std::int32_t> group_;
};

}  // namespace

Envelope initial_envelope(const SurfaceTiling& layer, std::int32_t number) {
    Envelope envelope;
    for (std::size_t p = 0; p < layer.plane.size(); ++p) {
        const bool surface = layer.plane[p] >= 0;
        const PlaneId plane = layer.plane[p] == kVoid ? kSky : layer.plane[p];
        envelope.add_facet(layer.polygons[p], plane, surface ? number : -1, surface ? number : -1);
        if (surface) envelope.add_face(layer.polygons[p], kOutsideCell);
    }
    return envelope;
}

Envelope overlay(PlanArrangement& geometry, const Envelope& envelope, const SurfaceTiling& layer,
                 std::int32_t number, Construction& construction, int threads,
                 const Progress* progress) {
    std::vector<std::uint8_t> whole(layer.plane.size(), 1);
    const std::size_t chunks = (envelope.size() + kChunk - 1) / kChunk;
    std::vector<std::unique_ptr<ChunkResult>> results(chunks);
    Envelope next;
    LoweredPieces lowered;
    ChunkJoining joining(results, envelope.size(), construction, next, lowered);
    OrderedCommit commit(geometry, chunks, envelope.size());
    const auto find_place = [&](std::size_t c) { joining.find_place(c); };
    parallel_chunks(chunks, threads, progress, [&](std::size_t c) {
        const std::size_t begin = c * kChunk, end = std::min(envelope.size(), begin + kChunk);
        results[c] = std::make_unique<ChunkResult>(geometry, end - begin);
        FacetOverlay facets(envelope, layer, number, whole, *results[c]);
        for (std::size_t f = begin; f < end; ++f)
            facets.process(f);
        for (const PolygonPool* pool : results[c]->pools())
            mark_used(*results[c]->scope, *pool);
        const auto [first, last] = commit.finished(c, *results[c]->scope, find_place);
        for (std::size_t done = first; done < last; ++done)
            joining.put_where_room(done);
    });
    commit.finish(find_place);
    joining.finish(threads, progress);
    add_surface_facets(layer, whole, lowered, number, next, threads, progress);
    return next;
}

void finish(const Envelope& envelope, std::optional<PlaneId> base, bool is_thick,
            Construction& construction) {
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        const bool based = base.has_value() && envelope.pending[f] == 0;
        std::int32_t cell = kOutsideCell;
        if (based) {
            cell = static_cast<std::int32_t>(construction.cell_block.size());
            construction.cell_block.push_back(0);
            construction.cell_is_thick.push_back(is_thick ? 1 : 0);
            construction.faces.add(envelope.outlines[f], *base, -1, cell, kOutsideCell);
        }
        for (auto g = envelope.face_offsets[f]; g < envelope.face_offsets[f + 1]; ++g) {
            const auto face = static_cast<std::size_t>(g);
            if (cell == kOutsideCell && envelope.face_above[face] == kOutsideCell) continue;
            construction.faces.add(envelope.face_polygons[face], envelope.plane[f],
                                   envelope.layer[f], envelope.face_above[face], cell);
        }
    }
}

}  // namespace realmodel::strata
