// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/facet_overlay.hpp"

#include <algorithm>
#include <cassert>
#include <memory>

#include "base/parallel_counts.hpp"
#include "strata/overlay/chunk_joining.hpp"
#include "strata/overlay/pieces.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Facets worked on at a time: fixed, so that the result does not depend on the number of threads.
/// More find fewer points twice, on the edges between chunks, but have to stay in the cache. Of
/// blocks few facets are left over, and some take long.
constexpr std::size_t kColumnFacets = 1024, kBlockFacets = 64;

/// Works on the facets of one chunk.
class FacetOverlay {
public:
    FacetOverlay(const Envelope& envelope, const NumberedTiling& surface, const BlockFacets* blocks,
                 const WantedBoxes* wanted, Overlaid& overlaid, ChunkResult& result)
        : envelope_(envelope),
          tiling_(surface.tiling),
          number_(surface.number),
          blocks_(blocks),
          wanted_(wanted),
          overlaid_(overlaid),
          result_(result),
          finder_(*result.scope, tiling_),
          grouping_(*result.scope, tiling_),
          clipper_(*result.scope) {}

    void process(std::size_t facet) {
        const PolygonView outline = envelope_.outlines[facet];
        const PlaneId plane = envelope_.plane[facet];
        if (plane == kOutside) {
            for (const std::int32_t polygon : finder_.overlapping(outline))
                atomic_set(overlaid_.is_divided[index(polygon)]);
            result_.remaining.add_facet_of(envelope_, facet, envelope_.block_beneath[facet]);
            return;
        }
        const Pieces& pieces = finder_.find(outline, plane, true);
        std::size_t below = 0, not_below = 0;
        for (const Piece& piece : pieces.list) {
            below += piece.side == PieceSide::kBelow;
            not_below += piece.side == PieceSide::kNotBelow;
            if (piece.side == PieceSide::kNotBelow)
                atomic_set(overlaid_.is_divided[index(piece.polygon)]);
        }
        const bool is_complete = blocks_ == nullptr || blocks_->is_complete[facet] != 0;
        const bool all_below = below == pieces.list.size();
        if (below == 0 && not_below == 0 && is_complete) {
            result_.remaining.add_facet_of(envelope_, facet, envelope_.block_beneath[facet]);
        } else if (plane == kSky) {
            split_sky(facet, pieces);
        } else if (below == 0 && not_below == pieces.list.size()) {
            result_.remaining.add_facet_of(envelope_, facet, number_);
        } else if (all_below && is_one_node(facet, pieces)) {
            close(facet, pieces);
        } else {
            const std::int32_t nodes = below == 0 ? 0 : group(outline, pieces);
            if (blocks_ == nullptr && all_below && nodes == 1) {
                close(facet, pieces);
            } else {
                split(facet, pieces, nodes);
            }
        }
    }

private:
    /// Whether any of what is between a facet and the pieces below it is.
    bool is_wanted(std::size_t facet, const Pieces& pieces) {
        if (wanted_ == nullptr) return true;
        spatial::Box box =
            box_of(*result_.scope, envelope_.outlines[facet], envelope_.plane[facet]);
        for (const Piece& piece : pieces.list) {
            if (piece.side != PieceSide::kBelow) continue;
            const HeightRange heights = tiling_.heights[static_cast<std::size_t>(piece.polygon)];
            box.low[2] = std::min(box.low[2], heights.low);
        }
        return wanted_->any_in(box);
    }

    /// Whether pieces below make one node without looking at their edges: nowhere as high as the
    /// facet, of triangles that go on in others all around; or over a block, undivided by a border.
    bool is_one_node(std::size_t facet, const Pieces& pieces) {
        if (std::find(pieces.touches.begin(), pieces.touches.end(), 1) != pieces.touches.end())
            return false;
        if (blocks_ != nullptr) {
            return !blocks_->borders->divide(*result_.scope, envelope_.outlines[facet],
                                             blocks_->span[facet]);
        }
        return std::all_of(pieces.list.begin(), pieces.list.end(), [&](const Piece& piece) {
            return tiling_.runs_on[static_cast<std::size_t>(piece.polygon)] != 0;
        });
    }

