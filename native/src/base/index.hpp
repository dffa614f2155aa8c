// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>

#include "realmodel/base/errors.hpp"

namespace realmodel {

/// A number that names something, such as a vertex, as an index into an array.
template <std::signed_integral Id>
constexpr std::size_t index(Id id) {
    assert(id >= 0);
    return static_cast<std::size_t>(id);
}

/// The number of the thing that is added to so many others.
/// @throws InputError kind too_large where it has none of 32 bits
inline std::int32_t checked_number(std::size_t count, const char* things) {
    if (count >= INT32_MAX)
        throw InputError("too_large", std::string("more than 2147 million ") + things +
                                          "; use a smaller part of the model or coarser surfaces");
    return static_cast<std::int32_t>(count);
}

}  // namespace realmodel
