// SPDX-License-Identifier: GPL-3.0-or-later
// krige, krige_left_out, fit_variogram, likely_variograms, fit_alike, fit_sheets, idw,
// idw_left_out, spline, SplinesOfSome, mean_spacing, nearest_distance, line_sums.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "execution.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/interpolation/distances.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/interpolation/line_sums.hpp"
#include "realmodel/interpolation/sheet_fit.hpp"
#include "realmodel/interpolation/thin_plate.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// model, range, sill, anisotropy ratio and azimuth.
using NestedTuple = std::tuple<std::string, double, double, double, double>;
/// At most how many neighbors, how many in an eighth of the directions, and how far away.
using NeighborhoodTuple = std::tuple<int, int, double>;
constexpr NeighborhoodTuple kNearest{16, 0, 0.0};
/// Positions, slopes, the baseline of slopes, and how many dips count at a node.
using DipsTuple = std::tuple<NumpyArray<double>, NumpyArray<double>, double, int>;

/// The sheet of each point and of each dip, variances, the variogram of thicknesses, the sheet
/// asked.
using SheetsTuple = std::tuple<NumpyArray<std::int32_t>, NumpyArray<std::int32_t>,
                               NumpyArray<double>, py::dict, std::int32_t>;

interpolation::Neighborhood neighborhood_of(const NeighborhoodTuple& of) {
    return std::make_from_tuple<interpolation::Neighborhood>(of);
}

/// @return spans of the arrays in `of`
interpolation::Dips dips_of(const std::optional<DipsTuple>& of) {
    if (!of) return {};
    const auto& [positions, slopes, baseline, neighbors] = *of;
    return {rows<2>(positions, "positions of dips"), rows<2>(slopes, "slopes"), baseline,
            neighbors};
}

/// Of what fit_variogram gives.
/// @throws KeyError
interpolation::Variogram variogram_of(const py::dict& of) {
    const auto number = [&](const char* name) { return py::cast<double>(of[name]); };
    interpolation::Variogram variogram{
        interpolation::variogram_model(py::cast<std::string>(of["model"])),
        number("range"),
        number("sill"),
        number("nugget"),
        {number("anisotropy_ratio"), number("anisotropy_azimuth")},
        {}};
    for (const auto& [name, range, sill, ratio, azimuth] :
         py::cast<std::vector<NestedTuple>>(of["further"])) {
        variogram.further.push_back(
            {interpolation::variogram_model(name), range, sill, {ratio, azimuth}});
    }
    return variogram;
}

/// @return spans of the arrays in `of`
interpolation::Sheets sheets_of(const std::optional<SheetsTuple>& of) {
    if (!of) return {};
    const auto& [points, dips, variances, thickness, asked] = *of;
    return {view(points), view(dips), view(variances), variogram_of(thickness), asked};
}

interpolation::Drift drift_of(const std::string& name) {
    if (name == "constant") return interpolation::Drift::kConstant;
    if (name == "linear") return interpolation::Drift::kLinear;
    if (name == "quadratic") return interpolation::Drift::kQuadratic;
    throw InputError("option", "drift \"" + name + "\" is not known");
}

/// heights, variances, nodes with no point within the radius
using KrigedArrays = std::tuple<NumpyArray<double>, NumpyArray<double>, std::int64_t>;

KrigedArrays kriged_tuple(interpolation::Kriged&& kriged) {
    return {to_array(std::move(kriged.z)), to_array(std::move(kriged.variance)), kriged.alone};
}

KrigedArrays krige(const NumpyArray<double>& points, const NumpyArray<double>& nodes,
                   const py::dict& variogram, const NeighborhoodTuple& neighborhood,
                   const std::string& drift, const std::optional<DipsTuple>& dips,
                   const std::optional<SheetsTuple>& sheets, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const auto model = variogram_of(variogram);
    const interpolation::KrigingOptions options{neighborhood_of(neighborhood), drift_of(drift),
                                                dips_of(dips), sheets_of(sheets)};
    return kriged_tuple(
        unlocked([&] { return interpolation::krige(from, to, model, options, run(execution)); }));
}

KrigedArrays krige_left_out(const NumpyArray<double>& points, const py::dict& variogram,
                            const NeighborhoodTuple& neighborhood, const std::string& drift,
                            const std::optional<DipsTuple>& dips,
                            const std::optional<SheetsTuple>& sheets, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto model = variogram_of(variogram);
    const interpolation::KrigingOptions options{neighborhood_of(neighborhood), drift_of(drift),
                                                dips_of(dips), sheets_of(sheets)};
    return kriged_tuple(unlocked(
        [&] { return interpolation::krige_left_out(from, model, options, run(execution)); }));
}

