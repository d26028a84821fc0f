"""Drives a robot forward and to the left from ROS 2: mode, ON, velocities, STOP.

    rumbo lab --scenario free        in one terminal
    rumbo-ros                        in another
    python3 drive.py                 where rclpy is; or ros2 run from a package of your own
"""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger

FORWARD_M_S = 0.15
YAW_RAD_S = 0.3
SECONDS = 3.0


def call(node, service):
    client = node.create_client(Trigger, service)
    client.wait_for_service()
    answer = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, answer)
    if not answer.result().success:
        raise SystemExit(f"{service}: {answer.result().message}")


def main():
    rclpy.init()
    node = rclpy.create_node("drive")
    velocities = node.create_publisher(Twist, "cmd_vel", 1)
    places = []
    node.create_subscription(Odometry, "odom", places.append, 1)
    call(node, "rumbo/mode/twist")
    call(node, "rumbo/arm")
    velocity = Twist()
    velocity.linear.x = FORWARD_M_S
    velocity.angular.z = YAW_RAD_S
    # The robot stops half a second after the last one.
    node.create_timer(0.05, lambda: velocities.publish(velocity))
    began = node.get_clock().now()
    while (node.get_clock().now() - began).nanoseconds < SECONDS * 1e9:
        rclpy.spin_once(node)
    call(node, "rumbo/stop")
    at = places[-1].pose.pose.position
    print(f"x {at.x:.2f} m, y {at.y:.2f} m")


main()
