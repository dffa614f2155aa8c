// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy arrays in and out without copies.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace realmodel::bindings {

/// C-contiguous array of T; other dtypes and layouts are converted (then, and only then, copied).
template <class T>
using Array = pybind11::array_t<T, pybind11::array::c_style | pybind11::array::forcecast>;

/// Hands a vector's memory to NumPy: an array of shape (values.size() / columns, columns), or
/// one-dimensional where columns is 0. The array owns the memory; nothing is copied.
template <class T>
Array<T> to_array(std::vector<T>&& values, std::size_t columns = 0) {
    auto owned = std::make_unique<std::vector<T>>(std::move(values));
    std::vector<T>* const kept = owned.get();
    const pybind11::capsule owner(
        kept, [](void* memory) { delete static_cast<std::vector<T>*>(memory); });
    (void)owned.release();
    if (columns == 0) {
        return Array<T>({static_cast<pybind11::ssize_t>(kept->size())}, kept->data(), owner);
    }
    return Array<T>({static_cast<pybind11::ssize_t>(kept->size() / columns),
                     static_cast<pybind11::ssize_t>(columns)},
                    kept->data(), owner);
}

/// The same for rows of N numbers: an array of shape (rows.size(), N).
template <class T, std::size_t N>
Array<T> to_array(std::vector<std::array<T, N>>&& rows) {
    static_assert(sizeof(std::array<T, N>) == N * sizeof(T));
    auto owned = std::make_unique<std::vector<std::array<T, N>>>(std::move(rows));
    auto* const kept = owned.get();
    const pybind11::capsule owner(
        kept, [](void* memory) { delete static_cast<std::vector<std::array<T, N>>*>(memory); });
    (void)owned.release();
    return Array<T>(
        {static_cast<pybind11::ssize_t>(kept->size()), static_cast<pybind11::ssize_t>(N)},
        reinterpret_cast<const T*>(kept->data()), owner);
}

/// Checks that an array has the shape (any, columns).
/// @throws ValueError naming the argument and both shapes
template <class T>
void require_columns(const Array<T>& array, std::size_t columns, const char* argument) {
    if (array.ndim() == 2 && static_cast<std::size_t>(array.shape(1)) == columns) return;
    std::string shape = "(";
    for (pybind11::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        shape += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
    }
    throw pybind11::value_error(std::string(argument) + ": an array of shape (any, " +
                                std::to_string(columns) + ") is needed, got " + shape + ")");
}

}  // namespace realmodel::bindings
