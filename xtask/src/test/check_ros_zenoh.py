"""Robots as nodes of ROS 2 over Zenoh, as the library of Zenoh sees them: keys, tokens, attachments, queries. The messages
are decoded by rosbags, and the hashes of types are those of rosbags and of the distribution's packages.

Argument: a folder for logs. `RUMBO_COMMAND` names a `rumbo` with the feature `zenoh`.
"""

import json
import math
import os
import random
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy
import xxhash
import zenoh
import zenoh.ext
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from ros_programs import Program, lab, wait_for

STORE = get_typestore(Stores.ROS2_JAZZY)
# Those of Nav2, as messages: their bytes are the same.
STORE.register(
    {
        **get_types_from_msg("uint8[16] id\ngeometry_msgs/PoseStamped pose\nstring behavior_tree", "nav2_msgs/msg/SendGoal"),
        **get_types_from_msg("uint8[16] id", "nav2_msgs/msg/GetResult"),
        **get_types_from_msg("bool accepted\nbuiltin_interfaces/Time stamp", "nav2_msgs/msg/Accepted"),
        **get_types_from_msg("bool success\nstring message", "std_srvs/msg/Triggered"),
        **get_types_from_msg("string[] names", "rcl_interfaces/msg/GetParameters"),
        **get_types_from_msg("rcl_interfaces/ParameterValue[] values", "rcl_interfaces/msg/GotParameters"),
    }
)
TOPICS = {
    "/odom": "nav_msgs/msg/Odometry",
    "/ground_truth/odom": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/sonar/left": "sensor_msgs/msg/Range",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/rosout": "rcl_interfaces/msg/Log",
    "/robot_description": "std_msgs/msg/String",
    "/clock": "rosgraph_msgs/msg/Clock",
    "/parameter_events": "rcl_interfaces/msg/ParameterEvent",
    "/rumbo/navigate_to_pose/_action/status": "action_msgs/msg/GoalStatusArray",
}
SERVICES = {
    "/rumbo/arm": "std_srvs/srv/Trigger",
    "/rumbo/list_parameters": "rcl_interfaces/srv/ListParameters",
    "/rumbo/describe_parameters": "rcl_interfaces/srv/DescribeParameters",
    "/rumbo/get_parameters": "rcl_interfaces/srv/GetParameters",
    "/rumbo/get_parameter_types": "rcl_interfaces/srv/GetParameterTypes",
    "/rumbo/set_parameters": "rcl_interfaces/srv/SetParameters",
    "/rumbo/set_parameters_atomically": "rcl_interfaces/srv/SetParametersAtomically",
    "/rumbo/navigate_to_pose/_action/cancel_goal": "action_msgs/srv/CancelGoal",
    "/rumbo/navigate_to_pose/_action/send_goal": "nav2_msgs/action/NavigateToPose_SendGoal",
    "/rumbo/navigate_to_pose/_action/get_result": "nav2_msgs/action/NavigateToPose_GetResult",
}
NAV2 = "nav2/nav2_msgs/action/NavigateToPose.json"
DOMAIN = 5


def dds(kind):
    package, folder, name = kind.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def of_package(kind):
    """The hash that the packages of the distribution have."""
    path = Path(sys.argv[1]) / NAV2 if kind.startswith("nav2_msgs") else Path(sys.prefix) / "share" / f"{kind}.json"
    hashes = json.loads(path.read_text())["type_hashes"]
    return next(each["hash_string"] for each in hashes if each["type_name"] == kind)


def hash_of(kind):
    return STORE.hash_rihs01(kind) if "/msg/" in kind else of_package(kind)


def key(name, kind):
    return f"{DOMAIN}{name}/{dds(kind)}/{hash_of(kind)}"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def session(mode, **endpoints):
    config = {"mode": mode, "scouting": {"multicast": {"enabled": False}}, "timestamping": {"enabled": True}}
    config |= {what: {"endpoints": [endpoint]} for what, endpoint in endpoints.items()}
    return zenoh.open(zenoh.Config.from_json5(json.dumps(config)))


