# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian fields with the covariance of a variogram, by turning bands.

A field in space is a sum of processes on lines in all directions (Matheron 1973; Chiles and Delfiner 2012,
"Geostatistics", section 7.4); in plan it is drawn at z = 0. A process is drawn by its Fourier coefficients
(Dietrich and Newsam 1997), so that fields of different variograms may be correlated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.algebra import cos, dot, exp, hypot, norm, sin
from ...base.work import Work, native_module
from ...settings.variogram import NO_ANISOTROPY, Structure, Variogram

LINES = 320
_STEPS = 64  # samples of a process in a range
_ENDS = 4.0  # ranges, at which all covariances have ended
_MOST_SAMPLES = 1 << 16
_LINES_AT_ONCE = 64
_MOST_KEPT = 1 << 13  # numbers of a line that are kept for a younger surface: 20 MB for all lines

# Covariance on a line, C1(t) = d/dt (t C3(t)) with t = h / range, of 1 - f(t) in variogram.py.
_A, _B = 4.743864518390579, 5.918649346310188
_ON_LINE = {
    "spherical": lambda t: np.where(t < 1, 1 - 3 * t + 2 * t**3, 0.0),
    "exponential": lambda t: (1 - 3 * t) * exp(-3 * t),
    "gaussian": lambda t: (1 - 6 * t**2) * exp(-3 * t**2),
    "cubic": lambda t: np.where(t < 1, 1 - 21 * t**2 + 35 * t**3 - 21 * t**5 + 6 * t**7, 0.0),
    "matern32": lambda t: (1 + _A * t - (_A * t) ** 2) * exp(-_A * t),
    "matern52": lambda t: (1 + _B * t - (_B * t) ** 3 / 3) * exp(-_B * t),
}


class Noise:
    """Independent normal numbers for the fields of one surface, drawn on demand, the same for the same seed.
    With an older surface's noise they are correlated with that by `correlation`."""

    def __init__(self, seed: tuple[int, ...], older: Noise | None = None, correlation: float = 0.0):
        self._seed, self._older, self._correlation = seed, older, correlation
        self._drawn: dict[int, np.ndarray] | None = None  # by part, for a younger surface
        self.processes: dict[tuple, np.ndarray] = {}  # along the lines of its fields, asked again and again
        if older is not None and correlation:
            older._drawn = {}

    def normal(self, part: int, count: int) -> np.ndarray:
        """(count,) float64 of one part, from -1; a longer draw begins with the same numbers."""
        if self._drawn is None:
            return self._normal(part, count)
        numbers = self._drawn.get(part)
        if numbers is None or len(numbers) < count:
            numbers = self._normal(part, count)
            if count <= _MOST_KEPT:
                self._drawn[part] = numbers
        return numbers[:count].copy()

    def chosen(self, part: int, free: int) -> tuple[float, float]:
        """A number from 0 to 1, and one of the chi-square distribution with so many degrees of freedom."""
        generator = self._generator(part)
        return float(generator.random()), float((generator.standard_normal(free) ** 2).sum())

    def _generator(self, part: int) -> np.random.Generator:
        return np.random.Generator(np.random.Philox(np.random.SeedSequence((*self._seed, part + 1))))

    def _normal(self, part: int, count: int) -> np.ndarray:
        drawn = self._generator(part).standard_normal(count)
        if self._older is None or not self._correlation:
            return drawn
        share = self._correlation
        return share * self._older.normal(part, count) + math.sqrt(1 - share**2) * drawn


