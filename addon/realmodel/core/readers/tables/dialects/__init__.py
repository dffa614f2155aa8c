# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of text with special headers of other programs, one module for each.

Input: the first lines of a file. Output: the names of its columns, their units, and where its rows begin.
"""

from .charisma import begins_as_charisma, charisma_header
from .cps3_lines import NOT_ROWS as OF_CPS3
from .cps3_lines import begins_as_cps3_lines, cps3_lines_header
from .dialect import Dialect
from .earthvision import begins_as_earthvision, earthvision_header
from .geo_eas import begins_as_geo_eas, geo_eas_header
from .geosoft import NOT_ROWS as OF_GEOSOFT
from .geosoft import begins_as_geosoft, geosoft_header
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
    Dialect("Charisma horizons", (".charisma", ".txt"), begins_as_charisma, charisma_header),
    Dialect("Geo-EAS", (".dat", ".gslib", ".eas"), begins_as_geo_eas, geo_eas_header),
    Dialect("Geosoft XYZ", (".xyz",), begins_as_geosoft, geosoft_header, OF_GEOSOFT),
)

__all__ = ["DIALECTS", "Dialect"]
