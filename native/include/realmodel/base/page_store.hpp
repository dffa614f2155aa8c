// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// The memory of large arrays, in blocks of pages. A build makes and drops arrays many times as
/// large as what it holds at once, and to a system that hands out pages one by one, cleared, that
/// is a third of the build's time: so while somebody keeps pages, the blocks of arrays that are
/// done with stay in the process and are moved, not copied, to where the next array is.
namespace realmodel::page_store {

inline constexpr std::size_t kBlock = std::size_t{2} << 20;  ///< bytes

// AddressSanitizer watches what comes from malloc.
#if !defined(__linux__) || defined(__SANITIZE_ADDRESS__)
inline constexpr bool kIsThere = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kIsThere = false;
#else
inline constexpr bool kIsThere = true;
#endif
#else
inline constexpr bool kIsThere = true;
#endif

/// Arrays of at least so many bytes have blocks of their own; smaller ones come from malloc.
inline constexpr std::size_t kLargeArray = kIsThere ? 2 * kBlock : SIZE_MAX;

constexpr std::size_t in_blocks(std::size_t bytes) {
    return (bytes + kBlock - 1) / kBlock * kBlock;
}

// All sizes below are whole numbers of blocks.

/// Room in the address space, for reading and writing. It takes no memory before it is touched or
/// given blocks.
/// @throws std::bad_alloc
void* reserve(std::size_t bytes);

/// Room all of which is about to be filled: as many blocks as can be had are ones that are kept.
/// @throws std::bad_alloc
void* take(std::size_t bytes);

/// Puts kept blocks to a place that was reserved and not touched yet, as many as there are.
/// @throws std::bad_alloc
void give_blocks(void* place, std::size_t bytes);

/// Moves the first `used` bytes of an array to room that was reserved and not touched yet, and
/// drops the array, of `reserved` bytes. What lies in it is not copied.
void move(void* from, std::size_t used, std::size_t reserved, void* to) noexcept;

/// Drops an array. Its `used` bytes are kept while somebody keeps blocks.
void drop(void* array, std::size_t used, std::size_t reserved) noexcept;

/// Bytes that are kept for later.
std::size_t kept() noexcept;

/// While one of these lives, on any thread, blocks that are dropped are kept. The last one gives
/// them back to the system.
class Keeper {
public:
    Keeper();
    ~Keeper();
    Keeper(const Keeper&) = delete;
    Keeper& operator=(const Keeper&) = delete;
};

}  // namespace realmodel::page_store
