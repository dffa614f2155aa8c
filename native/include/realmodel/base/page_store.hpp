// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// The memory of arrays. That of large ones comes in blocks of pages: a build makes and drops
/// arrays many times as large as what it holds at once, and a system hands out pages one by one,
/// cleared, which takes an eighth of the build's time. So while a Keeper lives, the blocks of
/// dropped arrays stay in the process: on Linux they are moved to where the next array needs them,
/// on Windows it is put where they are. Elsewhere all memory comes from malloc.
namespace realmodel::page_store {

inline constexpr std::size_t kBlock = std::size_t{2} << 20;  ///< bytes

// AddressSanitizer watches what comes from malloc.
#if !(defined(__linux__) || defined(_WIN64)) || defined(__SANITIZE_ADDRESS__)
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

/// The memory of one array, in bytes.
struct Memory {
    char* begin = nullptr;
    std::size_t ready = 0;     ///< up to where there are pages: all of this moves with the array
    std::size_t reserved = 0;  ///< up to where it can be made ready without moving
};

/// Reserves at least so many bytes. They take no memory before they are made ready.
/// @throws std::bad_alloc; the memory is then as it was or, where the system has failed while it
///         was moved, empty
void reserve(Memory& memory, std::size_t bytes);

/// Makes at least so many bytes ready to be written, from kept blocks first. What was ready keeps
/// its contents. Where more than what is reserved is asked for, twice as much is reserved.
/// @throws std::bad_alloc, as reserve()
void make_ready(Memory& memory, std::size_t bytes);

/// Drops the memory. Its blocks are kept while there is a Keeper.
void drop(Memory& memory) noexcept;

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
