// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/page_store.hpp"

/// Large arrays of the page store, each system in its own way. All sizes are in bytes of whole
/// blocks.
namespace realmodel::page_store {

/// A block here, and the least large array.
#if defined(_WIN64)
// The heap of Windows returns what has more than half a megabyte to the system at once.
inline constexpr std::size_t kPages = std::size_t{256} << 10;
inline constexpr std::size_t kLeastLarge = kIsThere ? 2 * kPages : kLargeArray;
#else
inline constexpr std::size_t kPages = kBlock;
inline constexpr std::size_t kLeastLarge = kLargeArray;
#endif

constexpr bool is_large(const Memory& memory) {
    return memory.reserved >= kLeastLarge;
}

constexpr std::size_t in_blocks(std::size_t bytes) {
    return (bytes + kPages - 1) / kPages * kPages;
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
