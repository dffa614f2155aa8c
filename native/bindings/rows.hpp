// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of NumPy arrays as the native parts take them.
#pragma once

#include <array>
#include <span>

#include "arrays.hpp"

namespace realmodel::bindings {

/// The rows of an array (any, N) as they lie in NumPy's memory.
/// @throws ValueError naming the argument and both shapes
template <std::size_t N, class T>
std::span<const std::array<T, N>> rows(const NumpyArray<T>& array, const char* argument) {
    require_columns(array, N, argument);
    static_assert(sizeof(std::array<T, N>) == N * sizeof(T));
    return {reinterpret_cast<const std::array<T, N>*>(array.data()),
            static_cast<std::size_t>(array.shape(0))};
}

}  // namespace realmodel::bindings
