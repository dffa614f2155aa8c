// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy arrays in and out without copies.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::bindings {

/// C-contiguous array of T; other dtypes and layouts are converted (then, and only then, copied).
template <class T>
using NumpyArray = pybind11::array_t<T, pybind11::array::c_style | pybind11::array::forcecast>;

template <class T>
std::span<const T> view(const NumpyArray<T>& array) {
    return {array.data(), static_cast<std::size_t>(array.size())};
}

/// C-contiguous array of int32 made from whole numbers of any width, none of which may be lost:
/// what NumPy's own conversion would wrap around is refused (see the caster below).
class Indices : public NumpyArray<std::int32_t> {
public:
    using NumpyArray<std::int32_t>::NumpyArray;
    Indices() = default;
    explicit Indices(NumpyArray<std::int32_t> whole) : NumpyArray<std::int32_t>(std::move(whole)) {}

    /// @throws InputError kind too_large (items: the row) where a number does not fit into 32 bits
    /// @throws TypeError where the array does not hold whole numbers
    static Indices from(const pybind11::array& numbers);

private:
    template <class Wide>
    static void require_fit(const pybind11::array& numbers);
};

template <class Wide>
void Indices::require_fit(const pybind11::array& numbers) {
    const NumpyArray<Wide> wide(numbers);
    const auto columns = wide.ndim() > 1 ? wide.shape(wide.ndim() - 1) : 1;
    const Wide* const values = wide.data();
    for (pybind11::ssize_t i = 0; i < wide.size(); ++i) {
        if (std::in_range<std::int32_t>(values[i])) continue;
        const auto row = static_cast<std::int64_t>(i / columns);
        throw InputError("too_large",
                         "row " + std::to_string(row) + " holds " + std::to_string(values[i]) +
                             ": indices go up to " +
                             std::to_string(std::numeric_limits<std::int32_t>::max()),
                         -1, {row});
    }
}

inline Indices Indices::from(const pybind11::array& numbers) {
    const char kind = numbers.dtype().kind();
    if (kind != 'i' && kind != 'u') {
        throw pybind11::type_error("indices: an array of whole numbers is needed, not of dtype " +
                                   pybind11::str(numbers.dtype()).cast<std::string>());
    }
    const auto width = numbers.dtype().itemsize();
    if (kind == 'u' && width >= 4) {
        require_fit<std::uint64_t>(numbers);
    } else if (width > 4) {
        require_fit<std::int64_t>(numbers);
    }
    return Indices(NumpyArray<std::int32_t>(numbers));
}

/// Keeps a vector for as long as an array lives.
template <class Values>
pybind11::capsule owner_of(Values&& values, Values*& owned_values) {
    auto owned = std::make_unique<Values>(std::forward<Values>(values));
    owned_values = owned.get();
    pybind11::capsule owner(owned_values,
                            [](void* memory) { delete static_cast<Values*>(memory); });
    (void)owned.release();
    return owner;
}

/// Hands the memory of a vector (std::vector or Array) to NumPy: an array of shape
/// (values.size() / columns, columns), or one-dimensional where columns is 0; of rows of N numbers
/// one of shape (rows.size(), N). The array owns the memory; nothing is copied.
template <template <class...> class Vector, class T, class... More>
NumpyArray<T> to_array(Vector<T, More...>&& values, std::size_t columns = 0) {
    Vector<T, More...>* owned_values = nullptr;
    const pybind11::capsule owner = owner_of(std::move(values), owned_values);
    if (columns == 0) {
        return NumpyArray<T>({static_cast<pybind11::ssize_t>(owned_values->size())},
                             owned_values->data(), owner);
    }
    return NumpyArray<T>({static_cast<pybind11::ssize_t>(owned_values->size() / columns),
                          static_cast<pybind11::ssize_t>(columns)},
                         owned_values->data(), owner);
}
template <template <class...> class Vector, class T, std::size_t N, class... More>
NumpyArray<T> to_array(Vector<std::array<T, N>, More...>&& rows) {
    static_assert(sizeof(std::array<T, N>) == N * sizeof(T));
    Vector<std::array<T, N>, More...>* owned_values = nullptr;
    const pybind11::capsule owner = owner_of(std::move(rows), owned_values);
    return NumpyArray<T>(
        {static_cast<pybind11::ssize_t>(owned_values->size()), static_cast<pybind11::ssize_t>(N)},
        reinterpret_cast<const T*>(owned_values->data()), owner);
}

/// Checks that an array has the shape (any, columns).
/// @throws ValueError naming the argument and both shapes
template <class T>
void require_columns(const NumpyArray<T>& array, std::size_t columns, const char* argument) {
    if (array.ndim() == 2 && static_cast<std::size_t>(array.shape(1)) == columns) return;
    std::string shape = "(";
    for (pybind11::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        shape += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
    }
    throw pybind11::value_error(std::string(argument) + ": an array of shape (any, " +
                                std::to_string(columns) + ") is needed, got " + shape + ")");
}

}  // namespace realmodel::bindings

namespace pybind11::detail {

/// Arguments of type Indices. Empty lists and the like come as float64 and hold nothing to lose.
template <>
struct type_caster<realmodel::bindings::Indices> {
    PYBIND11_TYPE_CASTER(realmodel::bindings::Indices, const_name("numpy.ndarray[numpy.int32]"));

    bool load(handle source, bool) {
        const array numbers = array::ensure(source);
        if (!numbers) return false;
        value = numbers.size() == 0 ? realmodel::bindings::Indices(
                                          realmodel::bindings::NumpyArray<std::int32_t>(numbers))
                                    : realmodel::bindings::Indices::from(numbers);
        return true;
    }
    static handle cast(const realmodel::bindings::Indices& source, return_value_policy, handle) {
        return source.inc_ref();
    }
};

}  // namespace pybind11::detail
