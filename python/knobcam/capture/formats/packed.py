"""Text that is packed: gzip, xz or bzip2 around it, or a zip archive that holds it and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, cast

from ...base.reading import open_file
from ...errors import InputError
from . import magic

_SHOWN = 5  # names of files in an archive, in a message


def is_packed(path: Path, head: bytes) -> bool:
    """Whether a file holds text that is packed; an archive of arrays is none, nor is a workbook."""
    return bool(_texts(path)) if head.startswith(magic.ZIP) else head.startswith(magic.PACKED)


@contextmanager
def unpacked(path: Path, head: bytes) -> Iterator[tuple[str, IO[bytes]]]:
    """Open what is packed in a file: how it is called, and its content. InputError for several files."""
    # Each of these is loaded for its own files alone.
    if head.startswith(magic.ZIP):
        import zipfile

        names = _texts(path)
        if len(names) > 1:
            shown = ", ".join(names[:_SHOWN]) + (" ..." if len(names) > _SHOWN else "")
            raise InputError(f"{path}: a zip of {len(names)} files ({shown}); unpack it and give one of them")
        with zipfile.ZipFile(path) as archive, archive.open(names[0]) as held:
            yield "CSV zip", held
        return
    with open_file(path) as file:
        if head.startswith(magic.GZIP):
            import gzip

            with gzip.GzipFile(fileobj=file) as stream:
                yield "CSV gzip", cast("IO[bytes]", stream)
        elif head.startswith(magic.XZ):
            import lzma

            with lzma.LZMAFile(file) as stream_xz:
                yield "CSV xz", cast("IO[bytes]", stream_xz)
        else:
            import bz2

            with bz2.BZ2File(file) as stream_bz2:
                yield "CSV bzip2", cast("IO[bytes]", stream_bz2)


def _texts(path: Path) -> list[str]:
    """Return the files of an archive that may be text; none of one that is a format of its own."""
    import zipfile

    with zipfile.ZipFile(path) as archive:
        infos = [info for info in archive.infolist() if not info.is_dir()]
    names = [info.filename for info in infos if not info.filename.startswith("__MACOSX/")]
    own = any(name.endswith(".npy") or name.startswith("xl/") or name == "content.xml" for name in names)
    return [] if own else names
