# SPDX-License-Identifier: GPL-3.0-or-later
"""Semivariograms: the difference of heights as a function of distance."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import counted
from ..base.units import number_text

# f(t) of each model, t = h / range, along the azimuth. The factors of the last two make f(1) = 0.95.
_A, _B = 4.743864518390579, 5.918649346310188
_SHAPES = {
    "spherical": lambda t: np.where(t < 1, 1.5 * t - 0.5 * t**3, 1.0),
    "exponential": lambda t: -np.expm1(-3 * t),
    "gaussian": lambda t: -np.expm1(-3 * t**2),
    "cubic": lambda t: np.where(t < 1, t**2 * (7 - 8.75 * t + 3.5 * t**3 - 0.75 * t**5), 1.0),
    "matern32": lambda t: 1 - (1 + _A * t) * np.exp(-_A * t),
    "matern52": lambda t: 1 - (1 + _B * t + (_B * t) ** 2 / 3) * np.exp(-_B * t),
    "wave": lambda t: -np.expm1(-3 * t**2),
}
VARIOGRAMS = {  # label and tooltip in the panel
    "spherical": ("Spherical", "Linear at the origin, reaches the sill at the range: for rough elevations"),
    "exponential": ("Exponential", "Linear at the origin, approaches the sill: for rough elevations"),
    "gaussian": (
        "Gaussian",
        "Parabolic at the origin: for very smooth elevations; unstable with many close points",
    ),
    "cubic": ("Cubic", "Parabolic at the origin, reaches the sill at the range: for smooth elevations"),
    "matern32": ("Matern 3/2", "Between exponential and Gaussian, rougher than Matern 5/2"),
    "matern52": ("Matern 5/2", "Between exponential and Gaussian, smoother than Matern 3/2"),
    "wave": (
        "Wave",
        "Rises and falls across the azimuth of its anisotropy, `ratio` times in a range: for folds",
    ),
}
NO_ANISOTROPY = {"ratio": 1.0, "azimuth": 0.0}

# A fit is not significant where neighbouring points differ as much as any, or its range exceeds the data.
_PURE_NUGGET = 0.75
_FEW_PAIRS = 30
RANGE_BEYOND = "the range of the fitted variogram"  # in the warning that concerns variances alone
NO_DEVIATION = "no standard deviation is given"  # begins the warning where data show no variogram
# Of data, beyond the terms of a trend: two standard deviations of fewer hold less than 90 % of the errors
# (Student's distribution), and two contacts of nearly equal height would seem certain.
_LEAST_FREE = 5
_FAR_RANGE = 1.5  # extents of the points: near twice of them the fit has found no sill


@dataclass(frozen=True)
class Structure:
    """One part of a nested variogram: sill * f(h / range), f that of the `model`. anisotropy: {ratio,
    azimuth}, or None for that of the interpolation; of a wave its crests in a range, and their azimuth."""

    model: str
    range: float
    sill: float
    anisotropy: dict | None = None

    def settings(self) -> dict:
        """The settings as in a project file."""
        settings = {"model": self.model, "range": self.range, "sill": self.sill}
        return settings if self.anisotropy is None else {**settings, "anisotropy": self.anisotropy}


@dataclass(frozen=True)
class Variogram:
    """gamma(h) = nugget + (sill - nugget) f(h / range), 0 at h = 0; the sill includes the nugget.

    `model` is spherical, exponential, gaussian, cubic, matern32, matern52 or wave; `range` is the practical
    range in model units, `sill` and `nugget` are in units of height squared. A nested variogram has
    `structures`, whose parts are added to the nugget; then `model` is "nested", `range` the longest range,
    that of waves aside, and `sill` the whole. `anisotropy` is {ratio, azimuth} where one was found with a
    fit, `range` then the one along the azimuth; else None: that of the interpolation. Where it was fitted to
    points, `lags` (L,), `gamma` (L,) and `pairs` (L,) are the experimental semivariogram, with distances
    under the anisotropy; else they are None.
    """

    model: str
    range: float
    sill: float
    nugget: float = 0.0
    structures: tuple[Structure, ...] = ()
    anisotropy: dict | None = None
    lags: np.ndarray | None = field(default=None, compare=False, repr=False)
    gamma: np.ndarray | None = field(default=None, compare=False, repr=False)
    pairs: np.ndarray | None = field(default=None, compare=False, repr=False)

    @classmethod
    def from_settings(cls, settings: dict) -> Variogram:
        """The variogram of the dictionary that `settings` returns."""
        if "structures" not in settings:
            return cls(**settings)
        structures = tuple(Structure(**part) for part in settings["structures"])
        nugget = settings["nugget"]
        sill = nugget + sum(part.sill for part in structures)
        return cls("nested", _longest(structures), sill, nugget, structures)

    @classmethod
    def from_fit(cls, fit: dict, finds_anisotropy: bool) -> Variogram:
        """The variogram that the native fit returns; finds_anisotropy: with the fitted anisotropy."""

        def along(ratio: float, azimuth: float) -> dict | None:
            return {"ratio": ratio, "azimuth": azimuth} if finds_anisotropy and ratio != 1.0 else None

        anisotropy = along(fit["anisotropy_ratio"], fit["anisotropy_azimuth"])
        nugget, sill = fit["nugget"], fit["sill"]
        experimental = {name: fit[name] for name in ("lags", "gamma", "pairs")}
        if not fit["further"]:
            return cls(fit["model"], fit["range"], sill, nugget, anisotropy=anisotropy, **experimental)
        further = [
            Structure(model, range_, part, along(*axes)) for model, range_, part, *axes in fit["further"]
        ]
        first = sill - nugget - sum(part.sill for part in further)
        structures = (Structure(fit["model"], fit["range"], first, anisotropy), *further)
        return cls("nested", _longest(structures), sill, nugget, structures, anisotropy, **experimental)

    def with_least_nugget(self, least: float) -> Variogram:
        """The same with a nugget no smaller than the least one; the sill grows with it."""
        more = max(least - self.nugget, 0.0)
        return replace(self, nugget=self.nugget + more, sill=self.sill + more) if more else self

    @property
    def fitted(self) -> bool:
        """Whether it was fitted to points."""
        return self.lags is not None

    def experimental(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`lags`, `gamma` and `pairs` of a fitted variogram."""
        assert self.lags is not None and self.gamma is not None and self.pairs is not None
        return self.lags, self.gamma, self.pairs

    def semivariance(self, distance: ArrayLike) -> np.ndarray:
        """gamma at each `distance`, (N,) float64, in the direction of the longest range; to draw it beside
        `lags` and `gamma`."""
        distance = np.asarray(distance, np.float64)
        gamma = np.full(distance.shape, self.nugget)
        for part in self.parts():
            gamma = gamma + part.sill * _SHAPES[part.model](distance / part.range)
        return np.where(distance > 0, gamma, 0.0)

    def settings(self) -> dict:
        """The settings as in a project file."""
        if self.structures or self.anisotropy:
            return {"nugget": self.nugget, "structures": [part.settings() for part in self.parts()]}
        return {"model": self.model, "range": self.range, "sill": self.sill, "nugget": self.nugget}

    def parts(self) -> tuple[Structure, ...]:
        """The structures of a sum, or the only one."""
        structure = Structure(self.model, self.range, self.sill - self.nugget, self.anisotropy)
        return self.structures or (structure,)

    def native(self, anisotropy: dict | None) -> dict:
        """As the native kriging functions take it. anisotropy: of parts that have none of their own."""
        first, *further = self.parts()
        anisotropy = anisotropy or NO_ANISOTROPY
        first_anisotropy = first.anisotropy or anisotropy
        return {
            "model": first.model,
            "range": first.range,
            "sill": self.sill,
            "nugget": self.nugget,
            "anisotropy_ratio": first_anisotropy["ratio"],
            "anisotropy_azimuth": first_anisotropy["azimuth"],
            "further": [
                (
                    part.model,
                    part.range,
                    part.sill,
                    (part.anisotropy or anisotropy)["ratio"],
                    (part.anisotropy or anisotropy)["azimuth"],
                )
                for part in further
            ],
        }


