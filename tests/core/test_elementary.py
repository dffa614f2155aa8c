# SPDX-License-Identifier: GPL-3.0-or-later
"""Elementary functions of our own, and that nothing that reaches a model is computed with the C library's."""

import re
from pathlib import Path

import numpy as np
import pytest
from realmodel.core.base import algebra

ROOT = Path(__file__).resolve().parents[2]
FUNCTIONS = r"(expm1|exp2?|log(2|10|1p)?|pow|cbrt|hypot|a?(sin|cos|tan)h?|atan2)"


@pytest.mark.parametrize("name", ["sin", "cos", "exp"])
def test_numbers_and_arrays(name):
    ours, numpys = getattr(algebra, name), getattr(np, name)
    x = np.linspace(-20, 20, 4001).reshape(-1, 1)
    np.testing.assert_array_max_ulp(ours(x), numpys(x), 2)
    assert isinstance(ours(0.5), float)
    assert ours(0.5) == ours(np.array([0.5]))[0]


@pytest.mark.parametrize(("ours", "numpys"), [(algebra.atan2, np.arctan2), (algebra.hypot, np.hypot)])
def test_of_two_numbers(ours, numpys):
    y, x = np.linspace(-3, 3, 101)[:, None], np.linspace(-2, 2, 50)
    np.testing.assert_array_max_ulp(ours(y, x), numpys(y, x), 3)
    assert isinstance(ours(1, 2.5), float)


def test_the_native_part_calls_none_of_the_c_library():
    calls = [
        f"{path.relative_to(ROOT)}: {line.strip()}"
        for path in sorted((ROOT / "native" / "src").rglob("*.?pp"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.search(rf"\b{FUNCTIONS}\(", re.sub(rf"elementary::{FUNCTIONS}\(", "", line.split("//")[0]))
    ]
    assert not calls, "\n".join(calls)
