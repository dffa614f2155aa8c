// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <new>
#include <type_traits>
#include <utility>

#include "realmodel/base/page_store.hpp"

namespace realmodel {

/// A vector of numbers, or of what is nothing but numbers, that differs from std::vector in two
/// ways where it is large. Elements that resize() adds are not set: the threads that fill them are
/// the first to touch their memory. And it grows by whole pages (page_store.hpp): what is there is
/// not copied, and what is reserved takes no memory before it is filled or made ready to be.
template <class Element>
class GrowingArray {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_destructible_v<Element> &&
                  alignof(Element) <= alignof(std::max_align_t));

public:
    using value_type = Element;
    using iterator = Element*;
    using const_iterator = const Element*;

    GrowingArray() = default;
    explicit GrowingArray(std::size_t size) { resize(size); }
    GrowingArray(std::size_t size, const Element& value) { resize(size, value); }
    GrowingArray(std::initializer_list<Element> elements) {
        append(elements.begin(), elements.end());
    }
    GrowingArray(const GrowingArray& other) { append(other.begin(), other.end()); }
    GrowingArray(GrowingArray&& other) noexcept { swap(other); }
    GrowingArray& operator=(const GrowingArray& other) {
        if (this != &other) {
            clear();
            append(other.begin(), other.end());
        }
        return *this;
    }
    GrowingArray& operator=(GrowingArray&& other) noexcept {
        GrowingArray(std::move(other)).swap(*this);
        return *this;
    }
    ~GrowingArray() { drop(); }

    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }
    bool empty() const { return size_ == 0; }
    Element* data() { return elements_; }
    const Element* data() const { return elements_; }
    Element& operator[](std::size_t i) { return elements_[i]; }
    const Element& operator[](std::size_t i) const { return elements_[i]; }
    Element* begin() { return elements_; }
    Element* end() { return elements_ + size_; }
    const Element* begin() const { return elements_; }
    const Element* end() const { return elements_ + size_; }
    Element& front() { return elements_[0]; }
    const Element& front() const { return elements_[0]; }
    Element& back() { return elements_[size_ - 1]; }
    const Element& back() const { return elements_[size_ - 1]; }

    void push_back(const Element& element) {
        if (size_ == ready_) {
            const Element own = element;  // it may be one of these
            grow(size_ + 1);
            elements_[size_++] = own;
        } else {
            elements_[size_++] = element;
        }
    }
    void pop_back() { --size_; }
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        const auto count = static_cast<std::size_t>(std::distance(first, last));
        if (size_ + count > ready_) grow(size_ + count);
        std::copy(first, last, elements_ + size_);
        size_ += count;
    }
    /// New elements are not set.
    void resize(std::size_t size) {
        if (size > ready_) grow(size);
        size_ = size;
    }
    void resize(std::size_t size, const Element& value) {
        const Element own = value;
        const std::size_t before = size_;
        resize(size);
        if (size > before) std::fill(elements_ + before, elements_ + size, own);
    }
    void assign(std::size_t size, const Element& value) {
        const Element own = value;
        clear();
        resize(size, own);
    }
    /// Elements stay where they are while there are no more than `capacity`.
    void reserve(std::size_t capacity) {
        if (capacity > capacity_) move_to(capacity);
    }
    /// Makes memory ready for elements that are set before resize() counts them.
    void make_ready(std::size_t size) {
        if (size > ready_) grow(size);
    }
    void clear() { size_ = 0; }
    void swap(GrowingArray& other) noexcept {
        std::swap(elements_, other.elements_);
        std::swap(size_, other.size_);
        std::swap(ready_, other.ready_);
        std::swap(capacity_, other.capacity_);
    }

    friend bool operator==(const GrowingArray& a, const GrowingArray& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    static constexpr std::size_t kMost = PTRDIFF_MAX / 4 / sizeof(Element);

    static bool is_large(std::size_t elements) {
        return elements * sizeof(Element) >= page_store::kLargeArray;
    }
    static std::size_t blocks_of(std::size_t elements) {
        return page_store::in_blocks(elements * sizeof(Element));
    }

    /// Makes more than what is ready so.
    void grow(std::size_t least) {
        if (least > capacity_) move_to(std::max({least, capacity_ * 2, std::size_t{4}}));
        if (least > ready_) get_blocks(std::max(least, std::min(ready_ + ready_ / 16, capacity_)));
    }

    void move_to(std::size_t capacity) {
        if (capacity > kMost) throw std::bad_alloc();
        if (is_large(capacity)) {
            move_to_blocks(capacity);
            return;
        }
        void* moved = std::realloc(static_cast<void*>(elements_), capacity * sizeof(Element));
        if (moved == nullptr) throw std::bad_alloc();
        elements_ = static_cast<Element*>(moved);
        ready_ = capacity_ = capacity;
    }
    void move_to_blocks(std::size_t capacity) {
        GrowingArray moved;
        moved.elements_ = static_cast<Element*>(page_store::reserve(blocks_of(capacity)));
        moved.capacity_ = blocks_of(capacity) / sizeof(Element);
        if (is_large(capacity_)) {
            page_store::move(elements_, blocks_of(ready_), blocks_of(capacity_), moved.elements_);
            moved.ready_ = blocks_of(ready_) / sizeof(Element);
            moved.size_ = size_;
            elements_ = nullptr;
        } else {
            moved.append(begin(), end());
        }
        swap(moved);
    }
    /// Puts blocks of pages that are kept where elements are going to be.
    void get_blocks(std::size_t elements) {
        const std::size_t there = blocks_of(ready_), wanted = blocks_of(elements);
        page_store::give_blocks(reinterpret_cast<char*>(elements_) + there, wanted - there);
        ready_ = wanted / sizeof(Element);
    }

    void drop() noexcept {
        if (is_large(capacity_) && elements_ != nullptr) {
            page_store::drop(elements_, blocks_of(ready_), blocks_of(capacity_));
        } else {
            std::free(elements_);
        }
    }

    Element* elements_ = nullptr;
    std::size_t size_ = 0, ready_ = 0;  ///< up to where memory is ready
    std::size_t capacity_ = 0;          ///< up to where there is room
};

}  // namespace realmodel
