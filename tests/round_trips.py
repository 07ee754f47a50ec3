#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings to and fro between adit and the Python packages rosbags and mcap.

Usage: round_trips.py ADIT [--folder FOLDER]. A simulated recording is written by the other programs in every container,
version and compression that they know. `adit inspect` must find each topic with its type and number of messages in it,
and `adit convert` must make of it, in each of its own forms, what the other programs read as the same messages: topic,
type, stamp and content. Exits 1 where one differs, 2 where a package is missing (rosbags mcap lz4 zstandard).
"""

import argparse
import collections
import itertools
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

try:
    import mcap.reader
    import mcap.writer
    from rosbags.highlevel import AnyReader
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as FolderWriter
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
except ImportError as error:
    print(f"round_trips.py: {error}; pip install rosbags mcap lz4 zstandard", file=sys.stderr)
    sys.exit(2)

ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
ROS1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
ONLY_ROS2 = {"/note"}  # of a type that adit does not translate
Message = collections.namedtuple("Message", "topic type stamp data")  # data: ROS 2's, little-endian CDR


def canonical(kind, data):
    return bytes(ROS2.serialize_cdr(ROS2.deserialize_cdr(data, kind), kind))


def to_ros1(message):
    return bytes(ROS2.cdr_to_ros1(message.data, message.type))


# --- what is recorded -------------------------------------------------------------------------------------------------


def simulated(adit, folder):
    file = folder / "mine.mcap"
    command = [adit, "simulate", "mine", "-o", file, "--duration", "2", "--gnss", "rtk", "--quiet"]
    subprocess.run([str(word) for word in command], check=True)
    messages = []
    with open(file, "rb") as stream:
        for schema, channel, message in mcap.reader.make_reader(stream).iter_messages(log_time_order=False):
            kind = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
            messages.append(Message(channel.topic, kind, message.log_time, canonical(kind, message.data)))
    string = ROS2.types["std_msgs/msg/String"]
    for k in range(200):
        stamp = messages[0].stamp + 10_000_000 * k
        data = bytes(ROS2.serialize_cdr(string(f"note {k}"), "std_msgs/msg/String"))
        messages.append(Message("/note", "std_msgs/msg/String", stamp, data))
    return file, sorted(messages, key=lambda m: m.stamp)


def topics_of(messages):
    return {m.topic: m.type for m in messages}


# --- written by others ------------------------------------------------------------------------------------------------


def write_bag(path, messages, compression):
    writer = BagWriter(path)
    if compression:
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    with writer:
        channels = {t: writer.add_connection(t, k, typestore=ROS1) for t, k in topics_of(messages).items()}
        for m in messages:
            writer.write(channels[m.topic], m.stamp, to_ros1(m))


def without_bag_index(path):
    """As a recorder leaves it that was killed: the head says that there is no index, and there is none."""
    data = bytearray(path.read_bytes())
    at = data.index(b"index_pos=") + len(b"index_pos=")
    (index,) = struct.unpack_from("<Q", data, at)
    data[at : at + 8] = bytes(8)
    path.write_bytes(data[:index])


def write_mcap(path, messages, compression, ros, form):
    kinds = mcap.writer.IndexType
    with open(path, "wb") as stream:
        writer = mcap.writer.Writer(
            stream,
            chunk_size=200_000,
            compression=getattr(mcap.writer.CompressionType, compression.upper()),
            use_chunking=form != "no chunks",
            index_types=kinds.NONE if form in ("no index", "no summary") else kinds.ALL,
            repeat_channels=form != "no summary",
            use_statistics=form != "no summary",
            use_summary_offsets=form != "no summary",
        )
        writer.start(f"ros{ros}", "round_trips.py")
        store, channels = (ROS1, {}) if ros == 1 else (ROS2, {})
        for topic, kind in topics_of(messages).items():
            definition, _ = store.generate_msgdef(kind, ros_version=ros)
            name = kind.replace("/msg/", "/") if ros == 1 else kind
            schema = writer.register_schema(name, f"ros{ros}msg", definition.encode())
            channels[topic] = writer.register_channel(topic, "ros1" if ros == 1 else "cdr", schema)
        for m in messages:
            data = to_ros1(m) if ros == 1 else m.data
            writer.add_message(channels[m.topic], log_time=m.stamp, publish_time=m.stamp, data=data)
        writer.finish()


def qualities(topic):
    latched = topic == "/tf_static"
    return [
        Qos(
            QosHistory.KEEP_LAST,
            10,
            QosReliability.RELIABLE,
            QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
            QosTime(0, 0),
            QosTime(0, 0),
            QosLiveliness.AUTOMATIC,
            QosTime(0, 0),
            False,
        )
    ]


def write_folder(path, messages, version, plugin, mode):
    writer = FolderWriter(path, version=version, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        channels = {
            t: writer.add_connection(t, k, typestore=ROS2, offered_qos_profiles=qualities(t))
            for t, k in topics_of(messages).items()
        }
        for m in messages:
            writer.write(channels[m.topic], m.stamp, m.data)


def split_folder(path, messages, plugin):
    """Two files, as a recorder with a largest size leaves them; each knows every topic."""
    half, suffix = len(messages) // 2, ".db3" if plugin == StoragePlugin.SQLITE3 else ".mcap"
    first = [m for m in messages if m.topic == "/tf_static"] + [m for m in messages[:half] if m.topic != "/tf_static"]
    second = [m for m in messages[half:] if m.topic != "/tf_static"]
    write_folder(path, first, 8, plugin, CompressionMode.NONE)
    other = path.with_name(path.name + "_second")
    write_folder(other, second, 8, plugin, CompressionMode.NONE)
    name = next(path.glob("*" + suffix)).name
    next_name = name.replace(suffix, "_1" + suffix)
    shutil.move(next(other.glob("*" + suffix)), path / next_name)
    shutil.rmtree(other)
    yaml = (path / "metadata.yaml").read_text()
    lines = []
    for line in yaml.splitlines():
        lines.append(line)
        if line.strip() in (f"- {name}", f"- '{name}'"):
            lines.append(line.replace(name, next_name))
    (path / "metadata.yaml").write_text("\n".join(lines) + "\n")


def written_by_others(folder, messages):
    """Yields (path, generation of ROS, whether the container tells its counts)."""
    old = [m for m in messages if m.topic not in ONLY_ROS2]
    for compression in ("", "lz4", "bz2"):
        for index in (True, False):
            path = folder / f"bag_{compression or 'none'}_{'indexed' if index else 'killed'}.bag"
            write_bag(path, old, compression)
            if not index:
                without_bag_index(path)
            yield path, 1
    forms = ("whole", "no index", "no summary", "no chunks")
    for compression, ros, form in itertools.product(("none", "lz4", "zstd"), (1, 2), forms):
        if form == "no chunks" and compression != "none":
            continue
        path = folder / f"mcap_{compression}_ros{ros}_{form.replace(' ', '_')}.mcap"
        write_mcap(path, old if ros == 1 else messages, compression, ros, form)
        yield path, ros
    for version, plugin, mode in itertools.product((8, 9), StoragePlugin, CompressionMode):
        if mode == CompressionMode.STORAGE and plugin != StoragePlugin.MCAP:
            continue
        path = folder / f"rosbag2_v{version}_{plugin.name.lower()}_{mode.name.lower()}"
        write_folder(path, messages, version, plugin, mode)
        yield path, 2
        if mode != CompressionMode.MESSAGE:  # which nothing but metadata.yaml tells
            bare = folder / (path.name + "_without_metadata")
            shutil.copytree(path, bare)
            (bare / "metadata.yaml").unlink()
            yield bare, 2
    for plugin in StoragePlugin:
        path = folder / f"rosbag2_split_{plugin.name.lower()}"
        split_folder(path, messages, plugin)
        yield path, 2


# --- read by others ---------------------------------------------------------------------------------------------------


def read_mcap(path):
    messages = []
    with open(path, "rb") as stream:
        for schema, channel, m in mcap.reader.make_reader(stream).iter_messages(log_time_order=True):
            kind = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
            data = ROS2.ros1_to_cdr(m.data, kind) if channel.message_encoding == "ros1" else m.data
            messages.append(Message(channel.topic, kind, m.log_time, canonical(kind, bytes(data))))
    return messages


def read_any(path):
    with AnyReader([path], default_typestore=ROS2) as reader:
        messages = []
        for connection, stamp, raw in reader.messages():
            data = ROS2.ros1_to_cdr(raw, connection.msgtype) if reader.is2 is False else raw
            kind = connection.msgtype
            messages.append(Message(connection.topic, kind, stamp, canonical(kind, bytes(data))))
        return messages


def read(path):
    return read_mcap(path) if path.suffix == ".mcap" else read_any(path)


def metadata_faults(path, expected, has_qualities):
    """What `ros2 bag info` would tell wrongly of a folder. Only folders know qualities of service to keep."""
    from rosbags.rosbag2 import Reader

    faults = []
    with Reader(path) as reader:
        if reader.message_count != len(expected):
            faults.append(f"{reader.message_count} messages, not {len(expected)}")
        stamps = [m.stamp for m in expected]
        if (reader.start_time, reader.end_time - reader.start_time) != (min(stamps), max(stamps) - min(stamps) + 1):
            faults.append(f"from {reader.start_time} to {reader.end_time}, not {min(stamps)} to {max(stamps)}")
        counts = collections.Counter(m.topic for m in expected)
        for connection in reader.connections:
            if connection.msgcount != counts[connection.topic]:
                faults.append(f"{connection.topic}: {connection.msgcount} messages")
            if not has_qualities:
                continue
            if not connection.ext.offered_qos_profiles:
                faults.append(f"{connection.topic}: no qualities of service")
            elif connection.topic == "/tf_static" and (
                connection.ext.offered_qos_profiles[0].durability != QosDurability.TRANSIENT_LOCAL
            ):
                faults.append("/tf_static is not latched")
    return faults


# --- comparison -------------------------------------------------------------------------------------------------------


def difference(expected, found):
    key = lambda m: (m.stamp, m.topic, m.data)
    expected, found = sorted(expected, key=key), sorted(found, key=key)
    if expected == found:
        return ""
    missing = collections.Counter(m.topic for m in expected)
    missing.subtract(m.topic for m in found)
    counts = {topic: n for topic, n in missing.items() if n}
    if counts:
        return f"messages too few: {counts}"
    return next(f"{a.topic} at {a.stamp} is {b.topic} at {b.stamp}, of {len(a.data)} and {len(b.data)} bytes"
                for a, b in zip(expected, found) if a != b)


def inspected(adit, path, expected):
    result = subprocess.run([adit, "inspect", path, "--json"], capture_output=True, text=True)
    if result.returncode not in (0, 1):
        return f"exit {result.returncode}: {result.stderr.strip()}"
    topics = {t["name"]: t for t in json.loads(result.stdout)["topics"]}
    for topic, kind in topics_of(expected).items():
        count = sum(m.topic == topic for m in expected)
        told = topics.get(topic)
        if told is None:
            return f"{topic} is missing"
        if told["type"].replace("/msg/", "/") != kind.replace("/msg/", "/"):
            return f"{topic} is of {told['type']}"
        counts = {told[k] for k in ("messages_declared", "events") if told.get(k) is not None}
        if told["kind"] != "other" and told["events"] != count or counts - {count}:
            return f"{topic} has {counts} messages, not {count}"
    return ""


def forms(ros):
    """Name, arguments and the generation of ROS of what `adit convert` can write."""
    yield "same.mcap", [], ros
    for compression, to in itertools.product(("none", "lz4", "zstd"), (1, 2)):
        yield f"{compression}{to}.mcap", ["--compression", compression, "--ros", str(to)], to
    for compression in ("none", "lz4", "bz2"):
        yield f"{compression}.bag", ["--compression", compression], 1
    yield "folder", [], 2


class Tally:
    def __init__(self):
        self.equal, self.unequal = collections.Counter(), collections.Counter()

    def take(self, what, name, complaint):
        (self.unequal if complaint else self.equal)[what] += 1
        if complaint:
            print(f"{what}: {name}: {complaint}", flush=True)


def convert(adit, source, target, arguments):
    """A recording whose recorder was killed is converted as far as it goes, and said to be damaged: exit 1."""
    result = subprocess.run([adit, "convert", source, target, *arguments], capture_output=True, text=True)
    wanted = 1 if "_killed" in source.name else 0
    return "" if result.returncode == wanted else f"exit {result.returncode}: {result.stderr.strip()}"


def check(adit, folder, tally):
    file, messages = simulated(adit, folder)
    own = [m for m in messages if m.topic not in ONLY_ROS2]
    tally.take("simulate -> mcap", file.name, difference(own, read(file)))
    made = folder / "made"
    made.mkdir()

    def round_trips(what, path, ros, source):
        for name, arguments, to in forms(ros):
            target = made / name
            # What adit does not understand it copies, and leaves out where it would have to translate.
            expected = [m for m in source if to == ros or m.topic not in ONLY_ROS2]
            complaint = convert(adit, path, target, arguments) or difference(expected, read(target))
            tally.take(what, f"{path.name} -> {name}", complaint)
            if name == "folder" and not complaint:
                faults = metadata_faults(target, expected, has_qualities=(path / "metadata.yaml").exists())
                tally.take("metadata.yaml", path.name, "; ".join(faults))
            yield target, to, expected
            shutil.rmtree(target) if target.is_dir() else target.unlink(missing_ok=True)

    for path, ros in written_by_others(folder, messages):
        expected = messages if ros == 2 else own
        tally.take("others -> inspect", path.name, inspected(adit, path, expected))
        for _ in round_trips("others -> convert -> others", path, ros, expected):
            pass
    for target, to, expected in round_trips("simulate -> convert -> others", file, 2, own):
        back = folder / "back.mcap"
        complaint = convert(adit, target, back, ["--ros", "2"]) or difference(expected, read(back))
        tally.take("convert -> convert -> mcap", target.name, complaint)
        back.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--folder", type=pathlib.Path, help="keep what is written here (default: a temporary one)")
    arguments = parser.parse_args()
    tally = Tally()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        check(str(arguments.adit.resolve()), folder, tally)
    for what in tally.equal | tally.unequal:
        print(f"{what:32} {tally.equal[what]:5} equal {tally.unequal[what]:5} unequal")
    return 1 if tally.unequal else 0


if __name__ == "__main__":
    sys.exit(main())
