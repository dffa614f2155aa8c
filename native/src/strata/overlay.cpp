// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <atomic>
#include <memory>

#include "envelope.hpp"
#include "parallel_chunks.hpp"
#include "pieces.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

/// Facets worked on at a time: fixed, so that the result does not depend on the number of threads.
constexpr std::size_t kChunk = 256;

/// A piece of the surface that becomes part of the envelope.
struct LoweredPiece {
    std::int32_t polygon;     ///< of the layer
    std::int32_t cell_above;  ///< counted within the chunk, or kOutsideCell
};

/// What one chunk of facets became. Lines and points are the scope's, cells are counted from 0.
struct ChunkResult {
    explicit ChunkResult(const PlanGeometry& geometry) : scope(geometry) {}

    Scope scope;
    std::vector<std::int32_t> cell_block;
    FaceList faces;  ///< finished; above is a shared cell, below one of the chunk's
    PolygonPool lowered_outlines;
    std::vector<LoweredPiece> lowered;
    Envelope kept;
};

/// Works on the facets of one chunk.
class FacetOverlay {
public:
    FacetOverlay(const Envelope& envelope, const Layer& layer, std::int32_t number,
                 std::vector<std::uint8_t>& whole, ChunkResult& result)
        : envelope_(envelope),
          layer_(layer),
          number_(number),
          whole_(whole),
          result_(result),
          finder_(result.scope, layer),
          grouping_(result.scope, layer),
          clipper_(result.scope) {}

    void process(std::size_t facet) {
        const PolygonView outline = envelope_.outlines[facet];
        const PlaneId plane = envelope_.plane[facet];
        if (plane == kOutside) {
            for (const std::int32_t polygon : finder_.overlapping(outline))
                leave_in_parts(polygon);
            keep(facet, envelope_.pending[facet]);
            return;
        }
        const Pieces& pieces = finder_.find(outline, plane);
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
        result_.cell_block.insert(result_.cell_block.end(), static_cast<std::size_t>(cells),
                                  envelope_.pending[facet]);
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
            for (std::size_t f = begin; f < end; ++f) {
                const PolygonView part = clipper_.intersect(envelope_.face_polygons[f], outline);
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
    const Layer& layer_;
    std::int32_t number_;
    std::vector<std::uint8_t>& whole_;
    ChunkResult& result_;
    PieceFinder finder_;
    PieceGrouping grouping_;
    Clipper clipper_;
    std::vector<std::int32_t> group_;
};

Polygon shared_polygon(Scope& scope, PolygonView polygon) {
    Polygon result(polygon.begin(), polygon.end());
    for (Corner& corner : result) {
        corner = {scope.shared_point(corner.point), scope.shared_directed(corner.line)};
    }
    return result;
}

/// The lowered pieces of all chunks, under shared ids.
struct LoweredPieces {
    PolygonPool outlines;
    std::vector<std::int32_t> polygon;
    std::vector<std::int32_t> cell_above;
};

void append(PlanGeometry& geometry, ChunkResult& chunk, Construction& construction, Envelope& next,
            LoweredPieces& lowered) {
    chunk.scope.hand_over(geometry);
    const auto cell_count = static_cast<std::int64_t>(construction.cell_block.size());
    if (cell_count + static_cast<std::int64_t>(chunk.cell_block.size()) > INT32_MAX) {
        throw InputError("too_large",
                         "the model has more than 2147 million cells; use coarser surfaces");
    }
    const auto first_cell = static_cast<std::int32_t>(cell_count);
    construction.cell_block.insert(construction.cell_block.end(), chunk.cell_block.begin(),
                                   chunk.cell_block.end());
    const auto shared_cell = [&](std::int32_t cell) {
        return cell == kOutsideCell ? cell : cell + first_cell;
    };
    for (std::size_t f = 0; f < chunk.faces.size(); ++f) {
        construction.faces.add(shared_polygon(chunk.scope, chunk.faces.polygons[f]),
                               chunk.faces.plane[f], chunk.faces.layer[f], chunk.faces.above[f],
                               shared_cell(chunk.faces.below[f]));
    }
    for (std::size_t i = 0; i < chunk.lowered.size(); ++i) {
        lowered.outlines.add(shared_polygon(chunk.scope, chunk.lowered_outlines[i]));
        lowered.polygon.push_back(chunk.lowered[i].polygon);
        lowered.cell_above.push_back(shared_cell(chunk.lowered[i].cell_above));
    }
    const Envelope& kept = chunk.kept;
    for (std::size_t f = 0; f < kept.size(); ++f) {
        next.add_facet(shared_polygon(chunk.scope, kept.outlines[f]), kept.plane[f], kept.layer[f],
                       kept.pending[f]);
        for (auto g = kept.face_offsets[f]; g < kept.face_offsets[f + 1]; ++g) {
            const auto face = static_cast<std::size_t>(g);
            next.add_face(shared_polygon(chunk.scope, kept.face_polygons[face]),
                          kept.face_above[face]);
        }
    }
}

/// The surface's own facets: a polygon that lies below the envelope all over becomes one facet
/// again, so that the overlay does not compound; of others each piece is a facet.
void add_surface_facets(const Layer& layer, const std::vector<std::uint8_t>& whole,
                        const LoweredPieces& lowered, std::int32_t number, Envelope& next,
                        const Progress* progress) {
    std::vector<std::int64_t> offsets(layer.plane.size() + 1, 0);
    for (const std::int32_t p : lowered.polygon)
        ++offsets[static_cast<std::size_t>(p) + 1];
    for (std::size_t p = 0; p < layer.plane.size(); ++p)
        offsets[p + 1] += offsets[p];
    std::vector<std::size_t> of_polygon(lowered.polygon.size());
    {
        auto free = offsets;
        for (std::size_t i = 0; i < lowered.polygon.size(); ++i) {
            of_polygon[static_cast<std::size_t>(
                free[static_cast<std::size_t>(lowered.polygon[i])]++)] = i;
        }
    }
    for (std::size_t p = 0; p < layer.plane.size(); ++p) {
        poll(progress, p);
        const auto begin = static_cast<std::size_t>(offsets[p]);
        const auto end = static_cast<std::size_t>(offsets[p + 1]);
        if (begin == end) continue;
        const bool open =
            std::all_of(of_polygon.begin() + offsets[p], of_polygon.begin() + offsets[p + 1],
                        [&](std::size_t i) { return lowered.cell_above[i] == kOutsideCell; });
        if (whole[p]) {
            next.add_facet(layer.polygons[p], layer.plane[p], number, number);
            if (open) {  // nothing above needs the pieces
                next.add_face(layer.polygons[p], kOutsideCell);
                continue;
            }
        }
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t piece = of_polygon[i];
            if (!whole[p]) next.add_facet(lowered.outlines[piece], layer.plane[p], number, number);
            next.add_face(lowered.outlines[piece], lowered.cell_above[piece]);
        }
    }
}

}  // namespace

