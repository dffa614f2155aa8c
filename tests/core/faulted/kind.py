# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with faults and bodies, as a hunt takes them."""

from .case import CORPUS, load_case, save_case
from .generate import random_case
from .hunted import Hunted
from .judge import failures_of
from .minimize import minimize

HUNTED = Hunted(random_case, failures_of, minimize, load_case, save_case, CORPUS)