NumpyArray<double> idw(const NumpyArray<double>& points, const NumpyArray<double>& nodes,
                       double power, const NeighborhoodTuple& neighborhood,
                       WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    return to_array(unlocked([&] {
        return interpolation::inverse_distance(from, to, {power, neighborhood_of(neighborhood)},
                                               run(execution));
    }));
}

NumpyArray<double> idw_left_out(const NumpyArray<double>& points, double power,
                                const NeighborhoodTuple& neighborhood,
                                WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    return to_array(unlocked([&] {
        return interpolation::inverse_distance_left_out(
            from, {power, neighborhood_of(neighborhood)}, run(execution));
    }));
}

NumpyArray<double> spline(const NumpyArray<double>& points, const NumpyArray<double>& nodes,
                          double smoothing, const NeighborhoodTuple& neighborhood, double spacing,
                          const std::optional<DipsTuple>& dips, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const interpolation::ThinPlateOptions options{smoothing, neighborhood_of(neighborhood), spacing,
                                                  dips_of(dips)};
    return to_array(
        unlocked([&] { return interpolation::thin_plate(from, to, options, run(execution)); }));
}

NumpyArray<double> heights_of_some(const interpolation::SplinesOfSome& splines,
                                   const NumpyArray<std::uint8_t>& counts,
                                   const NumpyArray<double>& nodes,
                                   const std::vector<double>& smoothings, std::size_t neighbors,
                                   WatchedExecution* execution) {
    const auto to = rows<2>(nodes, "nodes");
    if (static_cast<std::size_t>(counts.size()) != splines.size())
        throw py::value_error("counts: one for each point");
    const auto z = unlocked(
        [&] { return splines.heights(view(counts), to, smoothings, neighbors, run(execution)); });
    NumpyArray<double> array({smoothings.size(), to.size()});
    std::ranges::copy(z, array.mutable_data());
    return array;
}

double mean_spacing(const NumpyArray<double>& points, bool are_apart) {
    const auto from = rows<3>(points, "points");
    const py::gil_scoped_release release;
    return interpolation::mean_spacing(from, are_apart);
}

NumpyArray<double> nearest_distance(const NumpyArray<double>& points,
                                    const NumpyArray<double>& nodes, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    return to_array(
        unlocked([&] { return interpolation::nearest_distances(from, to, run(execution)); }));
}

NumpyArray<double> line_sums(const NumpyArray<double>& nodes, const NumpyArray<double>& directions,
                             const NumpyArray<double>& starts, const NumpyArray<double>& values,
                             double step, WatchedExecution* execution) {
    const auto to = rows<2>(nodes, "nodes");
    const interpolation::Lines lines{rows<2>(directions, "directions"), view(starts), view(values),
                                     step};
    return to_array(unlocked([&] { return interpolation::line_sums(to, lines, run(execution)); }));
}

/// As variogram_of takes it.
py::dict variogram_dict(const interpolation::Variogram& variogram) {
    std::vector<NestedTuple> further;
    for (const interpolation::NestedStructure& nested : variogram.further) {
        further.emplace_back(std::string(name_of(nested.model)), nested.range, nested.sill,
                             nested.anisotropy.ratio, nested.anisotropy.azimuth);
    }
    py::dict out;
    out["model"] = py::str(std::string(name_of(variogram.model)));
    out["range"] = variogram.range;
    out["sill"] = variogram.sill;
    out["nugget"] = variogram.nugget;
    out["anisotropy_ratio"] = variogram.anisotropy.ratio;
    out["anisotropy_azimuth"] = variogram.anisotropy.azimuth;
    out["further"] = further;
    return out;
}

void add_experimental(py::dict& out, interpolation::ExperimentalVariogram&& experimental) {
    out["lags"] = to_array(std::move(experimental.lags));
    out["gamma"] = to_array(std::move(experimental.gamma));
    out["pairs"] = to_array(std::move(experimental.pairs));
}

interpolation::Anisotropy anisotropy_of(const std::optional<std::pair<double, double>>& of) {
    return of ? interpolation::Anisotropy{of->first, of->second} : interpolation::Anisotropy{};
}