def attachment(number, age_s=0.0, identity=bytes(range(16))):
    stamp = time.time_ns() - int(age_s * 1e9)
    return number.to_bytes(8, "little") + stamp.to_bytes(8, "little", signed=True) + b"\x10" + identity


class Robot:
    """A robot's node, seen by a session."""

    def __init__(self, peer, namespace=""):
        self.peer, self.namespace, self.number = peer, namespace, 0

    def tokens(self):
        replies = self.peer.liveliness().get(f"@ros2_lv/{DOMAIN}/**")
        tokens = [str(reply.ok.key_expr) for reply in replies if reply.ok]
        return [token for token in tokens if token.split("/")[7] == (self.namespace.replace("/", "%") or "%")]

    def listen(self, name, kind):
        """A list that grows with the samples."""
        received = []
        self.peer.declare_subscriber(key(self.namespace + name, kind), received.append)
        return received

    def ask(self, service, kind, request, response):
        """The answer to a request in bytes, decoded."""
        self.number += 1
        attached = attachment(self.number)
        name = f"{self.namespace}/rumbo/{service}"
        replies = list(self.peer.get(key(name, kind), payload=request, attachment=attached, timeout=30.0))
        assert len(replies) == 1 and replies[0].ok, (service, replies)
        answered = replies[0].ok.attachment.to_bytes()
        assert (answered[:8], answered[16:]) == (attached[:8], attached[16:]), answered
        return decode(replies[0].ok, response)

    def call(self, service):
        return self.ask(service, "std_srvs/srv/Trigger", b"\x00\x01\x00\x00\x00", "std_srvs/msg/Triggered")

    def must(self, service):
        answer = self.call(service)
        assert answer.success, (service, answer.message)

    def drive(self, forward, seconds, age_s=0.0, **put):
        """Velocities, 20 times a second."""
        zero = STORE.types["geometry_msgs/msg/Vector3"]
        velocity = STORE.types["geometry_msgs/msg/Twist"](linear=zero(x=forward, y=0.0, z=0.0), angular=zero(x=0.0, y=0.0, z=0.0))
        payload = put.get("payload") or bytes(STORE.serialize_cdr(velocity, "geometry_msgs/msg/Twist"))
        for _ in range(int(20 * seconds)):
            self.number += 1
            attached = None if put.get("bare") else attachment(self.number, age_s)
            self.peer.put(key(f"{self.namespace}/cmd_vel", "geometry_msgs/msg/Twist"), payload, attachment=attached)
            time.sleep(0.05)


def decode(sample, kind):
    data = sample.payload.to_bytes()
    message = STORE.deserialize_cdr(data, kind)
    # Every byte is understood.
    assert bytes(STORE.serialize_cdr(message, kind)) == data, kind
    return message


def place(odometry):
    position = decode(odometry[-1], "nav_msgs/msg/Odometry").pose.pose.position
    return position.x, position.y


def moved_m(odometry, act):
    before = place(odometry)
    act()
    time.sleep(0.3)
    return math.dist(place(odometry), before)


def check_tokens(robot):
    published = lambda: {token.split("/")[9].replace("%", "/") for token in robot.tokens() if "/MP/" in token}
    wait_for("all topics", lambda: published() >= TOPICS.keys())
    parts = [token.split("/") for token in robot.tokens()]
    assert all(part[6:9] == ["%", "%", "rumbo"] for part in parts), parts
    assert [part[3:6] for part in parts if part[5] == "NN"] == [[parts[0][3], parts[0][3], "NN"]], parts
    has = {(part[5], part[9].replace("%", "/"), part[10], part[11]): part[12] for part in parts if part[5] != "NN"}
    latched = ("/tf_static", "/robot_description", "/rumbo/navigate_to_pose/_action/status")
    for name, kind in TOPICS.items():
        quality = has["MP", name, dds(kind), hash_of(kind)]
        assert (quality[:3] == ":1:") == (name in latched) and quality.endswith(":,:,:,,"), (name, quality)
    for name, kind in SERVICES.items():
        assert ("SS", name, dds(kind), hash_of(kind)) in has, (name, has)
    feedback = "nav2_msgs/action/NavigateToPose_FeedbackMessage"
    assert ("MP", "/rumbo/navigate_to_pose/_action/feedback", dds(feedback), of_package(feedback)) in has
    assert has["MS", "/cmd_vel", dds("geometry_msgs/msg/Twist"), hash_of("geometry_msgs/msg/Twist")] == "2::,1:,:,:,,"


