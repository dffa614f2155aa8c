// SPDX-License-Identifier: GPL-3.0-or-later
// The CGAL triangulation behind meshing. Private: CGAL stays out of the public headers.
#pragma once

#include "exact/cgal_kernel.hpp"
// CGAL
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Triangulation_data_structure_2.h>
#include <CGAL/Triangulation_vertex_base_2.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// A vertex that knows the number of its input point (-1: made by refinement). The time stamp makes
/// CGAL order vertices by when they were made and not by address, so that runs repeat.
template <class Traits, class Base = CGAL::Triangulation_vertex_base_2<Traits>>
class NumberedVertex : public Base {
public:
    template <class Tds>
    struct Rebind_TDS {
        using Other = NumberedVertex<Traits, typename Base::template Rebind_TDS<Tds>::Other>;
    };
    using Base::Base;

    using Has_timestamp = CGAL::Tag_true;
    std::size_t time_stamp() const { return stamp_; }
    void set_time_stamp(std::size_t value) { stamp_ = value; }

    std::int32_t number = -1;

private:
    std::size_t stamp_ = 0;
};

// Faces of the mesher's kind are stamped too, and say whether they belong to the region.
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<NumberedVertex<Kernel>,
                                         CGAL::Delaunay_mesh_face_base_2<Kernel>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

/// What becomes of a point that is there already: refused, or it is the same vertex, which keeps
/// the lesser number.
enum class Repeated : std::uint8_t { kRefuse, kJoin };

/// Inserts points in the order of a space-filling curve; returns the vertex of each.
/// @throws InputError "repeated_point", "not_finite".
std::vector<Cdt::Vertex_handle> insert_points(Cdt& cdt, std::span<const PlanPoint> points,
                                              const Check& check,
                                              Repeated repeated = Repeated::kRefuse);

/// Inserts segments between points inserted before. Those that cross one before them are left out
/// and listed in `refused`, or refused where that is null.
/// @throws InputError "crossing", "bad_index".
void insert_segments(Cdt& cdt, std::span<const Cdt::Vertex_handle> vertices,
                     std::span<const VertexSegment> segments, const Check& check,
                     std::vector<std::size_t>* refused = nullptr);

/// ConstrainedTriangulation::covered, once all segments are inserted.
std::vector<CoveredEdge> covered_edges(const Cdt& cdt, std::span<const Cdt::Vertex_handle> vertices,
                                       std::span<const VertexSegment> segments);

/// The finite faces by number; each starts with its least vertex, in the order of their vertices.
ConstrainedTriangulation numbered_triangles(const Cdt& cdt);

}  // namespace realmodel::meshing
