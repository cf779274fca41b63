"""The captures of a batch: in folders, by patterns, as files, in Parquet datasets, behind addresses."""

from __future__ import annotations

import glob
import os
import re
import stat
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from ..base.reading import look
from ..base.strict_json import readable
from ..errors import InputError
from . import dataset, places
from .places import Found

LABELS = ("lot", "station", "part", "date")
"""What a capture belongs to, as its path, its table or its own description says."""
RESULTS = "_batch.json"
"""A file that a folder of results has, which is no folder of captures."""
_LABEL = re.compile(rf"({'|'.join(LABELS)})[=_-](.+)", re.IGNORECASE)
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


@dataclass(frozen=True)
class Source:
    """One capture: `name` is what the table calls it, `place` where it is read.

    `rows` are those of a Parquet file that holds several, the first and how many; None: the whole file.
    `stamp` tells another content of the file without reading it, `modified` is when it was written, s.
    """

    name: str
    place: str
    stamp: str
    modified: float | None
    labels: Mapping[str, str]
    bytes: int = 0
    rows: tuple[int, int] | None = None
    error: str | None = None
    """Why there is none."""


def sources(given: Sequence[str | os.PathLike[str]], besides: Path | None = None) -> list[Source]:
    """Return the captures that paths, patterns and addresses name, each once, by their names.

    `besides` is a folder whose files are none, as the results are; so are those of other batches. InputError
    for what names nothing.
    """
    found: dict[str, Source] = {}
    places_seen: set[tuple[str, tuple[int, int] | None]] = set()
    for one in given:
        some = list(_named(os.fspath(one), besides))
        if not some and len(given) > 1 and is_results(one):
            continue  # a shell names all that is in a folder
        if not some:
            raise InputError(f"{one}: {nothing_in(one)}")
        for source in some:
            if (source.place, source.rows) in places_seen:
                continue
            places_seen.add((source.place, source.rows))
            if source.name in found:  # keys of two datasets
                source = replace(source, name=f"{source.place}#{source.name}")
            found[source.name] = source
    if not found:
        raise InputError("SOURCES: names nothing; give folders, files, patterns or addresses")
    return [found[name] for name in sorted(found)]


def gone(
    known: Mapping[str, str | None], found: Sequence[Source], given: Sequence[str | os.PathLike[str]]
) -> frozenset[str]:
    """Return which of the captures `known` by name and place are not there any more.

    One that `found` has is, and one that lies where `given` does not lead to may be: what can be looked at
    without a store's being asked for all of it decides. A capture that has another name now is gone by its
    old one.
    """
    here = {one.name for one in found}
    taken = {readable(one.place) for one in found}
    heads = tuple(places.below(os.fspath(one)) for one in given if places.is_address(os.fspath(one)))
    return frozenset(
        name
        for name, place in known.items()
        if place is not None and name not in here and (place in taken or _is_gone(place, heads))
    )


def _is_gone(place: str, heads: tuple[str, ...]) -> bool:
    if places.is_address(place):
        return place.startswith(heads) and not places.find(place)
    return not os.path.lexists(place)


def is_results(folder: str | os.PathLike[str]) -> bool:
    """Whether a folder holds results of a batch, which are no captures."""
    return os.path.isfile(f"{os.fspath(folder)}/{RESULTS}")  # noqa: PTH113 - as of any path at all


def nothing_in(given: str | os.PathLike[str]) -> str:
    """Say why a name has no capture."""
    if is_results(given):
        return "holds results of a batch, and no captures; name the folder of captures"
    return "no capture is there; check the name, or the pattern"


def _named(given: str, besides: Path | None) -> Iterator[Source]:
    if not given:
        raise InputError("SOURCES: '' names nothing; is a variable of the shell empty?")
    if places.is_address(given):
        every, head = places.find(given), places.below(given)
        results = tuple(one.place.removesuffix(RESULTS) for one in every if one.place.endswith(f"/{RESULTS}"))
        for one in every:
            # The one that was asked for lies below nothing.
            within = one.place.removeprefix(head) if one.place.startswith(head) else Path(one.place).name
            hidden = any(part.startswith((".", "_")) for part in within.split("/"))
            if not (hidden or one.place.startswith(results)):
                yield from _of_file(one, within)
        return
    path = Path(given)
    there = os.path.lexists(path)
    if there or not glob.has_magic(given):
        if not there:
            look(path)  # which says what is wrong with the name
        yield from _below(path, path, besides)
        return
    first = next(at for at, part in enumerate(path.parts) if glob.has_magic(part))
    root = Path(*path.parts[:first])
    for each in sorted(root.glob("/".join(path.parts[first:]))):
        if not each.name.startswith((".", "_")):
            yield from _below(each, root, besides)


