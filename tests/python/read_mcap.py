"""Reads a log with three independent libraries and prints what they see.

    python -m venv .venv && .venv/bin/pip install -r tests/python/requirements.txt
    .venv/bin/python tests/python/read_mcap.py RUN.mcap

`mcap` lists metadata and attachments, `mcap-ros2-support` and `rosbags` decode every message from the definitions in the file.
Ends with an error where they disagree with each other, or a value that must be finite or of unit length is not.
"""

import math
import sys
from collections import Counter
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def numbers(message):
    """What is compared between the libraries, by the kind of message."""
    if hasattr(message, "fluid_pressure"):
        return (message.fluid_pressure,)
    if hasattr(message, "pose"):
        p, q = message.pose.position, message.pose.orientation
        return (p.x, p.y, p.z, q.w, q.x, q.y, q.z)
    if hasattr(message, "markers"):
        return tuple(x for m in message.markers for p in m.points for x in (p.x, p.y, p.z))
    if hasattr(message, "twist"):
        return (message.twist, message.extension, message.outer_diameter, message.torque, message.force)
    if hasattr(message, "start_pressure"):
        return (message.time, message.objective, *message.start_pressure, *message.pressure, *message.target_position)
    return ()


def same(a, b):
    return len(a) == len(b) and all(x == y or (math.isnan(x) and math.isnan(y)) for x, y in zip(a, b))


def main(path):
    counts, first, by_mcap = Counter(), {}, {}
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        check(reader.get_header().profile == "ros2", "the profile is not ros2")
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        check("freeact" in metadata, "there is no metadata record freeact")
        for key, value in sorted(metadata["freeact"].items()):
            print(f"  {key} = {value}")
        attachments = {record.name: len(record.data) for record in reader.iter_attachments()}
        check("rig.toml" in attachments, "the rig is not attached")
        print(f"  attachments: {attachments}")
        for schema, channel, _, message in reader.iter_decoded_messages():
            counts[channel.topic] += 1
            first.setdefault(channel.topic, (schema.name, message))
            by_mcap.setdefault(channel.topic, []).append(numbers(message))
            if channel.topic.endswith(("/pressure", "/pressure_command")):
                check(0 < message.fluid_pressure < 1e6, f"{channel.topic}: {message.fluid_pressure} Pa")
            if channel.topic == "/tip/pose" and not math.isnan(message.pose.orientation.w):
                q = message.pose.orientation
                norm = math.hypot(q.w, q.x, q.y, q.z)
                check(abs(norm - 1) < 1e-3, f"{channel.topic}: quaternion of length {norm}")
    by_rosbags = {}
    with AnyReader([Path(path)]) as bag:
        for connection, _, data in bag.messages():
            message = bag.deserialize(data, connection.msgtype)
            by_rosbags.setdefault(connection.topic, []).append(numbers(message))
    check(set(by_rosbags) == set(by_mcap), f"topics differ: {sorted(by_rosbags)} and {sorted(by_mcap)}")
    for topic in sorted(counts):
        kind, message = first[topic]
        print(f"{topic}: {counts[topic]} x {kind}, first {numbers(message)[:7]}")
        check(len(by_rosbags[topic]) == counts[topic], f"{topic}: rosbags reads {len(by_rosbags[topic])}")
        check(all(same(a, b) for a, b in zip(by_mcap[topic], by_rosbags[topic])), f"{topic}: values differ")
    check(counts, "there is no message")
    print(f"{sum(counts.values())} messages, the same by mcap-ros2-support and rosbags")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
