"""Several robots in one world: a node for each, in a namespace of its own."""

import math
import threading

from nav_msgs.msg import Odometry
from ros_peers import TFMessage, lab, place, twist, wait_for
from rosgraph_msgs.msg import Clock

ROBOTS = ["south_west", "south_east", "north_east", "north_west"]


def heading(odometry):
    facing = odometry[-1].pose.pose.orientation
    return 2 * math.atan2(facing.z, facing.w)


def namespaces(peer):
    return {where for name, where in peer.node.get_node_names_and_namespaces() if name == "rumbo"}


def check(peer, cyclone):
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
    wait_for("why not", lambda: fleet.said("ROS 2, /south_west: cmd_vel: refused, the robot is off"))
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
    herd = lab("--scenario", "free", "--robots", "2", "--namespace", "herd")
    odometry = peer.listen(Odometry, "/herd/robot2/odom")
    clock = peer.listen(Clock, "/herd/clock")
    wait_for("the second robot", lambda: odometry and clock)
    wait_for("both", lambda: namespaces(peer) == {"/herd/robot1", "/herd/robot2"})
    peer.must("/herd/robot2/rumbo/arm")
    herd.end()
