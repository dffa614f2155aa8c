# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects of the real faults of ../shared/data, which name its files where they lie."""

from . import places

DROGON_HORIZONS = ("BaseVolantis", "TopVolon", "TopTherys", "TopVolantis")  # oldest first
_DROGON_REGION = "[[461537, 5926637], [467404, 5930024], [462016, 5939355], [456149, 5935968]]"

_CALIFORNIA = (  # that lie in a square of 120 km around San Bernardino, or reach into it
    "PNRA-SJFZ-SBRN-Rialto_Colton_fault-CFM4",
    "SAFS-SGPR-SBRN-San_Bernardino_cross_fault-CFM5",
    "PNRA-CRSF-USAV-Fontana_Seismicity_lineament-CFM1",
    "WTRA-SMFZ-CCMG-Cucamonga_fault_low_dip-CFM5",
    "WTRA-SGMF-STDC-South_Fork_Stoddard_Canyon_fault_truncated-CFM5",
    "ETRA-CLGZ-SCHS-Cleghorn_fault_steep-CFM5",
    "PNRA-SJFZ-SJCV-Casa_Loma_fault-CFM4",
    "ETRA-CLGZ-NCHS-Grass_Valley_fault_steep-CFM5",
    "SAFS-SAFZ-SBMT-Mission_Creek_fault_strand_steep-CFM4",
    "WTRA-USAV-USAV-Upland_fault_dipslip-CFM1",
    "WTRA-USAV-USAV-San_Jose_fault-CFM5",
    "PNRA-SJFZ-SJCV-Hot_Springs_fault-CFM4",
    "SAFS-SGPR-SJMT-Beaumont_A_blind_fault-CFM5",
    "SAFS-SAFZ-COAV-Banning_NPS_fault_splay-CFM4",
    "OCBA-NIRC-DANA-Newport_Inglewood_fault-CFM5",
    "PNRA-HSSF-MRHS-Murrieta_Hotsprings_fault-CFM4",
    "PNRA-SJFZ-ANZA-Hot_Springs_Buck_Ridge_link-CFM4",
    "MJVA-CREC-CMPR-Camp_Rock_fault-CFM5",
    "PNRA-ELSZ-WHIT-Workman_Hill_fault-CFM1",
    "PNRA-ELSZ-WHIT-Whittier_Heights_fault-CFM1",
)


def drogon(folder, edge_length=200, method="natural_neighbour"):
    """The project file of a reservoir: four horizons picked block by block, and six faults as sticks."""
    data = places.REAL_DATA / "drogon_faults"
    text = f'format = 1\nname = "drogon faults"\n[[rock]]\nname = "drogon"\nregion = {_DROGON_REGION}\n'
    text += f"edge_length = {edge_length}\n"
    for name in DROGON_HORIZONS:
        text += f'[[rock.surface]]\nname = "{name}"\npoints = "{(data / name).as_posix()}.poi"\n'
        text += f'z_axis = "down"\nmethod = "{method}"\nextrapolate = "nearest"\n'
    for number in range(1, 7):
        text += f'[[fault]]\nname = "F{number}"\npoints = "{(data / f"F{number}.pol").as_posix()}"\n'
        text += 'z_axis = "down"\ndies_out = true\nextend = 100\n'
    return _written(folder, text)


def california(folder, faults=None):
    """The project file of a box of rock with faults of southern California: level surfaces."""
    data = places.REAL_DATA / "california_faults"
    corners = "[[411000, 3710000], [531000, 3710000], [531000, 3830000], [411000, 3830000]]"
    text = f'format = 1\nname = "california"\n[[rock]]\nname = "crust"\nregion = {corners}\n'
    text += "edge_length = 4000\nbase_elevation = -15000\n"
    for number, height in enumerate((-10000, -5000, -500)):
        text += f'[[rock.surface]]\nname = "S{number}"\nmethod = "constant"\nvalue = {height}\n'
    for name in _CALIFORNIA[:faults]:
        text += f'[[fault]]\nname = "{name}"\nmesh = "{(data / name).as_posix()}.ts"\ndies_out = true\n'
    return _written(folder, text)


def _written(folder, text):
    path = folder / "project.toml"
    path.write_text(text, encoding="utf-8")
    return path