py::dict fit_variogram(const NumpyArray<double>& points,
                       const std::optional<std::pair<double, double>>& anisotropy,
                       const std::string& drift, int neighbours, bool are_apart,
                       const std::optional<DipsTuple>& dips, bool has_bounds, double error,
                       WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const interpolation::FitOptions options{drift_of(drift), neighbours, !anisotropy, are_apart,
                                            dips_of(dips),   has_bounds, error};
    const interpolation::Anisotropy along = anisotropy_of(anisotropy);
    auto fitted = unlocked(
        [&] { return interpolation::fit_variogram(from, along, options, run(execution)); });
    py::dict out = variogram_dict(fitted.variogram);
    add_experimental(out, std::move(fitted.experimental));
    return out;
}

py::list likely_variograms(const NumpyArray<double>& points,
                           const std::optional<std::pair<double, double>>& anisotropy,
                           const std::string& drift, const std::optional<DipsTuple>& dips,
                           bool has_bounds, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    interpolation::FitOptions options;
    options.drift = drift_of(drift);
    options.dips = dips_of(dips);
    options.has_bounds = has_bounds;
    const auto result = unlocked([&] {
        return interpolation::likely_variograms(from, anisotropy_of(anisotropy), options,
                                                run(execution));
    });
    py::list out;
    for (const auto& [variogram, density, squares, free] : result)
        out.append(py::make_tuple(std::string(name_of(variogram.model)), variogram.range,
                                  variogram.nugget, density, squares, free));
    return out;
}

/// Points and dips of a surface.
using SurfaceTuple = std::tuple<NumpyArray<double>, std::optional<DipsTuple>>;

py::list fit_alike(const std::vector<SurfaceTuple>& surfaces,
                   const std::optional<std::pair<double, double>>& anisotropy,
                   const std::string& drift, double error, WatchedExecution* execution) {
    std::vector<interpolation::SurfaceData> data;
    for (const auto& [points, dips] : surfaces)
        data.push_back({rows<3>(points, "points"), dips_of(dips)});
    interpolation::FitOptions options;
    options.drift = drift_of(drift);
    options.finds_anisotropy = !anisotropy;
    options.error = error;
    const interpolation::Anisotropy along = anisotropy_of(anisotropy);
    auto fitted =
        unlocked([&] { return interpolation::fit_alike(data, along, options, run(execution)); });
    py::list out;
    for (interpolation::FittedVariogram& fit : fitted) {
        py::dict entry = variogram_dict(fit.variogram);
        add_experimental(entry, std::move(fit.experimental));
        out.append(entry);
    }
    return out;
}

/// The sheet of each point and of each dip, and how many there are.
using SheetNumbersTuple =
    std::tuple<NumpyArray<std::int32_t>, NumpyArray<std::int32_t>, std::size_t>;

std::optional<py::dict> fit_sheets(const NumpyArray<double>& points,
                                   const SheetNumbersTuple& sheets,
                                   const std::optional<std::pair<double, double>>& anisotropy,
                                   const std::string& drift, const std::optional<DipsTuple>& dips,
                                   const std::optional<py::dict>& variogram, double error,
                                   WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto& [of_points, of_dips, count] = sheets;
    const std::vector<double> variances(count);
    const interpolation::Sheets numbers{view(of_points), view(of_dips), variances};
    interpolation::FitOptions options;
    options.drift = drift_of(drift);
    options.finds_anisotropy = !anisotropy;
    options.dips = dips_of(dips);
    options.error = error;
    std::optional<interpolation::Variogram> fixed;
    if (variogram) fixed = variogram_of(*variogram);
    auto fitted = unlocked([&] {
        return interpolation::fit_sheets(from, numbers, anisotropy_of(anisotropy), options, fixed,
                                         run(execution));
    });
    if (!fitted) return std::nullopt;
    py::dict out = variogram_dict(fitted->variogram);
    add_experimental(out, std::move(fitted->experimental));
    out["thickness"] = fitted->thickness;
    out["points"] = fitted->points;
    out["constants"] = to_array(std::move(fitted->constants));
    return out;
}

