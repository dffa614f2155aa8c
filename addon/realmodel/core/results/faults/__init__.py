# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on both sides of a fault, on the fault unrolled along its strike, and the throws along it.

Input: `ModelData`. Output: `JuxtapositionData`, its `Drawing`.
"""
