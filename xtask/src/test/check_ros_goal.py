"""*Go to goal* as an action: rclpy's own client, with Nav2's type."""

import math
import sys
from pathlib import Path

import ros_action
from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.action import ActionClient
from ros_peers import LATCHED, PATIENCE_S, Page, place, wait_for

NavigateToPose = ros_action.make(Path(sys.argv[1]) / "nav2")


class Goals:
    """A client of the action."""

    def __init__(self, peer):
        self.client = ActionClient(peer.node, NavigateToPose, "/rumbo/navigate_to_pose")
        assert self.client.wait_for_server(PATIENCE_S)

    def send(self, x, y, frame="odom", heading=None):
        """The accepted goal, the feedback that will come, and its result."""
        goal = NavigateToPose.Goal()
        goal.pose.header.frame_id = frame
        goal.pose.pose.position.x, goal.pose.pose.position.y = float(x), float(y)
        if heading is not None:
            goal.pose.pose.orientation.z, goal.pose.pose.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
        feedback = []
        sent = self.client.send_goal_async(goal, feedback_callback=lambda message: feedback.append(message.feedback))
        wait_for("whether it is accepted", sent.done)
        handle = sent.result()
        return handle, feedback, handle.get_result_async() if handle.accepted else None

    def must(self, x, y, **frame):
        handle, feedback, result = self.send(x, y, **frame)
        assert handle.accepted
        return handle, feedback, result


def status_of(result):
    wait_for("the end", result.done)
    return result.result().status


def check(peer, odometry, robot):
    """The robot is off, and stands where it began."""
    goals = Goals(peer)
    statuses = peer.listen(GoalStatusArray, "/rumbo/navigate_to_pose/_action/status", LATCHED)
    check_refusals(peer, goals, robot)
    handle, feedback, result = goals.must(0.6, 0.0)
    assert status_of(result) == GoalStatus.STATUS_SUCCEEDED and result.result().result.error_code == 0
    wait_for("standing there", lambda: math.dist(place(odometry), (0.6, 0.0)) < 0.05)
    left = [each.distance_remaining for each in feedback]
    assert len(left) > 3 and left[0] > 0.3 > left[-1], left
    assert feedback[-1].current_pose.header.frame_id == "odom" and feedback[-1].current_pose.pose.position.x > 0.3
    times = [each.navigation_time.sec + each.navigation_time.nanosec / 1e9 for each in feedback]
    assert times == sorted(times) and times[-1] > 0.5, times
    # The robot counts from the goal that it has reached; those who send goals need not know.
    _, _, result = goals.must(0.6, 0.4)
    assert status_of(result) == GoalStatus.STATUS_SUCCEEDED
    assert math.dist(place(odometry), (0.6, 0.4)) < 0.06, place(odometry)
    # A newer goal replaces the one on the way.
    _, feedback, first = goals.must(-1.2, 0.4)
    wait_for("the way", lambda: feedback and feedback[-1].distance_remaining < 1.6)
    _, _, second = goals.must(0.2, 0.4)
    assert status_of(first) == GoalStatus.STATUS_ABORTED and first.result().result.error_code == 9000
    assert robot.said("a newer goal has come")
    assert status_of(second) == GoalStatus.STATUS_SUCCEEDED
    assert math.dist(place(odometry), (0.2, 0.4)) < 0.08, place(odometry)
    # They come after the result.
    last = lambda: statuses and [each.status for each in statuses[-1].status_list]
    wait_for("statuses", lambda: last() == [4, 4, 6, 4])
    check_ends(peer, goals, odometry, robot)
    check_pose(peer, goals, odometry)


def check_refusals(peer, goals, robot):
    assert not goals.send(0.5, 0.0)[0].accepted
    wait_for("why not", lambda: robot.said("the robot is off; call arm"))
    peer.must("/rumbo/mode/manual")
    peer.must("/rumbo/arm")
    assert not goals.send(0.5, 0.0)[0].accepted
    wait_for("why not", lambda: robot.said("call mode/mission, or mode/waypoints"))
    peer.must("/rumbo/disarm")
    peer.must("/rumbo/mode/mission")
    peer.must("/rumbo/arm")
    for x, frame, why in [(math.nan, "odom", "not finite"), (1e5, "odom", "allowed is"), (1, "earth", "no frame `earth`")]:
        assert not goals.send(x, 0.0, frame=frame)[0].accepted, why
        wait_for("why not", lambda: robot.said(why))


def check_ends(peer, goals, odometry, robot):
    """A client cancels; a page stops."""
    page = Page(robot.url)
    for cancel, status in [(True, GoalStatus.STATUS_CANCELED), (False, GoalStatus.STATUS_ABORTED)]:
        handle, feedback, result = goals.must(-1.5, 0.4)
        wait_for("the way", lambda: len(feedback) > 3 and abs(odometry[-1].twist.twist.linear.x) > 0.1)
        if cancel:
            canceled = handle.cancel_goal_async()
            wait_for("an answer", canceled.done)
            assert len(canceled.result().goals_canceling) == 1 and canceled.result().return_code == 0
        else:
            page.order("stop")
        assert status_of(result) == status, result.result()
        wait_for("standing still", lambda: abs(odometry[-1].twist.twist.linear.x) < 0.005)
        assert not goals.send(0.0, 0.0)[0].accepted
        canceled = handle.cancel_goal_async()
        wait_for("an answer", canceled.done)
        assert canceled.result().return_code == 3, canceled.result()
        peer.must("/rumbo/arm")
    assert robot.said("aborted, the robot was stopped")
    # Something else to do, from a page: control is free while no goal is on its way.
    page.order("take_control")
    wait_for("control of the page", lambda: not goals.send(0.0, 0.4)[0].accepted)
    assert robot.said("navigate_to_pose: refused, refused: another page has control") or robot.said("another page has control")
    page.order("release_control")
    peer.must("/rumbo/stop")


def check_pose(peer, goals, odometry):
    """Mode 7 has a heading at the end, and frames are those of the tree."""
    peer.must("/rumbo/mode/waypoints")
    peer.must("/rumbo/arm")
    turn = lambda: 2 * math.atan2(odometry[-1].pose.pose.orientation.z, odometry[-1].pose.pose.orientation.w)
    start, before = place(odometry), turn()
    _, _, result = goals.must(0.3, 0.0, frame="base_link", heading=math.pi / 2)
    assert status_of(result) == GoalStatus.STATUS_SUCCEEDED
    turned = math.remainder(turn() - before - math.pi / 2, 2 * math.pi)
    assert abs(turned) < 0.15 and 0.2 < math.dist(place(odometry), start) < 0.4, (turned, start, place(odometry))
    peer.must("/rumbo/stop")
