# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight geological histories in closed form: formulas of surfaces with their rules, and what is measured of
them: logs of vertical holes, outcrops, dips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

LENGTH = 1000.0  # of the square region
BASE = -250.0
GRID = 25.0  # of the ground
FOOT = 400.0  # depth of the holes

Height = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Layer:
    """A surface. dips: how many are measured where it crops out."""

    name: str
    rule: str
    height: Height
    dips: int = 0


@dataclass(frozen=True)
class History:
    """Surfaces, oldest first; the youngest is the ground. holes, outcrops: how many are made. conformable:
    runs of names of surfaces that lie parallel to one another, as a geologist would tell."""

    name: str
    layers: Sequence[Layer]
    holes: int
    outcrops: int
    conformable: Sequence[Sequence[str]] = ()

    def heights(self, plan: np.ndarray) -> np.ndarray:
        """(S, N) of all surfaces at places (N, 2)."""
        x, y = plan[:, 0], plan[:, 1]
        return np.array([layer.height(x, y) + 0.0 * x for layer in self.layers])

    def block_at(self, points: np.ndarray) -> np.ndarray:
        """(N,) the block of points (N, 3) by the replay of docs/dev/geometry.md; -1 is air."""
        z, heights = points[:, 2], self.heights(points[:, :2])
        block = np.where(z <= heights[0], 0, -1)
        protects = self.layers[0].rule in ("base", "discontinuous")
        safe = (block == 0) & protects
        for number, layer in enumerate(self.layers[1:], 1):
            cuts = layer.rule in ("erosional", "discontinuous")
            below = z <= heights[number]
            if cuts:
                block = np.where(~below & ~safe, -1, block)
            block = np.where((block < 0) & below, number, block)
            if layer.rule in ("base", "discontinuous"):
                safe |= (block >= 0) | below
        return block

    def log(self, x: float, y: float, depth: float = FOOT) -> list[tuple[float, int]]:
        """(top, block) from the ground downward; the last entry is the foot of the hole with block -1."""
        heights = np.unique(self.heights(np.array([[x, y]]))[:, 0])[::-1]
        ground = float(self.heights(np.array([[x, y]]))[-1, 0])
        levels = [ground, *heights[(heights < ground) & (heights > ground - depth)].tolist(), ground - depth]
        found: list[tuple[float, int]] = []
        for top, bottom in pairwise(levels):
            block = int(self.block_at(np.array([[x, y, 0.5 * (top + bottom)]]))[0])
            if not found or found[-1][1] != block:
                found.append((top, block))
        return [*found, (ground - depth, -1)]

    def on_surface(self, x: float, y: float, z: float) -> int:
        """The surface through a place where two blocks meet."""
        return int(np.argmin(np.abs(self.heights(np.array([[x, y]]))[:, 0] - z)))

    def slope(self, number: int, x: float, y: float) -> tuple[float, float]:
        """(along x, along y) of a surface."""
        step = 0.01
        plan = np.array([[x + step, y], [x - step, y], [x, y + step], [x, y - step]])
        a, b, c, d = self.heights(plan)[number].tolist()
        return (a - b) / (2 * step), (c - d) / (2 * step)


def _wave(x, y, length, azimuth, phase=0.0):
    a = np.radians(azimuth)
    return np.sin(2 * np.pi * (x * np.sin(a) + y * np.cos(a)) / length + phase)


def _ground(x, y):
    return 300.0 + 25.0 * _wave(x, y, 900, 30) + 18.0 * _wave(x, y, 420, 100, 1.0)


def _hills(x, y):
    return 300.0 + 60.0 * _wave(x, y, 1100, 20, 0.5) + 35.0 * _wave(x, y, 500, 110, 2.0)


def _channel(x, y, across, width, depth, level):
    """A plain with a channel that winds along x."""
    way = y - across - 120.0 * np.sin(x / 160.0)
    return level - depth * np.exp(-((way / width) ** 2))


def _undulating():
    def bed(level):
        return lambda x, y: (
            level + 30.0 * _wave(x, y, 1400, 60) + 12.0 * _wave(x, y, 600, 150, 0.7) + 0.02 * x
        )

    return (
        *(Layer(f"H{k}", "conformable", bed(-20.0 + 60.0 * k), 3) for k in range(5)),
        Layer("ground", "erosional", _ground),
    )


