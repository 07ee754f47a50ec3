#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What `adit convert RUN --as foxglove` writes, beside the programs of those who read it.

Usage: foxglove_mcap.py ADIT RUN... [--folder FOLDER]. RUN is a folder that `adit run` wrote, or a map. Python's mcap
reads the file with its check sums and its index; mcap-protobuf-support decodes each message by the schema in the file;
foxglove-schemas-protobuf has the same types, whose classes must read the same messages and leave no byte unknown;
rerun's own check and its import must find transforms, points, places and logs. Poses are compared with trajectory.tum,
sweeps with sweeps.csv and points with `adit export`. Exits 1 where one differs, 2 where a package is missing
(mcap mcap-protobuf-support foxglove-schemas-protobuf rerun-sdk numpy).
"""

import argparse
import collections
import csv
import importlib
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
    from google.protobuf import descriptor_pb2, unknown_fields
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    importlib.import_module("foxglove_schemas_protobuf")
    importlib.import_module("rerun")
except ImportError as error:
    print(f"foxglove_mcap.py: {error}; pip install mcap mcap-protobuf-support foxglove-schemas-protobuf rerun-sdk numpy",
          file=sys.stderr)
    sys.exit(2)

Message = collections.namedtuple("Message", "topic type stamp data decoded")
RERUN = pathlib.Path(sys.executable).parent / "rerun"
# What Rerun makes of a type, by the columns of its chunks.
SHOWN_BY_RERUN = {
    "foxglove.FrameTransform": "Transform3D:translation",
    "foxglove.PoseInFrame": "InstancePoses3D:translations",
    "foxglove.PointCloud": "Points3D:positions",
    "foxglove.LocationFix": "GeoPoints:positions",
    "foxglove.Log": "TextLog:text",
}


class Differs(Exception):
    pass


def require(condition, text):
    if not condition:
        raise Differs(text)


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def read(file):
    with open(file, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        channels = reader.get_summary().channels
        schemas = {schema.name: schema for schema in reader.get_summary().schemas.values()}
        messages = [Message(channel.topic, schema.name, message.log_time, message.data, decoded)
                    for schema, channel, message, decoded in reader.iter_decoded_messages()]
    with open(file, "rb") as stream:
        written = [message.log_time for _, _, message in make_reader(stream).iter_messages(log_time_order=False)]
    require(written == sorted(written), "messages are not in the order of their stamps")
    require(statistics.message_count == len(messages), "the statistics count other messages")
    for number, count in statistics.channel_message_counts.items():
        found = sum(message.topic == channels[number].topic for message in messages)
        require(found == count, f"{channels[number].topic}: {found} messages, {count} by the statistics")
    return schemas, messages


# --- types ------------------------------------------------------------------------------------------------------------


def fields_of(message):
    kinds = descriptor_pb2.FieldDescriptorProto
    return {field.number: (field.name, field.type, field.type_name, field.label == kinds.LABEL_REPEATED,
                           field.proto3_optional) for field in message.field}


def official(type_name):
    return getattr(importlib.import_module(f"foxglove_schemas_protobuf.{type_name}_pb2"), type_name)


def check_types(schemas):
    """Each field that adit describes is the published one."""
    for schema in schemas.values():
        described = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
        for file in described.file:
            if file.package != "foxglove":
                continue
            for message in file.message_type:
                published = descriptor_pb2.DescriptorProto()
                official(message.name).DESCRIPTOR.CopyToProto(published)
                theirs = fields_of(published)
                for number, field in fields_of(message).items():
                    require(theirs.get(number) == field, f"{message.name}: {field}, published as {theirs.get(number)}")
                enumerations = {one.name: [(value.name, value.number) for value in one.value]
                                for one in published.enum_type}
                for one in message.enum_type:
                    values = [(value.name, value.number) for value in one.value]
                    require(enumerations.get(one.name) == values, f"{message.name}.{one.name}: {values}")


def has_unknown_fields(message):
    if len(unknown_fields.UnknownFieldSet(message)) > 0:
        return True
    for field, value in message.ListFields():
        if field.message_type is not None:
            if any(has_unknown_fields(one) for one in (value if field.is_repeated else [value])):
                return True
    return False


def check_messages(messages):
    """The published classes read the same as the schemas in the file say."""
    for message in messages:
        package, name = message.type.split(".")
        if package == "foxglove":
            theirs = official(name).FromString(message.data)
            require(not has_unknown_fields(theirs), f"{message.topic}: a field that {name} does not have")
            require(theirs.SerializeToString(deterministic=True) ==
                    message.decoded.SerializeToString(deterministic=True), f"{message.topic}: {name} reads otherwise")
        stamped = message.decoded.entities[0] if name == "SceneUpdate" else message.decoded
        stamp = stamped.timestamp.seconds * 10**9 + stamped.timestamp.nanos
        require(stamp == message.stamp, f"{message.topic}: stamped {stamp}, logged {message.stamp}")


# --- content ----------------------------------------------------------------------------------------------------------


def check_poses(messages, folder):
    lines = [line.split() for line in (folder / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expected = sorted(([int(line[0].replace(".", "")), *map(float, line[1:])] for line in lines), key=lambda p: p[0])
    found = [message for message in messages if message.topic == "/tf"]
    require(len(found) == len(expected), f"/tf: {len(found)} poses, trajectory.tum has {len(expected)}")
    worst = 0.0
    for message, (stamp, *pose) in zip(found, expected):
        require(message.stamp == stamp, f"/tf: a pose at {message.stamp}, trajectory.tum has {stamp}")
        t, q = message.decoded.translation, message.decoded.rotation
        sign = 1.0 if q.w * pose[6] + q.x * pose[3] + q.y * pose[4] + q.z * pose[5] > 0.0 else -1.0
        ours = [t.x, t.y, t.z, sign * q.x, sign * q.y, sign * q.z, sign * q.w]
        worst = max(worst, *(abs(a - b) for a, b in zip(ours, pose)))
    require(worst < 1e-9, f"/tf: poses are off by {worst}")
    return f"{len(found)} poses within {worst:.1e}"


def check_sweeps(messages, folder):
    with open(folder / "sweeps.csv", newline="") as stream:
        expected = list(csv.DictReader(stream))
    found = [message.decoded for message in messages if message.topic == "/sweep"]
    require(len(found) == len(expected), f"/sweep: {len(found)} messages, sweeps.csv has {len(expected)}")
    for sweep, row in zip(found, expected):
        for name, cell in row.items():
            if name == "stamp_s":
                continue
            value = getattr(sweep, name)
            if isinstance(value, str):
                require(value == cell, f"/sweep: {name} is {value}, not {cell}")
            elif cell == "":
                require(math.isnan(value), f"/sweep: {name} is {value}, and not known")
            else:
                # A covariance's upper triangle is written; all else is the same double.
                require(value == float(cell), f"/sweep: {name} is {value}, not {cell}")
    return f"{len(found)} sweeps of {len(expected[0])} columns"


def points_of(cloud):
    require([(field.name, field.offset, field.type) for field in cloud.fields][:3] ==
            [("x", 0, 7), ("y", 4, 7), ("z", 8, 7)], "a cloud's fields")
    return np.frombuffer(cloud.data, dtype=np.float32).reshape(-1, cloud.point_stride // 4)


def ply_points(file):
    content = file.read_bytes()
    head, _, body = content.partition(b"end_header\n")
    names = re.findall(rb"property (\w+) (\w+)", head)
    sizes = {b"float": "<f4", b"double": "<f8", b"ushort": "<u2", b"int": "<i4", b"uchar": "<u1", b"uint": "<u4"}
    kind = np.dtype([(name.decode(), sizes[size]) for size, name in names])
    count = int(re.search(rb"element vertex +(\d+)", head)[1])
    points = np.frombuffer(body, dtype=kind, count=count)
    return np.stack([points["x"], points["y"], points["z"]], axis=1).astype(np.float64)


def check_points(messages, cloud):
    """All points of keyframes, without a map those of the overview, are those of the cloud file."""
    overview = np.concatenate([points_of(m.decoded) for m in messages if m.topic == "/map/points"])[:, :3]
    keyframes = [points_of(m.decoded)[:, :3] for m in messages if m.topic == "/keyframe/points"]
    theirs = ply_points(cloud)
    box = (theirs.min(axis=0) - 1e-3, theirs.max(axis=0) + 1e-3)
    require(((overview >= box[0]) & (overview <= box[1])).all(), "/map/points: a point beyond the cloud's box")
    if not keyframes:
        return f"{len(overview)} of {len(theirs)} points"
    ours = np.concatenate(keyframes).astype(np.float64)
    require(len(ours) == len(theirs), f"/keyframe/points: {len(ours)} points, exported are {len(theirs)}")
    off = np.abs(ours - theirs).max()
    require(off < 1e-3, f"/keyframe/points: off by {off} m")
    return f"{len(ours)} points within {off:.1e} m, {len(overview)} in the overview"


def check_layout(file, messages):
    """Panels show topics and fields that are there."""
    layout = json.loads(file.read_text())
    topics = {message.topic: message.decoded for message in messages}
    for panel in layout["configById"].values():
        for path in panel.get("paths", []):
            topic, field = path["value"].split(".", 1)
            require(topic in topics and hasattr(topics[topic], field), f"the layout plots {path['value']}")
    return f"{len(layout['configById'])} panels"


def check_rerun(file, messages, folder):
    run(RERUN, "mcap", "check", "--full", file)
    recording = folder / "run.rrd"
    run(RERUN, "mcap", "convert", file, "-o", recording)
    rows = collections.Counter()
    for line in run(RERUN, "rrd", "print", recording).splitlines():
        chunk = re.match(r"Chunk\(\w+\) with (\d+) rows .* - (/\S*) - data columns: \[(.*)\]", line)
        if chunk:
            for column in chunk[3].split():
                rows[chunk[2], column] += int(chunk[1])
    expected = collections.Counter((message.topic, SHOWN_BY_RERUN[message.type]) for message in messages
                                   if message.type in SHOWN_BY_RERUN)
    for (topic, column), count in expected.items():
        require(rows[topic, column] == count, f"rerun: {topic} has {rows[topic, column]} rows of {column}, not {count}")
    return f"{len(expected)} topics in rerun"


def check(adit, source, folder):
    file = folder / "run.mcap"
    run(adit, "convert", source, file, "--as", "foxglove")
    schemas, messages = read(file)
    check_types(schemas)
    check_messages(messages)
    facts = [f"{len(messages)} messages of {len(schemas)} types"]
    is_folder = source.is_dir()
    database = source / "map.adit" if is_folder else source
    if is_folder:
        facts.append(check_poses(messages, source))
        facts.append(check_sweeps(messages, source))
    if database.exists():
        run(adit, "export", database, "--cloud", "ply", "-o", folder / "cloud.ply")
        facts.append(check_points(messages, folder / "cloud.ply"))
    elif (source / "map.ply").exists():
        facts.append(check_points(messages, source / "map.ply"))
    facts.append(check_layout(file.with_suffix(".foxglove.json"), messages))
    facts.append(check_rerun(file, messages, folder))
    return ", ".join(facts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    parser.add_argument("--folder", type=pathlib.Path, help="Keep what is written here")
    options = parser.parse_args()
    failed = 0
    for number, source in enumerate(options.runs):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="foxglove_mcap_")) if options.folder is None \
            else options.folder / str(number)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            print(f"{source}: {check(options.adit, source, folder)}")
        except Differs as difference:
            print(f"{source}: {difference}")
            failed += 1
        except subprocess.CalledProcessError as error:
            print(f"{source}: {error}\n{error.stdout}{error.stderr}")
            failed += 1
        finally:
            if options.folder is None:
                shutil.rmtree(folder, ignore_errors=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