void bind_estimators(py::module_& module) {
    using py::arg;
    module.def("krige", &krige, arg("points"), arg("nodes"), arg("variogram"),
               arg("neighborhood") = kNearest, arg("drift") = "constant", arg("dips") = py::none(),
               arg("sheets") = py::none(), arg("execution") = py::none(),
               R"(Kriging: ordinary, or with a drift universal.

points        (P, 3) float64: x, y, z; points that repeat another count once
nodes         (N, 2) float64: x, y
variogram     dict as fit_variogram returns it, of:
  model               spherical, exponential, gaussian, cubic, matern32 or matern52
  range, sill, nugget the sill includes the nugget, the range is the practical one
  anisotropy_ratio    longest to shortest range (2 and 0.5 mean the same); `range` is the longest
  anisotropy_azimuth  of the longest range, degrees, clockwise from north (+y)
  further             structures of a nested variogram: (model, range, sill, ratio, azimuth) each;
                      `sill` includes theirs
neighborhood  (neighbors, octants, radius): the nearest in plan that make a node's system, 0: all
              points, factored once; at most so many points from each eighth of the directions, 0:
              any; points farther away do not count, 0: all do
drift         constant, linear or quadratic
dips          (positions (D, 2), slopes (D, 2): dz/dx and dz/dy, baseline, number), or None: along
              each axis a slope is that between the heights at the ends of the baseline; so many of
              the nearest dips count at a node, 0: all
sheets        (sheet of each point (P,), of each dip (D,), variances (S,), variogram of thicknesses,
              sheet asked), or None: surfaces that are estimated together. Their heights have the
              variogram in common; of each sheet the variance of its thickness above the lowest one,
              in units of the sill, ascends from 0
execution     Execution, or None

Returns (z (N,), variance of its error (N,) float64, number of nodes without a point within the
radius: there the nearest alone counts). A node on a point gets the point's value.
Raises InputError: kind "no_points", "not_finite", "contradicting_points" (items, place),
"variogram", "anisotropy", "option", "too_large"; Cancelled.)");
    module.def(
        "krige_left_out", &krige_left_out, arg("points"), arg("variogram"),
        arg("neighborhood") = kNearest, arg("drift") = "constant", arg("dips") = py::none(),
        arg("sheets") = py::none(), arg("execution") = py::none(),
        R"(krige at each of the points, from all the others and the dips. Returns and raises as krige
does.)");
    module.def("idw", &idw, arg("points"), arg("nodes"), arg("power") = 2.0,
               arg("neighborhood") = kNearest, arg("execution") = py::none(),
               R"(Inverse distance: means of the nearest points weighted by distance ** -power.

points        (P, 3) float64: x, y, z
nodes         (N, 2) float64: x, y
neighborhood  as krige

Returns z (N,) float64; a node on a point gets the point's value.
Raises InputError as krige does; Cancelled.)");
    module.def("idw_left_out", &idw_left_out, arg("points"), arg("power") = 2.0,
               arg("neighborhood") = kNearest, arg("execution") = py::none(),
               R"(idw at each of the points, from all the others. Returns z (P,).)");
    module.def("spline", &spline, arg("points"), arg("nodes"), arg("smoothing") = 0.0,
               arg("neighborhood") = kNearest, arg("spacing") = 0.0, arg("dips") = py::none(),
               arg("execution") = py::none(),
               R"(Thin plate splines through the nearest points of each node.

points        (P, 3) float64: x, y, z
nodes         (N, 2) float64: x, y
smoothing     added to the diagonal where distances count in the points' mean spacing; 0: points
              hold
neighborhood  as krige
spacing       the unit of distances, mean_spacing of all points where these are a part; 0: of these
dips          as krige

Returns z (N,) float64. Raises InputError as krige does; Cancelled.)");
    py::class_<interpolation::SplinesOfSome>(
        module, "SplinesOfSome",
        "Thin plate splines through the nearest of some of many points, then of others.")
        .def(py::init([](const NumpyArray<double>& points) {
                 return std::make_unique<interpolation::SplinesOfSome>(rows<3>(points, "points"));
             }),
             arg("points"),
             "points (P, 3) float64: x, y, z; several may be at one position. Raises InputError.")
        .def("heights", &heights_of_some, arg("counts"), arg("nodes"), arg("smoothings"),
             arg("neighbors"), arg("execution") = py::none(),
             R"(What spline gives from the points that count, of each position their mean height.

counts (P,) uint8. nodes (N, 2) float64. smoothings: S of them. Returns (S, N) float64. Raises InputError where none
counts; Cancelled.)");
}

