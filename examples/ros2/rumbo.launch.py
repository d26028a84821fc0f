"""A simulated robot and RViz: ros2 launch rumbo.launch.py [scenario:=mode8-goals] [namespace:=left]

`rumbo` and `rumbo-ros` are on the PATH (docs/ros2.md). The layout is made for a robot without a namespace.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

LAYOUT = str(Path(__file__).with_name("rumbo.rviz"))


def generate_launch_description():
    robot = ExecuteProcess(
        cmd=["rumbo", "lab", "--scenario", LaunchConfiguration("scenario")],
        output="screen",
        # It ends as with Ctrl-C, and writes its log to the end.
        sigterm_timeout="10",
    )
    # It waits for the robot, and ends with it.
    node = ExecuteProcess(cmd=["rumbo-ros", "--namespace", LaunchConfiguration("namespace")], output="screen")
    rviz = Node(
        package="rviz2",
        executable="rviz2",
        arguments=["--display-config", LAYOUT],
        parameters=[{"use_sim_time": True}],
        output="log",
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("scenario", default_value="free", description="what `rumbo list` names"),
            DeclareLaunchArgument("namespace", default_value="", description="of the robot's topics"),
            robot,
            node,
            rviz,
            RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[EmitEvent(event=Shutdown())])),
        ]
    )
