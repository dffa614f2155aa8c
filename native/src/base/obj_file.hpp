// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

namespace realmodel {

/// A Wavefront OBJ file that is written: what the dumps of several folders are. Coordinates have 17
/// digits. Throws std::runtime_error where the file cannot be written.
class ObjFile {
public:
    using Position = std::array<double, 3>;

    explicit ObjFile(const char* path) : file_(path) {
        if (!file_) throw std::runtime_error(std::string("cannot write ") + path);
        file_.precision(std::numeric_limits<double>::max_digits10);
    }

    void begin_group(const std::string& name) { file_ << "g " << name << '\n'; }
    void add_vertex(const Position& at) {
        file_ << "v " << at[0] << ' ' << at[1] << ' ' << at[2] << '\n';
        ++vertices_;
    }
    /// A face on vertices that were added before, counted from 0.
    void add_face(std::span<const std::int32_t> vertices) {
        file_ << 'f';
        for (const std::int32_t vertex : vertices)
            file_ << ' ' << vertex + 1;
        file_ << '\n';
    }
    /// A face, or a line of two corners, with vertices of its own.
    void add(char kind, std::span<const Position> corners) {
        const std::size_t first = vertices_ + 1;
        for (const Position& corner : corners)
            add_vertex(corner);
        file_ << kind;
        for (std::size_t i = 0; i < corners.size(); ++i)
            file_ << ' ' << first + i;
        file_ << '\n';
    }

private:
    std::ofstream file_;
    std::size_t vertices_ = 0;
};

}  // namespace realmodel
