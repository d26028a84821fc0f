"""Others on the domain who do not behave: two publishers of velocities, one that is killed, writers of garbage."""

import math
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int64, uint8, uint32, uint64
from ros_peers import DiagnosticArray, Peer, moved_m, place, twist, wait_for

DRIVER = """
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node('driver')
publisher = node.create_publisher(Twist, '/cmd_vel', 1)
message = Twist()
message.linear.x = 0.15
node.create_timer(0.05, lambda: publisher.publish(message))
rclpy.spin(node)
"""


@dataclass
class ShortTwist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    nothing: uint8


@dataclass
class EndlessRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Request_"):
    """It announces more parameters than there are bytes."""

    guid: uint64
    number: int64
    count: uint32


@dataclass
class ShortGoal(IdlStruct, typename="nav2_msgs::action::dds_::NavigateToPose_SendGoal_Request_"):
    guid: uint64
    number: int64
    nothing: uint8


def check(peer, cyclone, odometry, robot):
    """The robot is off, in the mode that takes velocities."""
    peer.must("/rumbo/arm")
    check_two_publishers(peer, cyclone, odometry)
    check_killed_driver(odometry)
    check_garbage_writer(peer, cyclone, odometry, robot)
    peer.must("/rumbo/disarm")


def standing(odometry):
    return abs(odometry[-1].twist.twist.linear.x) < 0.005


def check_two_publishers(peer, cyclone, odometry):
    diagnostics = cyclone.read("rt/diagnostics", DiagnosticArray, cyclone.volatile)
    second = Peer("second_driver")
    drivers = [
        threading.Thread(target=who.drive, args=("/cmd_vel", lambda: twist(forward), 2.0))
        for who, forward in [(peer, 0.15), (second, 0.05)]
    ]
    for driver in drivers:
        driver.start()
    by_turns = lambda: any("drive by turns" in each.status[2].message for each in diagnostics.take(N=50))
    wait_for("two publishers in diagnostics", by_turns)
    for driver in drivers:
        driver.join()
    wait_for("standing still", lambda: standing(odometry))


def check_killed_driver(odometry):
    driver = subprocess.Popen([sys.executable, "-c", DRIVER])
    wait_for("driving", lambda: odometry[-1].twist.twist.linear.x > 0.1)
    driver.send_signal(signal.SIGKILL)
    driver.wait()
    killed = place(odometry)
    wait_for("standing still", lambda: standing(odometry))
    # Half a second at 0.15 m/s, what was on its way, and the ramp.
    assert math.dist(place(odometry), killed) < 0.25, (killed, place(odometry))


def check_garbage_writer(peer, cyclone, odometry, robot):
    velocities = cyclone.write("rt/cmd_vel", ShortTwist)
    endless = cyclone.write("rq/rumbo/set_parametersRequest", EndlessRequest)
    short = cyclone.write("rq/rumbo/navigate_to_pose/_action/send_goalRequest", ShortGoal)
    writers = [velocities, endless, short]
    wait_for("its readers", lambda: all(writer.get_matched_subscriptions() for writer in writers))

    def write():
        for number in range(200):
            velocities.write(ShortTwist(nothing=number % 256))
            endless.write(EndlessRequest(guid=1, number=number, count=0xFFFFFFFF))
            short.write(ShortGoal(guid=1, number=number, nothing=0))
        return robot.said("cmd_vel: it cannot be decoded")

    # Again and again: no velocity is sent twice, and the robot's reader may know its writer later than that one knows it.
    moved = moved_m(odometry, lambda: wait_for("what is no velocity", write))
    assert moved < 1e-3, moved
    # What is right is still done.
    assert moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 1.0)) > 0.05
