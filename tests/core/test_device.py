# SPDX-License-Identifier: GPL-3.0-or-later
"""The device that helps a build: chosen, missing, failing, and the same bytes with it. A device is played by
NumPy, through the functions that the native module calls; where there is a GPU, it is tried, too."""

import ctypes
import importlib.util
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from realmodel.core import Fault, Project, Rock, Surface, UsageError, build, build_surfaces, interpolate
from realmodel.core.base import device as devices

SQUARE = [[0, 0], [40, 0], [40, 40], [0, 40]]
_MODULE = "realmodel._native_cuda"


class Merging(ctypes.Structure):
    _fields_ = (
        ("vertices", ctypes.POINTER(ctypes.c_double)),
        ("vertex_count", ctypes.c_size_t),
        ("is_shared", ctypes.POINTER(ctypes.c_uint8)),
        ("corners", ctypes.POINTER(ctypes.c_int32)),
        ("corner_count", ctypes.c_size_t),
    )


_MERGE = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.POINTER(Merging))
_KRIGE = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_void_p)


class Functions(ctypes.Structure):
    _fields_ = (
        ("layout", ctypes.c_uint32),
        ("state", ctypes.c_void_p),
        ("merge", _MERGE),
        ("krige", _KRIGE),
    )


class PlayedDevice:
    """Merges with NumPy, and leaves kriging to the CPU, as a device without memory does."""

    def __init__(self, layout=1):
        self.calls = []
        self.said = []
        self._functions = Functions(layout, None, _MERGE(self._merge), _KRIGE(self._krige))
        make = ctypes.pythonapi.PyCapsule_New
        make.restype = ctypes.py_object
        make.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
        self.functions = make(ctypes.addressof(self._functions), b"realmodel.Device", None)

    def messages(self):
        said, self.said = self.said, []
        return said

    def _merge(self, _state, merging):
        self.calls.append("merge")
        task = merging.contents
        vertices = np.ctypeslib.as_array(task.vertices, (task.vertex_count, 3))
        corners = np.ctypeslib.as_array(task.corners, (task.corner_count,))
        shared = np.flatnonzero(np.ctypeslib.as_array(task.is_shared, (task.vertex_count,)))
        positions, of_position = np.unique(vertices[shared], axis=0, return_inverse=True)
        number = np.arange(len(vertices), dtype=np.int32)
        number[shared] = shared[of_position.reshape(-1)]
        vertices[shared[: len(positions)]] = positions
        corners[:] = number[corners]
        return True

    def _krige(self, _state, _systems):
        self.calls.append("krige")
        self.said = ["kriging: the device has too little memory; the CPU does it, with the same result"]
        return False


@pytest.fixture
def play(monkeypatch):
    """play(opens) puts a module in the place of _native_cuda, whose open_device is that function."""
    monkeypatch.setattr(devices, "_opened", {})

    def put(opens):
        monkeypatch.setitem(sys.modules, _MODULE, opens and SimpleNamespace(open_device=opens))

    put(None)
    return put


def faulted():
    random = np.random.default_rng(1)
    plan = random.uniform(0, 40, (60, 2))
    surfaces = [
        Surface(name, points=np.column_stack([plan, level + np.sin(plan[:, 0] / 9)]), block=f"above {name}")
        for name, level in (("low", 3), ("high", 8))
    ]
    rock = Rock("hill", surfaces, region=SQUARE, edge_length=4, base_elevation=-5)
    vertices = [[20, -9, -20], [20, 50, -20], [24, 50, 30], [24, -9, 30]]
    fault = Fault("fault", vertices=vertices, triangles=[[0, 1, 2], [0, 2, 3]])
    return Project("faulted", [rock], faults=[fault])


def bytes_of(model):
    cells = model.complex
    return [
        getattr(cells, name).tobytes() for name in ("vertices", "face_offsets", "face_vertices", "face_cells")
    ]


def of_device(warnings):
    return [str(warning) for warning in warnings if str(warning).startswith("device")]


def test_a_device_gives_the_same_bytes(play):
    played = PlayedDevice()
    play(lambda: played)
    model = build(faulted(), device="cuda")
    assert "merge" in played.calls and "krige" in played.calls
    plain = build(faulted())
    assert bytes_of(model) == bytes_of(plain)
    (warning,) = of_device(model.warnings)
    assert "too little memory" in warning
    assert [w.kind for w in model.warnings if str(w) == warning] == ["device"]
    assert of_device(plain.warnings) == []


def test_devices_help_with_surfaces_and_points_too(play):
    played = PlayedDevice()
    play(lambda: played)
    assert "too little memory" in of_device(build_surfaces(faulted(), device="cuda").warnings)[0]
    points = np.random.default_rng(2).uniform(0, 9, (60, 3))
    helped = interpolate(points, [[1, 2], [3, 4]], neighbours=8, device="cuda")
    alone = interpolate(points, [[1, 2], [3, 4]], neighbours=8)
    assert helped.z.tobytes() == alone.z.tobytes()
    assert helped.warnings == (*alone.warnings, *of_device(helped.warnings))
    assert len(of_device(helped.warnings)) == 1


def test_without_the_module_or_a_gpu_the_cpu_computes(play):
    expected = bytes_of(build(faulted()))
    model = build(faulted(), device="cuda")
    assert bytes_of(model) == expected
    (warning,) = of_device(model.warnings)
    assert "_native_cuda cannot be loaded" in warning and "the CPU computes" in warning

    def no_driver():
        raise RuntimeError("there is no driver of NVIDIA, or one that is too old")

    play(no_driver)
    (warning,) = of_device(build_surfaces(faulted(), device="cuda").warnings)
    assert warning.startswith("device 'cuda': there is no driver")


def test_a_device_is_opened_once(play):
    opened = []
    play(lambda: opened.append(PlayedDevice()) or opened[-1])
    for _ in range(2):
        build_surfaces(faulted(), device="cuda")
    assert len(opened) == 1


def test_a_module_of_another_version_is_not_used(play):
    played = PlayedDevice(layout=2)
    play(lambda: played)
    (warning,) = of_device(build(faulted(), device="cuda").warnings)
    assert "build it again; the CPU computes" in warning
    assert played.calls == []


@pytest.mark.parametrize("device", ["gpu", "CUDA", None])
def test_an_unknown_device_is_refused(device):
    with pytest.raises(UsageError, match=r"device must be one of cpu, cuda"):
        build(faulted(), device=device)


def test_the_command_line_has_the_same_devices():
    from realmodel.batch.options import OPTIONS

    (option,) = (option for option in OPTIONS if option.name == "device")
    assert option.value == tuple(devices.DEVICES)
    assert option.default == "cpu"


@pytest.mark.skipif(importlib.util.find_spec(_MODULE) is None, reason="_native_cuda is not built here")
def test_the_gpu_gives_the_same_bytes():
    model = build(faulted(), device="cuda")
    if of_device(model.warnings):
        pytest.skip(of_device(model.warnings)[0])
    assert bytes_of(model) == bytes_of(build(faulted()))