@dataclass(frozen=True)
class FieldArea:
    """The area of random fields, from one corner (2,) in plan to the other. Fields of one area have the
    correlation of their noises."""

    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class GaussianField:
    """A random field of mean 0 in an area, with the variogram's covariance without its nugget. anisotropy:
    {ratio, azimuth} of structures without an anisotropy."""

    variogram: Variogram
    anisotropy: dict | None
    area: FieldArea
    noise: Noise

    def at(self, work: Work, nodes: np.ndarray) -> np.ndarray:
        """(N,) float64: the field at nodes (N, 2)."""
        local = np.ascontiguousarray(nodes - (self.area.low + self.area.high) / 2)
        field = np.zeros(len(nodes))
        parts = self.variogram.parts()
        for number, part in enumerate(parts):
            if part.sill > 0 and part.model == "wave":
                field += self._of_wave(work, (number, len(parts) + number), part, local)
            elif part.sill > 0:
                field += self._of_structure(work, number, part, local)
        return field

    def _of_wave(
        self, work: Work, numbers: tuple[int, int], part: Structure, local: np.ndarray
    ) -> np.ndarray:
        """cos(v) A + sin(v) B, v turning as the wave does: A and B, fields of these numbers, have the
        covariance along its crests, and the sum has its own."""
        crests = part.anisotropy or self.anisotropy or NO_ANISOTROPY
        turn = 2 * math.pi / part.range * dot(local, _to_isotropic(crests)[1])
        plain = Structure("gaussian", part.range, part.sill, NO_ANISOTROPY)
        one, other = (self._of_structure(work, number, plain, local) for number in numbers)
        return cos(turn) * one + sin(turn) * other

    def _of_structure(self, work: Work, number: int, part: Structure, local: np.ndarray) -> np.ndarray:
        east, north = _directions().T[:, :, None]
        along, across = _to_isotropic(part.anisotropy or self.anisotropy or NO_ANISOTROPY)
        directions = east * along + north * across
        reach = hypot(*(self.area.high - self.area.low)) / 2
        reach *= float(norm(directions).max())  # how far lines go, both ways
        # half of it is as far as covariances count; a process as smooth as these needs them to end near 0
        length = 2 * max(2 * reach, _ENDS * part.range)
        samples = int(min(_MOST_SAMPLES, 2 ** math.ceil(math.log2(length / part.range * _STEPS))))
        step = length / samples
        distance = np.minimum(np.arange(samples), samples - np.arange(samples)) * step / part.range
        covariance = _ON_LINE[part.model](distance)
        spectrum = np.sqrt(np.maximum(np.fft.rfft(covariance).real, 0.0))
        # between two samples interpolation loses a third of what they differ, on average
        lost = (1.0 - _ON_LINE[part.model](np.array(step / part.range))) / 3
        scale = math.sqrt(part.sill / LINES / (1.0 - lost))
        starts = np.full(_LINES_AT_ONCE, -reach)
        needed = min(samples, math.ceil(2 * reach / step) + 2)
        field = np.zeros(len(local))
        for batch in range(LINES // _LINES_AT_ONCE):
            work.check()
            lines = slice(batch * _LINES_AT_ONCE, (batch + 1) * _LINES_AT_ONCE)
            key = (number, lines.start, part.model, part.range, length, samples, needed)
            values = self.noise.processes.get(key)
            if values is None:
                values = np.empty((_LINES_AT_ONCE, needed))
                for row in range(_LINES_AT_ONCE):
                    line = number * LINES + lines.start + row
                    values[row] = _process(spectrum, samples, self.noise, line)[:needed]
                if needed <= _MOST_KEPT:
                    self.noise.processes[key] = values
            field += work.native(
                native_module().line_sums,
                local,
                np.ascontiguousarray(directions[lines]),
                starts,
                values,
                step,
            )
        return scale * field


def _process(spectrum: np.ndarray, samples: int, noise: Noise, line: int) -> np.ndarray:
    """(samples,) float64 of variance 1 with the covariance whose roots of eigenvalues are given."""
    drawn = noise.normal(line, samples)
    # real and imaginary parts beside one another, so that fields of other lengths share the first ones
    waves = np.empty(samples // 2 + 1, complex)
    waves[1:-1] = (drawn[2::2] + 1j * drawn[3::2]) * math.sqrt(0.5)
    waves[0], waves[-1] = drawn[0], drawn[1]
    return np.fft.irfft(waves * spectrum, samples) * math.sqrt(samples)


def _directions() -> np.ndarray:
    """(LINES, 2) float64: the projections to the plan of directions that are spread evenly over a half
    sphere."""
    number = np.arange(LINES)
    height = (number + 0.5) / LINES
    around = number * math.pi * (3 - math.sqrt(5))  # the golden angle
    return np.sqrt(1 - height**2)[:, None] * np.column_stack([cos(around), sin(around)])


def _to_isotropic(anisotropy: dict) -> np.ndarray:
    """(2, 2): a direction times it is one in the plan whose ranges are the same in all directions."""
    ratio, azimuth = anisotropy["ratio"], math.radians(anisotropy["azimuth"])
    ratio = max(ratio, 1 / ratio)
    along = np.array([sin(azimuth), cos(azimuth)])
    across = np.array([cos(azimuth), -sin(azimuth)])
    return np.array([along, ratio * across])
