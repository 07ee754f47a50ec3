#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""`adit live`: packets over loopback and ROS 2 topics are recorded and mapped, and `adit run` of the recording gives the
same bytes.

Usage: live.py ADIT [TOPIC_PEER]. TOPIC_PEER, built where there is a DDS, is the other side of the topics.
"""

import concurrent.futures
import json
import math
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

SWEEPS = 28
SAME = ["trajectory.tum", "online.tum", "odometry.tum", "sweeps.csv", "map.ply"]
ELEVATIONS = [-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15]


def distance(azimuth, elevation, x):
    """Metres to the walls of a room, from a sensor at (x, 0.3, 1.2)."""
    a, e = math.radians(azimuth), math.radians(elevation)
    ray = (math.cos(e) * math.sin(a), math.cos(e) * math.cos(a), math.sin(e))
    walls = zip(ray, (x, 0.3, 1.2), ((-6, 7), (-4, 5), (0, 3.5)))
    return min(((far if d > 0 else near) - p) / d for d, p, (near, far) in walls if abs(d) > 1e-9)


def vlp16_packets(sweeps=SWEEPS):
    """Packets of a VLP-16 that turns ten times a second and moves at 0.4 m/s."""
    packets = []
    for number in range(sweeps * 75):
        body = b""
        for block in range(12):
            turn = (number * 12 + block) % 900
            second = (number * 12 + block) * 110.592e-6
            body += struct.pack("<HH", 0xEEFF, turn * 40)
            ranges = [distance(turn * 0.4, elevation, 0.4 * second) for elevation in ELEVATIONS]
            channels = b"".join(struct.pack("<HB", round(r / 0.002), 50) for r in ranges)
            body += channels + channels
        packets.append(body + struct.pack("<IBB", round(number * 12 * 110.592), 0x37, 0x22))
    return packets


def payloads(file, port):
    """UDP payloads of a recording that were sent to a port."""
    data, at, found = file.read_bytes(), 24, []
    while at < len(data):
        size = struct.unpack_from("<I", data, at + 8)[0]
        if struct.unpack_from(">H", data, at + 16 + 22)[0] == port:
            found.append(data[at + 16 + 28:at + 16 + size])
        at += 16 + size
    return found


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def expect(holds, what):
    if not holds:
        sys.exit(f"live: {what}")


def same_files(one, other):
    for name in SAME:
        expect((one / name).read_bytes() == (other / name).read_bytes(), f"{name} is another file")
    expect((one / "trajectory.tum").stat().st_size > 0, "the trajectory is empty")


def run(adit, *words):
    done = subprocess.run([adit, *map(str, words)], capture_output=True, text=True, check=False)
    expect(done.returncode == 0, f"{words}: exit code {done.returncode}\n{done.stderr}")


def wait_until_it_listens(process):
    line = process.stderr.readline()
    expect("listening; adit waits" in line, f"it says {line!r} first")


def send_until(sender, port, packets, end):
    """At the sensor's pace, again and again; returns how many were sent."""
    sent = 0
    while not end.is_set():
        sender.sendto(packets[sent % len(packets)], ("127.0.0.1", port))
        sent += 1
        time.sleep(1 / 754)
    return sent


def send(sender, port, packets):
    """At the sensor's pace, with datagrams that no sensor sends between them."""
    chance = random.Random(52)
    bad = 0
    for number, packet in enumerate(packets):
        sender.sendto(packet, ("127.0.0.1", port))
        sender.sendto(chance.randbytes(chance.randrange(1400)), ("127.0.0.1", port))
        bad += 1
        if number % 50 == 7:
            sender.sendto(packet[:chance.randrange(1200)], ("127.0.0.1", port))
            bad += 1
        time.sleep(1 / 754)
    return bad


