// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "realmodel/strata/stack.hpp"

namespace realmodel::fuzz {

/// The bytes of arrays in one number (FNV-1a, 64 bits).
class Digest {
public:
    /// Any container of numbers, or of arrays of them, that lies in one piece.
    template <class Array>
    Digest& add(const Array& array) {
        const std::uint64_t count = array.size();
        add_bytes(&count, sizeof count);
        if (count > 0) add_bytes(array.data(), count * sizeof array[0]);
        return *this;
    }
    std::uint64_t value() const { return sum_; }

private:
    void add_bytes(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i)
            sum_ = (sum_ ^ bytes[i]) * 0x100000001b3U;
    }

    std::uint64_t sum_ = 0xcbf29ce484222325U;
};

/// Of all arrays of a model.
inline std::uint64_t digest(const strata::CellComplex& c) {
    return Digest()
        .add(c.vertices)
        .add(c.face_offsets)
        .add(c.face_vertices)
        .add(c.face_cells)
        .add(c.face_surface)
        .add(c.cell_block)
        .add(c.volumes)
        .value();
}

}  // namespace realmodel::fuzz
