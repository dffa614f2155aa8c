// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <new>
#include <type_traits>
#include <utility>

#include "realmodel/base/page_store.hpp"

namespace realmodel {

/// A vector of numbers, or of what is nothing but numbers, that differs from std::vector in two
/// ways. Elements that are added without a value are not set: the threads that fill them are the
/// first to touch their memory. And where it is large it takes the memory of others that were
/// dropped (page_store.hpp), and grows as realloc does it, which on Linux copies nothing.
template <class Element>
class Array {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_destructible_v<Element> &&
                  alignof(Element) <= alignof(std::max_align_t));

public:
    using value_type = Element;
    using iterator = Element*;
    using const_iterator = const Element*;

    Array() = default;
    explicit Array(std::size_t size) { resize(size); }
    Array(std::size_t size, const Element& value) : Array(size) {
        std::fill(begin(), end(), value);
    }
    Array(std::initializer_list<Element> elements) { append(elements.begin(), elements.end()); }
    Array(const Array& other) { append(other.begin(), other.end()); }
    Array(Array&& other) noexcept { swap(other); }
    Array& operator=(const Array& other) {
        if (this != &other) {
            clear();
            append(other.begin(), other.end());
        }
        return *this;
    }
    Array& operator=(Array&& other) noexcept {
        Array(std::move(other)).swap(*this);
        return *this;
    }
    ~Array() { page_store::drop(memory_); }

    std::size_t size() const { return size_; }
    std::size_t capacity() const { return memory_.reserved / sizeof(Element); }
    bool empty() const { return size_ == 0; }
    Element* data() { return reinterpret_cast<Element*>(memory_.begin); }
    const Element* data() const { return reinterpret_cast<const Element*>(memory_.begin); }
    Element& operator[](std::size_t i) { return data()[i]; }
    const Element& operator[](std::size_t i) const { return data()[i]; }
    Element* begin() { return data(); }
    Element* end() { return data() + size_; }
    const Element* begin() const { return data(); }
    const Element* end() const { return data() + size_; }
    Element& front() { return data()[0]; }
    const Element& front() const { return data()[0]; }
    Element& back() { return data()[size_ - 1]; }
    const Element& back() const { return data()[size_ - 1]; }

    void push_back(const Element& element) {
        if ((size_ + 1) * sizeof(Element) > memory_.ready) {
            const Element own = element;  // it may be one of these
            make_ready(size_ + 1);
            data()[size_++] = own;
        } else {
            data()[size_++] = element;
        }
    }
    void pop_back() {
        assert(size_ > 0);
        --size_;
    }
    /// @param first, last  not of this array
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        const auto count = static_cast<std::size_t>(std::distance(first, last));
        make_ready(size_ + count);
        std::copy(first, last, end());
        size_ += count;
    }
    /// New elements are not set.
    void resize(std::size_t size) {
        make_ready(size);
        size_ = size;
    }
    void resize(std::size_t size, const Element& value) {
        const Element own = value;
        const std::size_t before = size_;
        resize(size);
        if (size > before) std::fill(begin() + before, end(), own);
    }
    void assign(std::size_t size, const Element& value) {
        const Element own = value;
        clear();
        resize(size, own);
    }
    /// Elements stay where they are while there are no more than `capacity`.
    void reserve(std::size_t capacity) {
        change_memory(page_store::reserve, std::max<std::size_t>(capacity, 4));
    }
    /// Makes memory ready for elements that are set before resize() counts them.
    void make_ready(std::size_t size) {
        if (size > memory_.ready / sizeof(Element)) change_memory(page_store::make_ready, size);
    }
    void clear() { size_ = 0; }
    void swap(Array& other) noexcept {
        std::swap(memory_, other.memory_);
        std::swap(size_, other.size_);
    }

    friend bool operator==(const Array& a, const Array& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    void change_memory(void (*change)(page_store::Memory&, std::size_t), std::size_t size) {
        if (size > PTRDIFF_MAX / 4 / sizeof(Element)) throw std::bad_alloc();
        try {
            change(memory_, size * sizeof(Element));
        } catch (...) {
            size_ = std::min(size_, capacity());
            throw;
        }
    }

    page_store::Memory memory_;
    std::size_t size_ = 0;
};

}  // namespace realmodel
