// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "cutter_surface.hpp"
#include "halves.hpp"
#include "overlay.hpp"
#include "strata/disjoint_parts.hpp"

namespace realmodel::cutting {

/// Cuts a model by a surface: faces near it and its triangles are overlaid exactly; the surface's
/// regions are the caps of the cells that they lie in; the faces and caps that meet round an edge
/// tell the parts of cells, and the caps their sides.
class SurfaceCut {
public:
    SurfaceCut(const ComplexView& model, const CutterSurface& surface, int threads,
               Progress* progress)
        : model_(model),
          surface_(surface),
          threads_(threads),
          progress_(progress),
          overlay_(points_),
          vertex_node_(model.vertex_count(), -1) {}

    Cut cut();

private:
    /// A region or a face that is no part of the overlay, seen along one of its edges.
    struct Use {
        std::array<NodeId, 2> edge;  ///< lesser, greater
        std::int32_t item;           ///< region, or face after all regions
        std::int8_t direction;       ///< 1 from lesser to greater, -1 back
        auto operator<=>(const Use&) const = default;
    };
    struct CellUse {
        std::int32_t cell;
        Use use;
        auto operator<=>(const CellUse&) const = default;
    };

    // surface_overlay.cpp: what meets what
    void find_active_faces();
    void name_vertices();
    std::optional<NodeId> place_on_surface(const Position& p);
    void overlay_all();
    void name_nodes();

    // surface_cut.cpp: cells, parts, sides
    bool is_cap_region(std::size_t r) const {
        return overlay_.regions()[r].triangle >= first_cutter_;
    }
    const std::vector<Region>& regions() const { return overlay_.regions(); }
    std::size_t item_of_face(std::size_t f) const { return regions().size() + f; }
    void find_level_regions();
    void locate_caps();
    NodeId exact_node(NodeId node);
    NodeId far_corner(std::size_t face, const std::array<NodeId, 2>& edge) const;
    std::vector<std::size_t> round_edge(std::span<const Use> uses);
    std::int32_t cell_after(const Use& use) const;
    std::int32_t cell_around(const Position& p) const;
    void join_parts();
    void join_round_edge(std::span<const CellUse> uses);
    void attach_hollows();
    void label_parts();
    [[noreturn]] void refuse_open(std::size_t region) const;

    // surface_pieces.cpp: polygons
    void make_pieces();
    void make_face_pieces(std::size_t face, std::span<const std::int32_t> own);
    void add_piece(std::span<const std::vector<NodeId>> loops, const Position& normal,
                   std::int32_t face, std::int32_t region);
    void number_cells();
    void make_distinct();
    std::array<bool, 2> verify() const;
    Position position(NodeId node) const {
        const auto vertices = static_cast<NodeId>(model_.vertex_count());
        return node < vertices ? model_.vertex(node) : new_positions_[index(node - vertices)];
    }

    std::size_t slot(std::int32_t item, std::size_t which) const { return 2 * index(item) + which; }

    const ComplexView& model_;
    const CutterSurface& surface_;
    int threads_;
    Progress* progress_;

    ExactPoints points_;
    Overlay overlay_;
    std::unique_ptr<BoxTree> tree_;
    double margin_ = 0;
    std::vector<std::uint8_t> active_;
    std::vector<std::int32_t> active_faces_;
    std::vector<NodeId> vertex_node_;    ///< of the model's vertices, -1 away from the surface
    std::vector<std::int32_t> face_of_;  ///< of the model's triangles in the overlay
    std::int32_t first_cutter_ = 0;      ///< the overlay's first triangle of the surface
    std::vector<NodeId> out_;            ///< of exact points: the model's vertex, or a new node
    std::vector<NodeId> exact_of_new_;   ///< the exact point of each new node
    std::vector<Position> new_positions_;
    std::vector<std::vector<std::vector<NodeId>>> loops_;  ///< of regions, in nodes of the result

    std::vector<std::int32_t> level_;      ///< region of the surface that a face's region lies on
    std::vector<std::int8_t> level_turn_;  ///< 1 where both turn the same way
    std::vector<std::uint8_t> used_up_;    ///< regions of the surface that lie on faces
    std::vector<std::int32_t> cap_cell_;   ///< by region: the cell that it lies in, -1 none
    std::vector<Use> uses_;             ///< of edges of the surface's regions, all that meet there
    std::vector<std::uint8_t> is_cut_;  ///< by cell
    std::unique_ptr<strata::DisjointParts> sets_;
    std::vector<std::int8_t> side_;  ///< by slot of a set's least member
    Pieces pieces_;
    PieceParts parts_;
    std::vector<HalfCell> half_cells_;
    std::vector<std::array<NodeId, 2>> barriers_;
};

}  // namespace realmodel::cutting