def _onlap():
    def high(x, y):
        r = ((x - 550) / 260) ** 2 + ((y - 450) / 330) ** 2
        return -40.0 + 260.0 * np.exp(-r) + 20.0 * _wave(x, y, 500, 40)

    def bed(level, dip):
        return lambda x, y: level + dip * x + 6.0 * _wave(x, y, 800, 10)

    return (
        Layer("basement", "base", high, 6),
        *(Layer(f"L{k}", "conformable", bed(20.0 + 45.0 * k, 0.03), 3) for k in range(5)),
        Layer("ground", "erosional", _ground),
    )


def _unconformity():
    def bed(level):
        return lambda x, y: level + 0.35 * (x - 500) + 14.0 * _wave(x, y, 700, 120)

    def plain(x, y):
        return 170.0 + 22.0 * _wave(x, y, 900, 80) + 0.03 * y

    return (
        *(Layer(f"B{k}", "conformable", bed(-60.0 + 70.0 * k), 5) for k in range(4)),
        Layer("U", "erosional", plain, 3),
        Layer("C1", "conformable", lambda x, y: 225.0 + 0.03 * y + 10.0 * _wave(x, y, 700, 20), 3),
        Layer("C2", "conformable", lambda x, y: 275.0 + 0.03 * y + 10.0 * _wave(x, y, 700, 20), 3),
        Layer("ground", "erosional", _hills),
    )


def _channels():
    def first(x, y):
        return _channel(x, y, 330.0, 110.0, 170.0, 230.0)

    def second(x, y):
        return _channel(y, x, 620.0, 90.0, 130.0, 285.0)

    return (
        Layer("A", "base", lambda x, y: -10.0 + 25.0 * _wave(x, y, 900, 45), 2),
        Layer("B", "conformable", lambda x, y: 90.0 + 20.0 * _wave(x, y, 1000, 70), 3),
        Layer("C", "conformable", lambda x, y: 200.0 + 12.0 * _wave(x, y, 1000, 70), 3),
        Layer("base of K", "erosional", first, 4),
        Layer("top of K", "conformable", lambda x, y: 245.0 + 0.01 * x, 3),
        Layer("base of M", "discontinuous", second, 4),
        Layer("ground", "erosional", lambda x, y: 300.0 + 20.0 * _wave(x, y, 700, 45)),
    )


def _dipping():
    def bed(level):
        return lambda x, y: level + 0.7 * (y - 500) - 0.25 * (x - 500) + 25.0 * _wave(x, y, 800, 75)

    return (
        *(Layer(f"D{k}", "conformable", bed(-260.0 + 110.0 * k), 6) for k in range(7)),
        Layer("ground", "erosional", _hills),
    )


def _folded():
    def bed(level):
        def height(x, y):
            return level + 150.0 * _wave(x, y, 520, 75) + 0.1 * (y - 500) + 20.0 * _wave(x, y, 900, 10)

        return height

    return (
        *(Layer(f"F{k}", "conformable", bed(-60.0 + 75.0 * k), 10) for k in range(6)),
        Layer("ground", "erosional", _ground),
    )


def _discontinuous():
    def bed(level):
        return lambda x, y: level - 0.4 * (x - 500) + 40.0 * _wave(x, y, 600, 95)

    def thrust(x, y):
        return 110.0 + 0.18 * (x - 500) + 18.0 * _wave(x, y, 700, 20)

    return (
        *(Layer(f"P{k}", "conformable", bed(-80.0 + 80.0 * k), 5) for k in range(4)),
        Layer("T", "discontinuous", thrust, 5),
        Layer("Q1", "conformable", lambda x, y: 150.0 + 0.1 * (y - 500) + 30.0 * _wave(x, y, 800, 60), 4),
        Layer("Q2", "conformable", lambda x, y: 215.0 + 0.1 * (y - 500) + 30.0 * _wave(x, y, 800, 60), 4),
        Layer("R", "erosional", lambda x, y: 240.0 + 45.0 * _wave(x, y, 650, 140), 5),
        Layer("ground", "erosional", _hills),
    )


