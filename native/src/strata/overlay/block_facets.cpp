// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/block_facets.hpp"

#include <algorithm>
#include <atomic>

#include "base/parallel.hpp"
#include "strata/overlay/ordered_commit.hpp"
#include "strata/overlay/pieces.hpp"
#include "strata/overlay/shared_polygons.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Facets worked on at a time: fixed, so that the result does not depend on the number of threads.
constexpr std::size_t kChunk = 64;

class FacetOverlay {
public:
    FacetOverlay(const ExactFacets& exact, const SurfaceTiling& layer, std::int32_t number,
                 const BorderEdges& borders, std::vector<std::uint8_t>& is_divided,
                 OverlaidChunk& result)
        : exact_(exact),
          borders_(borders),
          number_(number),
          is_divided_(is_divided),
          result_(result),
          finder_(result.scope, layer),
          clipper_(result.scope) {}

    void process(std::size_t facet) {
        const Envelope& in = exact_.facets;
        const PlaneId plane = in.plane[facet];
        if (plane == kOutside) {
            for (const std::int32_t polygon : finder_.overlapping(in.outlines[facet]))
                divide(polygon);
            keep(facet, in.pending[facet]);
            return;
        }
        const Pieces& pieces = finder_.find_for_split(in.outlines[facet], plane);
        std::size_t below = 0, not_below = 0;
        for (const Piece& piece : pieces.list) {
            below += piece.side == Side::kBelow;
            not_below += piece.side == Side::kNotBelow;
            if (piece.side == Side::kNotBelow) divide(piece.polygon);
        }
        const bool complete = facet < exact_.whole || exact_.is_complete[facet - exact_.whole] != 0;
        if (below == 0 && not_below == 0 && complete) {
            keep(facet, in.pending[facet]);
        } else if (plane == kSky) {
            split_sky(facet, pieces);
        } else if (below == 0 && not_below == pieces.list.size()) {
            keep(facet, number_);
        } else if (below == pieces.list.size() && is_strict(pieces, 0, pieces.touches.size()) &&
                   !borders_.divide(result_.scope, in.outlines[facet], exact_.span[facet])) {
            close(facet, pieces);
        } else {
            split(facet, pieces);
        }
    }

private:
    // Several threads may say so of one polygon at once; they all write the same.
    void divide(std::int32_t polygon) {
        std::atomic_ref<std::uint8_t>(is_divided_[static_cast<std::size_t>(polygon)])
            .store(1, std::memory_order_relaxed);
    }

    static bool is_strict(const Pieces& pieces, std::size_t first, std::size_t last) {
        return std::all_of(pieces.touches.begin() + static_cast<std::ptrdiff_t>(first),
                           pieces.touches.begin() + static_cast<std::ptrdiff_t>(last),
                           [](std::uint8_t touches) { return touches == 0; });
    }

    std::int32_t new_node(std::size_t facet) {
        result_.node_block.push_back(exact_.facets.pending[facet]);
        return static_cast<std::int32_t>(result_.node_block.size()) - 1;
    }

    void lower(const Pieces& pieces, const Piece& piece, std::int32_t node) {
        result_.lowered.push_back({piece.polygon, node,
                                   is_strict(pieces, static_cast<std::size_t>(piece.first),
                                             static_cast<std::size_t>(piece.last))});
        result_.lowered_outlines.add(pieces.outline(piece));
    }

    void keep(std::size_t facet, std::int32_t pending) {
        const Envelope& in = exact_.facets;
        if (facet < exact_.whole) {
            const auto face = static_cast<std::size_t>(in.face_offsets[facet]);
            result_.kept_whole.push_back({in.plane[facet], pending, in.face_above[face]});
        } else {
            result_.kept.add_facet_of(in, facet, pending);
        }
    }

