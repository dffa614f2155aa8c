# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files that appear whole or not at all, all those of a run together, at its end.

Until then a file has no name (O_TMPFILE): whatever ends the process, even SIGKILL or a power cut, the
system takes it back. It gets its name by one system call. Where a file of that name is to be replaced,
it is named in a scratch folder under the system's temporary folder first, and moved over the old one.
Where a file system has no nameless files, a hidden name beside the target is used; a later run removes
what a killed one left there.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import signal
import socket
import tempfile
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from .errors import OutputFailed

_MARK = "realmodel"
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@dataclass
class _Staged:
    """One output before it has its name: an open file without one, or a path where it waits."""

    target: Path
    file: BinaryIO | None = None
    path: Path | None = None


class Outputs:
    """The outputs of one run. Leaving the `with` block gives them their names; leaving it by an
    exception of any kind drops them all.

    >>> with Outputs() as outputs:
    ...     with outputs.file("m.npz") as file:
    ...         file.write(b"...")
    """

    def __init__(self):
        self._staged: list[_Staged] = []
        self._scratch: list[Path] = []  # at most one folder
        # Ctrl-C may come between two lines of this class: then the end of the object is the end of its files
        self._net = weakref.finalize(self, _drop, self._staged, self._scratch)

    def __enter__(self) -> Outputs:
        return self

    def __exit__(self, kind, error, trace) -> None:
        try:
            if kind is None:
                with _uninterrupted():
                    self._publish()
        finally:
            self.drop()

    @contextmanager
    def file(self, target: str | Path) -> Iterator[BinaryIO]:
        """A binary file to write, seekable. Raises OutputFailed in the place of OSError."""
        target = writable_target(target)
        with _explained(target):
            staged = self._open(target)
            yield staged.file
            staged.file.flush()
            os.fsync(staged.file.fileno())

    @contextmanager
    def path(self, target: str | Path) -> Iterator[Path]:
        """A path of the same ending for software that writes files by name (Blender). Raises
        OutputFailed in the place of OSError, and where nothing was written."""
        target = writable_target(target)
        with _explained(target):
            with _uninterrupted():
                folder = Path(tempfile.mkdtemp(dir=self._scratch_folder()))
                staged = _Staged(target, path=folder / target.name)
                self._staged.append(staged)
            yield staged.path
            if not staged.path.is_file():
                raise OutputFailed(f"{target}: nothing was written")
            _sync(staged.path)

    def _open(self, target: Path) -> _Staged:
        staged = _Staged(target)
        with _uninterrupted():
            descriptor = _nameless(target.parent)
            if descriptor is None:
                _remove_left_over(target)
                staged.path = _hidden_name(target)
                descriptor = os.open(staged.path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
            staged.file = open(descriptor, "w+b")  # noqa: SIM115 - closed by drop
            self._staged.append(staged)
        return staged

    def _publish(self) -> None:
        new: list[Path] = []
        try:
            for staged in list(self._staged):
                with _explained(staged.target):
                    existed = staged.target.exists()
                    if not existed:
                        new.append(staged.target)
                    self._name(staged)
            for folder in {staged.target.parent for staged in self._staged}:
                _sync(folder)
        except BaseException:
            for target in new:
                with suppress(OSError):
                    target.unlink()
            raise

    def _name(self, staged: _Staged) -> None:
        if staged.file is None:
            self._move(staged.path, staged.target)
        elif staged.path is not None:
            os.replace(staged.path, staged.target)
        else:
            try:
                _link(staged.file, staged.target)
            except FileExistsError:
                self._replace_by_nameless(staged)

    def _replace_by_nameless(self, staged: _Staged) -> None:
        """A nameless file can be linked to a new name only: to one in the scratch folder, then moved."""
        waiting = self._scratch_folder() / secrets.token_hex(8)
        try:
            try:
                _link(staged.file, waiting)
                os.replace(waiting, staged.target)
            except OSError as error:
                if error.errno not in (errno.EXDEV, errno.EPERM):
                    raise
                _remove_left_over(staged.target)
                waiting = _hidden_name(staged.target)  # another file system: for an instant, beside it
                _link(staged.file, waiting)
                os.replace(waiting, staged.target)
        except BaseException:
            with suppress(OSError):
                waiting.unlink()
            raise

    def _move(self, path: Path, target: Path) -> None:
        try:
            os.replace(path, target)
        except OSError as error:
            if error.errno != errno.EXDEV:
                raise
            copy = self._open(target)
            with path.open("rb") as source:
                shutil.copyfileobj(source, copy.file, 1 << 22)
            copy.file.flush()
            os.fsync(copy.file.fileno())
            self._name(copy)

    def _scratch_folder(self) -> Path:
        if not self._scratch:
            _remove_dead_scratch_folders()
            user = os.getuid() if hasattr(os, "getuid") else 0
            self._scratch.append(Path(tempfile.mkdtemp(prefix=f"{_MARK}-{user}-{os.getpid()}-")))
        return self._scratch[0]

    def drop(self) -> None:
        """Gives up all that has no name yet."""
        _drop(self._staged, self._scratch)
        self._net.detach()  # Python would drop a Ctrl-C that comes while it ends the object


def _drop(staged: list[_Staged], scratch: list[Path]) -> None:
    with _uninterrupted():
        for output in staged:
            if output.file is not None:
                with suppress(OSError):  # what could not be written is not wanted any more
                    output.file.close()
                if output.path is not None:
                    output.path.unlink(missing_ok=True)
        staged.clear()
        for folder in scratch:
            shutil.rmtree(folder, ignore_errors=True)
        scratch.clear()


@contextmanager
def atomic_file(target: str | Path) -> Iterator[BinaryIO]:
    """One output file of its own."""
    with Outputs() as outputs, outputs.file(target) as file:
        yield file


@contextmanager
def atomic_path(target: str | Path) -> Iterator[Path]:
    """One output of its own, for software that writes files by name."""
    with Outputs() as outputs, outputs.path(target) as path:
        yield path


def writable_target(target: str | Path) -> Path:
    """The path, links followed, where an output will stand. Raises OutputFailed where it cannot."""
    with _explained(target):
        resolved = Path(os.path.realpath(target))
        if resolved.is_dir():
            raise OutputFailed(f"{target}: this is a folder; give a file name")
        if resolved.exists() and not resolved.is_file():
            raise OutputFailed(f"{target}: this is not an ordinary file")
        if not resolved.parent.is_dir():
            raise OutputFailed(f"{target}: there is no folder {resolved.parent}; make it first")
        if not os.access(resolved.parent, os.W_OK | os.X_OK):
            raise OutputFailed(f"{target}: you may not write in {resolved.parent}; choose another folder")
    return resolved


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C waits until a file that was made is also known, or one that was known is gone."""
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or threading.current_thread() is not threading.main_thread():
        yield
        return
    pressed = []
    signal.signal(signal.SIGINT, lambda number, frame: pressed.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if pressed:
            handler(*pressed[0])


@contextmanager
def _explained(target: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        if error.errno in _FULL:
            message = f"{target}: cannot be written: {reason}; make room or choose another folder"
        else:
            message = f"{target}: cannot be written: {reason}"
        raise OutputFailed(message) from error


def _nameless(folder: Path) -> int | None:
    """An open file without a name on the file system of a folder, or None where there are none."""
    flag = getattr(os, "O_TMPFILE", None)
    if flag is None or not os.path.isdir("/proc/self/fd"):
        return None
    try:
        return os.open(folder, flag | os.O_RDWR | os.O_CLOEXEC, 0o666)
    except OSError as error:
        if error.errno in (errno.EOPNOTSUPP, errno.EISDIR, errno.EINVAL, errno.ENOENT):
            return None
        raise


def _link(file: BinaryIO, name: Path) -> None:
    # A directory descriptor, although the path is absolute, makes Python call linkat, which follows the link
    # in /proc to the nameless file; plain link() does not.
    os.link(f"/proc/self/fd/{file.fileno()}", name, src_dir_fd=file.fileno())


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _prefix(target: Path) -> str:
    return f".{target.name}.{_MARK}-{socket.gethostname()}-"


def _hidden_name(target: Path) -> Path:
    return target.parent / f"{_prefix(target)}{os.getpid()}-{secrets.token_hex(4)}"


def _remove_left_over(target: Path) -> None:
    """Removes hidden files of this target that processes of this machine left when they were killed."""
    prefix = _prefix(target)
    for entry in target.parent.iterdir():
        if entry.name.startswith(prefix):
            process = entry.name[len(prefix) :].partition("-")[0]
            if process.isdecimal() and not _alive(int(process)):
                entry.unlink(missing_ok=True)


def _remove_dead_scratch_folders() -> None:
    user = os.getuid() if hasattr(os, "getuid") else 0
    prefix = f"{_MARK}-{user}-"
    for entry in Path(tempfile.gettempdir()).glob(f"{prefix}*-*"):
        process = entry.name[len(prefix) :].partition("-")[0]
        if process.isdecimal() and not _alive(int(process)) and not entry.is_symlink():
            shutil.rmtree(entry, ignore_errors=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
