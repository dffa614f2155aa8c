# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hunt needs of a kind of cases."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Hunted:
    """random_case(seed), failures_of(case), minimize(case, still_fails, steps), load_case(path),
    save_case(case, path, why); the folder of those that were found."""

    random_case: Callable
    failures_of: Callable
    minimize: Callable
    load_case: Callable
    save_case: Callable
    corpus: Path