def check_topics(robot):
    received = {name: robot.listen(name, kind) for name, kind in TOPICS.items()}
    odometry = received["/odom"]
    wait_for("odometry", lambda: len(odometry) >= 50 and len(received["/clock"]) >= 50)
    for name, samples in received.items():
        for sample in samples[-3:]:
            decode(sample, TOPICS[name])
    attached = [sample.attachment.to_bytes() for sample in odometry]
    assert all(len(each) == 33 and each[16] == 16 for each in attached)
    numbers = [int.from_bytes(each[:8], "little") for each in attached]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), numbers
    age_s = (time.time_ns() - int.from_bytes(attached[-1][8:16], "little")) / 1e9
    assert -1.0 < age_s < 5.0, age_s
    token = next(token for token in robot.tokens() if "/MP/" in token and "/%odom/" in token)
    low, high = divmod(xxhash.xxh3_128_intdigest(token.encode()), 1 << 64)[::-1]
    assert attached[-1][17:] == low.to_bytes(8, "little") + high.to_bytes(8, "little")
    return odometry


def check_late(robot):
    """What is latched, to the subscribers that `rmw_zenoh` has for it."""
    for name, kind in [("/robot_description", "std_msgs/msg/String"), ("/tf_static", "tf2_msgs/msg/TFMessage")]:
        late = []
        history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
        where = key(name, kind)
        subscriber = zenoh.ext.declare_advanced_subscriber(robot.peer, where, late.append, history=history)
        wait_for(f"what {name} said before", lambda: late)
        decode(late[0], kind)
        subscriber.undeclare()


def check_driving(robot, odometry, program):
    assert moved_m(odometry, lambda: robot.drive(0.15, 0.5)) < 1e-3
    wait_for("why not", lambda: program.said("the robot is in another mode; call mode/twist"))
    robot.must("mode/twist")
    robot.must("arm")
    refused = robot.call("mode/manual")
    assert not refused.success and "disarm first" in refused.message, refused
    assert 0.1 < moved_m(odometry, lambda: robot.drive(0.15, 1.5)) < 0.5
    standing(odometry)
    # Of one who does not say when it was sent it counts on arrival.
    assert 0.05 < moved_m(odometry, lambda: robot.drive(0.15, 1.0, bare=True))
    standing(odometry)
    for what, why in [
        (lambda: robot.drive(0.15, 0.5, age_s=2.0), "refused, it was sent 2."),
        (lambda: robot.drive(math.nan, 0.5), "its forward speed is not a finite number"),
        (lambda: robot.drive(0.15, 0.5, payload=b"\x00\x01\x00\x00garbage"), "it cannot be decoded"),
    ]:
        time.sleep(2.1)
        assert moved_m(odometry, what) < 2e-3, why
        wait_for(why, lambda: program.said(why))


def standing(odometry):
    still = lambda: abs(decode(odometry[-1], "nav_msgs/msg/Odometry").twist.twist.linear.x) < 0.005
    wait_for("standing still", still)
    time.sleep(0.5)


def check_parameters(robot):
    request = STORE.types["rcl_interfaces/msg/GetParameters"](names=["front_kp"])
    request = bytes(STORE.serialize_cdr(request, "rcl_interfaces/msg/GetParameters"))
    answer = robot.ask("get_parameters", "rcl_interfaces/srv/GetParameters", request, "rcl_interfaces/msg/GotParameters")
    assert answer.values[0].double_value == 5.0, answer
    # The list of all is long.
    everything = b"\x00\x01\x00\x00" + bytes(16)
    listed = robot.ask("list_parameters", "rcl_interfaces/srv/ListParameters", everything, "rcl_interfaces/msg/ListParametersResult")
    assert "front_kp" in listed.names and len(listed.names) > 60, listed