def _pinching():
    def lens(level, x0, y0, thick, width):
        def height(x, y):
            r = ((x - x0) / width) ** 2 + ((y - y0) / (0.7 * width)) ** 2
            return level + thick * (1.6 * np.exp(-r) - 0.6) + 15.0 * _wave(x, y, 1100, 35)

        return height

    return (
        Layer("base", "base", lambda x, y: 20.0 + 15.0 * _wave(x, y, 1100, 35), 2),
        Layer("lens 1", "conformable", lens(60.0, 300, 350, 90.0, 330), 4),
        Layer("lens 2", "conformable", lens(70.0, 700, 650, 110.0, 300), 4),
        Layer("cover", "conformable", lambda x, y: 165.0 + 15.0 * _wave(x, y, 1100, 35), 3),
        Layer("scour", "erosional", lambda x, y: 215.0 + 40.0 * _wave(x, y, 480, 65), 5),
        Layer("fill", "conformable", lambda x, y: 245.0 + 0.02 * x, 3),
        Layer("ground", "erosional", _ground),
    )


def _names(letter: str, count: int) -> tuple[str, ...]:
    return tuple(f"{letter}{k}" for k in range(count))


HISTORIES = (
    History("undulating", _undulating(), 20, 30, (_names("H", 5),)),
    History("onlap", _onlap(), 20, 30, (_names("L", 5),)),
    History("unconformity", _unconformity(), 20, 40, (_names("B", 4), ("C1", "C2"))),
    History("channels", _channels(), 25, 40, (("B", "C"),)),
    History("dipping", _dipping(), 12, 40, (_names("D", 7),)),
    History("folded", _folded(), 15, 60, (_names("F", 6),)),
    History("discontinuous", _discontinuous(), 20, 60, (_names("P", 4), ("Q1", "Q2"))),
    History("pinching", _pinching(), 20, 40),
)


def random_history(seed: int) -> History:
    """Beds that rise to the side, undulate or are folded gently, with an unconformity, an onlapped high,
    channels or lenses, or none of them."""
    draw = np.random.default_rng([64, seed])
    length, azimuth, wave = draw.uniform(500, 1800), draw.uniform(0, 360), draw.choice([8.0, 25.0, 50.0])
    slope = draw.choice([0.0, 0.05, 0.25]) * draw.uniform(-1, 1, 2)

    def bed(level, share=1.0, turn=0.0):
        return lambda x, y: (
            level
            + share * wave * _wave(x, y, length, azimuth + turn)
            + share * (slope[0] * (x - 500) + slope[1] * (y - 500))
        )

    layers: list[Layer] = []
    what: list[str] = []
    if draw.random() < 0.3:
        x0, y0, rise = draw.uniform(300, 700), draw.uniform(300, 700), draw.uniform(120, 240)
        width = draw.uniform(200, 350)
        layers.append(
            Layer(
                "high",
                "base",
                lambda x, y: -60 + rise * np.exp(-((x - x0) ** 2 + (y - y0) ** 2) / width**2),
            )
        )
        what.append("onlap")
    level = -40.0
    for k in range(draw.integers(2, 5)):
        layers.append(Layer(f"H{k}", "conformable", bed(level)))
        level += draw.uniform(35, 80)
    if draw.random() < 0.5:
        layers.append(Layer("U", "erosional", bed(draw.uniform(120, 180), 0.3, 70.0)))
        what.append("unconformity")
        level = max(level, 210.0)
    if draw.random() < 0.4:
        x0, y0, thick = draw.uniform(250, 750), draw.uniform(250, 750), draw.uniform(40, 90)
        base = level - 20

        def lens(x, y):
            r = ((x - x0) ** 2 + (y - y0) ** 2) / 280.0**2
            return bed(base, 0.3)(x, y) + thick * (1.5 * np.exp(-r) - 0.5)

        layers.append(Layer("pinching", "conformable", lens))
        level += 45.0
        what.append("pinching")
    for k in range(draw.integers(1, 3)):
        layers.append(Layer(f"C{k}", "conformable", bed(level, 0.3)))
        level += draw.uniform(25, 50)
    if draw.random() < 0.35:
        across, depth = draw.uniform(300, 700), draw.uniform(60, 130)
        top = level - 20.0
        layers.append(Layer("base of K", "erosional", lambda x, y: _channel(x, y, across, 110.0, depth, top)))
        what.append("channel")
    layers.append(Layer("ground", "erosional", _hills if draw.random() < 0.4 else _ground))
    return History(" ".join(what) or "plain", layers, int(draw.integers(12, 40)), 0)
