// SPDX-License-Identifier: GPL-3.0-or-later
// krige, fit_variogram, idw.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <span>
#include <string>

#include "arrays.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/inverse_distance.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// The rows of an array as they lie in NumPy's memory.
template <std::size_t N>
std::span<const std::array<double, N>> rows(const Array<double>& array, const char* argument) {
    require_columns(array, N, argument);
    static_assert(sizeof(std::array<double, N>) == N * sizeof(double));
    return {reinterpret_cast<const std::array<double, N>*>(array.data()),
            static_cast<std::size_t>(array.shape(0))};
}

py::tuple krige(const Array<double>& points, const Array<double>& nodes, const std::string& model,
                double range, double sill, double nugget, int neighbours, double ratio,
                double azimuth, int threads, Progress* control) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const interpolation::Variogram variogram{
        interpolation::variogram_model(model), range, sill, nugget, {ratio, azimuth}};
    interpolation::Kriged kriged;
    {
        const py::gil_scoped_release unlocked;
        kriged = interpolation::krige(from, to, variogram, {neighbours, threads}, control);
    }
    return py::make_tuple(to_array(std::move(kriged.z)), to_array(std::move(kriged.variance)));
}

Array<double> idw(const Array<double>& points, const Array<double>& nodes, double power,
                  int neighbours, int threads, Progress* control) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    std::vector<double> z;
    {
        const py::gil_scoped_release unlocked;
        z = interpolation::inverse_distance(from, to, {power, neighbours, threads}, control);
    }
    return to_array(std::move(z));
}

py::dict fit_variogram(const Array<double>& points, double ratio, double azimuth,
                       Progress* control) {
    const auto from = rows<3>(points, "points");
    interpolation::FittedVariogram fitted;
    {
        const py::gil_scoped_release unlocked;
        fitted = interpolation::fit_variogram(from, {ratio, azimuth}, control);
    }
    py::dict out;
    out["model"] = py::str(std::string(name_of(fitted.variogram.model)));
    out["range"] = fitted.variogram.range;
    out["sill"] = fitted.variogram.sill;
    out["nugget"] = fitted.variogram.nugget;
    out["lags"] = to_array(std::move(fitted.experimental.lags));
    out["gamma"] = to_array(std::move(fitted.experimental.gamma));
    out["pairs"] = to_array(std::move(fitted.experimental.pairs));
    return out;
}

}  // namespace

void bind_interpolation(py::module_& module) {
    using py::arg;
    module.def("krige", &krige, arg("points"), arg("nodes"), arg("model"), arg("range"),
               arg("sill"), arg("nugget"), arg("neighbours") = 16, arg("anisotropy_ratio") = 1.0,
               arg("anisotropy_azimuth") = 0.0, arg("threads") = 0, arg("control") = py::none(),
               R"(Ordinary kriging.

points              (P, 3) float64: x, y, z; points that repeat another count once
nodes               (N, 2) float64: x, y
model               spherical, exponential, gaussian, cubic, matern32 or matern52
range, sill, nugget of the variogram; the sill includes the nugget, the range is the practical one
neighbours          the nearest in plan that make a node's system; 0: all points, factored once
anisotropy_ratio    longest to shortest range (2 and 0.5 mean the same); `range` is the longest
anisotropy_azimuth  of the longest range, degrees, clockwise from north (+y)
threads             0: as many as there are; the result does not depend on it
control             Control to watch and stop it, or None

Returns (z (N,), variance of its error (N,)) float64. A node on a point gets the point's value.
Raises InputError: kind "no_points", "not_finite", "contradicting_points" (items, place),
"variogram", "anisotropy", "option", "too_large"; Cancelled.)");
    module.def("idw", &idw, arg("points"), arg("nodes"), arg("power") = 2.0, arg("neighbours") = 16,
               arg("threads") = 0, arg("control") = py::none(),
               R"(Inverse distance: means of the nearest points weighted by distance ** -power.

points      (P, 3) float64: x, y, z
nodes       (N, 2) float64: x, y
neighbours  the nearest in plan that count; 0: all points

Returns z (N,) float64; a node on a point gets the point's value.
Raises InputError as krige does; Cancelled.)");
    module.def("fit_variogram", &fit_variogram, arg("points"), arg("anisotropy_ratio") = 1.0,
               arg("anisotropy_azimuth") = 0.0, arg("control") = py::none(),
               R"(Fits a variogram to points (P, 3) float64.

Returns a dict: model, range, sill, nugget as krige takes them, and the experimental values
lags (L,), gamma (L,) float64 and pairs (L,) int64.
Raises InputError: kind "no_points", "not_finite", "contradicting_points", "anisotropy"; Cancelled.)");
}

}  // namespace realmodel::bindings
