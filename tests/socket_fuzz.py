#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""`adit live` while its sources send what no sensor, publisher or gpsd sends, between what they do send.

It must go on, end with 0 at a signal, leave a map that `adit check` finds whole, and not grow.

Usage: socket_fuzz.py ADIT SECONDS [TOPIC_PEER]. SECONDS for each source: UDP packets; with TOPIC_PEER also ROS 2
topics. A gpsd is beside either.
"""

import concurrent.futures
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import live

MOST_GROWTH = 200 << 20  # bytes, from a third of the time on: the map grows, too


def resident(process):
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8").splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) * 1024
    return 0


def damaged(chance, data):
    """Cut off, with other bytes, longer, or nothing of it."""
    kind = chance.randrange(4)
    if kind == 0:
        return data[:chance.randrange(len(data))]
    if kind == 1:
        some = bytearray(data)
        for _ in range(chance.randrange(1, 30)):
            some[chance.randrange(len(some))] = chance.randrange(256)
        return bytes(some)
    if kind == 2:
        return data + chance.randbytes(chance.randrange(1, 400))
    return data[:chance.randrange(1, 40)] + chance.randbytes(chance.randrange(1400))


class Watched:
    """A run of adit, and how its memory grows."""

    def __init__(self, adit, folder, *words):
        self.folder = folder
        self.err = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")
        command = [adit, "live", *map(str, words), "-o", str(folder), "--wait", "60"]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=self.err)

    def wait_for_map(self):
        for _ in range(1200):
            if (self.folder / "map.adit").exists():
                return
            live.expect(self.process.poll() is None, f"it ended by itself: {self.text()}")
            time.sleep(0.1)
        self.process.kill()
        sys.exit(f"live: no map appears: {self.text()}")

    def text(self):
        self.err.seek(0)
        return self.err.read()[-3000:]

    def watch(self, seconds):
        begin, third = time.monotonic(), None
        while time.monotonic() - begin < seconds:
            live.expect(self.process.poll() is None, f"it ended by itself: {self.text()}")
            if third is None and time.monotonic() - begin > seconds / 3:
                third = resident(self.process)
            time.sleep(0.1)
        return third, resident(self.process)

    def end(self, adit):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait()
        live.expect(code == 0, f"exit code {code}: {self.text()}")
        live.run(adit, "check", self.folder / "map.adit")


def report(source, grown, sent):
    third, end = grown
    print(f"{source}: {sent}; memory {third / 1e6:.0f} MB after a third of the time, {end / 1e6:.0f} MB at the end", flush=True)
    live.expect(end - third < MOST_GROWTH, f"{source}: its memory grows")


def serve_gpsd(server, sent):
    """To each client: reports, whole and damaged."""
    chance = random.Random(2)
    line = b'{"class":"TPV","mode":3,"lat":49.1,"lon":8.4,"altHAE":112.5,"epx":1.5,"epy":1.5,"epv":3.0}\n'
    while True:
        try:
            client, _ = server.accept()
        except OSError:
            return
        with client:
            try:
                for _ in range(200):
                    client.sendall(line + damaged(chance, line))
                    sent["reports"] += 2
                    time.sleep(0.05)
            except OSError:
                pass  # it has ended


def fuzz(adit, out, seconds, sources, send, sent):
    """Maps the sources and a gpsd, while send(begun, done) sends to them; `begun` is set once there is a map."""
    begun, done = threading.Event(), threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server, concurrent.futures.ThreadPoolExecutor() as pool:
        threading.Thread(target=serve_gpsd, args=[server, sent], daemon=True).start()
        run = Watched(adit, out, *sources, live.gpsd_of(server))
        sending = pool.submit(send, begun, done)
        try:
            run.wait_for_map()
            begun.set()
            grown = run.watch(seconds)
        finally:
            done.set()
        sending.result()
        run.end(adit)
    report(f"{out.name} and gpsd", grown, sent)


def fuzz_packets(adit, folder, seconds):
    """Damaged packets once the map has begun: before, a run is refused where its points' times contradict its sweeps'."""
    port, packets, chance = live.free_port(), live.vlp16_packets(), random.Random(1)
    sent = {"packets": 0, "damaged": 0, "reports": 0}

    def send(begun, done):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            while not done.is_set():
                packet = packets[sent["packets"] % len(packets)]
                sender.sendto(packet, ("127.0.0.1", port))
                sent["packets"] += 1
                if begun.is_set():
                    sender.sendto(damaged(chance, packet), ("127.0.0.1", port))
                    sent["damaged"] += 1
                time.sleep(1 / 754)  # the rate of a VLP-16

    fuzz(adit, folder / "packets", seconds, [f"udp://127.0.0.1:{port}"], send, sent)


def fuzz_topics(adit, peer, folder, seconds):
    """Publishers come and go, each with damaged messages and with stamps that step back."""
    recording, sent = folder / "room.mcap", {"publishers": 0, "reports": 0}
    live.run(adit, "simulate", "room", "--duration", "8", "--seed", "53", "-o", recording)
    os.environ["ROS_DOMAIN_ID"] = str(random.randrange(1, 100))

    def publish(_, done):
        while not done.is_set():
            with subprocess.Popen([peer, recording, "1", str(sent["publishers"])], stdout=subprocess.DEVNULL) as one:
                sent["publishers"] += 1
                while one.poll() is None and not done.is_set():
                    time.sleep(0.05)
                live.expect(not one.returncode, f"a publisher ends with {one.returncode}")
                one.kill()

    fuzz(adit, folder / "topics", seconds, ["ros2", "--publish"], publish, sent)


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    adit, seconds = str(pathlib.Path(sys.argv[1]).resolve()), float(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        fuzz_packets(adit, pathlib.Path(name), seconds)
        if len(sys.argv) == 4:
            fuzz_topics(adit, sys.argv[3], pathlib.Path(name), seconds)


if __name__ == "__main__":
    main()
