"""Robots as nodes of ROS 2, as genuine peers see them: rclpy on Fast DDS, and Cyclone DDS.

Argument: a folder for logs. `RUMBO_COMMAND` names a `rumbo`, `RUMBO_ROS_COMMAND` a `rumbo-ros`.
"""

import math
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import check_ros_goal
import check_ros_others
import check_ros_parameters
import rclpy
import yaml
from nav_msgs.msg import OccupancyGrid, Odometry
from ros_peers import (
    COMMANDS,
    DOMAIN,
    LATCHED,
    PATIENCE_S,
    CycloneAnswer,
    CycloneRequest,
    Cyclone,
    DiagnosticArray,
    Page,
    Peer,
    Program,
    ShortRequest,
    Text,
    TFMessage,
    lab,
    moved_m,
    place,
    seconds,
    twist,
    wait_for,
)
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan, Range
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

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
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/markers/world": "visualization_msgs/msg/MarkerArray",
    "/markers/way": "visualization_msgs/msg/MarkerArray",
    "/clock": "rosgraph_msgs/msg/Clock",
    "/parameter_events": "rcl_interfaces/msg/ParameterEvent",
    "/rumbo/navigate_to_pose/_action/feedback": "nav2_msgs/action/NavigateToPose_FeedbackMessage",
    "/rumbo/navigate_to_pose/_action/status": "action_msgs/msg/GoalStatusArray",
}


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
    # An open floor.
    floors = late.listen(OccupancyGrid, "/map", LATCHED)
    assert set(wait_for("the map", lambda: floors)[-1].data) == {0}, floors


def check_surroundings(late):
    """The robot is in no void, for those who come late too."""
    robot = lab("--scenario", "free", "--world", "room", node=["--scan", "--namespace", "room"])
    grids = late.listen(OccupancyGrid, "/room/map", LATCHED)
    walls = late.listen(MarkerArray, "/room/markers/world", LATCHED)
    ways = late.listen(MarkerArray, "/room/markers/way", LATCHED)
    scans = late.listen(LaserScan, "/room/scan")
    wait_for("map, markers and a scan", lambda: grids and walls and ways and scans)
    grid = grids[-1]
    assert grid.header.frame_id == "map" and len(grid.data) == grid.info.width * grid.info.height, grid.info
    assert {0, 100} == set(grid.data) and grid.info.width * grid.info.resolution > 3.0, grid.info
    assert {marker.ns for marker in walls[-1].markers[1:]} == {"walls", "boxes"}, walls
    assert [marker.ns for marker in ways[-1].markers] == ["way", "goals"] and ways[-1].markers[0].header.frame_id == "odom", ways
    seen = [distance for distance in scans[-1].ranges if not math.isnan(distance)]
    assert len(scans[-1].ranges) == 360 and 20 < len(seen) < 180, scans[-1]
    robot.end()


def check_driving(peer, odometry, truth, robot):
    # Connecting has armed nothing, and so does a velocity.
    assert moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5)) < 1e-3
    wait_for("why not", lambda: robot.said("the robot is in another mode; call mode/twist"))
    peer.must("/rumbo/mode/twist")
    peer.must("/rumbo/arm")
    refused = peer.call("/rumbo/mode/manual")
    assert not refused.success and "disarm first" in refused.message, refused
    from_m, true_m = place(odometry), truth[-1].pose.pose.position
    peer.drive("/cmd_vel", lambda: twist(0.15), 1.5)
    assert odometry[-1].twist.twist.linear.x > 0.1, odometry[-1].twist
    wait_for("standing still", lambda: abs(odometry[-1].twist.twist.linear.x) < 0.005)
    forward_m, now_m = math.dist(place(odometry), from_m), truth[-1].pose.pose.position
    true_m = math.hypot(now_m.x - true_m.x, now_m.y - true_m.y)
    assert 0.15 < forward_m < 0.5 and abs(true_m - forward_m) < 0.03, (true_m, forward_m)
    # Turning left is positive.
    heading = lambda: 2 * math.atan2(odometry[-1].pose.pose.orientation.z, odometry[-1].pose.pose.orientation.w)
    before = heading()
    peer.drive("/cmd_vel", lambda: twist(0.0, 1.0), 0.7)
    assert math.remainder(heading() - before, 2 * math.pi) > 0.2, (before, heading())
    wait_for("standing still", lambda: abs(odometry[-1].twist.twist.angular.z) < 0.02)
    for absurd in (twist(math.nan), twist(math.inf), twist(0.1, math.nan), twist(5.0), twist(0.1, 1e300)):
        assert moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: absurd, 0.3)) < 2e-3, absurd
    wait_for("what is no number", lambda: robot.said("its forward speed is not a finite number"))
    wait_for("what is too fast", lambda: robot.said("out of range"))
    peer.must("/rumbo/stop")
    assert moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5)) < 1e-3