def _longest(structures: Sequence[Structure]) -> float:
    """The longest range, of waves where there is nothing else: they continue far beyond what one shows."""
    return max([part.range for part in structures if part.model != "wave"] or [structures[0].range])


def missing_data(variogram: Variogram, points: int, dips: int, terms: int) -> str | None:
    """A warning where data are too few, or too equal, to show how heights vary: no standard deviation follows
    from a variogram that is fitted to them. points, dips: how many; a dip counts as the two slopes that it
    is. terms: of the trends that are fitted with it."""
    least = _LEAST_FREE + terms
    if points + 2 * dips < least:
        counts = counted(points, "point") + (f" and {counted(dips, 'dip')}" if dips else "")
        missing = f"a variogram takes {least} points or more (a dip counts as two), and the data are {counts}"
    elif not dips and not variogram.experimental()[1].any():
        missing = "near points have equal elevations, so they show no variogram"
    else:
        return None
    return f"{NO_DEVIATION}: {missing}; measure more, or set a variogram by hand"


def lacks_deviation(warnings: Iterable[str]) -> list[str]:
    """Those of an interpolation's warnings that say why it gives no standard deviation."""
    return [text for text in warnings if NO_DEVIATION in text]  # a compartment may be named before


def fit_warnings(
    variogram: Variogram, points: np.ndarray, has_trend: bool = False, has_dips: bool = False
) -> list[str]:
    """Warnings about a fitted variogram of little significance, as sentences. has_trend: heights far from
    points follow a trend. has_dips: it was fitted to dips, too, which show much of it."""
    warnings = []
    lags, _, counts = variogram.experimental()
    pairs = int(counts.sum())
    if pairs < _FEW_PAIRS and not has_dips:
        number = f"only {counted(pairs, 'pair')}" if pairs else "no pair"
        warnings.append(
            f"the variogram is fitted to {number} of points, so elevations far from them, and their "
            "standard deviations, are unreliable; set one by hand, or use the method 'plane' or 'tin'"
        )
    elif pairs >= _FEW_PAIRS and variogram.semivariance(lags[0]) > _PURE_NUGGET * variogram.sill:
        warnings.append(
            "the fitted variogram is nearly pure nugget: neighboring points differ almost as much as "
            "distant ones, so kriging gives hardly more than local means; check the points for errors"
        )
    extent = float(np.hypot(*np.ptp(points[:, :2], axis=0)))
    if not has_trend and variogram.range > _FAR_RANGE * extent > 0 and pairs >= _FEW_PAIRS:
        warnings.append(
            f"{RANGE_BEYOND}, {number_text(variogram.range)}, far exceeds the extent of "
            f"the points, {number_text(extent)}: its sill, and variances far from points, are extrapolated; "
            "the elevations may follow a trend: try universal kriging"
        )
    return warnings
