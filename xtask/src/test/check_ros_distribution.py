"""*Go to goal* for clients with another distribution's type of the action.

Arguments: a folder, and the distribution. A process can have one type of that name.
"""

import math
import sys
from pathlib import Path

import rclpy
import ros_action
from action_msgs.msg import GoalStatus
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from ros_peers import PATIENCE_S, Peer, lab, place, wait_for


def main():
    folder, distribution = sys.argv[1:]
    NavigateToPose = ros_action.make(Path(folder) / f"nav2-{distribution}", distribution)
    rclpy.init()
    robot = lab("--scenario", "mode8-goals", node=["--distribution", distribution])
    peer = Peer("peer")
    odometry = peer.listen(Odometry, "/odom")
    peer.must("/rumbo/mode/mission")
    peer.must("/rumbo/arm")
    client = ActionClient(peer.node, NavigateToPose, "/rumbo/navigate_to_pose")
    assert client.wait_for_server(PATIENCE_S)
    outcomes, places = [], []
    for x, stops in ((0.6, False), (-1.0, True)):
        goal = NavigateToPose.Goal()
        goal.pose.header.frame_id = "odom"
        goal.pose.pose.position.x = x
        sent = client.send_goal_async(goal)
        wait_for("whether it is accepted", sent.done)
        assert sent.result().accepted
        result = sent.result().get_result_async()
        if stops:
            peer.must("/rumbo/stop")
        wait_for("the end", result.done)
        outcomes.append(result.result())
        places.append(place(odometry))
    there, stopped = outcomes
    assert [each.status for each in outcomes] == [GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_ABORTED], outcomes
    # The second goal may have moved the robot before it was stopped.
    assert math.dist(places[0], (0.6, 0.0)) < 0.3, places
    if distribution == "kilted":
        assert (there.result.error_code, there.result.error_msg) == (0, ""), there
        assert stopped.result.error_code == 9000 and stopped.result.error_msg, stopped
    robot.end()
    Peer.end()


main()
