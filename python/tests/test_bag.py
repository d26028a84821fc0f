"""A bag of `rumbo export --ros2bag` as a genuine reader of ROS 2's bags sees it."""

from __future__ import annotations

import itertools
import math
import pathlib
import subprocess
import xml.etree.ElementTree
from typing import Any

import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

EXPORT = ["export", "logs/mode8-goals-1.mcap", "--ros2bag", "--scan"]


@pytest.fixture(scope="module")
def bag(rumbo_command: str, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    folder = tmp_path_factory.mktemp("bag")
    for words in (["run", "mode8-goals", "--out", "logs"], EXPORT):
        done = subprocess.run([rumbo_command, *words], cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return folder / "mode8-goals-1.ros2bag"


def messages(bag: pathlib.Path, topic: str) -> list[tuple[int, Any]]:
    with AnyReader([bag]) as reader:
        connections = [each for each in reader.connections if each.topic == topic]
        return [(time, reader.deserialize(raw, each.msgtype)) for each, time, raw in reader.messages(connections)]


def test_types_and_bytes_are_those_of_the_distributions(bag: pathlib.Path) -> None:
    with AnyReader([bag]) as reader:
        topics = {each.topic for each in reader.connections}
        assert {"/odom", "/tf", "/tf_static", "/joint_states", "/sonar/front", "/diagnostics"} <= topics
        assert {"/map", "/markers/world", "/markers/way", "/scan"} <= topics
        for store in (get_typestore(Stores.ROS2_JAZZY), get_typestore(Stores.LATEST)):
            for each in reader.connections:
                assert each.digest == store.hash_rihs01(each.msgtype), each.topic
                for _, _, raw in reader.messages([each]):
                    message = store.deserialize_cdr(raw, each.msgtype)
                    assert bytes(store.serialize_cdr(message, each.msgtype)) == bytes(raw), each.topic


def test_odometry_never_jumps_and_ends_near_the_truth(bag: pathlib.Path) -> None:
    poses = [message.pose.pose.position for _, message in messages(bag, "/odom")]
    assert len(poses) > 500
    # Three goals: the robot counts from each of them.
    assert max(math.dist((a.x, a.y), (b.x, b.y)) for a, b in itertools.pairwise(poses)) < 0.025
    truth = [message.pose.pose.position for _, message in messages(bag, "/ground_truth/odom")]
    assert math.dist((poses[-1].x, poses[-1].y), (truth[-1].x, truth[-1].y)) < 0.1
    assert max(math.dist((a.x, a.y), (b.x, b.y)) for a, b in zip(poses, truth, strict=True)) < 0.1


def test_speeds_are_those_of_the_poses(bag: pathlib.Path) -> None:
    odometry = messages(bag, "/odom")
    driven, summed = 0.0, 0.0
    for (before_ns, before), (now_ns, now) in itertools.pairwise(odometry):
        a, b = before.pose.pose.position, now.pose.pose.position
        driven += math.dist((a.x, a.y), (b.x, b.y))
        summed += abs(now.twist.twist.linear.x) * (now_ns - before_ns) / 1e9
    assert driven > 2 and abs(summed - driven) < 0.05 * driven


def test_every_frame_hangs_on_the_map(bag: pathlib.Path) -> None:
    parents = {}
    for topic in ("/tf_static", "/tf"):
        for _, message in messages(bag, topic):
            for transform in message.transforms:
                parent = parents.setdefault(transform.child_frame_id, transform.header.frame_id)
                assert parent == transform.header.frame_id
                turn = transform.transform.rotation
                assert abs(math.hypot(turn.x, turn.y, turn.z, turn.w) - 1) < 1e-9
    (description,) = messages(bag, "/robot_description")
    robot = xml.etree.ElementTree.fromstring(description[1].data)
    for link in robot.iter("link"):
        frame = link.attrib["name"]
        while frame != "map":
            frame = parents[frame]
    joints = {joint.attrib["name"] for joint in robot.iter("joint") if joint.attrib["type"] != "fixed"}
    assert joints == set(messages(bag, "/joint_states")[0][1].name)


def test_a_bag_is_written_again_but_nothing_else_is_replaced(rumbo_command: str, bag: pathlib.Path) -> None:
    export = [rumbo_command, *EXPORT]
    before = (bag / "mode8-goals-1.mcap").read_bytes()
    assert subprocess.run(export, cwd=bag.parent, capture_output=True).returncode == 0
    assert (bag / "mode8-goals-1.mcap").read_bytes() == before
    other = bag.parent / "other"
    (other / "mode8-goals-1.ros2bag").mkdir(parents=True)
    (other / "mode8-goals-1.ros2bag" / "metadata.yaml").write_text("mine\n")
    refused = subprocess.run([*export, "--out", "other"], cwd=bag.parent, capture_output=True, text=True)
    assert refused.returncode == 2 and "metadata.yaml: is there already" in refused.stderr
    assert not (other / "mode8-goals-1.ros2bag" / "mode8-goals-1.mcap").exists()
