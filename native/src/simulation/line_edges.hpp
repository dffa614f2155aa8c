// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "base/index.hpp"
#include "meshing/flat_mesh.hpp"
#include "realmodel/simulation/layered_mesh.hpp"

namespace realmodel::simulation {

/// Which edges of a planar mesh lie on the lines of a model. Edges are named by their nodes, so
/// flips of other edges change nothing.
class LineEdges {
public:
    /// @throws InputError kind bad_index (items: the segment; place) where the mesh lacks the end
    /// of a segment
    LineEdges(const PlanLines& lines, const meshing::FlatMesh& mesh);

    /// The segment that the edge between two nodes lies on, or -1.
    std::int32_t segment(std::int32_t a, std::int32_t b) const {
        if (!is_on_line(a) || !is_on_line(b)) return -1;
        const auto found = segments_.find(unordered(a, b));
        return found == segments_.end() ? -1 : found->second;
    }
    /// Whether an edge lies between triangles whose heights may differ there.
    bool is_step(std::int32_t a, std::int32_t b) const {
        const std::int32_t own = segment(a, b);
        return own >= 0 && lines_->segments[index(own)].is_step;
    }
    /// A node was added, which divides an edge.
    void divide(std::int32_t a, std::int32_t b, std::int32_t middle);

private:
    bool is_on_line(std::int32_t node) const {
        return index(node) < is_on_line_.size() && is_on_line_[index(node)];
    }

    const PlanLines* lines_;
    std::map<std::array<std::int32_t, 2>, std::int32_t> segments_;
    std::vector<bool> is_on_line_;  ///< of each node, or of the first
};

}  // namespace realmodel::simulation
