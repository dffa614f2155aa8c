// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>

namespace realmodel {

/// Sorts numbers that are mostly very few, or half in order already.
template <class Number>
void sort_few(Number* begin, Number* end) {
    constexpr std::ptrdiff_t kFew = 32;
    if (end - begin > kFew) {
        std::sort(begin, end);
        return;
    }
    for (Number* next = begin; next < end; ++next) {
        const Number own = *next;
        Number* to = next;
        for (; to > begin && to[-1] > own; --to)
            *to = to[-1];
        *to = own;
    }
}

}  // namespace realmodel