def check_goal(robot, odometry):
    robot.must("disarm")
    robot.must("mode/mission")
    robot.must("arm")
    states = robot.listen("/rumbo/navigate_to_pose/_action/status", "action_msgs/msg/GoalStatusArray")
    feedback = []
    kind = "nav2_msgs/action/NavigateToPose_FeedbackMessage"
    robot.peer.declare_subscriber(f"{DOMAIN}/rumbo/navigate_to_pose/_action/feedback/{dds(kind)}/{of_package(kind)}", feedback.append)
    types = STORE.types
    stamp = types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="base_link")
    pose = types["geometry_msgs/msg/Pose"](
        position=types["geometry_msgs/msg/Point"](x=0.4, y=0.0, z=0.0),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
    )
    goal = numpy.arange(16, dtype=numpy.uint8)
    posed = types["geometry_msgs/msg/PoseStamped"](header=header, pose=pose)
    send = types["nav2_msgs/msg/SendGoal"](id=goal, pose=posed, behavior_tree="")
    send = bytes(STORE.serialize_cdr(send, "nav2_msgs/msg/SendGoal"))
    before = place(odometry)
    action = "navigate_to_pose/_action"
    accepted = robot.ask(f"{action}/send_goal", SERVICES[f"/rumbo/{action}/send_goal"], send, "nav2_msgs/msg/Accepted")
    assert accepted.accepted
    result = types["nav2_msgs/msg/GetResult"](id=goal)
    result = bytes(STORE.serialize_cdr(result, "nav2_msgs/msg/GetResult"))
    where = key(f"/rumbo/{action}/get_result", SERVICES[f"/rumbo/{action}/get_result"])
    ended = list(robot.peer.get(where, payload=result, attachment=attachment(1), timeout=40.0))
    # 4: succeeded.
    assert ended[0].ok.payload.to_bytes()[4] == 4, ended
    assert 0.3 < math.dist(place(odometry), before) < 0.5 and feedback
    last = lambda: decode(states[-1], "action_msgs/msg/GoalStatusArray").status_list[-1].status
    wait_for("the goal's end", lambda: last() == 4)


def check_others(robot, odometry, program, endpoint):
    """Others who do not behave: other types, garbage, one that is killed."""
    peer = robot.peer
    of = lambda kind, digest: f"@ros2_lv/{DOMAIN}/ab/0/1/MP/%/%/other/%odom/{kind}/{digest}/::,:,:,:,,"
    tokens = [peer.liveliness().declare_token(of(dds("std_msgs/msg/String"), "RIHS01_0"))]
    wait_for("the other type", lambda: program.said("/odom: somebody publishes std_msgs::msg::dds_::String_"))
    tokens.append(peer.liveliness().declare_token(of(dds("nav_msgs/msg/Odometry"), "RIHS01_0")))
    wait_for("the other version", lambda: program.said("/odom: somebody publishes another version of nav_msgs::msg::dds_::Odometry_"))
    tokens.append(peer.liveliness().declare_token(f"@ros2_lv/{DOMAIN}/x"))
    noise = random.Random(1)
    host, port = endpoint.removeprefix("tcp/").split(":")
    for _ in range(20):
        with socket.create_connection((host, int(port))) as connection:
            connection.sendall(noise.randbytes(noise.randrange(1_400)))
    arm, trigger = key("/rumbo/arm", "std_srvs/srv/Trigger"), b"\x00\x01\x00\x00\x00"
    for number in range(300):
        garbage = noise.randbytes(noise.randrange(60))
        goal = key("/rumbo/navigate_to_pose/_action/send_goal", SERVICES["/rumbo/navigate_to_pose/_action/send_goal"])
        peer.get(goal, payload=garbage, attachment=attachment(number), timeout=0.5)
        peer.get(arm, payload=trigger, attachment=garbage[:20], timeout=0.5)
        peer.get(arm, timeout=0.5)
    robot.must("disarm")
    robot.must("mode/twist")
    robot.must("arm")
    driver = subprocess.Popen([sys.executable, __file__, sys.argv[1], "drive", endpoint])
    speed = lambda: decode(odometry[-1], "nav_msgs/msg/Odometry").twist.twist.linear.x
    wait_for("driving", lambda: speed() > 0.1)
    driver.kill()
    driver.wait()
    killed = place(odometry)
    standing(odometry)
    assert math.dist(place(odometry), killed) < 0.25
    robot.must("stop")
    for token in tokens:
        token.undeclare()