def robot_is(diagnostics, what):
    """Whether the newest diagnostics have the robot so."""
    newest = diagnostics.take(N=50)[-1:]
    return newest and newest[0].status[0].message == what


def check_page(peer, cyclone, odometry, robot):
    """The robot is off, in the mode that takes velocities."""
    diagnostics = cyclone.read("rt/diagnostics", DiagnosticArray, cyclone.volatile)
    page = Page(robot.url)
    page.order("arm")
    wait_for("the page's ON", lambda: robot_is(diagnostics, "on"))
    refused = peer.call("/rumbo/arm").message
    assert "another page has control" in refused, refused
    assert moved_m(odometry, lambda: peer.drive("/cmd_vel", lambda: twist(0.15), 0.5)) < 1e-3
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
    before = place(odometry)
    driving.join()
    assert math.dist(place(odometry), before) < 0.01, (before, place(odometry))


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


def check_examples():
    """What of the examples can be checked without RViz and `ros2 launch`, and the one that runs."""
    launch = Path("examples/ros2/rumbo.launch.py")
    compile(launch.read_text(), launch, "exec")
    layout = yaml.safe_load(Path("examples/ros2/rumbo.rviz").read_text())["Visualization Manager"]
    kinds = {
        "Map": "nav_msgs/msg/OccupancyGrid",
        "MarkerArray": "visualization_msgs/msg/MarkerArray",
        "Odometry": "nav_msgs/msg/Odometry",
        "Range": "sensor_msgs/msg/Range",
        "RobotModel": "std_msgs/msg/String",
    }
    shown = {}
    for display in layout["Displays"]:
        topic = display.get("Topic") or display.get("Description Topic")
        if topic:
            shown[topic["Value"]] = kinds[display["Class"].split("/")[1]]
    assert len(shown) == 9 and shown.items() <= TOPICS.items(), shown
    assert layout["Global Options"]["Fixed Frame"] == "odom"
    example = [sys.executable, "examples/ros2/drive.py"]
    run = subprocess.run(example, capture_output=True, text=True, timeout=PATIENCE_S)
    assert run.returncode == 0 and run.stdout.startswith("x "), run


def check_connected(peer):
    """A robot at a port: its messages have the time of day. The node may be there before the station."""
    simulated = Program("rumbo", "lab", "--pty", "--scenario", "mode1", ready="/dev/")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    node = Program("rumbo-ros", f"127.0.0.1:{port}", "--namespace", "third", ready="waiting: no rumbo at")
    options = ["--no-browser", "--port", port, "--out", sys.argv[1]]
    robot = Program("rumbo", "connect", simulated.ready.split()[-1], *options, ready="http://")
    odometry = peer.listen(Odometry, "/third/odom")
    description = peer.listen(String, "/third/robot_description", LATCHED)
    wait_for("the third robot", lambda: len(odometry) > 20 and description)
    late_s = time.time() - seconds(odometry[-1].header.stamp)
    assert abs(late_s) < 5.0, late_s
    assert "/third/clock" not in dict(peer.node.get_topic_names_and_types())
    peer.must("/third/rumbo/arm")
    peer.must("/third/rumbo/stop")
    node.end()
    # It comes again: what was before is not told again.
    odometry.clear()
    description.clear()
    node = Program("rumbo-ros", f"127.0.0.1:{port}", "--namespace", "third", ready="ROS 2: node /third/rumbo")
    began = time.time()
    wait_for("the third robot again", lambda: len(odometry) > 20 and description)
    assert seconds(odometry[0].header.stamp) > began - 3.0, (odometry[0].header, began)
    robot.end()
    node.end(ask=False)
    simulated.process.terminate()