    /// Finds the node of each piece below, counted from 0; how many there are.
    std::int32_t group(PolygonView outline, const Pieces& pieces) {
        if (blocks_ == nullptr) return grouping_.group(outline, pieces, group_);
        group_.clear();
        std::int32_t nodes = 0;
        for (const Piece& piece : pieces.list)
            group_.push_back(piece.side == PieceSide::kBelow ? nodes++ : -1);
        return nodes;
    }

    void add_below(const Pieces& pieces, const Piece& piece, std::int32_t node) {
        result_.below.push_back({piece.polygon, node});
        result_.below_outlines.add(pieces.outline(piece));
        if (blocks_ == nullptr) return;
        const auto touches = pieces.touches.begin();
        if (std::find(touches + piece.first, touches + piece.last, 1) != touches + piece.last)
            atomic_set(overlaid_.is_touched[index(piece.polygon)]);
    }

    void split_sky(std::size_t facet, const Pieces& pieces) {
        for (const Piece& piece : pieces.list) {
            if (piece.side == PieceSide::kBelow) {
                add_below(pieces, piece, kOutsideCell);
            } else {
                result_.remaining.add_facet(pieces.outline(piece), kSky, envelope_.surface[facet],
                                            envelope_.block_beneath[facet]);
            }
        }
    }

    /// Adds nodes beneath a facet; the first of them.
    std::int32_t add_nodes(std::size_t facet, std::int32_t count, bool is_thick) {
        const std::size_t first = result_.node_block.size(),
                          end = first + static_cast<std::size_t>(count);
        check_nodes(static_cast<std::int64_t>(end));
        result_.node_block.resize(end, envelope_.block_beneath[facet]);
        result_.node_is_thick.resize(end, is_thick ? 1 : 0);
        return static_cast<std::int32_t>(first);
    }

    /// All of the facet lies above the surface, and one node is between them.
    void close(std::size_t facet, const Pieces& pieces) {
        const bool is_thick = blocks_ != nullptr || pieces.is_clear;
        std::int32_t node = is_thick ? kOutsideCell : kLeftOut;
        if (is_wanted(facet, pieces)) node = add_nodes(facet, 1, is_thick);
        const auto [begin, end] = envelope_.faces_of(facet);
        if (node >= 0) {
            const auto& offsets = envelope_.face_polygons.offsets;
            result_.closed.push_back(
                {static_cast<std::uint32_t>(facet), node, result_.faces.size()});
            result_.closed_faces += end - begin;
            result_.closed_corners += offsets[end] - offsets[begin];
        } else {
            for (std::size_t f = begin; f < end; ++f)
                seal(facet, f, envelope_.face_polygons[f], node);
        }
        for (const Piece& piece : pieces.list)
            add_below(pieces, piece, node);
    }

    void split(std::size_t facet, const Pieces& pieces, std::int32_t nodes) {
        const bool wanted = nodes > 0 && is_wanted(facet, pieces);
        const std::int32_t first_node = add_nodes(facet, wanted ? nodes : 0, false);
        const auto [begin, end] = envelope_.faces_of(facet);
        for (std::size_t i = 0; i < pieces.list.size(); ++i) {
            const Piece& piece = pieces.list[i];
            const PolygonView outline = pieces.outline(piece);
            const bool below = piece.side == PieceSide::kBelow;
            const std::int32_t node = wanted ? first_node + group_[i] : kLeftOut;
            if (below) {
                add_below(pieces, piece, node);
            } else {
                result_.remaining.add_facet(
                    outline, envelope_.plane[facet], envelope_.surface[facet],
                    piece.side == PieceSide::kNotBelow ? number_ : envelope_.block_beneath[facet]);
            }
            const bool only_one = end - begin == 1;  // then it is the facet
            if (!only_one) clipper_.begin(outline);
            for (std::size_t f = begin; f < end; ++f) {
                const PolygonView clipped =
                    only_one ? outline : clipper_.intersect(envelope_.face_polygons[f]);
                if (clipped.empty()) continue;
                if (below) {
                    seal(facet, f, clipped, node);
                } else {
                    result_.remaining.add_face(clipped, envelope_.face_above[f]);
                }
            }
        }
    }

