// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/page_store.hpp"

/// Large arrays of the page store, each system in its own way. All sizes are in bytes of whole
/// blocks.
namespace realmodel::page_store {

constexpr bool is_large(const Memory& memory) {
    return memory.reserved >= kLargeArray;
}

constexpr std::size_t in_blocks(std::size_t bytes) {
    return (bytes + kBlock - 1) / kBlock * kBlock;
}

/// Gives a new array kept blocks that lie side by side, just so many.
/// @return false where there are none, and nothing was done
bool take_kept(Memory& memory, std::size_t bytes);

/// Reserves so many, more than there were. What was ready moves along; it may be of a small array.
/// @throws std::bad_alloc
void reserve_blocks(Memory& memory, std::size_t bytes);

/// Makes so many ready of those that are reserved, kept ones first.
/// @throws std::bad_alloc
void make_blocks_ready(Memory& memory, std::size_t ready);

/// Keeps the blocks of an array while there is a Keeper, or gives them back.
void drop_blocks(Memory& memory) noexcept;

}  // namespace realmodel::page_store