def check_left(peer, robot, odometry):
    """A node that is asked to end stops the robot on its way to a goal: nobody would follow it there."""
    peer.must("/rumbo/mode/mission")
    peer.must("/rumbo/arm")
    check_ros_goal.Goals(peer).must(-1.5, 0.4)
    wait_for("the way", lambda: abs(odometry[-1].twist.twist.linear.x) > 0.1)
    robot.node.end()
    again = Program("rumbo-ros", robot.url.split("?")[0], ready="ROS 2: node")
    heard = len(odometry)
    wait_for("the robot again, standing", lambda: len(odometry) > heard + 10 and abs(odometry[-1].twist.twist.linear.x) < 0.005)
    robot.node, robot.said = again, again.said
    # It is off.
    peer.must("/rumbo/mode/manual")


def fleet_of_names(folder, *names):
    """A scenario with such robots."""
    path = Path(folder) / "fleet.toml"
    around = 'title = "Names"\nrobot = "memoria"\nrig = "final"\nworld = "room"\nmode = "twist"\nduration_s = 9\n'
    members = [f'[[fleet]]\nname = "{name}"\nstart = {{ y_m = {place} }}\n' for place, name in enumerate(names)]
    path.write_text(around + "".join(members))
    return str(path)


def refused(*arguments):
    run = subprocess.run([COMMANDS["rumbo-ros"], *arguments], capture_output=True, text=True, timeout=PATIENCE_S)
    assert run.returncode == 2, (arguments, run)
    return run.stderr


def check_refusals(folder):
    assert "0..232" in refused("--domain", "233")
    assert "no digit first" in refused("--namespace", "2nd")
    assert "as rumbo prints it" in refused("https://127.0.0.1:8360")
    options = ["--no-browser", "--port", "0", "--out", folder]
    named = Program("rumbo", "lab", "--scenario", fleet_of_names(folder, "first", "2nd"), *options, ready="http://")
    address = named.ready
    said = refused(address.replace("token=", "token=0"))
    assert "was used already or is of an earlier start" in said, said
    # The address with its token is enough.
    said = refused(address)
    assert "robot 2nd: a name of ROS 2 begins with a letter" in said, said
    named.end()
    # The file of the key is gone with it.
    assert "no rumbo at" in refused(address.split("?")[0])
    run = subprocess.run([COMMANDS["rumbo"], "run", "mode1", "--out", folder], stdout=subprocess.DEVNULL)
    assert run.returncode < 2
    log = Program("rumbo", "replay", str(Path(folder) / "mode1-1.mcap"), *options[:3], ready="http://")
    said = refused(log.ready.split("?")[0])
    assert "--ros2bag" in said, said
    log.end()


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
    check_ros_parameters.check(peer, cyclone, first)
    done("parameters")
    check_ros_goal.check(peer, odometry, first)
    done("go to goal")
    check_driving(peer, odometry, truth, first)
    done("services and velocities")
    check_page(peer, cyclone, odometry, first)
    done("STOP of a page")
    check_cyclone_calls(cyclone)
    done("services of Cyclone")
    peer.must("/rumbo/disarm")
    check_ros_others.check(peer, cyclone, odometry, first)
    done("others")
    check_garbage(peer, cyclone, odometry, first)
    done("garbage")
    check_killed_peer(peer, odometry)
    done("a killed peer")
    check_ros_others.check_two(peer, first, odometry)
    done("two robots")
    check_examples()
    done("the examples")
    check_left(peer, first, odometry)
    done("a node that leaves")
    first.end()
    check_ros_others.check_fleet(peer, cyclone)
    done("a fleet")
    check_connected(peer)
    done("a robot at a port")
    check_surroundings(peer)
    done("a room")
    Peer.end()
    for distribution in ("humble", "kilted"):
        script = Path(__file__).with_name("check_ros_distribution.py")
        subprocess.run([sys.executable, script, sys.argv[1], distribution], check=True)
        done(f"go to goal for {distribution}")


main()
