// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/page_store.hpp"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <new>

#include "base/large_arrays.hpp"

namespace realmodel::page_store {

void reserve(Memory& memory, std::size_t bytes) {
    if (bytes <= memory.reserved) return;
    if (bytes >= kLeastLarge) {
        reserve_blocks(memory, in_blocks(bytes));
        return;
    }
    void* const moved = std::realloc(memory.begin, bytes);
    if (moved == nullptr) throw std::bad_alloc();
    memory = {static_cast<char*>(moved), bytes, bytes};
}

void make_ready(Memory& memory, std::size_t bytes) {
    constexpr std::size_t kLeast = 64;
    if (bytes <= memory.ready) return;
    const bool is_new = memory.begin == nullptr && bytes >= kLeastLarge;
    if (is_new && take_kept(memory, in_blocks(bytes))) return;
    if (bytes > memory.reserved) reserve(memory, std::max({bytes, memory.reserved * 2, kLeast}));
    if (is_large(memory)) {
        const std::size_t stepped = std::min(memory.ready + memory.ready / 16, memory.reserved);
        make_blocks_ready(memory, in_blocks(std::max(bytes, stepped)));
    }
    assert(bytes <= memory.ready && memory.ready <= memory.reserved);
}

void drop(Memory& memory) noexcept {
    if (is_large(memory)) {
        drop_blocks(memory);
    } else {
        std::free(memory.begin);
    }
    memory = {};
}

}  // namespace realmodel::page_store
