"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from lumiere.errors import LumiereError, UsageError


def _beside(path: Path) -> Path:
    """An unused hidden name in the same folder and with the same suffix, so that the rename stays on one file system."""
    return path.with_name(f".{path.stem[:64]}.{os.urandom(6).hex()}{path.suffix}")


def _create(path: Path) -> None:
    """Makes an empty file with the rights that the umask leaves. Raises OSError, also where it exists."""
    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raises UsageError where a file could not be put at ``path``; leaves nothing behind."""
    path = Path(path)
    if path.is_dir():
        raise UsageError(f"cannot write {path}: it is a folder, expected the name of a file")
    if path.exists() and not path.is_file():
        raise UsageError(f"cannot write {path}: it is not a regular file")
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise UsageError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    probe = _beside(target)
    try:
        _create(probe)
        probe.unlink()
    except OSError as error:
        raise UsageError(f"cannot write {path}: its folder takes no new file ({error.strerror})") from None


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A file to write that takes the place of ``path`` when the block ends well, and is removed when it does not.

    A link is followed; a file that is replaced hands down its rights. Raises LumiereError where the system refuses.
    """
    target = Path(os.path.realpath(path))
    temporary = _beside(target)
    try:
        _create(temporary)
        yield temporary
        if target.exists():
            temporary.chmod(target.stat().st_mode & 0o7777)
        _sync(temporary)
        temporary.replace(target)
        with contextlib.suppress(OSError):  # some file systems cannot sync a folder; the rename is done all the same
            _sync(target.parent)
    except OSError as error:
        raise LumiereError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)
