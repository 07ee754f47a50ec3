#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Foxglove's own client against `adit run --view` and `adit view`, beside clients of its protocol that mean no good.

Usage: foxglove.py ADIT WRITE_VIEW_MAP FOLDER. FOLDER has foxglove_client.mjs with its package-lock.json, and gets what npm installs by
that. A run that is watched must have the bytes of one that is not, and its result the points and poses of its files.
"""

import atexit
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading

from bad_clients import check_page, closed_for, get, status
from live_run import SETTINGS, Running
from viewing import Viewing, refusals, require, square, write_ply
from websocket import BINARY, CLOSE, Refused, WebSocket

SWEEPS = 60
NAMES = ("foxglove.sdk.v1", "foxglove.websocket.v1")
FOREIGN = "https://app.foxglove.dev"
LIVE = {"/log", "/tf", "/pose", "/sweep", "/lidar/points", "/keyframe/points", "/map/points", "/graph/trajectory",
        "/graph/keyframes", "/graph/odometry", "/graph/constraints", "/graph/loops", "/graph/uncertainty"}


class Client:
    """foxglove_client.mjs with all that it has told so far."""

    def __init__(self, folder, url, protocol, origin=""):
        self.process = subprocess.Popen(["node", "foxglove_client.mjs", url, protocol, origin], cwd=folder, text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        atexit.register(self.process.kill)  # where a test ends before it
        self.told = []
        self.changed = threading.Condition()
        self.ended = False
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            with self.changed:
                self.told.append(json.loads(line))
                self.changed.notify_all()
        with self.changed:
            self.ended = True
            self.changed.notify_all()

    def events(self, name):
        return [event for event in self.told if event["event"] == name]

    def messages(self, topic):
        """Of the feed that is told of now: what came after the last announcement."""
        last = max((i for i, event in enumerate(self.told) if event["event"] in ("advertise", "unadvertise")),
                   default=len(self.told))
        return [event["message"] for event in self.told[last:] if event["event"] == "message" and event["topic"] == topic]

    def wait(self, is_there, what, timeout=120):
        with self.changed:
            self.changed.wait_for(lambda: is_there() or self.ended, timeout)
            counts = {}
            for event in self.events("message"):
                counts[event["topic"]] = counts.get(event["topic"], 0) + 1
            require(is_there(), f"not told in time: {what}", counts, *[e for e in self.told if e["event"] != "message"])

    def close(self):
        """Ends it; nothing that it was told may have been wrong."""
        self.process.stdin.close()
        self.process.wait(timeout=20)
        self.reader.join()
        wrong = self.events("error") + self.events("status")
        require(not wrong, "the client complains", *wrong)


def points_in(messages):
    return sum(message["points"] for message in messages)


def ply_count(file):
    return int(file.read_bytes().split(b"element vertex ", 1)[1].split(b"\n", 1)[0])


def expected_counts(adit, out, folder):
    """Messages by topic, as `adit convert` writes them."""
    said = subprocess.run([str(adit), "convert", str(out), str(folder / "run.mcap"), "--as", "foxglove", "--overwrite"],
                          check=True, capture_output=True, text=True).stdout
    return {line.split()[0]: int(line.split()[1]) for line in said.splitlines() if line.startswith("/")}


def check_result(client, out, counts, points):
    """All that `adit convert` writes has come, with the points and poses of the run's files."""
    client.wait(lambda: all(len(client.messages(topic)) == count for topic, count in counts.items()),
                f"what is in the file: {counts}")
    require(points_in(client.messages("/keyframe/points")) == points, "there are other points in the map", points)
    require(points_in(client.messages("/map/points")) > 0, "the overview is empty")
    poses = [line.split() for line in (out / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    require(len(poses) == SWEEPS, "there are other sweeps", len(poses))
    for message, pose in zip(client.messages("/tf"), poses):
        told = [message["translation"][axis] for axis in "xyz"]
        require(max(abs(a - float(b)) for a, b in zip(told, pose[1:4])) < 1e-9, "a pose is another", message, pose)


def check_live(adit, folder, npm):
    """A run that Foxglove watches, and one that nobody does."""
    recording, alone, watched = folder / "room.mcap", folder / "alone", folder / "watched"
    subprocess.run([str(adit), "simulate", "room", "-o", str(recording), "--duration", str(SWEEPS / 10), "--trajectory",
                    "walk", "--quiet"], check=True)
    subprocess.run([str(adit), "run", str(recording), "-o", str(alone), *SETTINGS, "--quiet"], check=True)
    subprocess.run([str(adit), "export", str(alone / "map.adit"), "--cloud", "ply", "-o", str(folder / "cloud.ply")],
                   check=True, capture_output=True)
    running = Running(adit, recording, watched, "--foxglove")
    try:
        client = Client(npm, running.foxglove, NAMES[0], FOREIGN)
        silent = never_reading(running.port, running.foxglove)
        client.wait(lambda: client.events("serverInfo") and client.events("advertise"), "channels")
        require(client.events("serverInfo")[0]["protocol"] == NAMES[0], "another protocol was chosen")
        announced = {channel["topic"] for channel in client.events("advertise")[0]["channels"]}
        require(announced == LIVE, "other channels are announced while it runs", announced)
        client.wait(lambda: client.events("unadvertise"), "the result")
        told = {event["topic"] for event in client.events("message")}
        require(told >= LIVE, "channels without a message while it ran", LIVE - told)
        before = client.told[:client.told.index(client.events("unadvertise")[0])]
        placed = [e for e in before if e["event"] == "message" and e["topic"] == "/lidar/points"]
        require(all(e["message"]["frame_id"] == "lidar" and e["message"]["points"] > 1000 for e in placed),
                "a sweep without points")
        stamps = [int(e["stamp"]) for e in before if e["event"] == "message" and e["topic"] == "/tf"]
        require(stamps == sorted(set(stamps)), "poses out of order", stamps)
        require(client.events("unadvertise")[0]["topics"] == ["/lidar/points"], "other channels have gone")
        check_result(client, watched, expected_counts(adit, watched, folder), ply_count(folder / "cloud.ply"))
        client.close()
        silent.close()
        running.end()
    finally:
        running.process.kill()  # where the test has ended before it
    names = sorted(file.name for file in alone.iterdir())
    require(names == sorted(file.name for file in watched.iterdir()), "there are other files", names)
    for name in names:
        if name != "summary.json":  # which has times
            require((alone / name).read_bytes() == (watched / name).read_bytes(), f"{name} is another where it is watched")
    print(f"live: {len(before)} events, {len(stamps)} of {SWEEPS} poses, before the result")
    return watched


def raw(port, path="/", **options):
    return WebSocket(port, path, protocol="foxglove.websocket.v1", **options)


def greeted(port, path):
    client = raw(port, path)
    received(client, "advertise")
    return client


def ask(client, **message):
    client.send(json.dumps(message))


def received(client, op):
    """The next text of that kind; data are passed over."""
    while True:
        kind, data = client.receive()
        require(kind != CLOSE, f"closed instead of {op}", data)
        if kind != BINARY and json.loads(data)["op"] == op:
            return json.loads(data)


def subscriptions(count):
    return [{"id": i, "channelId": i} for i in range(count)]


def never_reading(port, url):
    """Subscribes to all that there is and takes nothing of it."""
    client = raw(port, "/?" + url.split("?")[1], receive_buffer=4096)
    count = len(received(client, "advertise")["channels"])
    ask(client, op="subscribe", subscriptions=subscriptions(count))
    return client


def check_bad_clients(port, path):
    """Each is refused or told; returns how many of which kind there were."""
    for wrong in ("/", "/?token=0"):
        for origin in (None, FOREIGN):
            try:
                raw(port, wrong, origin=origin)
                require(False, f"{wrong} was let in")
            except Refused as refused:
                require("403" in refused.args[0], "refused for another reason", refused)
    try:
        WebSocket(port, "/socket" + path[1:])
        require(False, "the page is open to who has Foxglove's link")
    except Refused as refused:
        require("403" in refused.args[0], "refused for another reason", refused)
    for other in ("/socket" + path[1:], "/map" + path[1:]):  # the page's own is closed to pages of others
        try:
            raw(port, other, origin=FOREIGN)
            require(False, f"{other} was let in")
        except Refused as refused:
            require("403" in refused.args[0], "refused for another reason", refused)

    # Asks for what is not offered, and gets what is, all the same.
    client = greeted(port, path)
    for op in ("setParameters", "advertise", "no such thing", "x" * 1000):
        ask(client, op=op)
        told = received(client, "status")
        require(told["level"] == 2 and op[:40] in told["message"] and len(told["message"]) < 100, "not told", told)
    ask(client, op="subscribe", subscriptions=[{"id": 1, "channelId": 99}])
    require("no channel 99" in received(client, "status")["message"], "another complaint")
    ask(client, op="subscribe", subscriptions=[{"id": 1, "channelId": 0}])
    for again in ({"id": 1, "channelId": 1}, {"id": 2, "channelId": 0}):
        ask(client, op="subscribe", subscriptions=[again])
        require("already" in received(client, "status")["message"], "subscribed twice")
    ask(client, op="unsubscribe", subscriptionIds=[7])
    require("no subscription 7" in received(client, "status")["message"], "another complaint")
    ask(client, op="unsubscribe", subscriptionIds=[1])
    client.close()

    nonsense = ["", "no json", "[]", "{}", '{"op": 1}', '{"op": "subscribe"}', '{"op": "subscribe", "subscriptions": {}}',
                '{"op": "subscribe", "subscriptions": [1]}', '{"op": "unsubscribe", "subscriptionIds": ["1"]}',
                '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 0}]}',
                '{"op": "subscribe", "subscriptions": [{"id": 4294967296, "channelId": 0}]}', '{"tiles": [0]}', "[" * 16000]
    for message in nonsense:
        client = greeted(port, path)
        client.send(message)
        closed_for(client, 1008)
    for garbage in (b"", b"\x01" * 9, bytes(range(256))):
        client = greeted(port, path)
        client.send(garbage, BINARY)
        closed_for(client, 1003)
    client = greeted(port, path)
    ask(client, op="subscribe", subscriptions=subscriptions(300))
    closed_for(client, 1008)
    client = greeted(port, path)
    ask(client, op="subscribe", subscriptions=subscriptions(3000))
    closed_for(client, 1009)
    return {"wrong token": 5, "foreign origin": 2, "not offered": 8, "malformed": len(nonsense) + 3, "too many": 1, "too large": 1}


def check_flood(port, path):
    """Asks on and on, and takes no answer: its answers are bounded, and it is sent away."""
    client = raw(port, path, receive_buffer=4096)
    try:
        for _ in range(1_000_000):
            ask(client, op="nothing")
    except ConnectionError:
        return
    require(False, "a million questions were answered to nobody")


def check_view(adit, folder, npm, out):
    """What is served of a run that has ended."""
    counts = expected_counts(adit, out, folder)
    points = ply_count(folder / "cloud.ply")
    viewing = Viewing(adit, out, "--foxglove")
    url = viewing.foxglove
    path = "/?" + url.split("?")[1]
    for name, origin in zip(NAMES, (FOREIGN, "")):
        client = Client(npm, url, name, origin)
        check_result(client, out, counts, points)
        require(client.events("serverInfo")[0]["protocol"] == name, "another protocol was chosen")
        require({c["topic"] for c in client.events("advertise")[0]["channels"]} == set(counts), "there are other channels")
        client.close()
    expected = check_bad_clients(viewing.port, path)
    before = viewing.memory()
    silent = [never_reading(viewing.port, url) for _ in range(8)]
    check_flood(viewing.port, path)
    grown = viewing.memory() - before
    require(grown < 40e6, f"memory has grown by {grown} bytes for clients that read nothing")
    require(status(get(viewing.port, "/?" + viewing.link.split("?")[1])) == 200, "the page is served no more")
    for client in silent:
        client.close()
    text = viewing.end()
    counted = refusals(text)
    flood = counted.pop("not offered") - expected.pop("not offered")
    expected["too many"] += 1
    require(counted == expected and flood > 64, "counted otherwise", f"expected {expected}", f"counted  {counted}", text)
    print(f"view: {sum(counts.values())} messages of {len(counts)} channels, {points} points; memory grew by "
          f"{grown / 1e6:.1f} MB; {flood} of a flood answered")


def check_edit(adit, folder, npm, write_view_map):
    """What a page edits is drawn anew."""
    view_map = folder / "map.adit"
    subprocess.run([str(write_view_map), str(view_map)], check=True)
    viewing = Viewing(adit, view_map, "--edit")
    client = Client(npm, f"ws://127.0.0.1:{viewing.port}/", NAMES[1])
    page = WebSocket(viewing.port)
    ends = []
    for told, edit in enumerate(("revoke", "restore", None), 1):
        client.wait(lambda: len(client.messages("/graph/loops")) == told and len(client.messages("/keyframe/points")) == 6 * told,
                    f"the map, before {edit}")
        ends.append(client.messages("/tf")[-1]["translation"]["x"])
        if edit:
            page.send(json.dumps({edit: 1}))
    require(abs(ends[1] - 50.0) < 1e-3 and ends[2] < 49.5, "the loop does not hold the last sweep nearer", ends)
    require(len(client.events("advertise")) == 1 and not client.events("unadvertise"), "other channels are announced")
    page.close()
    client.close()
    require("refused" not in viewing.end(), "somebody was refused")


def check_cloud(adit, folder, npm):
    """A cloud alone: all of its points, and no token where nobody has asked for one."""
    cloud = folder / "square.ply"
    write_ply(cloud, square(20.0, 0.1))
    viewing = Viewing(adit, cloud)
    client = Client(npm, f"ws://localhost:{viewing.port}/", NAMES[1])
    client.wait(lambda: client.events("message"), "the cloud")
    (told,) = client.messages("/map/points")
    require(told["points"] == 40_000 and abs(told["high"][0] - 9.95) < 1e-3 and abs(told["low"][1] + 9.95) < 1e-3,
            "there are other points", told)
    client.close()
    refused = Client(npm, f"ws://localhost:{viewing.port}/", NAMES[1], FOREIGN)
    refused.wait(lambda: refused.events("refused"), "no refusal")
    refused.process.wait(timeout=20)
    check_page(viewing.port)
    require(refusals(viewing.end()) == {"foreign origin": 1}, "counted otherwise")


def main():
    adit, write_view_map, npm = (pathlib.Path(argument).absolute() for argument in sys.argv[1:4])
    if shutil.which("node") is None or shutil.which("npm") is None:
        print("needs node and npm")
        return
    subprocess.run(["npm", "ci", "--prefer-offline", "--silent"], cwd=npm, check=True)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        check_cloud(adit, folder, npm)
        check_edit(adit, folder, npm, write_view_map)
        out = check_live(adit, folder, npm)
        check_view(adit, folder, npm, out)
    print("foxglove: live, result and cloud as they are; bad clients refused, bounded and counted")


if __name__ == "__main__":
    main()
