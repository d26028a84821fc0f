"""Robots as nodes of ROS 2, as genuine peers see them: rclpy on Fast DDS, and Cyclone DDS.

Argument: a folder for logs. `RUMBO_COMMAND` names a `rumbo` with the feature `ros`.
"""

import atexit
import base64
import json
import math
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

DOMAIN = 30 + os.getpid() % 60
os.environ["ROS_DOMAIN_ID"] = str(DOMAIN)
# Cyclone on this computer alone, as `rmw_cyclonedds` does it with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
os.environ["CYCLONEDDS_URI"] = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)

import rclpy
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import String
from std_srvs.srv import Trigger

# Long enough for any machine; nothing is judged by it.
PATIENCE_S = 40
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

# Its robot does not measure its battery.
TOPICS = {
    "/odom": "nav_msgs/msg/Odometry",
    "/ground_truth/odom": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/sonar/left": "sensor_msgs/msg/Range",
    "/sonar/right": "sensor_msgs/msg/Range",
    "/sonar/front": "sensor_msgs/msg/Range",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/rosout": "rcl_interfaces/msg/Log",
    "/robot_description": "std_msgs/msg/String",
    "/clock": "rosgraph_msgs/msg/Clock",
}


# What the wheels of PyPI do not have, or not for Cyclone.
@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class Text(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


# Cyclone puts half its identity and a number before requests and answers.
@dataclass
class CycloneRequest(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Request_"):
    guid: uint64
    number: int64
    nothing: uint8


@dataclass
class ShortRequest(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Request_"):
    nothing: uint8


@dataclass
class CycloneAnswer(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Response_"):
    guid: uint64
    number: int64
    success: bool
    message: str


def wait_for(what, condition):
    """The first true value of `condition`."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"not seen: {what}")


class Program:
    """A `rumbo` that runs until it is asked to end; what it prints."""

    def __init__(self, *arguments, ready):
        command = [os.environ["RUMBO_COMMAND"], *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        atexit.register(self.process.kill)
        self.lines = []
        threading.Thread(target=self._read, daemon=True).start()
        self.ready = wait_for(f"{ready} of {arguments}", lambda: self.said(ready) or self.process.poll() is not None)
        assert self.process.poll() is None, self.lines

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    def said(self, text):
        return next((line for line in list(self.lines) if text in line), None)

    def end(self):
        self.process.terminate()
        status = self.process.wait(PATIENCE_S)
        assert status == 0, (status, self.lines)


def lab(*arguments):
    folder = ["--out", sys.argv[1]]
    return Program("ros", "lab", "--no-browser", "--port", "0", *folder, *arguments, ready="http://")


class Peer:
    """A node of rclpy, spinning in a thread."""

    def __init__(self, name):
        self.node = rclpy.create_node(name)
        self.executor = rclpy.executors.SingleThreadedExecutor()
        self.executor.add_node(self.node)
        threading.Thread(target=self._spin, daemon=True).start()

    def _spin(self):
        try:
            self.executor.spin()
        except rclpy.executors.ExternalShutdownException:
            pass

    def listen(self, kind, topic, quality=50):
        """A list that grows with the messages."""
        heard = []
        self.node.create_subscription(kind, topic, heard.append, quality)
        return heard

    def call(self, service):
        client = self.node.create_client(Trigger, service)
        assert client.wait_for_service(PATIENCE_S), service
        answer = client.call_async(Trigger.Request())
        wait_for(f"an answer of {service}", answer.done)
        return answer.result()

    def must(self, service):
        answer = self.call(service)
        assert answer.success, (service, answer.message)

    def drive(self, topic, make, seconds):
        """Publishes what `make` gives, 20 times a second."""
        publisher = self.publisher(topic, type(make()))
        for _ in range(int(20 * seconds)):
            publisher.publish(make())
            time.sleep(0.05)

    def publisher(self, topic, kind):
        publisher = self.node.create_publisher(kind, topic, 10)
        wait_for(f"a reader of {topic}", publisher.get_subscription_count)
        return publisher


class Page:
    """A page of the dashboard at the address that was printed; it only gives orders."""

    def __init__(self, url):
        host, query = url.split("/")[2], url.split("?")[1]
        head = f"Host: {host}\r\nOrigin: http://{host}\r\n"
        request = f"POST /key?{query} HTTP/1.1\r\n{head}Authorization: Bearer test\r\nConnection: close\r\n\r\n"
        with self._connect(host) as connection:
            connection.sendall(request.encode())
            key = connection.makefile("rb").read().decode().split("\r\n\r\n")[1]
        upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        upgrade += f"Sec-WebSocket-Key: {base64.b64encode(bytes(16)).decode()}\r\nSec-WebSocket-Protocol: rumbo, {key}\r\n"
        self.socket = self._connect(host)
        self.socket.sendall(f"GET /ws HTTP/1.1\r\n{head}{upgrade}\r\n".encode())
        assert self.socket.recv(12) == b"HTTP/1.1 101"
        threading.Thread(target=self._drain, daemon=True).start()

    @staticmethod
    def _connect(host):
        name, port = host.split(":")
        return socket.create_connection((name, int(port)), PATIENCE_S)

    def _drain(self):
        try:
            while self.socket.recv(1 << 16):
                pass
        except OSError:
            pass

    def order(self, kind):
        text = json.dumps({"type": kind}).encode()
        # A masked text; the mask of zeros changes nothing.
        self.socket.sendall(bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text)


class Cyclone:
    """A participant of Cyclone DDS."""

    def __init__(self):
        self.participant = DomainParticipant(DOMAIN)
        reliable = Policy.Reliability.Reliable(duration(seconds=1))
        self.volatile = Qos(reliable, Policy.Durability.Volatile, Policy.History.KeepLast(50))
        self.latched = Qos(reliable, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))

    def read(self, name, kind, quality):
        return DataReader(self.participant, Topic(self.participant, name, kind, qos=quality), qos=quality)

    def write(self, name, kind):
        topic = Topic(self.participant, name, kind, qos=self.volatile)
        return DataWriter(self.participant, topic, qos=self.volatile)


def twist(forward, yaw=0.0):
    message = Twist()
    message.linear.x = forward
    message.angular.z = yaw
    return message


def stamped(clock, behind_s):
    message = TwistStamped()
    message.header.stamp.sec = clock[-1].clock.sec - behind_s
    message.header.stamp.nanosec = clock[-1].clock.nanosec
    message.twist.linear.x = 0.15
    return message


def x_m(odometry):
    return odometry[-1].pose.pose.position.x


def moved_m(odometry, act):
    """How far the robot goes while `act` and a little after."""
    before = x_m(odometry)
    act()
    time.sleep(0.3)
    return x_m(odometry) - before


def seconds(stamp):
    return stamp.sec + stamp.nanosec / 1e9


def check_graph(peer):
    assert wait_for("the node", lambda: ("rumbo", "/") in peer.node.get_node_names_and_namespaces())
    own = lambda: dict(peer.node.get_publisher_names_and_types_by_node("rumbo", "/"))
    wait_for("all topics", lambda: own().keys() >= TOPICS.keys())
    assert {name: [kind] for name, kind in TOPICS.items()} == own(), own()
    services = dict(peer.node.get_service_names_and_types_by_node("rumbo", "/"))
    assert services["/rumbo/arm"] == ["std_srvs/srv/Trigger"] and "/rumbo/mode/twist" in services, services


def check_topics(peer, cyclone):
    odometry = peer.listen(Odometry, "/odom")
    truth = peer.listen(Odometry, "/ground_truth/odom")
    joints = peer.listen(JointState, "/joint_states")
    front = peer.listen(Range, "/sonar/front")
    clock = peer.listen(Clock, "/clock")
    diagnostics = cyclone.read("rt/diagnostics", DiagnosticArray, cyclone.volatile)
    moving = cyclone.read("rt/tf", TFMessage, cyclone.volatile)
    wait_for("fifty of each", lambda: min(map(len, (odometry, truth, joints, front, clock))) >= 50)
    stamps = [seconds(each.header.stamp) for each in odometry]
    steps = [later - earlier for earlier, later in zip(stamps, stamps[1:])]
    assert all(0.0 < step < 0.2 for step in steps), steps
    last = odometry[-1]
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base_link")
    assert truth[-1].header.frame_id == "map"
    assert all(math.isfinite(value) for value in last.pose.covariance) and last.pose.covariance[0] > 0.0
    assert joints[-1].name == ["left_wheel_joint", "right_wheel_joint", "sonar_front_joint"], joints[-1]
    assert front[-1].header.frame_id == "sonar_front" and 0.0 < front[-1].range, front[-1]
    # No time stamp is ahead of the clock for long: it comes first.
    assert seconds(clock[-1].clock) > stamps[-1] - 0.5
    frames = wait_for("a transform", lambda: moving.take(N=1))[0].transforms
    frames = [(each.header.frame_id, each.child_frame_id) for each in frames]
    assert frames[0] == ("odom", "base_link") and ("base_link", "sonar_front") in frames, frames
    status = wait_for("diagnostics", lambda: diagnostics.take(N=1))[0].status
    assert [each.name for each in status] == ["rumbo: robot", "rumbo: link", "rumbo: ROS 2"], status
    return odometry, truth


def check_late(cyclone):
    late = Peer("late")
    description = late.listen(String, "/robot_description", LATCHED)
    fixed = cyclone.read("rt/tf_static", TFMessage, cyclone.latched)
    robot = ElementTree.fromstring(wait_for("the description", lambda: description)[-1].data)
    links = [link.get("name") for link in robot.iter("link")]
    assert links[0] == "base_link" and "sonar_left" in links, links
    frames = wait_for("the fixed frames", lambda: fixed.take(N=1))[0].transforms
    frames = {each.child_frame_id: each.header.frame_id for each in frames}
    assert frames == {"sonar_left": "base_link", "sonar_right": "base_link", "odom": "map"}, frames


def check_driving(peer, odometry, truth, robot):
    # Connecting has armed nothing, and so does a velocity.
    assert abs(moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5))) < 1e-3
    wait_for("why not", lambda: robot.said("the robot is in another mode; call mode/twist"))
    peer.must("/rumbo/mode/twist")
    peer.must("/rumbo/arm")
    refused = peer.call("/rumbo/mode/manual")
    assert not refused.success and "disarm first" in refused.message, refused
    from_m, true_m = x_m(odometry), truth[-1].pose.pose.position
    peer.drive("/cmd_vel", lambda: twist(0.15), 1.5)
    assert odometry[-1].twist.twist.linear.x > 0.1, odometry[-1].twist
    wait_for("standing still", lambda: abs(odometry[-1].twist.twist.linear.x) < 0.005)
    forward_m, now_m = x_m(odometry) - from_m, truth[-1].pose.pose.position
    true_m = math.hypot(now_m.x - true_m.x, now_m.y - true_m.y)
    assert 0.15 < forward_m < 0.5 and abs(true_m - forward_m) < 0.03, (true_m, forward_m)
    # Turning left is positive.
    heading = lambda: odometry[-1].pose.pose.orientation.z
    before = heading()
    peer.drive("/cmd_vel", lambda: twist(0.0, 1.0), 0.7)
    assert heading() > before + 0.1, (before, heading())
    wait_for("standing still", lambda: abs(odometry[-1].twist.twist.angular.z) < 0.02)
    for absurd in (twist(math.nan), twist(math.inf), twist(0.1, math.nan), twist(5.0), twist(0.1, 1e300)):
        assert abs(moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: absurd, 0.3))) < 2e-3, absurd
    wait_for("what is no number", lambda: robot.said("its forward speed is not a finite number"))
    wait_for("what is too fast", lambda: robot.said("out of range"))
    peer.must("/rumbo/stop")
    assert abs(moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5))) < 1e-3


def robot_is(diagnostics, what):
    """Whether the newest diagnostics have the robot so."""
    newest = diagnostics.take(N=50)[-1:]
    return newest and newest[0].status[0].message == what


def check_page(peer, cyclone, odometry, robot):
    """The robot is off, in the mode that takes velocities."""
    diagnostics = cyclone.read("rt/diagnostics", DiagnosticArray, cyclone.volatile)
    page = Page(robot.ready)
    page.order("arm")
    wait_for("the page's ON", lambda: robot_is(diagnostics, "on"))
    refused = peer.call("/rumbo/arm").message
    assert "another page has control" in refused, refused
    assert abs(moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5))) < 1e-3
    status = wait_for("diagnostics", lambda: diagnostics.take(N=50))[-1].status[2]
    assert (status.level, "another page has control" in status.message) == (1, True), status
    # STOP needs no control, from either side.
    peer.must("/rumbo/stop")
    page.order("release_control")
    wait_for("ROS 2 to be let in", lambda: peer.call("/rumbo/arm").success)
    wait_for("ON", lambda: robot_is(diagnostics, "on"))
    driving = threading.Thread(target=peer.drive, args=("/cmd_vel", lambda: twist(0.15), 4.0))
    driving.start()
    wait_for("driving", lambda: odometry[-1].twist.twist.linear.x > 0.1)
    page.order("stop")
    wait_for("standing still", lambda: abs(odometry[-1].twist.twist.linear.x) < 0.005)
    assert driving.is_alive()
    before = x_m(odometry)
    driving.join()
    assert abs(x_m(odometry) - before) < 0.01, (before, x_m(odometry))


def check_cyclone_calls(cyclone):
    answers = cyclone.read("rr/rumbo/armReply", CycloneAnswer, cyclone.volatile)
    short = cyclone.write("rq/rumbo/armRequest", ShortRequest)
    requests = cyclone.write("rq/rumbo/armRequest", CycloneRequest)
    wait_for("the service", requests.get_matched_subscriptions)
    time.sleep(0.5)
    # Too short to name its client: nobody can be answered.
    short.write(ShortRequest(nothing=0))
    requests.write(CycloneRequest(guid=0x1234567890AB, number=7, nothing=0))
    answer = wait_for("an answer", lambda: answers.take(N=1))[0]
    assert (answer.guid, answer.number, answer.success) == (0x1234567890AB, 7, True), answer


def check_garbage(peer, cyclone, odometry, robot):
    other = cyclone.write("rt/odom", Text)
    wait_for("the other type", lambda: robot.said("/odom: somebody publishes std_msgs::msg::dds_::String_"))
    other.write(Text(data="garbage"))
    noise = random.Random(1)
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    # Those of the first participant of the domain, which the robot is.
    ports = [7400 + 250 * DOMAIN + offset for offset in (10, 11)]
    for number in range(3_000):
        data = noise.randbytes(noise.randrange(1_400))
        head = b"RTPS\x02\x03\x01\x0f" if number % 2 else b""
        out.sendto(head + data, ("127.0.0.1", noise.choice(ports)))
    heard = len(odometry)
    wait_for("more odometry", lambda: len(odometry) > heard + 25)
    peer.must("/rumbo/disarm")


def check_killed_peer(peer, odometry):
    text = "import time, rclpy\nfrom nav_msgs.msg import Odometry\nrclpy.init()\nnode = rclpy.create_node('victim')\n"
    text += "node.create_subscription(Odometry, '/odom', lambda odometry: print('heard', flush=True), 10)\nrclpy.spin(node)\n"
    victim = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
    assert victim.stdout.readline() == "heard\n"
    victim.send_signal(signal.SIGKILL)
    victim.wait()
    heard = len(odometry)
    wait_for("more odometry", lambda: len(odometry) > heard + 50)
    peer.must("/rumbo/arm")


def check_two(peer, first):
    """The first robot is armed; the second one takes stamped velocities."""
    second = lab("--namespace", "second", "--stamped", "--scenario", "mode1")
    odometry = peer.listen(Odometry, "/second/odom")
    clock = peer.listen(Clock, "/second/clock")
    wait_for("the second robot", lambda: odometry and clock)
    nodes = {("rumbo", "/"), ("rumbo", "/second")}
    wait_for("both nodes", lambda: nodes <= set(peer.node.get_node_names_and_namespaces()))
    peer.must("/second/rumbo/mode/twist")
    peer.must("/second/rumbo/arm")
    old = moved_m(odometry, lambda: peer.drive("/second/cmd_vel", lambda: stamped(clock, 2), 0.7))
    assert abs(old) < 1e-3, old
    wait_for("what is old", lambda: second.said("refused, it was stamped 2."))
    new = moved_m(odometry, lambda: peer.drive("/second/cmd_vel", lambda: stamped(clock, 0), 1.0))
    assert new > 0.05, new
    peer.must("/second/rumbo/stop")
    # The first one is still armed.
    refused = peer.call("/rumbo/mode/manual")
    assert "disarm first" in refused.message, refused
    peer.must("/rumbo/stop")
    second.end()
    wait_for("one node less", lambda: ("rumbo", "/second") not in peer.node.get_node_names_and_namespaces())
    assert ("rumbo", "/") in peer.node.get_node_names_and_namespaces()
    assert first.process.poll() is None


def check_example():
    example = [sys.executable, "examples/ros2/drive.py"]
    run = subprocess.run(example, capture_output=True, text=True, timeout=PATIENCE_S)
    assert run.returncode == 0 and run.stdout.startswith("x "), run


def check_connected(peer):
    """A robot at a port: its messages have the time of day."""
    simulated = Program("lab", "--pty", "--scenario", "mode1", ready="/dev/")
    options = ["--no-browser", "--port", "0", "--out", sys.argv[1], "--namespace", "third"]
    robot = Program("ros", "connect", simulated.ready.split()[-1], *options, ready="http://")
    odometry = peer.listen(Odometry, "/third/odom")
    description = peer.listen(String, "/third/robot_description", LATCHED)
    wait_for("the third robot", lambda: len(odometry) > 20 and description)
    late_s = time.time() - seconds(odometry[-1].header.stamp)
    assert abs(late_s) < 5.0, late_s
    assert "/third/clock" not in dict(peer.node.get_topic_names_and_types())
    peer.must("/third/rumbo/arm")
    peer.must("/third/rumbo/stop")
    robot.end()
    simulated.process.terminate()


def check_replayed(peer, folder):
    run = subprocess.run([os.environ["RUMBO_COMMAND"], "run", "mode1", "--out", folder], stdout=subprocess.DEVNULL)
    assert run.returncode < 2
    odometry = peer.listen(Odometry, "/log/odom")
    clock = peer.listen(Clock, "/log/clock")
    log = str(Path(folder) / "mode1-1.mcap")
    replay = Program("ros", "replay", log, "--speed", "10", "--namespace", "log", ready="ROS 2")
    assert replay.process.wait(PATIENCE_S) == 0, replay.lines
    wait_for("the end", lambda: clock and odometry and seconds(odometry[-1].header.stamp) > 5.0)
    assert x_m(odometry) > 0.1, x_m(odometry)


def check_refusals(folder):
    for arguments, why in [
        (["lab", "--domain", "233"], "0..232"),
        (["lab", "--namespace", "2nd"], "no digit first"),
        (["lab", "--pty"], "rumbo ros connect"),
        (["replay", str(Path(folder) / "none.mcap")], "none.mcap"),
    ]:
        run = subprocess.run([os.environ["RUMBO_COMMAND"], "ros", *arguments], capture_output=True, text=True)
        assert run.returncode == 2 and why in run.stderr, (arguments, run)


def main():
    began = time.monotonic()

    def done(what):
        print(f"{time.monotonic() - began:5.1f} s  {what}", flush=True)

    rclpy.init()
    check_refusals(sys.argv[1])
    done("wrong input")
    first = lab("--scenario", "mode8-goals")
    peer, cyclone = Peer("peer"), Cyclone()
    check_graph(peer)
    done("the graph")
    odometry, truth = check_topics(peer, cyclone)
    done("topics")
    check_late(cyclone)
    done("latched topics, late")
    check_driving(peer, odometry, truth, first)
    done("services and velocities")
    check_page(peer, cyclone, odometry, first)
    done("STOP of a page")
    check_cyclone_calls(cyclone)
    done("services of Cyclone")
    check_garbage(peer, cyclone, odometry, first)
    done("garbage")
    check_killed_peer(peer, odometry)
    done("a killed peer")
    check_two(peer, first)
    done("two robots")
    check_example()
    done("the example")
    first.end()
    check_connected(peer)
    done("a robot at a port")
    with tempfile.TemporaryDirectory() as folder:
        check_replayed(peer, folder)
    done("a log")
    rclpy.shutdown()


main()