Envelope initial_envelope(const Layer& layer, std::int32_t number) {
    Envelope envelope;
    for (std::size_t p = 0; p < layer.plane.size(); ++p) {
        const bool surface = layer.plane[p] >= 0;
        const PlaneId plane = layer.plane[p] == kVoid ? kSky : layer.plane[p];
        envelope.add_facet(layer.polygons[p], plane, surface ? number : -1, surface ? number : -1);
        if (surface) envelope.add_face(layer.polygons[p], kOutsideCell);
    }
    return envelope;
}

Envelope overlay(PlanGeometry& geometry, const Envelope& envelope, const Layer& layer,
                 std::int32_t number, Construction& construction, int threads,
                 const Progress* progress) {
    std::vector<std::uint8_t> whole(layer.plane.size(), 1);
    const std::size_t chunks = (envelope.size() + kChunk - 1) / kChunk;
    std::vector<std::unique_ptr<ChunkResult>> results(chunks);
    parallel_chunks(chunks, threads, progress, [&](std::size_t c) {
        results[c] = std::make_unique<ChunkResult>(geometry);
        FacetOverlay facets(envelope, layer, number, whole, *results[c]);
        for (std::size_t f = c * kChunk; f < std::min(envelope.size(), (c + 1) * kChunk); ++f) {
            facets.process(f);
        }
    });
    Envelope next;
    LoweredPieces lowered;
    for (auto& chunk : results) {
        if (progress != nullptr) progress->check();
        append(geometry, *chunk, construction, next, lowered);
        chunk.reset();
    }
    add_surface_facets(layer, whole, lowered, number, next, progress);
    return next;
}

void finish(const Envelope& envelope, std::optional<PlaneId> base, Construction& construction) {
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        const bool based = base.has_value() && envelope.pending[f] == 0;
        std::int32_t cell = kOutsideCell;
        if (based) {
            cell = static_cast<std::int32_t>(construction.cell_block.size());
            construction.cell_block.push_back(0);
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
