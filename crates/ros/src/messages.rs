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
    /// Distances all around; not a number: not known.
    "sensor_msgs/msg/LaserScan" LaserScan {
        /// When; the frame of the directions.
        header: Header,
        /// Direction of the first one [rad].
        angle_min: f32,
        /// Direction of the last one [rad].
        angle_max: f32,
        /// Between two of them [rad].
        angle_increment: f32,
        /// 0: all at once.
        time_increment: f32,
        /// Not known: 0.
        scan_time: f32,
        /// Shortest distance [m].
        range_min: f32,
        /// Longest distance [m].
        range_max: f32,
        /// The distances [m].
        ranges: Vec<f32>,
        /// Not known.
        intensities: Vec<f32>,
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
    /// Size and place of a map.
    "nav_msgs/msg/MapMetaData" MapMetaData {
        /// When it was made.
        map_load_time: Time,
        /// Side of a cell [m].
        resolution: f32,
        /// Cells along x.
        width: u32,
        /// Cells along y.
        height: u32,
        /// The first cell's lowest corner.
        origin: Pose,
    }
    /// A map of cells.
    "nav_msgs/msg/OccupancyGrid" OccupancyGrid {
        /// When; in which frame.
        header: Header,
        /// Its size.
        info: MapMetaData,
        /// 0 free, 100 occupied; along x first.
        data: Vec<i8>,
    }
    /// A length of time; 0 for ever.
    "builtin_interfaces/msg/Duration" Duration {
        /// Whole seconds.
        sec: i32,
        /// The rest [ns].
        nanosec: u32,
    }
    /// A colour, each part 0 to 1.
    "std_msgs/msg/ColorRGBA" Color {
        /// Red.
        r: f32,
        /// Green.
        g: f32,
        /// Blue.
        b: f32,
        /// Opacity.
        a: f32,
    }
    /// A picture.
    "sensor_msgs/msg/CompressedImage" Picture {
        /// When.
        header: Header,
        /// Empty: none.
        format: String,
        /// It.
        data: Vec<u8>,
    }
    /// A place in a picture.
    "visualization_msgs/msg/UVCoordinate" PicturePlace {
        /// Across.
        u: f32,
        /// Down.
        v: f32,
    }
    /// A shape from a file.
    "visualization_msgs/msg/MeshFile" MeshFile {
        /// Empty: none.
        filename: String,
        /// It.
        data: Vec<u8>,
    }
    /// A shape in a display.
    "visualization_msgs/msg/Marker" Marker {
        /// When; in which frame.
        header: Header,
        /// What it belongs to.
        ns: String,
        /// Its number there.
        id: i32,
        /// 1 a box, 4 a line, 7 balls.
        kind as "type": i32,
        /// 0 show, 2 remove, 3 remove all.
        action: i32,
        /// Where.
        pose: Pose,
        /// Its size, or the width of lines [m].
        scale: Vector3,
        /// Its colour.
        color: Color,
        /// For how long.
        lifetime: Duration,
        /// It moves with its frame.
        frame_locked: bool,
        /// Places of a line, or of balls.
        points: Vec<Point>,
        /// A colour for each, or none.
        colors: Vec<Color>,
        /// Empty.
        texture_resource: String,
        /// None.
        texture: Picture,
        /// None.
        uv_coordinates: Vec<PicturePlace>,
        /// Empty.
        text: String,
        /// Empty.
        mesh_resource: String,
        /// None.
        mesh_file: MeshFile,
        /// No.
        mesh_use_embedded_materials: bool,
    }
    /// Shapes in a display.
    "visualization_msgs/msg/MarkerArray" Markers {
        /// All.
        markers: Vec<Marker>,
    }
    /// The answer of a service that has no question.
    "std_srvs/srv/Trigger_Response" Triggered {
        /// It was done.
        success: bool,
        /// Why not, in words.
        message: String,
    }
}