def check_sensor(adit, folder):
    """Packets, and the fixes of a gpsd."""
    out, port, packets = folder / "live", free_port(), vlp16_packets()
    with socket.create_server(("127.0.0.1", 0)) as server, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender, \
            subprocess.Popen([adit, "live", f"udp://127.0.0.1:{port}", gpsd_of(server), "-o", out, "--wait", "60"],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        threading.Thread(target=serve_gpsd, args=[server], daemon=True).start()
        wait_until_it_listens(process)
        bad = send(sender, port, packets)
        wait_for_file(process, out / "map.adit")  # the job has begun
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate()
        expect(process.returncode == 0, f"exit code {process.returncode}\n{err}")
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    live, recorded = summary["live"], payloads(out / "recording.pcap", port)
    rest = iter(packets)
    expect(all(one in rest for one in recorded), "the recording is not what was sent, in its order")
    missing = len(packets) - len(recorded) + bad - live["unknown_datagrams"]
    expect(0 <= missing <= live["lost_datagrams"], f"{missing} datagrams are unaccounted for: {live}")
    expect(live["sweeps"] > SWEEPS // 2, f"the latency of too few sweeps is known: {live}")
    expect("verdict" in summary, "there is no verdict")
    expect(summary["map"]["gnss"]["fixes"] >= 5, f"fixes of the gpsd are not used: {summary['map']}")
    run(adit, "check", out / "map.adit")
    run(adit, "run", out / "recording.pcap", "-o", folder / "again", "--quiet")
    same_files(out, folder / "again")


def gpsd_of(server):
    return f"gpsd://127.0.0.1:{server.getsockname()[1]}"


def serve_gpsd(server):
    """One client of a gpsd: garbage, then ten fixes a second, at the times of vlp16_packets()."""
    client, _ = server.accept()
    with client:
        expect(b"?WATCH=" in client.recv(100), "gpsd is not asked for reports")
        client.sendall(b'{"class":"VERSION"}\n\x00\xff{{{\n')
        try:
            hour = 3600 * round(time.time() / 3600)
            for number in range(100):
                stamp = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(hour + number // 10))
                client.sendall(b'{"class":"TPV","mode":3,"time":"%s.%dZ","lat":49.1,"lon":8.4,"altHAE":%d}\n' %
                               (stamp.encode(), number % 10, number))
                time.sleep(0.1)
        except OSError:
            pass  # it has ended


def asked(port, path):
    """Code and body of a GET."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/{path}", timeout=5) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def wait_for_file(process, file):
    for _ in range(6000):
        if file.exists():
            return
        if process.poll() is not None:
            break
        time.sleep(0.01)
    process.kill()
    sys.exit(f"live: {file.name} does not appear: {process.communicate()}")


def begin_next_session(process, out, next_out):
    """SIGHUP once the first session is mapped; returns when the next one has begun."""
    wait_for_file(process, out / "map.adit")
    process.send_signal(signal.SIGHUP)
    wait_for_file(process, next_out / "recording.pcap")


def check_sessions(adit, folder):
    """A SIGHUP begins the next session, and no packet is lost."""
    out, next_out, port, packets = folder / "one", folder / "one-2", free_port(), vlp16_packets()
    command = [adit, "live", f"udp://127.0.0.1:{port}", "-o", out, "--wait", "60", "--status-port", "0", "--log-json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender, \
            concurrent.futures.ThreadPoolExecutor() as pool:
        status = int(json.loads(process.stderr.readline())["message"].split(":")[3].split("/")[0])
        wait_until_it_listens(process)
        end = threading.Event()
        sending = pool.submit(send_until, sender, port, packets, end)
        try:
            begin_next_session(process, out, next_out)
            code, health = asked(status, "health")
            time.sleep(3)  # the next session begins with two seconds of its sensors
            metrics = asked(status, "metrics")[1]
            elsewhere = asked(status, "elsewhere")[0]
        finally:
            end.set()
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate()
        expect(process.returncode == 0, f"sessions: exit code {process.returncode}\n{err}")
    expect(code == 200 and "sweeps" in json.loads(health), f"health: {code} {health}")
    expect(f'adit_received_messages_total{{source="udp://127.0.0.1:{port}"}}' in metrics, metrics)
    expect(elsewhere == 404, f"code {elsewhere} of a page that there is not")
    for line in err.splitlines():
        expect(set(json.loads(line)) == {"time", "level", "message"}, f"no line of JSON: {line}")
    first, second = (out / "recording.pcap").read_bytes()[24:], (next_out / "recording.pcap").read_bytes()[24:]
    shared = len(first) - first.index(second[:1000])  # with the times of arrival no packet is like another
    expect(first[-shared:] == second[:shared], "the recordings do not overlap")
    size = 16 + 28 + 1206
    expect(shared >= 0.25 * 754 / 2 * size, f"they overlap by {shared // size} packets")
    lost = json.loads((next_out / "summary.json").read_text(encoding="utf-8"))["live"]["lost_datagrams"]
    recorded = (len(first) - shared + len(second)) // size
    expect(recorded + lost == sending.result(), f"{recorded} of {sending.result()} packets, {lost} lost")
    for one in out, next_out:
        run(adit, "check", one / "map.adit")
        run(adit, "run", one / "recording.pcap", "-o", folder / f"{one.name}_again", "--quiet")
        same_files(one, folder / f"{one.name}_again")


def check_recording(adit, folder):
    recording = folder / "room.mcap"
    run(adit, "simulate", "room", "--duration", "1.5", "-o", recording)
    run(adit, "run", recording, "-o", folder / "run", "--quiet")
    run(adit, "live", recording, "-o", folder / "paced", "--speed", "20", "--quiet")
    same_files(folder / "run", folder / "paced")


def check_topics(adit, peer, folder):
    recording, out = folder / "topics.mcap", folder / "topics"
    run(adit, "simulate", "room", "--duration", "5", "--seed", "52", "-o", recording)
    os.environ["ROS_DOMAIN_ID"] = str(random.randrange(1, 100))  # another test may run beside this one
    with subprocess.Popen([peer, recording, "1"], stdout=subprocess.PIPE, text=True) as other:
        expect(other.stdout.readline() == "ready\n", "the other side does not begin")
        command = [adit, "live", "ros2", "--publish", "-o", out, "--wait", "60"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            report, _ = other.communicate()
            process.send_signal(signal.SIGTERM)
            _, err = process.communicate()
            expect(process.returncode == 0, f"topics: exit code {process.returncode}\n{err}")
    counts = {tuple(line.split()[:2]): int(line.split()[2]) for line in report.splitlines()}
    live = json.loads((out / "summary.json").read_text(encoding="utf-8"))["live"]
    expect(live["sweeps"] == counts["sent", "/points"], f"{counts}, {live}")
    # The last sweeps wait for IMU samples that come no more, until the run ends.
    expect(counts.get(("received", "/adit/odometry"), 0) >= live["sweeps"] - 2, f"{counts}, {live}")
    expect(counts.get(("received", "/adit/odometry_high_rate"), 0) > 5 * live["sweeps"], f"{counts}, {live}")
    expect(live["high_rate_poses"] > 5 * live["sweeps"], f"{live}")
    for topic in ("/tf", "/adit/path", "/adit/map", "/adit/occupancy_grid", "/adit/keyframe_cloud", "/diagnostics"):
        expect(counts.get(("received", topic), 0) > 0, f"{topic} is missing: {counts}")
    run(adit, "run", out / "recording.mcap", "-o", folder / "topics_again", "--quiet")
    same_files(out, folder / "topics_again")


# Two range sensors, wheels, another odometry, and a receiver with two antennas on a vehicle.
SENSES = """scene = "mine"
duration = 4.0
seed = 53
[[lidar]]
topic = "/front"
frame = "front"
[[lidar]]
topic = "/rear"
frame = "rear"
position = [-0.6, 0.0, 0.1]
yaw_pitch_roll = [170.0, 0.0, 0.0]
[wheels]
use = true
[visual_odometry]
use = true
[gnss]
receiver = "single"
heading = true
"""


def check_senses(adit, peer, folder):
    """Several lidars, wheels, headings and another odometry: each is used live, and again of the recording."""
    recording, scene = folder / "senses.mcap", folder / "senses.toml"
    scene.write_text(SENSES, encoding="utf-8")
    run(adit, "simulate", scene, "-o", recording)
    lidars = ["--topic", "/front", "--merge", "/rear"]
    heading = ["--set", "recording.heading_topic=/heading"]
    wheels = ["--set", "recording.velocity_topic=/wheels"]
    odometry = ["--set", "recording.velocity_topic=/visual_odometry", "--set", "recording.velocity_of_poses=true"]
    for name, words in ("wheels", lidars + heading + wheels), ("odometry", ["--topic", "/front"] + odometry):
        out = folder / f"live_{name}"
        with subprocess.Popen([peer, recording, "1"], stdout=subprocess.PIPE, text=True) as other:
            expect(other.stdout.readline() == "ready\n", "the other side does not begin")
            with subprocess.Popen([adit, "live", "ros2", "-o", out, "--wait", "60", *words], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True) as process:
                other.communicate()
                process.send_signal(signal.SIGTERM)
                _, err = process.communicate()
                expect(process.returncode == 0, f"{name}: exit code {process.returncode}\n{err}")
        summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
        fused = summary["velocity"]["sensor"]["fused"]
        expect(fused > 10, f"{name}: {fused} sweeps have their velocity\n{err}")
        if name == "wheels":
            headings = summary["map"]["gnss"]["headings"]["headings"]
            expect(headings > 10, f"{headings} headings arrived\n{err}")
            expect("/rear: " in err and " 0 points" not in err, f"the second lidar is not merged\n{err}")
        run(adit, "run", out / "recording.mcap", "-o", folder / f"again_{name}", "--quiet", *words)
        same_files(out, folder / f"again_{name}")


def check_record(adit, peer, folder):
    recording = folder / "topics.mcap"
    with subprocess.Popen([peer, recording, "2"], stdout=subprocess.PIPE, text=True) as other:
        expect(other.stdout.readline() == "ready\n", "the other side does not begin")
        command = [adit, "record", "ros2", "-o", folder / "parts.mcap", "--split-time", "1", "--quiet"]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
            report, _ = other.communicate()
            process.send_signal(signal.SIGTERM)
            _, err = process.communicate()
            expect(process.returncode == 0, f"record: exit code {process.returncode}\n{err}")
    counts = {tuple(line.split()[:2]): int(line.split()[2]) for line in report.splitlines()}
    parts = sorted(folder.glob("parts_*.mcap"))
    expect(len(parts) >= 3, f"{parts}")
    run(adit, "run", *parts, "-o", folder / "of_parts", "--odometry", "--quiet")
    sweeps = (folder / "of_parts" / "trajectory.tum").read_text(encoding="utf-8").count("\n")
    expect(sweeps == counts["sent", "/points"], f"{sweeps} sweeps of {counts}")


def check_gpsd(adit, peer, folder):
    with socket.create_server(("127.0.0.1", 0)) as server, \
            subprocess.Popen([peer, folder / "topics.mcap", "2"], stdout=subprocess.PIPE, text=True) as other:
        threading.Thread(target=serve_gpsd, args=[server], daemon=True).start()
        expect(other.stdout.readline() == "ready\n", "the other side does not begin")
        run(adit, "record", "ros2", gpsd_of(server), "-o", folder / "gpsd.mcap", "--duration", "4", "--quiet")
        other.kill()
    done = subprocess.run([adit, "inspect", folder / "gpsd.mcap", "--json"], capture_output=True, text=True, check=False)
    topics = {topic["name"]: topic for topic in json.loads(done.stdout)["topics"]}
    expect(topics["/gpsd/fix"]["events"] >= 10, f"{topics.get('/gpsd/fix')}")


def check_no_topics(adit, folder):
    command = [adit, "live", "/nowhere", "-o", folder / "nowhere", "--wait", "0.3"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    expect(done.returncode == 1 and "/nowhere was not published" in done.stderr, f"no topics: {done}")


def check_list(adit):
    """Without a source, what arrives at the ports of sensors is listed, and how to map it."""
    with subprocess.Popen([adit, "live", "--wait", "2"], stdout=subprocess.PIPE, text=True) as process, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for packet in vlp16_packets(1) * 20:
            sender.sendto(packet, ("127.0.0.1", 2368))
            time.sleep(1 / 754)
        out, _ = process.communicate()
    if "port 2368 (Velodyne, Hesai): another program listens there" in out:
        print("live: port 2368 is taken; that packets are listed is not tested")
        return
    expect("map it: adit live udp://0.0.0.0:2368 -o out" in out, f"list: {out}")


def check_silence(adit, folder):
    command = [adit, "live", f"udp://127.0.0.1:{free_port()}", "-o", folder / "none", "--wait", "0.2"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    expect(done.returncode == 1 and "no packet of a known sensor arrived" in done.stderr, f"silence: {done}")
    expect(not (folder / "none").exists(), "silence leaves a folder")
    command = [adit, "record", f"udp://127.0.0.1:{free_port()}", "-o", folder / "none.pcap", "--wait", "0.2"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    expect(done.returncode == 1 and "nothing arrived" in done.stderr, f"silence: {done}")
    expect(not (folder / "none.pcap").exists(), "silence leaves a recording")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    adit = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_silence(adit, folder)
        check_recording(adit, folder)
        check_sensor(adit, folder)
        check_sessions(adit, folder)
        check_list(adit)
        if len(sys.argv) == 3:
            check_no_topics(adit, folder)
            check_topics(adit, sys.argv[2], folder)
            check_senses(adit, sys.argv[2], folder)
            check_record(adit, sys.argv[2], folder)
            check_gpsd(adit, sys.argv[2], folder)


if __name__ == "__main__":
    main()
