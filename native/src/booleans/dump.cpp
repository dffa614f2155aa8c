// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/dump.hpp"

#include "base/obj_file.hpp"

// Named when a program is linked (native/cmake/Fuzzing.cmake), so that it contains this file
// although it never calls it.
extern "C" {
extern const int realmodel_dump_pieces;
const int realmodel_dump_pieces = 1;
}

namespace realmodel::booleans {

void dump_pieces(const TrianglePieces& pieces, const char* path) {
    ObjFile file(path);
    for (std::size_t p = 0; p < pieces.points.size(); ++p)
        file.add_vertex(pieces.points.rounded(SpacePointId(p)));
    for (const std::uint8_t source : {0, 1}) {
        for (const bool fresh : {false, true}) {
            file.begin_group(std::string(source == 0 ? "P" : "Q") + (fresh ? "_fresh" : ""));
            for (std::size_t i = 0; i < pieces.input_count(); ++i) {
                const auto input = static_cast<std::int32_t>(i);
                if (pieces.source(input) != source) continue;
                for (const TrianglePiece& piece : pieces.of(input)) {
                    if (piece.is_fresh != fresh) continue;
                    std::array<std::int32_t, 3> corners;
                    for (std::size_t k = 0; k < 3; ++k)
                        corners[k] = piece.corners[k].number();
                    file.add_face(corners);
                }
            }
        }
    }
}

}  // namespace realmodel::booleans
