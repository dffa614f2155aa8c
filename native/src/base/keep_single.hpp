// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace realmodel {

/// Sorts elements and keeps each once.
template <class Element>
void sort_unique(std::vector<Element>& elements) {
    if (!std::is_sorted(elements.begin(), elements.end()))
        std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
}

/// Keeps of sorted elements those that occur once.
template <class Element>
void keep_single(std::vector<Element>& sorted) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t end = i + 1;
        while (end < sorted.size() && sorted[end] == sorted[i])
            ++end;
        if (end - i == 1) sorted[kept++] = sorted[i];
        i = end;
    }
    sorted.erase(sorted.begin() + static_cast<std::ptrdiff_t>(kept), sorted.end());
}

}  // namespace realmodel
