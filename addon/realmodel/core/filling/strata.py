# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of beds in a solid."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..base.errors import UsageError
from ..project.library import Library, Property
from ..project.looks import LOOKS, look_of

# Of each palette: the name of a rock, which its look follows from, and its color.
PALETTES: dict[str, tuple[tuple[str, str], ...]] = {
    "canyon": (
        ("Red Sandstone", "#b5653f"),
        ("Buff Sandstone", "#d6a872"),
        ("Maroon Shale", "#7d4238"),
        ("Cream Limestone", "#dcc9a0"),
        ("Orange Siltstone", "#c98550"),
    ),
    "cliff": (
        ("Chalk", "#e4dfcf"),
        ("Gray Marl", "#9a9c92"),
        ("Limestone", "#cbbf9f"),
        ("Yellow Sandstone", "#cfae6b"),
        ("Dark Shale", "#63666a"),
    ),
    "volcanic": (
        ("Basalt", "#4d4c50"),
        ("Red Tuff", "#8e4a3c"),
        ("Ash Tuff", "#a39a8e"),
        ("Andesite Lava", "#6e6661"),
        ("Ocher Clay", "#b98a4c"),
    ),
    "coal": (
        ("Gray Sandstone", "#a59e8c"),
        ("Coal", "#2e2c30"),
        ("Gray Mudstone", "#77787a"),
        ("Brown Siltstone", "#8c7559"),
        ("Pale Limestone", "#c9c3ac"),
    ),
    "desert": (
        ("Pink Sandstone", "#d59a83"),
        ("White Gypsum", "#e6ded3"),
        ("Green Marl", "#94a184"),
        ("Violet Clay", "#86647a"),
        ("Ocher Sandstone", "#d3a256"),
    ),
}


def rocks_of_beds(count: int, palette: str, seed: int) -> tuple[Library, list[int]]:
    """The library of a palette, and the number in it of each bed's rock: unlike those of the two beds
    beneath."""
    entries = PALETTES[palette]
    library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(entries, 1)])
    numbers: list[int] = []
    for chance in np.random.default_rng(seed).random(count).tolist():
        free = [n for n in range(1, len(entries) + 1) if n not in numbers[-2:]]
        numbers.append(free[int(chance * len(free))])
    return library, numbers


def hardness_of_beds(count: int, strata: Strata) -> np.ndarray:
    """(B,) how well each bed withstands weathering, from 0 to 1: that of the look of its rock."""
    _, rocks = rocks_of_beds(count, strata.palette, strata.seed)
    hardness = [LOOKS[look_of(name)].hardness for name, _ in PALETTES[strata.palette]]
    return np.array(hardness)[np.array(rocks) - 1]


MOST_BEDS = 200
MOST_FAULTS = 40
MOST_PEGS = 20  # on a bed
STEEPEST = 85.0  # degrees: steeper beds would hardly have one height at each position
UPRIGHT, RECUMBENT = 90.0, 10.0  # degrees: the greatest and the least dip of axial planes

# (least, greatest) of what is bounded
_BOUNDS: dict[str, tuple[float, float]] = {
    "beds": (1, MOST_BEDS),
    "thickness": (0.0, math.inf),
    "variation": (0.0, 1.0),
    "dip": (0.0, STEEPEST),
    "fold_amplitude": (0.0, math.inf),
    "fold_wavelength": (0.0, math.inf),
    "axial_dip": (RECUMBENT, UPRIGHT),
    "faults": (0, MOST_FAULTS),
    "throw": (0.0, math.inf),
    "unconformity": (0.0, 0.95),
    "gap": (0.0, math.inf),
    "pegs": (0, MOST_PEGS),
    "peg_size": (0.0, math.inf),
    "seed": (0, 2**31 - 1),
}
_RIGHT_ANGLE = 1e-3  # degrees: how far a fault may be from it
_WHOLE = ("beds", "faults", "pegs", "seed")