    void split_sky(std::size_t facet, const Pieces& pieces) {
        const Envelope& in = exact_.facets;
        for (const Piece& piece : pieces.list) {
            if (piece.side == Side::kBelow) {
                lower(pieces, piece, kOutsideCell);
            } else {
                result_.kept.add_facet(pieces.outline(piece), kSky, in.layer[facet],
                                       in.pending[facet]);
            }
        }
    }

    /// All of the facet lies above the surface, and nowhere on it.
    void close(std::size_t facet, const Pieces& pieces) {
        const Envelope& in = exact_.facets;
        const std::int32_t node = new_node(facet);
        for (const Piece& piece : pieces.list)
            lower(pieces, piece, node);
        if (facet < exact_.whole) {
            const auto face = static_cast<std::size_t>(in.face_offsets[facet]);
            result_.closed_whole.push_back({in.plane[facet], in.face_above[face], node});
            return;
        }
        for (auto f = in.face_offsets[facet]; f < in.face_offsets[facet + 1]; ++f) {
            const auto face = static_cast<std::size_t>(f);
            result_.faces.add(in.face_polygons[face], in.plane[facet], in.layer[facet],
                              in.face_above[face], node);
        }
    }

    void split(std::size_t facet, const Pieces& pieces) {
        const Envelope& in = exact_.facets;
        if (facet < exact_.whole) result_.divided_whole.push_back(in.plane[facet]);
        for (const Piece& piece : pieces.list) {
            const PolygonView outline = pieces.outline(piece);
            const bool below = piece.side == Side::kBelow;
            const std::int32_t node = below ? new_node(facet) : kOutsideCell;
            if (below) {
                lower(pieces, piece, node);
            } else {
                result_.kept.add_facet(outline, in.plane[facet], in.layer[facet],
                                       piece.side == Side::kNotBelow ? number_ : in.pending[facet]);
            }
            const bool only_one = in.face_offsets[facet + 1] - in.face_offsets[facet] == 1;
            if (!only_one) clipper_.begin(outline);
            for (auto f = in.face_offsets[facet]; f < in.face_offsets[facet + 1]; ++f) {
                const auto face = static_cast<std::size_t>(f);
                // the faces tile the facet, so one alone is the facet
                const PolygonView part =
                    only_one ? outline : clipper_.intersect(in.face_polygons[face]);
                if (part.empty()) continue;
                if (below) {
                    result_.faces.add(part, in.plane[facet], in.layer[facet], in.face_above[face],
                                      node);
                } else {
                    result_.kept.add_face(part, in.face_above[face]);
                }
            }
        }
    }

    const ExactFacets& exact_;
    const BorderEdges& borders_;
    std::int32_t number_;
    std::vector<std::uint8_t>& is_divided_;
    OverlaidChunk& result_;
    PieceFinder finder_;
    FacetClipper clipper_;
};

}  // namespace

std::vector<std::unique_ptr<OverlaidChunk>> overlay_facets(
    PlanArrangement& geometry, const ExactFacets& exact, const SurfaceTiling& layer,
    std::int32_t number, const BorderEdges& borders, std::vector<std::uint8_t>& is_divided,
    int threads, const Progress* progress) {
    const std::size_t count = exact.facets.size(), chunks = (count + kChunk - 1) / kChunk;
    std::vector<std::unique_ptr<OverlaidChunk>> result(chunks);
    OrderedCommit commit(geometry, chunks, count);
    parallel_chunks(chunks, threads, progress, [&](std::size_t c) {
        result[c] = std::make_unique<OverlaidChunk>(geometry);
        FacetOverlay overlay(exact, layer, number, borders, is_divided, *result[c]);
        for (std::size_t f = c * kChunk; f < std::min(count, (c + 1) * kChunk); ++f)
            overlay.process(f);
        for (const PolygonPool* pool : result[c]->pools())
            mark_used(result[c]->scope, *pool);
        commit.finished(c, result[c]->scope);
    });
    commit.finish();
    return result;
}

}  // namespace realmodel::strata
