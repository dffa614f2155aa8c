# SPDX-License-Identifier: GPL-3.0-or-later
"""The device that computes: the CPU, or a GPU, by the optional module `_native_cuda`. Nothing that is built
depends on it; where the chosen one cannot be used, a warning says why, and the CPU computes."""

from __future__ import annotations

import importlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from .errors import BuildWarning, UsageError
from .work import OpenDevice, Work, native_module

# The modules of devices, by the names that a user chooses.
DEVICES = {"cpu": None, "cuda": "_native_cuda"}
_PACKAGE = __package__.removesuffix(".core.base")

_opened: dict[str, OpenDevice] = {}  # opening one takes part of a second
_opening = threading.Lock()


def check_device(device: str) -> None:
    """Raises UsageError where there is no device of this name."""
    if device not in DEVICES:
        raise UsageError(f"device must be one of {', '.join(DEVICES)}, not {device!r}")


@contextmanager
def on_device(work: Work, device: str) -> Iterator[list[BuildWarning]]:
    """Within it native calls of a work use a device. The list has the warnings, after it all of them."""
    warnings: list[BuildWarning] = []
    before = work.device
    work.device = _open(device, warnings)
    try:
        yield warnings
    finally:
        if work.device is not None:
            warnings += [_warning(device, text) for text in work.device.messages()]
        work.device = before


def _open(device: str, warnings: list[BuildWarning]) -> OpenDevice | None:
    module = DEVICES[device]
    if module is None:
        return None
    with _opening:
        if device not in _opened:
            try:
                opened = importlib.import_module(f"{_PACKAGE}.{module}").open_device()
                native_module().Execution(0, opened)
                _opened[device] = opened
            except ImportError as error:
                why = f"the module {module} cannot be loaded ({error}); docs/dev/gpu.md says how it is built"
                warnings.append(_on_cpu(device, why))
            except (RuntimeError, ValueError) as error:  # no driver, no GPU; of another version
                warnings.append(_on_cpu(device, str(error)))
    return _opened.get(device)


def _on_cpu(device: str, why: str) -> BuildWarning:
    return _warning(device, f"{why}; the CPU computes, with the same result")


def _warning(device: str, text: str) -> BuildWarning:
    return BuildWarning(f"device {device!r}: {text}", kind="device")
