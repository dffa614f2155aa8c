// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "realmodel/base/page_store.hpp"

namespace realmodel {

/// An array of numbers whose size is set once. Its elements are not set when it is made, so that
/// the threads that fill it touch its memory first. A large one has pages of its own
/// (page_store.hpp).
template <class Element>
class FlatArray {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_default_constructible_v<Element>);

public:
    FlatArray() = default;
    explicit FlatArray(std::size_t size)
        : elements_(allocate(size), Dropper{size * sizeof(Element)}), size_(size) {}

    FlatArray(const FlatArray& other) : FlatArray(other.size_) {
        std::copy(other.begin(), other.end(), begin());
    }
    FlatArray(FlatArray&& other) noexcept
        : elements_(std::move(other.elements_)), size_(std::exchange(other.size_, 0)) {}
    FlatArray& operator=(FlatArray other) noexcept {
        std::swap(elements_, other.elements_);
        std::swap(size_, other.size_);
        return *this;
    }

    std::size_t size() const { return size_; }
    Element& operator[](std::size_t i) { return elements_[i]; }
    const Element& operator[](std::size_t i) const { return elements_[i]; }
    Element* begin() { return elements_.get(); }
    Element* end() { return elements_.get() + size_; }
    const Element* begin() const { return elements_.get(); }
    const Element* end() const { return elements_.get() + size_; }

private:
    struct Dropper {
        std::size_t bytes = 0;
        void operator()(Element* elements) const noexcept {
            if (bytes < page_store::kLargeArray) {
                std::free(elements);
                return;
            }
            const std::size_t blocks = page_store::in_blocks(bytes);
            page_store::drop(elements, blocks, blocks);
        }
    };

    static Element* allocate(std::size_t size) {
        if (size > PTRDIFF_MAX / 4 / sizeof(Element)) throw std::bad_alloc();
        const std::size_t bytes = size * sizeof(Element);
        void* memory = bytes < page_store::kLargeArray
                           ? std::malloc(std::max(bytes, std::size_t{1}))
                           : page_store::take(page_store::in_blocks(bytes));
        if (memory == nullptr) throw std::bad_alloc();
        return static_cast<Element*>(memory);
    }

    std::unique_ptr<Element[], Dropper> elements_;
    std::size_t size_ = 0;
};

}  // namespace realmodel
