// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/dump.hpp"

#include "base/obj_file.hpp"

// Named when a program is linked (native/cmake/Fuzzing.cmake), so that it contains this file
// although it never calls it.
extern "C" {
extern const int realmodel_dump_regions;
const int realmodel_dump_regions = 1;
}

namespace realmodel::arrangement {

void dump_regions(const exact::SpacePoints& points, const TriangleArrangement& arrangement,
                  const char* path) {
    ObjFile file(path);
    std::int32_t last = -1;
    for (std::size_t r = 0; r < arrangement.regions().size(); ++r) {
        const Region region = arrangement.regions()[r];
        if (region.triangle != last) {
            file.begin_group("triangle_" + std::to_string(region.triangle));
            last = region.triangle;
        }
        char kind = 'f';
        for (const auto loop : region.loops) {
            std::vector<Position> corners;
            for (const SpacePointId p : loop)
                corners.push_back(points.rounded(p));
            if (kind == 'l') corners.push_back(corners.front());
            file.add(kind, corners);
            kind = 'l';
        }
    }
}

}  // namespace realmodel::arrangement
