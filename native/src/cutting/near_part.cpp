// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/near_part.hpp"

namespace realmodel::cutting {

NearPart::NearPart(const ComplexView& model, std::span<const std::uint8_t> is_near)
    : model_(model) {
    std::vector<std::int32_t> number(model.cell_count(), -1);
    for (std::int32_t c = 0; index(c) < number.size(); ++c) {
        if (is_near[index(c)] == 0) continue;
        number[index(c)] = static_cast<std::int32_t>(cells_.size());
        cells_.push_back(c);
        cell_block_.push_back(model.cell_block[index(c)]);
    }
    std::vector<NodeId> own_vertex(model.vertex_count(), -1);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        std::array<std::int32_t, 2> own{-1, -1};
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) own[k] = number[index(model.cell(f, k))];
        }
        if (own[0] < 0 && own[1] < 0) continue;
        const auto corners = model.face(f);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const NodeId v = corners[own[0] >= 0 ? i : corners.size() - 1 - i];
            if (own_vertex[index(v)] < 0) {
                own_vertex[index(v)] = static_cast<NodeId>(vertices_.size());
                vertices_.push_back(model.vertex(v));
                vertices_of_.push_back(v);
            }
            face_vertices_.push_back(own_vertex[index(v)]);
        }
        face_offsets_.push_back(static_cast<std::int64_t>(face_vertices_.size()));
        face_cells_.push_back(own[0] >= 0 ? own[0] : own[1]);
        face_cells_.push_back(own[0] >= 0 ? own[1] : -1);
        face_surface_.push_back(model.face_surface[f]);
        faces_.push_back(static_cast<std::int32_t>(f));
        beyond_.push_back(own[0] < 0 ? model.cell(f, 0) : own[1] < 0 ? model.cell(f, 1) : -1);
    }
}

ComplexView NearPart::view() const {
    ComplexView view = model_;
    view.vertices = {reinterpret_cast<const double*>(vertices_.data()), 3 * vertices_.size()};
    view.face_offsets = face_offsets_;
    view.face_vertices = face_vertices_;
    view.face_cells = face_cells_;
    view.face_surface = face_surface_;
    view.cell_block = cell_block_;
    return view;
}

}  // namespace realmodel::cutting
