// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_file.hpp"

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace realmodel::fuzz {

namespace {

using Tree = boost::property_tree::ptree;

double number_of(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') throw std::runtime_error("'" + text + "' is no number");
    return value;
}

template <class Number, std::size_t N>
std::vector<std::array<Number, N>> rows_of(const Tree& tree) {
    std::vector<std::array<Number, N>> rows;
    for (const auto& [unnamed, row] : tree) {
        if (row.size() != N)
            throw std::runtime_error("a row has not " + std::to_string(N) + " numbers");
        std::size_t column = 0;
        rows.emplace_back();
        for (const auto& [also_unnamed, cell] : row)
            rows.back()[column++] = static_cast<Number>(number_of(cell.data()));
    }
    return rows;
}

RockCase rock_of(const Tree& tree) {
    RockCase rock;
    for (const auto& [unnamed, surface] : tree.get_child("surfaces")) {
        rock.surfaces.push_back({rows_of<double, 3>(surface.get_child("vertices")),
                                 rows_of<std::int32_t, 3>(surface.get_child("triangles"))});
    }
    if (const auto rules = tree.get_child_optional("rules")) {
        for (const auto& [unnamed, name] : *rules) {
            const auto rule = strata::rule_named(name.data());
            if (!rule) throw std::runtime_error("rule '" + name.data() + "'");
            rock.rules.push_back(*rule);
        }
    }
    if (const auto region = tree.get_child_optional("region")) {
        rock.region = {rows_of<double, 2>(region->get_child("vertices")),
                       rows_of<std::int32_t, 3>(region->get_child("triangles"))};
    }
    if (const auto base = tree.get_optional<std::string>("base_elevation"))
        rock.base_elevation = number_of(*base);
    return rock;
}

std::string number(double value) {
    char text[40];
    const bool short_integer = std::nearbyint(value) == value && std::abs(value) < 0x1p53 &&
                               !(value == 0 && std::signbit(value));
    std::snprintf(text, sizeof text, short_integer ? "%.0f" : "\"%a\"", value);
    return text;
}

std::string number(std::int32_t value) {
    return std::to_string(value);
}

template <class Rows>
std::string rows_text(const Rows& rows, const std::string& margin) {
    std::string text = "[";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        text += (i == 0 ? "\n" : ",\n") + margin + " [";
        for (std::size_t k = 0; k < rows[i].size(); ++k)
            text += (k == 0 ? "" : ", ") + number(rows[i][k]);
        text += "]";
    }
    return text + (rows.empty() ? "]" : "\n" + margin + "]");
}

template <class M>
std::string mesh_text(const M& mesh, const std::string& margin) {
    return "{\n" + margin + " \"vertices\": " + rows_text(mesh.vertices, margin + " ") + ",\n" +
           margin + " \"triangles\": " + rows_text(mesh.triangles, margin + " ") + "\n" + margin +
           "}";
}

/// The lines of a rock mass, between the braces that hold them.
std::string rock_text(const RockCase& rock, const std::string& margin) {
    std::string text;
    if (!rock.rules.empty()) {
        text += margin + "\"rules\": [";
        for (std::size_t k = 0; k < rock.rules.size(); ++k) {
            text +=
                (k == 0 ? "\"" : ", \"") + std::string(strata::meaning(rock.rules[k]).name) + "\"";
        }
        text += "],\n";
    }
    if (rock.base_elevation)
        text += margin + "\"base_elevation\": " + number(*rock.base_elevation) + ",\n";
    if (rock.region) text += margin + "\"region\": " + mesh_text(*rock.region, margin) + ",\n";
    text += margin + "\"surfaces\": [";
    for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
        text += (k == 0 ? "\n" : ",\n") + margin + " " + mesh_text(rock.surfaces[k], margin + " ");
    }
    return text + "\n" + margin + "]\n";
}

/// As a JSON string.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return result + "\"";
}

}  // namespace

StackCase read_case(const std::filesystem::path& file) {
    try {
        Tree tree;
        boost::property_tree::read_json(file.string(), tree);
        StackCase stack;
        stack.label = tree.get("label", "");
        if (const auto rocks = tree.get_child_optional("rocks")) {
            for (const auto& [unnamed, rock] : *rocks)
                stack.rocks.push_back(rock_of(rock));
        } else {
            stack.rocks.push_back(rock_of(tree));
        }
        return stack;
    } catch (const std::exception& error) {
        throw std::runtime_error(file.string() + ": " + error.what());
    }
}

void write_case(const StackCase& stack, const std::filesystem::path& file, const std::string& why) {
    std::ofstream out(file);
    out << "{\n \"why\": " << quoted(why) << ",\n \"label\": " << quoted(stack.label) << ",\n";
    if (stack.rocks.size() == 1) {
        out << rock_text(stack.rocks[0], " ");
    } else {
        out << " \"rocks\": [";
        for (std::size_t r = 0; r < stack.rocks.size(); ++r)
            out << (r == 0 ? "\n  {\n" : ",\n  {\n") << rock_text(stack.rocks[r], "   ") << "  }";
        out << "\n ]\n";
    }
    out << "}\n";
    if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    if (!std::filesystem::is_directory(folder)) return files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace realmodel::fuzz
