"""Others on the domain: those who do not behave (two publishers of velocities, one that is killed, writers of garbage), and
other robots, of the same world or of another."""

import math
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass

import check_ros_parameters
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int64, uint8, uint32, uint64
from nav_msgs.msg import Odometry
from ros_peers import DiagnosticArray, Peer, TFMessage, lab, moved_m, place, stamped, twist, wait_for
from rosgraph_msgs.msg import Clock

ROBOTS = ["south_west", "south_east", "north_east", "north_west"]

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


def check_two(peer, first, first_odometry):
    """The first robot is armed; the second one takes stamped velocities."""
    second = lab("--scenario", "mode1", node=["--namespace", "second", "--stamped"])
    odometry = peer.listen(Odometry, "/second/odom")
    clock = peer.listen(Clock, "/second/clock")
    # A stamp of 0, 2 s before 2 s, would be none.
    wait_for("the second robot", lambda: odometry and clock and clock[-1].clock.sec > 2)
    nodes = {("rumbo", "/"), ("rumbo", "/second")}
    wait_for("both nodes", lambda: nodes <= set(peer.node.get_node_names_and_namespaces()))
    peer.must("/second/rumbo/mode/twist")
    peer.must("/second/rumbo/arm")
    old = moved_m(odometry, lambda: peer.drive("/second/cmd_vel", lambda: stamped(clock, 2), 0.7))
    assert old < 1e-3, old
    wait_for("what is old", lambda: second.said("refused, it was stamped 2."))
    # Each has its own commands: the other one stands.
    drive_second = lambda: peer.drive("/second/cmd_vel", lambda: stamped(clock, 0), 1.0)
    first_stands = moved_m(first_odometry, lambda: check_moves(odometry, drive_second))
    assert first_stands < 1e-3, first_stands
    wait_for("standing still", lambda: standing(odometry))
    drive_first = lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 1.0)
    second_stands = moved_m(odometry, lambda: check_moves(first_odometry, drive_first))
    assert second_stands < 1e-3, second_stands
    check_ros_parameters.check_two(peer)
    peer.must("/second/rumbo/stop")
    # The first one is still armed.
    refused = peer.call("/rumbo/mode/manual")
    assert "disarm first" in refused.message, refused
    peer.must("/rumbo/stop")
    assert len(peer.seen("/second/")) > 50
    second.end()
    wait_for("one node less", lambda: ("rumbo", "/second") not in peer.node.get_node_names_and_namespaces())
    # Before the lease of its participant is over, which is longer than any patience here.
    wait_for("its topics and services to be gone", lambda: not peer.seen("/second/"))
    assert ("rumbo", "/") in peer.node.get_node_names_and_namespaces()
    assert first.node.process.poll() is None


def check_moves(odometry, act):
    moved = moved_m(odometry, act)
    assert moved > 0.05, moved


def heading(odometry):
    facing = odometry[-1].pose.pose.orientation
    return 2 * math.atan2(facing.z, facing.w)


def namespaces(peer):
    return {where for name, where in peer.node.get_node_names_and_namespaces() if name == "rumbo"}


def check_fleet(peer, cyclone):
    """No other robot is there."""
    wait_for("the others to be gone", lambda: not namespaces(peer) and not peer.node.get_publishers_info_by_topic("/clock"))
    fleet = lab("--scenario", "examples/fleet/corners.toml")
    assert fleet.said("nodes /south_west/rumbo, /south_east/rumbo, /north_east/rumbo, /north_west/rumbo"), fleet.lines
    wait_for("the nodes", lambda: namespaces(peer) == {f"/{name}" for name in ROBOTS})
    odometry = {name: peer.listen(Odometry, f"/{name}/odom") for name in ROBOTS}
    clock = peer.listen(Clock, "/clock")
    moving = cyclone.read("rt/south_east/tf", TFMessage, cyclone.volatile)
    wait_for("the robots", lambda: clock and all(odometry.values()))
    # One world has one time.
    clocks = lambda: [each.node_namespace for each in peer.node.get_publishers_info_by_topic("/clock")]
    wait_for("one clock", lambda: clocks() == ["/south_west"])
    assert not {f"/{name}/clock" for name in ROBOTS} & dict(peer.node.get_topic_names_and_types()).keys()
    frames = wait_for("a transform", lambda: moving.take(N=1))[0].transforms
    assert (frames[0].header.frame_id, frames[0].child_frame_id) == ("odom", "base_link"), frames
    for name in ROBOTS:
        peer.must(f"/{name}/rumbo/mode/twist")
        peer.must(f"/{name}/rumbo/arm")
    check_commands(peer, odometry)
    # STOP of one is that of all.
    peer.must("/north_west/rumbo/stop")
    before = {name: place(odometry[name]) for name in ROBOTS}
    drive(peer, {name: twist(0.15) for name in ROBOTS}, 0.7)
    assert all(math.dist(place(odometry[name]), before[name]) < 1e-3 for name in ROBOTS)
    wait_for("why not", lambda: fleet.said("/south_west: cmd_vel: refused, the robot is off"))
    fleet.end()
    wait_for("no node and nothing of theirs", lambda: not namespaces(peer) and not any(peer.seen(f"/{name}/rumbo/") for name in ROBOTS))
    check_prefix(peer)


def drive(peer, velocities, seconds):
    """Drives several at once."""
    drivers = [
        threading.Thread(target=peer.drive, args=(f"/{name}/cmd_vel", lambda it=velocity: it, seconds))
        for name, velocity in velocities.items()
    ]
    for driver in drivers:
        driver.start()
    for driver in drivers:
        driver.join()


def check_commands(peer, odometry):
    """Each has its own: one drives, one turns, two stand."""
    places = {name: place(odometry[name]) for name in ROBOTS}
    headings = {name: heading(odometry[name]) for name in ROBOTS}
    drive(peer, {"south_west": twist(0.15), "north_east": twist(0.0, 1.0)}, 1.5)
    still = lambda each: abs(each[-1].twist.twist.linear.x) < 0.005 and abs(each[-1].twist.twist.angular.z) < 0.02
    wait_for("standing still", lambda: all(map(still, odometry.values())))
    moved_m = {name: math.dist(place(odometry[name]), places[name]) for name in ROBOTS}
    turned = {name: math.remainder(heading(odometry[name]) - headings[name], 2 * math.pi) for name in ROBOTS}
    seen = (moved_m, turned)
    assert 0.15 < moved_m["south_west"] < 0.5 and abs(turned["south_west"]) < 0.1, seen
    assert moved_m["north_east"] < 0.05 and turned["north_east"] > 0.5, seen
    for name in ("south_east", "north_west"):
        assert moved_m[name] < 1e-3 and abs(turned[name]) < 1e-3, seen


def check_prefix(peer):
    """Copies of a scenario's robot, below a namespace."""
    herd = lab("--scenario", "free", "--robots", "2", node=["--namespace", "herd"])
    odometry = peer.listen(Odometry, "/herd/robot2/odom")
    clock = peer.listen(Clock, "/herd/clock")
    wait_for("the second robot", lambda: odometry and clock)
    wait_for("both", lambda: namespaces(peer) == {"/herd/robot1", "/herd/robot2"})
    peer.must("/herd/robot2/rumbo/arm")
    herd.end()
