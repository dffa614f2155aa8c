// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// The memory of arrays, which comes from malloc. A build makes and drops large arrays many times
/// as large as what it holds at once, and a system hands out pages one by one, cleared, which takes
/// a tenth of the build's time. So while a PageCache lives, the memory of dropped arrays stays in
/// the process, and a new array takes what is nearest to its size.
namespace realmodel::page_store {

/// What has at least so many bytes is kept. AddressSanitizer is to see all that is dropped.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr std::size_t kLargeArray = SIZE_MAX;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr std::size_t kLargeArray = SIZE_MAX;
#else
inline constexpr std::size_t kLargeArray = std::size_t{4} << 20;
#endif
#else
inline constexpr std::size_t kLargeArray = std::size_t{4} << 20;
#endif

/// The memory of one array, in bytes.
struct Memory {
    char* begin = nullptr;
    std::size_t ready = 0;     ///< up to where it has been used, or soon will be
    std::size_t reserved = 0;  ///< up to where it can be made ready without moving
};

/// Reserves at least so many bytes.
/// @throws std::bad_alloc; the memory is then as it was
void reserve(Memory& memory, std::size_t bytes);

/// Makes at least so many bytes ready to be written. What was ready keeps its contents. Where more
/// than what is reserved is asked for, twice as much is reserved.
/// @throws std::bad_alloc, as reserve()
void make_ready(Memory& memory, std::size_t bytes);

/// Drops the memory. That of a large array is kept while there is a PageCache.
void drop(Memory& memory) noexcept;

/// Bytes that are kept for later.
std::size_t kept() noexcept;

/// While one of these lives, on any thread, memory that is dropped is kept, with what arrays have
/// no more than they had at most at once. The last one gives it back to the system.
class PageCache {
public:
    PageCache();
    ~PageCache();
    PageCache(const PageCache&) = delete;
    PageCache& operator=(const PageCache&) = delete;
};

}  // namespace realmodel::page_store
