// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/validation/topology.hpp"

#include <algorithm>
#include <chrono>

#include "base/floating_point.hpp"
#include "validation/array_tests.hpp"
#include "validation/cell_faces.hpp"
#include "validation/face_shape.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

namespace {

/// Cells with more faces than this are looked at one by one, on all threads.
constexpr std::size_t kFacesOfLargeCell = 4096;

/// What is found cell by cell.
struct CellFindings {
    Findings closed, volumes;
    void append(const CellFindings& later) {
        closed.append(later.closed);
        volumes.append(later.volumes);
    }
};

/// Cell by cell: is it closed, and has it a volume.
class CellTests {
public:
    CellTests(const ComplexView& model, const FacesByCell& oriented_faces,
              const FaceMeasures& faces, const Execution& execution)
        : model_(model),
          execution_(execution),
          faces_of_cells_(oriented_faces),
          faces_(faces),
          volume_(model.cell_count()) {}

    CellFindings run() {
        const std::size_t chunks = (model_.cell_count() + kCellsOfChunk - 1) / kCellsOfChunk;
        std::vector<CellFindings> chunk_findings(chunks);
        std::vector<std::vector<std::size_t>> large(chunks);
        parallel_chunks(chunks, execution_, [&](std::size_t chunk) {
            EdgeTable table;
            const std::size_t end = std::min(model_.cell_count(), (chunk + 1) * kCellsOfChunk);
            for (std::size_t c = chunk * kCellsOfChunk; c < end; ++c) {
                const auto oriented_faces = faces_of_cells_[c];
                volume(c, chunk_findings[chunk].volumes);
                if (oriented_faces.size() > kFacesOfLargeCell) {
                    large[chunk].push_back(c);
                } else {
                    closed(c, open_edge(model_, oriented_faces, table),
                           chunk_findings[chunk].closed);
                }
            }
        });
        CellFindings all;
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            all.append(chunk_findings[chunk]);
            for (const std::size_t c : large[chunk])
                closed(c, open_edge_of_large_cell(model_, faces_of_cells_[c], execution_),
                       all.closed);
        }
        all.closed.examined = all.volumes.examined = static_cast<std::int64_t>(model_.cell_count());
        return all;
    }

    const std::vector<double>& volumes() const { return volume_; }

private:
    static constexpr std::size_t kCellsOfChunk = 1024;

    void closed(std::size_t c, const std::optional<EdgeCount>& open, Findings& findings) const {
        if (!open) return;
        findings.fail([&] {
            const auto times = [](std::int64_t n) {
                return n == 1 ? std::string("once") : std::to_string(n) + " times";
            };
            return Offender{.text = "cell " + std::to_string(c) + " is not closed: its faces use " +
                                    "edge " + std::to_string(open->low) + "-" +
                                    std::to_string(open->high) + " " + times(open->ahead) +
                                    " one way and " + times(open->back) + " the other",
                            .cell = static_cast<std::int64_t>(c),
                            .vertex = open->low,
                            .block = model_.cell_block[c],
                            .place = model_.vertex(open->low)};
        });
    }

    void volume(std::size_t c, Findings& findings) {
        double sum = 0, rounding = 0;
        for (const OrientedFace oriented_face : faces_of_cells_[c]) {
            const FaceMeasure& face = faces_[face_of(oriented_face)];
            sum += face.volume[is_reversed(oriented_face) ? 1 : 0];
            rounding += face.rounding;
        }
        volume_[c] = sum;
        if (sum > kRoundingSteps * rounding) return;
        const CellExtent extent(model_, faces_of_cells_[c]);
        ++findings.undecided;
        if (!extent.is_flat() && sum >= -extent.volume_rounding()) return;
        findings.fail([&] {
            const std::string text =
                extent.is_flat() ? " is flat" : " is inside out: its volume is " + figure(sum);
            return Offender{.text = "cell " + std::to_string(c) + text,
                            .cell = static_cast<std::int64_t>(c),
                            .block = model_.cell_block[c],
                            .place = extent.middle()};
        });
    }

    const ComplexView& model_;
    Execution execution_;
    const FacesByCell& faces_of_cells_;
    const FaceMeasures& faces_;
    std::vector<double> volume_;
};

/// How far the volumes of the cells of a block may be off, each by the rounding of all its extent.
double volume_rounding(const ComplexView& model, const FacesByCell& oriented_faces,
                       std::size_t block) {
    double rounding = 0;
    for (std::size_t c = 0; c < model.cell_count(); ++c) {
        if (model.cell_block[c] == static_cast<std::int32_t>(block))
            rounding += CellExtent(model, oriented_faces[c]).volume_rounding();
    }
    return rounding;
}

Findings check_block_volumes(const ComplexView& model, const FacesByCell& oriented_faces,
                             const std::vector<double>& cell_volume) {
    std::vector<CorrectedSum> sums(model.block_volume.size());
    for (std::size_t c = 0; c < cell_volume.size(); ++c)
        sums[static_cast<std::size_t>(model.cell_block[c])].add(cell_volume[c]);
    Findings findings;
    findings.examined = static_cast<std::int64_t>(sums.size());
    for (std::size_t b = 0; b < sums.size(); ++b) {
        const double stated = model.block_volume[b], summed = sums[b].value();
        const double off = std::abs(stated - summed);
        if (off <= 1e-9 * std::abs(summed)) continue;
        if (off <= volume_rounding(model, oriented_faces, b)) {  // a block as thin as rounding
            ++findings.undecided;
            continue;
        }
        findings.fail([&] {
            return Offender{.text = "block " + std::to_string(b) + " is reported with volume " +
                                    figure(stated) + ", its cells have " + figure(summed),
                            .block = static_cast<std::int64_t>(b)};
        });
    }
    return findings;
}

/// Seconds since the last question.
class Clock {
public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> since = now - std::exchange(last_, now);
        return since.count();
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<TestResult> check_topology(const ComplexView& model, const Execution& execution) {
    std::vector<TestResult> results;
    Clock clock;
    const auto add = [&](const char* name, const char* unit, Findings&& findings) {
        results.push_back({name, unit, std::move(findings), clock.lap()});
    };
    const auto report = [&](double fraction, const char* text) {
        if (execution.progress == nullptr) return;
        execution.progress->check();
        execution.progress->report(fraction, text);
    };
    report(0.0, "checking the arrays");
    add("arrays", "faces", check_arrays(model, execution));
    if (!results.back().findings.passed()) return results;
    report(0.1, "checking every face");
    add("loops", "faces", check_loops(model, execution));
    add("vertices", "vertices", check_vertices(model, execution));
    add("outside", "faces", check_outside(model, execution));
    const FacesByCell oriented_faces(model, execution);
    FaceMeasures faces(model, oriented_faces, execution);
    add("faces", "faces", std::move(faces.findings()));
    report(0.5, "checking every cell");
    CellTests tests(model, oriented_faces, faces, execution);
    CellFindings cells = tests.run();
    add("closed", "cells", std::move(cells.closed));  // its time is that of the volumes, too
    add("volumes", "cells", std::move(cells.volumes));
    add("block volumes", "blocks", check_block_volumes(model, oriented_faces, tests.volumes()));
    report(1.0, "checking every cell");
    return results;
}

}  // namespace realmodel::validation
