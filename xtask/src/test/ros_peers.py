"""What the checks of ROS 2 share: a robot that runs, and its peers, a node of rclpy, Cyclone DDS and a page."""

import atexit
import base64
import json
import math
import os
import socket
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

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
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import Trigger

COMMANDS = {"rumbo": os.environ["RUMBO_COMMAND"], "rumbo-ros": os.environ["RUMBO_ROS_COMMAND"]}
# Long enough for any machine; nothing is judged by it.
PATIENCE_S = 40


def wait_for(what, condition):
    """The first true value of `condition`."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    said = [(program.name, program.lines[-20:]) for program in Program.all]
    raise AssertionError(f"not seen: {what}; what was said: {said}")


class Program:
    """A program that runs until it is asked to end; what it prints."""

    all = []

    def __init__(self, name, *arguments, ready):
        self.name = name
        self.all.append(self)
        self.process = subprocess.Popen([COMMANDS[name], *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
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

    def end(self, ask=True):
        if ask:
            self.process.terminate()
        status = self.process.wait(PATIENCE_S)
        assert status == 0, (status, self.lines)


class Robot:
    """A `rumbo` that serves a robot, or several, and the node that joins it."""

    def __init__(self, *arguments, node=()):
        options = ["--no-browser", "--port", "0", "--out", sys.argv[1]]
        self.rumbo = Program("rumbo", *arguments, *options, ready="http://")
        self.url = self.rumbo.ready
        # The address without its token, which is for the page: the key is in a file.
        self.node = Program("rumbo-ros", self.url.split("?")[0], *node, ready="ROS 2: node")
        self.said = self.node.said

    def end(self):
        """The node ends with its robot."""
        self.rumbo.end()
        self.node.end(ask=False)


def lab(*arguments, node=()):
    return Robot("lab", *arguments, node=node)


LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

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


class Peer:
    """A node of rclpy, spinning in a thread."""

    threads = []

    def __init__(self, name):
        self.node = rclpy.create_node(name)
        self.executor = rclpy.executors.SingleThreadedExecutor()
        self.executor.add_node(self.node)
        thread = threading.Thread(target=self._spin, daemon=True)
        thread.start()
        self.threads.append(thread)

    @classmethod
    def end(cls):
        """Ends all of them. A thread that still spins when Python ends aborts the process: it is in C++ then."""
        rclpy.shutdown()
        for thread in cls.threads:
            thread.join()

    def _spin(self):
        try:
            self.executor.spin()
        except rclpy.executors.ExternalShutdownException:
            pass

    def listen(self, kind, topic, quality=50):
        """A list that grows with the messages."""
        received = []
        self.node.create_subscription(kind, topic, received.append, quality)
        return received

    def seen(self, where=""):
        """The writers and readers of others, those of services too, of which the name has this in it."""
        names = [name for name, _ in self.node.get_topic_names_and_types(no_demangle=True) if where in name]
        infos = self.node.get_publishers_info_by_topic, self.node.get_subscriptions_info_by_topic
        found = [each for name in names for info in infos for each in info(name, no_mangle=True)]
        return [each for each in found if each.node_name != self.node.get_name()]

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

    def order(self, kind, **what):
        text = json.dumps({"type": kind, **what}).encode()
        assert len(text) < 126, text
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


def place(odometry):
    position = odometry[-1].pose.pose.position
    return position.x, position.y


def moved_m(odometry, act):
    """How far the robot goes while `act` and a little after."""
    before = place(odometry)
    act()
    time.sleep(0.3)
    return math.dist(place(odometry), before)


def seconds(stamp):
    return stamp.sec + stamp.nanosec / 1e9