    /// Finishes a face of the facet: the node beneath it is known now.
    void seal(std::size_t facet, std::size_t face, PolygonView outline, std::int32_t node) {
        if (node < 0 && envelope_.face_above[face] < 0) return;
        result_.faces.add(outline, envelope_.plane[facet], envelope_.surface[facet],
                          envelope_.face_above[face], node);
    }

    const Envelope& envelope_;
    const SurfaceTiling& tiling_;
    std::int32_t number_;
    const BlockFacets* blocks_;
    const WantedBoxes* wanted_;
    Overlaid& overlaid_;
    ChunkResult& result_;
    PieceFinder finder_;
    PieceGrouping grouping_;
    Clipper clipper_;
    std::vector<std::int32_t> group_;
};

}  // namespace

Overlaid overlay_facets(PlanArrangement& geometry, const Envelope& envelope,
                        const NumberedTiling& surface, const BlockFacets* blocks,
                        const WantedBoxes* wanted, Construction& construction,
                        const Execution& execution) {
    assert(blocks == nullptr || wanted == nullptr);
    assert(blocks == nullptr || (blocks->span.size() == envelope.size() &&
                                 blocks->is_complete.size() == envelope.size()));
    Overlaid overlaid;
    overlaid.is_divided.resize(surface.tiling.plane.size());
    if (blocks != nullptr) overlaid.is_touched.resize(surface.tiling.plane.size());
    const std::size_t size = blocks == nullptr ? kColumnFacets : kBlockFacets;
    const std::size_t chunks = (envelope.size() + size - 1) / size;
    std::vector<std::unique_ptr<ChunkResult>> results(chunks);
    ChunkJoining joining(results, envelope, construction, overlaid.remaining, overlaid.below);
    OrderedCommit commit(geometry, chunks, envelope.size());
    const auto find_offset = [&](std::size_t c) { joining.find_offset(c); };
    parallel_chunks(chunks, execution, [&](std::size_t c) {
        const std::size_t begin = c * size, end = std::min(envelope.size(), begin + size);
        results[c] = std::make_unique<ChunkResult>(geometry, end - begin);
        FacetOverlay facets(envelope, surface, blocks, wanted, overlaid, *results[c]);
        for (std::size_t f = begin; f < end; ++f)
            facets.process(f);
        for (const PolygonPool* pool : results[c]->pools())
            mark_used(*results[c]->scope, *pool);
        const auto [first, last] = commit.finished(c, *results[c]->scope, find_offset);
        for (std::size_t done = first; done < last; ++done)
            joining.put_where_room(done);
    });
    commit.finish(find_offset);
    joining.finish(execution);
    return overlaid;
}

Envelope overlay_columns(PlanArrangement& geometry, Envelope envelope,
                         const NumberedTiling& surface, Construction& construction,
                         const WantedBoxes* wanted, const Execution& execution) {
    Overlaid overlaid =
        overlay_facets(geometry, envelope, surface, nullptr, wanted, construction, execution);
    envelope = {};
    const PiecesOfPolygons pieces =
        sort_by_polygon(overlaid.below, surface.tiling.plane.size(), execution);
    add_surface_facets(surface, overlaid.is_divided, overlaid.below, pieces, overlaid.remaining,
                       execution);
    return std::move(overlaid.remaining);
}

}  // namespace realmodel::strata