def _below(path: Path, root: Path, besides: Path | None, above: tuple[Path, ...] = ()) -> Iterator[Source]:
    """Yield the captures of a file, or of all files below a folder; a bag is a folder and one capture.

    `above` are the folders that it was reached through. What cannot be looked at is a capture with an error.
    """
    if (besides is not None and path.absolute() == besides.absolute()) or is_results(path):
        return
    within = path.relative_to(root).as_posix() if path != root else path.name
    try:
        known = look(path)
        inside = _inside(path, above) if stat.S_ISDIR(known.st_mode) else None
    except (InputError, OSError) as error:
        if os.path.lexists(path):  # else it went since it was listed, as what a program renames does
            modified, why = path.lstat().st_mtime, str(error)
            nothing = Found(str(path), modified, f"{why} {modified}", 0)
            yield replace(_whole(nothing, within), error=why)
        return
    if inside is not None:
        through = (*above, path.resolve())
        for one in inside:
            yield from _below(one, root, besides, through)
        return
    yield from _of_file(Found(str(path), known.st_mtime, _stamp(known), known.st_size), within)


def _stamp(known: os.stat_result) -> str:
    return f"{known.st_size} {known.st_mtime_ns}"


def stands_still(source: Source) -> bool:
    """Whether a file of this machine is as it was when it was found."""
    try:
        return source.error is not None or _stamp(look(source.place)) == source.stamp
    except InputError:  # it went
        return False


def _inside(folder: Path, above: tuple[Path, ...]) -> list[Path] | None:
    """Return what is in a folder; None for a bag. InputError for a link that leads back to where it lies."""
    lies_in = (*above, folder.parent.resolve())
    if folder.is_symlink() and any(one.is_relative_to(folder.resolve()) for one in lies_in):
        raise InputError(f"{folder}: is a link back to a folder that it lies in; remove it")
    if (folder / "metadata.yaml").is_file():
        return None
    return [one for one in sorted(folder.iterdir()) if not one.name.startswith((".", "_"))]


def _whole(file: Found, within: str) -> Source:
    """Return a file as one capture; a table has no letters that are none, as in names that are not UTF-8."""
    labels = {name: readable(label) for name, label in of_path(file.place, within).items()}
    place = file.place if places.is_address(file.place) else str(Path(file.place).absolute())
    return Source(readable(file.place), place, file.stamp, file.modified, labels, file.bytes)


def _of_file(file: Found, within: str) -> Iterator[Source]:
    whole = _whole(file, within)
    try:
        several = file.place.lower().endswith(".parquet")
        inside = dataset.captures_in(file.place, file.stamp) if several else None
    except InputError as error:
        yield replace(whole, error=str(error))
        return
    if inside is None:
        yield whole
        return
    for key, rows, own in inside:
        yield replace(whole, name=key, labels={**whole.labels, **own}, rows=rows)


def of_path(place: str, within: str) -> dict[str, str]:
    """Return what a path says a capture belongs to.

    Folders such as `lot=7`, `lot-7` or `lot_7` say it by name, one that is a date is a date. Where no folder
    names a lot, the first one below the source is the lot, and the next one the station.
    """
    labels: dict[str, str] = {}
    for part in PurePosixPath(place.replace(os.sep, "/")).parts[:-1]:
        if (found := _LABEL.fullmatch(part)) is not None:
            labels[found[1].lower()] = found[2]
        elif _DATE.fullmatch(part):
            labels["date"] = part
    own = [p for p in PurePosixPath(within).parts[:-1] if not _LABEL.fullmatch(p) and not _DATE.fullmatch(p)]
    if "lot" not in labels:
        labels |= dict(zip(("lot", "station"), own, strict=False)) | labels
    return labels


def of_meta(meta: Mapping[str, Any]) -> dict[str, str]:
    """Return what a capture's own description says that it belongs to."""
    return {name: str(meta[name]) for name in LABELS if meta.get(name) is not None}
