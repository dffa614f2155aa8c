// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/face_lists.hpp"

#include <algorithm>
#include <string>

#include "base/index.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

[[noreturn]] void refuse(std::int64_t number, const char* what) {
    throw InputError("bad_index", std::string(what) + ": " + std::to_string(number), -1, {number});
}

std::span<const std::int32_t> loop_of(const FaceLoops& faces, std::int64_t face) {
    if (face < 0 || face + 1 >= static_cast<std::int64_t>(faces.offsets.size()))
        refuse(face, "there is no such face");
    const std::int64_t begin = faces.offsets[index(face)], end = faces.offsets[index(face + 1)];
    if (begin < 0 || begin >= end || end > static_cast<std::int64_t>(faces.vertices.size()))
        refuse(face, "the face has corners that do not exist");
    return faces.vertices.subspan(index(begin), index(end - begin));
}

}  // namespace

CellDescriptions describe_cells(const FaceLoops& faces, std::span<const std::int64_t> begin,
                                std::span<const std::int64_t> sides) {
    CellDescriptions made;
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
        if (begin[c] < 0 || begin[c] > begin[c + 1] ||
            begin[c + 1] > static_cast<std::int64_t>(sides.size()))
            refuse(static_cast<std::int64_t>(c), "the cell has sides that do not exist");
        const std::size_t first = made.vertices.size();
        made.faces.push_back(begin[c + 1] - begin[c]);
        for (const std::int64_t side :
             sides.subspan(index(begin[c]), index(begin[c + 1] - begin[c]))) {
            const auto loop = loop_of(faces, side >> 1);
            made.faces.push_back(static_cast<std::int64_t>(loop.size()));
            if ((side & 1) == 0) {
                for (const std::int32_t v : loop)
                    made.faces.push_back(v);
            } else {
                for (std::size_t i = loop.size(); i-- > 0;)
                    made.faces.push_back(loop[i]);
            }
            for (const std::int32_t v : loop)
                made.vertices.push_back(v);
        }
        std::int64_t* const own = made.vertices.data() + first;
        std::sort(own, made.vertices.data() + made.vertices.size());
        const auto count = static_cast<std::size_t>(
            std::unique(own, made.vertices.data() + made.vertices.size()) - own);
        made.vertices.resize(first + count);
        made.counts.push_back(static_cast<std::int64_t>(count));
    }
    return made;
}

OrderedFaces ordered_faces(const FaceLoops& faces, std::span<const std::int64_t> order,
                           std::span<const std::uint8_t> turned) {
    if (turned.size() != order.size())
        refuse(static_cast<std::int64_t>(turned.size()), "turned: one for each face, not");
    OrderedFaces made;
    made.offsets.push_back(0);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto loop = loop_of(faces, order[i]);
        made.vertices.push_back(loop[0]);
        if (turned[i] == 0) {
            for (const std::int32_t v : loop.subspan(1))
                made.vertices.push_back(v);
        } else {
            for (std::size_t k = loop.size(); k-- > 1;)
                made.vertices.push_back(loop[k]);
        }
        made.offsets.push_back(checked_number(made.vertices.size(), "corners of faces"));
    }
    return made;
}

}  // namespace realmodel::simulation
