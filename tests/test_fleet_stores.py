"""Captures in an object store: a server of one on this machine, read through workers of this machine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from moto.server import ThreadedMotoServer
from pyarrow.fs import S3FileSystem
from small import recorded

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fleet import places


@pytest.fixture
def store(monkeypatch: pytest.MonkeyPatch) -> Iterator[S3FileSystem]:
    """A bucket called `line`."""
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    address = "http://{}:{}".format(*server.get_host_and_port())
    for name, value in {
        **{"AWS_ACCESS_KEY_ID": "nobody", "AWS_SECRET_ACCESS_KEY": "nothing", "AWS_REGION": "us-east-1"},
        **{"AWS_ENDPOINT_URL": address, "AWS_EC2_METADATA_DISABLED": "true"},
    }.items():
        monkeypatch.setenv(name, value)
    made = S3FileSystem(endpoint_override=address, allow_bucket_creation=True)
    made.create_dir("line")
    try:
        yield made
    finally:
        server.stop()


def test_a_bucket_is_read_as_a_folder_is_and_what_is_refused_is_a_row(store: S3FileSystem, tmp_path: Path):
    captures = {f"lot=4/k{seed}.npz": recorded(seed, count=1200) for seed in range(2)}
    for name, capture in captures.items():
        with store.open_output_stream(f"line/{name}") as file:
            file.write(capture.save(tmp_path / Path(name).name).read_bytes())
    with store.open_output_stream("line/lot=4/none.csv") as file:
        file.write(b"nothing\n")
    done = kc.batch("s3://line/lot=4", tmp_path / "results", learn="none")
    assert [row["capture"] for row in done.rows] == [
        f"s3://line/lot=4/{one}" for one in ("k0.npz", "k1.npz", "none.csv")
    ]
    assert [row["lot"] for row in done.rows] == ["4", "4", "4"]
    assert [row["rmse"] for row in done.rows[:2]] == [kc.fit(one).rmse for one in captures.values()]
    assert done.rows[2]["error"] is not None and "s3://line/lot=4/none.csv" in done.rows[2]["error"]
    assert all(row["time"] for row in done.rows) and len(pq.read_table(tmp_path / "results")) == 3
    some = places.find("s3://line/*/k*.npz")
    assert [one.place for one in some] == ["s3://line/lot=4/k0.npz", "s3://line/lot=4/k1.npz"]


def test_a_store_that_refuses_is_one_line(store: S3FileSystem, tmp_path: Path):
    with pytest.raises(InputError, match="s3://nowhere/x: ") as refused:
        kc.batch("s3://nowhere/x", tmp_path / "results")
    assert "\n" not in str(refused.value) and not (tmp_path / "results").exists()


def test_other_addresses_are_those_of_fsspec(tmp_path: Path):
    recorded(1, count=1200).save(tmp_path / "k.npz")
    assert [one.place for one in places.find(f"file://{tmp_path}")] == [f"file://{tmp_path}/k.npz"]
    with places.on_disk(f"file://{tmp_path}/k.npz") as copy:
        assert kc.load(copy).samples == 1200
    with pytest.raises(InputError, match="nothing-of-fsspec://x: cannot be read"):
        places.find("nothing-of-fsspec://x")
