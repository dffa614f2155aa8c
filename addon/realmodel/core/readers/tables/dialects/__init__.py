# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of text with special headers of other programs, one module for each.

Input: the first lines of a file. Output: the names of its columns, their units, and where its rows begin.
"""

from .cps3_lines import NOT_ROWS as OF_CPS3
from .cps3_lines import begins_as_cps3_lines, cps3_lines_header
from .dialect import Dialect
from .earthvision import begins_as_earthvision, earthvision_header
from .openworks import NOT_ROWS as OF_OPENWORKS
from .openworks import begins_as_openworks, openworks_header
from .petrel import begins_as_petrel, petrel_header
from .rms import begins_as_rms, rms_header
from .zmap_points import begins_as_zmap_points, zmap_points_header

DIALECTS = (
    Dialect("Petrel points and well tops", (".txt", ".prn"), begins_as_petrel, petrel_header),
    Dialect("OpenWorks IJXYZ", (".ijxyz", ".dat"), begins_as_openworks, openworks_header, OF_OPENWORKS),
    Dialect("EarthVision", (".dat", ".2grd"), begins_as_earthvision, earthvision_header),
    Dialect("RMS points", (".rmsattr",), begins_as_rms, rms_header),
    Dialect("ZMAP+ points", (".zmap", ".dat"), begins_as_zmap_points, zmap_points_header),
    Dialect("CPS-3 lines", (".cps3", ".cps"), begins_as_cps3_lines, cps3_lines_header, OF_CPS3),
)

__all__ = ["DIALECTS", "Dialect"]
