# SPDX-License-Identifier: GPL-3.0-or-later
"""LAS files of curves that a test knows."""

import numpy as np


def las_text(well, depths, curves, unit="M", null=-999.25, version="2.0", wrap=False, uwi=""):
    """The text of a LAS file. curves: {mnemonic.unit: values (N,)}, NaN for none."""
    names = (
        f" WELL. WELL : {well}\n UWI . UWI : {uwi}\n"
        if version.startswith("1")
        else (f" WELL. {well} : WELL\n UWI . {uwi} : UWI\n")
    )
    head = (
        f"~Version Information\n VERS. {version} : CWLS\n WRAP. {'YES' if wrap else 'NO'} : wrap\n"
        f"~Well\n STRT.{unit} {depths[0]} : start\n STOP.{unit} {depths[-1]} : stop\n STEP.{unit} 0 : step\n"
        f" NULL. {null} : null\n{names}~Curve Information\n DEPT.{unit} : depth\n"
    )
    head += "".join(f" {name} : a curve\n" for name in curves) + "~A\n"
    rows = []
    for depth, *values in zip(depths, *curves.values(), strict=True):
        texts = [repr(float(null if np.isnan(value) else value)) for value in values]
        rows.append(f"{depth!r}\n " + "\n ".join(texts) if wrap else " ".join([repr(depth), *texts]))
    return head + "\n".join(rows) + "\n"
