// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/dump.hpp"

#include <algorithm>

#include "base/obj_file.hpp"

// Named when a program is linked, as realmodel_dump is (strata/dump.cpp).
extern "C" {
extern const int realmodel_cutting_dump;
const int realmodel_cutting_dump = 1;
}

namespace realmodel::cutting {

void dump_parts(const RoundedParts& parts, const char* path) {
    ObjFile file(path);
    for (std::size_t n = 0; n < parts.vertices.size() + parts.new_positions.size(); ++n)
        file.add_vertex(parts.at(static_cast<NodeId>(n)));
    for (std::size_t part = 0; part < parts.half_cells.size(); ++part) {
        file.begin_group("part_" + std::to_string(part));
        for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
            for (std::size_t k = 0; k < 2; ++k) {
                if (parts.pieces[p].parts[k] != static_cast<std::int32_t>(part)) continue;
                const auto polygon = parts.pieces.polygons[p];
                std::vector<NodeId> nodes(polygon.begin(), polygon.end());
                if (k == 1) std::ranges::reverse(nodes);
                file.add_face(nodes);
            }
        }
    }
}

}  // namespace realmodel::cutting