@dataclass(frozen=True)
class Strata:
    """How beds lie in a solid. Lengths are in model units, angles in degrees, azimuths clockwise from north,
    the direction of y.

    beds: how many. thickness: of a bed on average, at right angles to the bedding before it is folded; 0: so
    thick that they fill the solid. Otherwise they lie in its middle, and the lowest and the highest bed take
    the rest. variation: how much beds differ, from 0, not at all, to 1.
    dip: up to 85, toward the azimuth dip_direction. fold_amplitude: at right angles to the bedding, of folds
    with this fold_wavelength and the azimuth fold_axis; one of both 0: none. axial_dip: of the axial planes
    of folds, from 90, upright, to 10, recumbent. They dip to the left of the azimuth fold_axis, so folds lean
    to its right, and their limbs are overturned where the folds are steep enough.
    faults: how many, vertical ones with this throw and the azimuth fault_strike; where folds lean, it is at
    right angles to fold_axis.
    unconformity: at which share of the height, from below, an erosion surface cuts tilted, folded and faulted
    beds, which level ones cover; 0: none.
    gap: between beds, and between the two sides of a fault, for a print in parts: at right angles to the
    bedding before it is folded. pegs: up to so many on each bed, square and peg_size wide; they reach as far
    into the bed above, but at most through half of it, and have the play of the gap around them. None is on
    an unconformity, and there are none where folds lean.
    base: the elevation down to which an open mesh is filled; None: as far beneath its lowest point as its
    highest is above. palette: of the rocks. seed: of thicknesses, rocks, and the positions of folds and
    faults.

    Raises UsageError for a value out of its range.
    """

    beds: int = 12
    thickness: float = 0.0
    variation: float = 0.5
    dip: float = 0.0
    dip_direction: float = 90.0
    fold_amplitude: float = 0.0
    fold_wavelength: float = 0.0
    fold_axis: float = 0.0
    axial_dip: float = UPRIGHT
    faults: int = 0
    throw: float = 0.0
    fault_strike: float = 0.0
    unconformity: float = 0.0
    gap: float = 0.0
    pegs: int = 0
    peg_size: float = 0.0
    base: float | None = None
    palette: str = "canyon"
    seed: int = 0

    def __post_init__(self) -> None:
        for name in (parameter.name for parameter in fields(self) if parameter.name in _BOUNDS):
            _check(name, getattr(self, name))
        for name in ("dip_direction", "fold_axis", "fault_strike"):
            _number(name, getattr(self, name))
        if self.base is not None:
            _number("base", self.base)
        if self.palette not in PALETTES:
            raise UsageError(f"palette must be one of {', '.join(PALETTES)}, not {self.palette!r}")
        if self.pegs and not (self.peg_size and self.gap):
            raise UsageError(
                "peg_size and gap must be above 0 where there are pegs: these have play in their holes"
            )
        if self.has_leaning_folds:
            self._check_lean()
        if self.unconformity and self.beds < 2:
            raise UsageError("beds must be 2 or more where there is an unconformity: one below it, one above")

    @property
    def is_folded(self) -> bool:
        """Whether there are folds: both their numbers are above 0."""
        return self.fold_amplitude > 0 and self.fold_wavelength > 0

    @property
    def has_leaning_folds(self) -> bool:
        """Whether there are folds whose axial planes are not vertical."""
        return self.is_folded and self.axial_dip < UPRIGHT

    def _check_lean(self) -> None:
        """What is vertical in the space in which folds stand upright would lean with them."""
        if self.pegs:
            raise UsageError("pegs must be 0 if axial_dip is below 90: they would be inclined like the folds")
        off = (self.fault_strike - self.fold_axis) % 180.0 - 90.0
        if self.faults and abs(off) > _RIGHT_ANGLE:
            raise UsageError(
                f"fault_strike must be at right angles to fold_axis where axial_dip is below 90, such as "
                f"{(self.fold_axis + 90.0) % 180.0:g}: other faults would be inclined like the folds"
            )


def _check(name: str, value: Any) -> None:
    low, high = _BOUNDS[name]
    if name in _WHOLE and (isinstance(value, bool) or not hasattr(value, "__index__")):
        raise UsageError(f"{name} must be a whole number, not {value!r}")
    if not low <= _number(name, value) <= high:
        bounds = f"at least {low:g}" if math.isinf(high) else f"from {low:g} to {high:g}"
        raise UsageError(f"{name} must be {bounds}, not {value!r}")


def _number(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} must be a number, not {value!r}") from error
    if not math.isfinite(number):
        raise UsageError(f"{name} must be finite")
    return number
