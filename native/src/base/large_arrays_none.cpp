// SPDX-License-Identifier: GPL-3.0-or-later
#if !defined(__linux__) && !defined(_WIN64)

#include "base/large_arrays.hpp"

namespace realmodel::page_store {

// No array is large here.
bool take_kept(Memory&, std::size_t) {
    return false;
}
void reserve_blocks(Memory&, std::size_t) {}
void make_blocks_ready(Memory&, std::size_t) {}
void drop_blocks(Memory&) noexcept {}

std::size_t kept() noexcept {
    return 0;
}
Keeper::Keeper() = default;
Keeper::~Keeper() = default;

}  // namespace realmodel::page_store

#endif
