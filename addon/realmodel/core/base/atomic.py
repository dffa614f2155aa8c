# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files that appear whole or not at all, all those of a run together, at its end.

Until then each is written in a hidden folder beside its target, so that one `os.replace` publishes it, on
every system, and Blender sees the requested file name.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import weakref
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from .errors import OutputFailed

_FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC), errno.EFBIG)


class Outputs:
    """The outputs of one run. Leaving the `with` block publishes them; leaving it by an exception of any
    kind drops them all.

    >>> with Outputs() as outputs:
    ...     with outputs.file("m.npz") as file:
    ...         file.write(b"...")
    """

    def __init__(self, inputs: Iterable[str | Path] = ()):
        """inputs: files that are read; no output may replace one."""
        self._inputs = {Path(os.path.realpath(file)) for file in inputs}
        self._written: list[tuple[Path, Path]] = []  # (where it waits, its target), files and folders
        self._folders: list[Path] = []
        weakref.finalize(self, _remove, self._folders)  # a Ctrl-C may come before drop()

    def __enter__(self) -> Outputs:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self._publish()
        finally:
            self.drop()

    @contextmanager
    def file(self, target: str | Path) -> Iterator[BinaryIO]:
        """A binary file to write, seekable. Raises OutputFailed instead of OSError."""
        with self.path(target) as path, path.open("w+b") as file:
            yield file

    @contextmanager
    def path(self, target: str | Path) -> Iterator[Path]:
        """A path of the same name for software that writes files by name (Blender). Raises OutputFailed
        instead of OSError, and where nothing was written."""
        target = writable_target(target)
        if target in self._inputs:
            raise OutputFailed(f"{target}: this is a file that is read; choose another name")
        if any(target == other for _, other in self._written):
            raise OutputFailed(f"{target}: two outputs have this name")
        with explained(target):
            path = self._waiting_folder(target) / target.name
            yield path
            if not path.is_file():
                raise OutputFailed(f"{target}: nothing was written")
            with path.open("r+b") as file:
                os.fsync(file.fileno())
        self._written.append((path, target))

    @contextmanager
    def folder(self, target: str | Path, renewed: str) -> Iterator[Path]:
        """A folder to write into. `renewed` is a folder in it: if an earlier run left the target, only that
        is replaced, and missing files are added, so that files changed by the user stay.

        Raises OutputFailed instead of OSError, and where the target is a folder without `renewed`.
        """
        target = writable_folder(target, renewed)
        with explained(target):
            waiting = self._waiting_folder(target)
            path = waiting / target.name
            path.mkdir()
            yield path
            for file in sorted(path.rglob("*")):
                if file.is_file():
                    with file.open("r+b") as opened:
                        os.fsync(opened.fileno())
        if not target.exists():
            self._written.append((path, target))
            return
        self._written.append((path / renewed, target / renewed))
        for file in sorted(path.rglob("*")):
            inside = file.relative_to(path)
            if file.is_file() and not inside.is_relative_to(renewed) and not (target / inside).exists():
                self._written.append((file, target / inside))

    def _waiting_folder(self, target: Path) -> Path:
        folder = target.parent / f".realmodel-{secrets.token_hex(8)}"
        self._folders.append(folder)  # first, so that a Ctrl-C leaves no folder that is not known
        folder.mkdir()
        return folder

    def _publish(self) -> None:
        undone: list[tuple[Path | None, Path]] = []  # (the earlier file or None, its place)
        try:
            for path, target in self._written:
                with explained(target):
                    target.parent.mkdir(parents=True, exist_ok=True)
                    before = None
                    if path.is_dir() and target.is_dir():
                        before = path.with_name(f"{path.name}.before")
                        os.rename(target, before)
                    if before is not None or not target.exists():
                        undone.append((before, target))
                    os.replace(path, target)
        except BaseException:
            for before, target in reversed(undone):
                with suppress(OSError):
                    shutil.rmtree(target) if target.is_dir() else target.unlink(missing_ok=True)
                    if before is not None:
                        os.rename(before, target)
            raise

    def drop(self) -> None:
        """Removes everything that is not published."""
        self._written.clear()
        try:
            _remove(self._folders)
        except KeyboardInterrupt:  # it may keep this object alive, so that it is not finalized
            _remove(self._folders)
            raise


def _remove(folders: list[Path]) -> None:
    while folders:
        try:
            shutil.rmtree(folders[-1], ignore_errors=True)
        except OSError as error:  # after a Ctrl-C following a close, rmtree closes again, which fails
            raise error.__context__ or error from None
        folders.pop()


def make_folder(path: str | Path) -> None:
    """Makes a folder where there is none. Raises OutputFailed."""
    with explained(path):
        Path(path).mkdir(parents=True, exist_ok=True)


def writable_target(target: str | Path) -> Path:
    """The path, links followed, where an output will stand. Raises OutputFailed where it cannot."""
    with explained(target):
        resolved = Path(os.path.realpath(target))
        if resolved.is_dir():
            raise OutputFailed(f"{target}: this is a folder; give a file name")
        if resolved.exists() and not resolved.is_file():
            raise OutputFailed(f"{target}: this is not an ordinary file")
        _require_writable(target, resolved.parent)
    return resolved


def writable_folder(target: str | Path, renewed: str) -> Path:
    """The path, links followed, where a folder of outputs will stand: a new one, an empty one, or one that
    has the folder `renewed`. Raises OutputFailed where it cannot."""
    with explained(target):
        resolved = Path(os.path.realpath(target))
        if resolved.is_dir():
            if any(resolved.iterdir()) and not (resolved / renewed).is_dir():
                raise OutputFailed(f"{target}: a folder with other content (no {renewed}); choose a new name")
            _require_writable(target, resolved)
        elif resolved.exists():
            raise OutputFailed(f"{target}: this is a file, and a folder is to be written; choose a new name")
        _require_writable(target, resolved.parent)
    return resolved


def _require_writable(target: str | Path, folder: Path) -> None:
    if not folder.is_dir():
        raise OutputFailed(f"{target}: there is no folder {folder}; make it first")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputFailed(f"{target}: you may not write in {folder}; choose another folder")


@contextmanager
def explained(target: str | Path) -> Iterator[None]:
    """Raises OutputFailed, which names the target, instead of OSError."""
    try:
        yield
    except OutputFailed:
        raise
    except OSError as error:
        reason = error.strerror or str(error)
        advice = "; make room or choose another folder" if error.errno in _FULL else ""
        raise OutputFailed(f"{target}: cannot be written: {reason}{advice}") from error
