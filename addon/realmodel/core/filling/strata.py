# SPDX-License-Identifier: GPL-3.0-or-later
"""What says how beds lie in a solid."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ..base.errors import UsageError
from .palettes import PALETTES

MOST_BEDS = 200
MOST_FAULTS = 40
MOST_PEGS = 20  # on a bed
STEEPEST = 85.0  # degrees: steeper beds would hardly have one height at each position

# (least, greatest) of what is bounded
_BOUNDS: dict[str, tuple[float, float]] = {
    "beds": (1, MOST_BEDS),
    "thickness": (0.0, math.inf),
    "variation": (0.0, 1.0),
    "dip": (0.0, STEEPEST),
    "dip_direction": (-360.0, 360.0),
    "fold_amplitude": (0.0, math.inf),
    "fold_wavelength": (0.0, math.inf),
    "fold_axis": (-360.0, 360.0),
    "faults": (0, MOST_FAULTS),
    "throw": (0.0, math.inf),
    "fault_strike": (-360.0, 360.0),
    "unconformity": (0.0, 0.95),
    "gap": (0.0, math.inf),
    "pegs": (0, MOST_PEGS),
    "peg_size": (0.0, math.inf),
    "seed": (0, 2**31 - 1),
}
_WHOLE = ("beds", "faults", "pegs", "seed")


@dataclass(frozen=True)
class Strata:
    """How beds lie in a solid. Lengths are in model units, angles in degrees, azimuths clockwise from north,
    the direction of y.

    beds: how many. thickness: of a bed on average, at right angles to the bedding before it is folded; 0: so
    thick that they fill the solid. Otherwise they lie in its middle, and the lowest and the highest bed take
    the rest. variation: how much beds differ, from 0, not at all, to 1.
    dip: up to 85, towards the azimuth dip_direction. fold_amplitude: at right angles to the bedding, of folds
    with this fold_wavelength and the azimuth fold_axis; one of both 0: none. faults: how many, vertical ones
    with this throw and the azimuth fault_strike.
    unconformity: at which share of the height, from below, an erosion surface cuts tilted, folded and faulted
    beds, which level ones cover; 0: none.
    gap: between beds, and between the two sides of a fault, for a print in parts: at right angles to the
    bedding before it is folded. pegs: up to so many on each bed, square and peg_size wide; they reach as far
    into the bed above, but at most through half of it, and have the play of the gap around them. None is on
    an unconformity.
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

    def __post_init__(self):
        for name in (each.name for each in fields(self) if each.name in _BOUNDS):
            _check(name, getattr(self, name))
        if self.base is not None:
            _number("base", self.base)
        if self.palette not in PALETTES:
            raise UsageError(f"palette must be one of {', '.join(PALETTES)}, not {self.palette!r}")
        if self.pegs and not (self.peg_size and self.gap):
            raise UsageError(
                "peg_size and gap must be above 0 where there are pegs: these have play in their holes"
            )
        if self.unconformity and self.beds < 2:
            raise UsageError("beds must be 2 or more where there is an unconformity: one below it, one above")

    @property
    def is_folded(self) -> bool:
        """Whether there are folds: both their numbers are above 0."""
        return self.fold_amplitude > 0 and self.fold_wavelength > 0


def _check(name: str, value) -> None:
    low, high = _BOUNDS[name]
    if name in _WHOLE and (isinstance(value, bool) or not hasattr(value, "__index__")):
        raise UsageError(f"{name} must be a whole number, not {value!r}")
    if not low <= _number(name, value) <= high:
        bounds = f"at least {low:g}" if math.isinf(high) else f"from {low:g} to {high:g}"
        raise UsageError(f"{name} must be {bounds}, not {value!r}")


def _number(name: str, value) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} must be a number, not {value!r}") from error
    if not math.isfinite(number):
        raise UsageError(f"{name} must be finite")
    return number