def check_router():
    """A router, as `rmw_zenohd` is one: robots and others find each other by it."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    router = session("router", listen=endpoint)
    fleet = lab(f"--zenoh={endpoint}", "--domain", str(DOMAIN), "--scenario", "free", "--robots", "2", "--namespace", "herd")
    assert fleet.said(f"nodes /herd/robot1/rumbo, /herd/robot2/rumbo on domain {DOMAIN} over Zenoh by {endpoint}, for all whom that reaches"), fleet.lines
    peer = session("peer", connect=endpoint, listen="tcp/127.0.0.1:0")
    robots = [Robot(peer, f"/herd/robot{number}") for number in (1, 2)]
    odometry = [robot.listen("/odom", "nav_msgs/msg/Odometry") for robot in robots]
    wait_for("both", lambda: all(odometry))
    for robot in robots:
        robot.must("mode/twist")
        robot.must("arm")
    stands = moved_m(odometry[0], lambda: robots[1].drive(0.15, 1.0))
    assert stands < 1e-3 and place(odometry[1])[0] > 0.05, (stands, place(odometry[1]))
    robots[0].must("stop")
    fleet.end()
    wait_for("no token", lambda: not robots[0].tokens() and not robots[1].tokens())
    peer.close()
    router.close()


def check_refusals():
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = f"tcp/127.0.0.1:{other.getsockname()[1]}"
        for arguments, why in [
            (["--zenoh=udp/localhost:7447"], "an endpoint is tcp/HOST:PORT"),
            (["--zenoh=tcp/localhost"], "an endpoint is tcp/HOST:PORT"),
            (["--zenoh=tcp/192.0.2.1:7447"], "cannot listen at tcp/192.0.2.1:7447"),
            ([f"--zenoh={taken}"], f"cannot connect to {taken}"),
            (["--zenoh", "--distribution", "kilted"], "has the type of Jazzy"),
        ]:
            run = subprocess.run([os.environ["RUMBO_COMMAND"], "ros", "lab", *arguments], capture_output=True, text=True, timeout=60)
            assert run.returncode == 2 and why in run.stderr, (arguments, run)


def drive(endpoint):
    """What the one does that is killed."""
    robot = Robot(session("peer", connect=endpoint, listen="tcp/127.0.0.1:0"))
    robot.drive(0.15, 60.0)


def main():
    began = time.monotonic()

    def done(what):
        print(f"{time.monotonic() - began:5.1f} s  over Zenoh: {what}", flush=True)

    check_refusals()
    done("wrong input")
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    program = lab(f"--zenoh={endpoint}", "--domain", str(DOMAIN), "--scenario", "free")
    assert program.said(f"over Zenoh, at {endpoint} itself, since no router is there, for this computer"), program.lines
    robot = Robot(session("peer", connect=endpoint, listen="tcp/127.0.0.1:0"))
    check_tokens(robot)
    done("tokens")
    odometry = check_topics(robot)
    done("topics")
    check_late(robot)
    done("latched topics, late")
    check_driving(robot, odometry, program)
    done("services and velocities")
    check_parameters(robot)
    done("parameters")
    check_goal(robot, odometry)
    done("go to goal")
    check_others(robot, odometry, program, endpoint)
    done("others, garbage, a killed peer")
    program.end()
    wait_for("no token", lambda: not robot.tokens())
    robot.peer.close()
    done("the end")
    check_router()
    done("a router, two robots")


if sys.argv[2:3] == ["drive"]:
    drive(sys.argv[3])
else:
    main()
