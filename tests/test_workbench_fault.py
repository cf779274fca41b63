"""A fault that a rig has latched, at the workbench."""

from __future__ import annotations

from pathlib import Path

import httpx
from peer import Nth, Peer
from test_workbench_sources import begun, ended
from workbench_server import wrong


def test_a_latched_fault_is_told_and_only_the_one_that_was_read_is_cleared(
    client: httpx.Client, tmp_path: Path
) -> None:
    with Peer(hears=Nth("HEARTBEAT", set(range(8, 60)))) as peer:
        body = {"source": "port", "port": peer.port, "motion": "turns", "folder": str(tmp_path)}
        begun(client, **body, duration_s=50.0)
        assert "heartbeat" in ended(client)["error"]
        refused = client.post("/api/record", json=body)
        wrong(refused, 400, "the rig has latched fault 1")
        fault = refused.json()["fault"]
        assert fault["code"] == 1 and "s ago: the host was silent" in fault["told"]
        wrong(client.post("/api/record", json=body | {"clear_fault": 2}), 400, "has latched fault 1")
        wrong(client.post("/api/record", json=body | {"clear_fault": "1"}), 400, "clear_fault")
        assert peer.state == "fault"
        begun(client, **body, duration_s=0.5, clear_fault=1)
        assert ended(client)["error"] is None
