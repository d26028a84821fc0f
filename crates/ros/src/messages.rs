//! The messages of ROS 2 that a robot needs, as Jazzy and newer define them.

use crate::types::{Byte, Covariance, messages};

messages! {
    /// A time since 1970, or since the start of a simulation.
    "builtin_interfaces/msg/Time" Time {
        /// Whole seconds.
        sec: i32,
        /// The rest [ns].
        nanosec: u32,
    }
    /// When and in which frame.
    "std_msgs/msg/Header" Header {
        /// When it was so.
        stamp: Time,
        /// The frame of the values.
        frame_id: String,
    }
    /// A text.
    "std_msgs/msg/String" Text {
        /// It.
        data: String,
    }
    /// A place [m].
    "geometry_msgs/msg/Point" Point {
        /// Forward.
        x: f64,
        /// Left.
        y: f64,
        /// Up.
        z: f64,
    }
    /// Three components.
    "geometry_msgs/msg/Vector3" Vector3 {
        /// Forward, or about that axis.
        x: f64,
        /// Left.
        y: f64,
        /// Up.
        z: f64,
    }
    /// A rotation, of length 1.
    "geometry_msgs/msg/Quaternion" Quaternion {
        /// About x.
        x: f64,
        /// About y.
        y: f64,
        /// About z.
        z: f64,
        /// The real part.
        w: f64,
    }
    /// Place and rotation.
    "geometry_msgs/msg/Pose" Pose {
        /// Where.
        position: Point,
        /// Which way.
        orientation: Quaternion,
    }
    /// A pose and how sure it is.
    "geometry_msgs/msg/PoseWithCovariance" PoseWithCovariance {
        /// The pose.
        pose: Pose,
        /// [m², m rad, rad²].
        covariance: Covariance,
    }
    /// A velocity [m/s, rad/s].
    "geometry_msgs/msg/Twist" Twist {
        /// Along the axes.
        linear: Vector3,
        /// About them.
        angular: Vector3,
    }
    /// A velocity of an instant.
    "geometry_msgs/msg/TwistStamped" TwistStamped {
        /// When; in which frame.
        header: Header,
        /// The velocity.
        twist: Twist,
    }
    /// A velocity and how sure it is.
    "geometry_msgs/msg/TwistWithCovariance" TwistWithCovariance {
        /// The velocity.
        twist: Twist,
        /// All zero: not known.
        covariance: Covariance,
    }
    /// Pose in the header's frame, velocity in the child's.
    "nav_msgs/msg/Odometry" Odometry {
        /// When; frame of the pose.
        header: Header,
        /// The robot's frame.
        child_frame_id: String,
        /// Where it is.
        pose: PoseWithCovariance,
        /// How it moves.
        twist: TwistWithCovariance,
    }
    /// Where a frame lies in another.
    "geometry_msgs/msg/Transform" Transform {
        /// Its origin.
        translation: Vector3,
        /// Its axes.
        rotation: Quaternion,
    }
    /// The same at an instant.
    "geometry_msgs/msg/TransformStamped" TransformStamped {
        /// When; in which frame.
        header: Header,
        /// The frame that lies there.
        child_frame_id: String,
        /// Where.
        transform: Transform,
    }
    /// Transforms of one instant.
    "tf2_msgs/msg/TFMessage" Transforms {
        /// All.
        transforms: Vec<TransformStamped>,
    }
    /// Angles and speeds of joints.
    "sensor_msgs/msg/JointState" JointState {
        /// When.
        header: Header,
        /// The joints.
        name: Vec<String>,
        /// Their angles [rad].
        position: Vec<f64>,
        /// Their speeds [rad/s].
        velocity: Vec<f64>,
        /// Not known.
        effort: Vec<f64>,
    }
    /// The time of a simulation.
    "rosgraph_msgs/msg/Clock" Clock {
        /// It.
        clock: Time,
    }
    /// A distance. Infinite: nothing within reach (REP 117).
    "sensor_msgs/msg/Range" Range {
        /// When; the frame of the sensor, x along its axis.
        header: Header,
        /// 0: sound.
        radiation_type: u8,
        /// Opening angle of the beam [rad].
        field_of_view: f32,
        /// Shortest distance [m].
        min_range: f32,
        /// Longest distance [m].
        max_range: f32,
        /// The distance [m].
        range: f32,
        /// Not known: 0.
        variance: f32,
    }
    /// A battery; not a number: not known.
    "sensor_msgs/msg/BatteryState" BatteryState {
        /// When.
        header: Header,
        /// [V].
        voltage: f32,
        /// [°C].
        temperature: f32,
        /// [A].
        current: f32,
        /// [Ah].
        charge: f32,
        /// [Ah].
        capacity: f32,
        /// [Ah].
        design_capacity: f32,
        /// 0..=1.
        percentage: f32,
        /// 0: not known.
        power_supply_status: u8,
        /// 0: not known.
        power_supply_health: u8,
        /// 0: not known.
        power_supply_technology: u8,
        /// It is there.
        present: bool,
        /// Not known.
        cell_voltage: Vec<f32>,
        /// Not known.
        cell_temperature: Vec<f32>,
        /// Where it sits.
        location: String,
        /// Not known.
        serial_number: String,
    }
    /// A name and its value.
    "diagnostic_msgs/msg/KeyValue" KeyValue {
        /// The name.
        key: String,
        /// The value.
        value: String,
    }
    /// State of a part.
    "diagnostic_msgs/msg/DiagnosticStatus" DiagnosticStatus {
        /// 0 well, 1 warning, 2 error.
        level: Byte,
        /// The part.
        name: String,
        /// Its state in words.
        message: String,
        /// The robot.
        hardware_id: String,
        /// Figures.
        values: Vec<KeyValue>,
    }
    /// States of the parts.
    "diagnostic_msgs/msg/DiagnosticArray" Diagnostics {
        /// When.
        header: Header,
        /// All.
        status: Vec<DiagnosticStatus>,
    }
    /// An event, as consoles show it.
    "rcl_interfaces/msg/Log" Event {
        /// When.
        stamp: Time,
        /// 20 information, 30 warning, 40 error.
        level: u8,
        /// Who says it.
        name: String,
        /// What.
        msg: String,
        /// Empty.
        file: String,
        /// Empty.
        function: String,
        /// 0.
        line: u32,
    }
    /// The answer of a service that has no question.
    "std_srvs/srv/Trigger_Response" Triggered {
        /// It was done.
        success: bool,
        /// Why not, in words.
        message: String,
    }
}