void bind_fits(py::module_& module) {
    using py::arg;
    module.def("fit_variogram", &fit_variogram, arg("points"),
               arg("anisotropy") = py::make_tuple(1.0, 0.0), arg("drift") = "constant",
               arg("neighbours") = 32, arg("are_apart") = false, arg("dips") = py::none(),
               arg("has_bounds") = false, arg("error") = 0.0, arg("execution") = py::none(),
               R"(Fits a variogram to points (P, 3) float64, or to what a drift leaves of them.

anisotropy  (ratio, azimuth), as a variogram has them; None: the best is found
neighbours  with which points that are left out are predicted, at most 64
are_apart   no two points have one place, and all are finite: of many only some are copied
dips        as krige; the baseline is the mean spacing of points and dips
has_bounds  bounds of heights are known, which hold beside the points
error       the mean variance of the errors of the heights: the nugget is no less

Returns a dict: model, range, sill, nugget, anisotropy_ratio, anisotropy_azimuth and further as
krige takes it, the experimental values lags (L,), gamma (L,) float64 and pairs (L,) int64.
Raises InputError: kind "no_points", "not_finite", "contradicting_points", "anisotropy", "option";
Cancelled.)");
    module.def("fits_by_likelihood", &interpolation::fits_by_likelihood, arg("points"),
               arg("has_dips"), arg("has_bounds"), arg("error"),
               "Whether fit_variogram finds the variogram of so many points by likelihood.");
    module.def(
        "fit_alike", &fit_alike, arg("surfaces"), arg("anisotropy") = py::make_tuple(1.0, 0.0),
        arg("drift") = "constant", arg("error") = 0.0, arg("execution") = py::none(),
        R"(Fits variograms of one shape to surfaces of which heights vary alike, by likelihood.

surfaces    (points (P, 3) float64, dips) of each, as fit_variogram
anisotropy, drift  as fit_variogram
error       as fit_variogram, of all surfaces

Returns a list of dicts as of fit_variogram, one for each surface; empty where there is none, or the
data are too few.
Raises InputError as fit_variogram; Cancelled.)");
    module.def(
        "likely_variograms", &likely_variograms, arg("points"),
        arg("anisotropy") = py::make_tuple(1.0, 0.0), arg("drift") = "constant",
        arg("dips") = py::none(), arg("has_bounds") = false, arg("execution") = py::none(),
        R"(The variograms on a grid that points (P, 3) float64 and dips allow, and how likely they are.

anisotropy, drift, dips, has_bounds  as fit_variogram

Returns a list of (model, range, share of the nugget in the sill, logarithm of the density, squares, free):
squares divided by a chi-square number of so many degrees of freedom give a sill. Empty where the data are
too few. Raises InputError as fit_variogram; Cancelled.)");
    module.def(
        "fit_sheets", &fit_sheets, arg("points"), arg("sheets"),
        arg("anisotropy") = py::make_tuple(1.0, 0.0), arg("drift") = "constant",
        arg("dips") = py::none(), arg("variogram") = py::none(), arg("error") = 0.0,
        arg("execution") = py::none(),
        R"(Fits what sheets have in common to their points (P, 3) float64, or an even part of them, and dips.

sheets      (sheet of each point (P,), of each dip (D,) int32, their number)
anisotropy, drift, dips, error  as fit_variogram
variogram   one that is not to be changed, as krige takes it; None: the likeliest

Returns a dict: the variogram of the field that they share, as fit_variogram; thickness, the
variance of each thickness between two of them in units of its sill; constants (S,) float64, what
each lies above the first point; and points, how many of them counted. None where the data are too
few.
Raises InputError as fit_variogram; Cancelled.)");
}

}  // namespace

void bind_interpolation(py::module_& module) {
    using py::arg;
    bind_estimators(module);
    module.def(
        "mean_spacing", &mean_spacing, arg("points"), arg("are_apart") = false,
        R"(The side of a square as large as each point's (P, 3) share of the box of all in plan.

are_apart   no two points have one place, and all are finite: they stay where they are

Raises InputError as krige does for points.)");
    module.def(
        "dip_baseline",
        [](const py::dict& variogram, double spacing) {
            return interpolation::dip_baseline(variogram_of(variogram), spacing);
        },
        arg("variogram"), arg("spacing"),
        R"(The baseline of slopes with which they say most of heights under a variogram, as krige takes it.

spacing     the mean spacing of points and dips together)");
    module.def("nearest_distance", &nearest_distance, arg("points"), arg("nodes"),
               arg("execution") = py::none(),
               R"(How far the nearest of points (P, 3) is from each node (N, 2), in plan.

Returns (N,) float64. Raises InputError: kind "no_points", "not_finite"; Cancelled.)");
    module.def("line_sums", &line_sums, arg("nodes"), arg("directions"), arg("starts"),
               arg("values"), arg("step"), arg("execution") = py::none(),
               R"(Sums of processes on lines, by linear interpolation of their samples.

nodes       (N, 2) float64
directions  (L, 2) float64: on line l a node p is at p . d
starts      (L,) float64: where the first sample of each line is
values      (L, M) float64: samples at equal steps
step        between samples

Returns (N,) float64. Raises InputError: kind "option", "not_finite"; Cancelled.)");
    bind_fits(module);
}

}  // namespace realmodel::bindings
