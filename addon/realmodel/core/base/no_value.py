# SPDX-License-Identifier: GPL-3.0-or-later
"""What programs write where there is no value."""

# In small letters.
NO_VALUE = frozenset(
    (
        *("", "-", "--", "na", "n/a", "n.a.", "nan", "nr", "null", "none", "absent", "?", "#n/a", "nd"),
        *("n.d.", "*", "undef", "undefined", "no data", "nodata", "missing"),
    )
)
# Coordinates that may be real, and that often mean that there is none.
OFTEN_NO_VALUE = (
    *(-9999.0, -99999.0, -999.0, -999.25, -9999.25, -999.9, -999.99, -999999.0, -9999999.0, -32768.0),
    *(-32767.0, 9999.0, 99999.0, 999.25, 999999.0, 9999999.0, 9999900.0, 1e30, -1e30, 1e31, -1e31, 1e20),
    *(-1e20, 1e38, -1e38, 1.70141e38, -3.4028235e38, 3.4028235e38, -3.4028234663852886e38),
    *(3.4028234663852886e38, 1e34, 1e33),
)
