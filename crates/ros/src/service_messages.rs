//! What the services of a node's parameters and those of an action carry. Requests are read as tuples of the same shape.

use crate::messages::{Duration, Header, Pose, Time};
use crate::types::{Byte, messages};

messages! {
    /// The value of a parameter: that of the fields which its type names.
    "rcl_interfaces/msg/ParameterValue" ParameterValue {
        /// 0 not set, 1 bool, 2 integer, 3 double, 4 string; 5 to 9 arrays.
        kind as "type": u8,
        /// Type 1.
        bool_value: bool,
        /// Type 2.
        integer_value: i64,
        /// Type 3.
        double_value: f64,
        /// Type 4.
        string_value: String,
        /// Type 5.
        byte_array_value: Vec<Byte>,
        /// Type 6.
        bool_array_value: Vec<bool>,
        /// Type 7.
        integer_array_value: Vec<i64>,
        /// Type 8.
        double_array_value: Vec<f64>,
        /// Type 9.
        string_array_value: Vec<String>,
    }
    /// A parameter.
    "rcl_interfaces/msg/Parameter" Parameter {
        /// Its name.
        name: String,
        /// Its value.
        value: ParameterValue,
    }
    /// Parameters of a node have changed.
    "rcl_interfaces/msg/ParameterEvent" ParameterEvent {
        /// When.
        stamp: Time,
        /// The node, with its namespace.
        node: String,
        /// Those that have a value for the first time.
        new_parameters: Vec<Parameter>,
        /// Those that have another one.
        changed_parameters: Vec<Parameter>,
        /// Those that have none any more.
        deleted_parameters: Vec<Parameter>,
    }
    /// Values that a number may have.
    "rcl_interfaces/msg/FloatingPointRange" FloatingPointRange {
        /// Least.
        from_value: f64,
        /// Greatest.
        to_value: f64,
        /// 0: all between.
        step: f64,
    }
    /// Values that an integer may have.
    "rcl_interfaces/msg/IntegerRange" IntegerRange {
        /// Least.
        from_value: i64,
        /// Greatest.
        to_value: i64,
        /// 0 is 1.
        step: u64,
    }
    /// What a parameter is.
    "rcl_interfaces/msg/ParameterDescriptor" ParameterDescriptor {
        /// Its name.
        name: String,
        /// As in its values.
        kind as "type": u8,
        /// What it does.
        description: String,
        /// What ranges do not say.
        additional_constraints: String,
        /// It cannot be set.
        read_only: bool,
        /// Its type may change.
        dynamic_typing: bool,
        /// Of a double.
        floating_point_range: Option<FloatingPointRange>,
        /// Of an integer.
        integer_range: Option<IntegerRange>,
    }
    /// Whether a parameter was set.
    "rcl_interfaces/msg/SetParametersResult" SetParametersResult {
        /// It was.
        successful: bool,
        /// Why not.
        reason: String,
    }
    /// Names of parameters.
    "rcl_interfaces/msg/ListParametersResult" ListParametersResult {
        /// The parameters.
        names: Vec<String>,
        /// What stands before dots in them.
        prefixes: Vec<String>,
    }
    /// The parameters there are.
    "rcl_interfaces/srv/ListParameters_Response" Listed {
        /// Their names.
        result: ListParametersResult,
    }
    /// What parameters are.
    "rcl_interfaces/srv/DescribeParameters_Response" Described {
        /// In the order of the question.
        descriptors: Vec<ParameterDescriptor>,
    }
    /// Values of parameters.
    "rcl_interfaces/srv/GetParameters_Response" Values {
        /// In the order of the question.
        values: Vec<ParameterValue>,
    }
    /// Types of parameters.
    "rcl_interfaces/srv/GetParameterTypes_Response" Types {
        /// In the order of the question.
        types: Vec<u8>,
    }
    /// Whether each parameter was set.
    "rcl_interfaces/srv/SetParameters_Response" Set {
        /// In the order of the request.
        results: Vec<SetParametersResult>,
    }
    /// Whether all parameters were set.
    "rcl_interfaces/srv/SetParametersAtomically_Response" SetAtomically {
        /// It.
        result: SetParametersResult,
    }
    /// The identity of a goal.
    "unique_identifier_msgs/msg/UUID" Uuid {
        /// Chosen by the client.
        uuid: [u8; 16],
    }
    /// A goal.
    "action_msgs/msg/GoalInfo" GoalInfo {
        /// Its identity.
        goal_id: Uuid,
        /// When it was accepted.
        stamp: Time,
    }
    /// How a goal stands.
    "action_msgs/msg/GoalStatus" GoalStatus {
        /// The goal.
        goal_info: GoalInfo,
        /// 2 executing, 3 canceling, 4 succeeded, 5 canceled, 6 aborted.
        status: i8,
    }
    /// How the goals stand.
    "action_msgs/msg/GoalStatusArray" GoalStatusArray {
        /// Those that are known.
        status_list: Vec<GoalStatus>,
    }
    /// Which goals are canceled.
    "action_msgs/srv/CancelGoal_Response" Canceled {
        /// 0 none or some are, 1 refused, 2 unknown goal, 3 it has ended.
        return_code: i8,
        /// They.
        goals_canceling: Vec<GoalInfo>,
    }
    /// A pose in a frame, at an instant.
    "geometry_msgs/msg/PoseStamped" PoseStamped {
        /// When; the frame.
        header: Header,
        /// The pose.
        pose: Pose,
    }
    /// Whether a goal is accepted.
    "nav2_msgs/action/NavigateToPose_SendGoal_Response" Accepted {
        /// It is.
        accepted: bool,
        /// When.
        stamp: Time,
    }
    /// How a goal has ended. Humble has an empty result, Jazzy no text.
    "nav2_msgs/action/NavigateToPose_Result" NavigateResult {
        /// 0, or 9000: see the text.
        error_code: u16,
        /// Why it was not reached.
        error_msg: String,
    }
    /// The same, with its status.
    "nav2_msgs/action/NavigateToPose_GetResult_Response" Ended {
        /// 0 unknown, else as in [`GoalStatus`].
        status: i8,
        /// The result.
        result: NavigateResult,
    }
    /// How far the robot has come. The last two are not there before Lyrical.
    "nav2_msgs/action/NavigateToPose_Feedback" NavigateFeedback {
        /// Where it is.
        current_pose: PoseStamped,
        /// Since the goal was accepted.
        navigation_time: Duration,
        /// If it goes on as up to now; 0 as long as it has come no nearer.
        estimated_time_remaining: Duration,
        /// 0.
        number_of_recoveries: i16,
        /// In a straight line [m].
        distance_remaining: f32,
        /// Not known: 0 [m].
        position_tracking_error: f32,
        /// Not known: 0 [rad].
        heading_tracking_error: f32,
    }
    /// The same, of a goal.
    "nav2_msgs/action/NavigateToPose_FeedbackMessage" FeedbackMessage {
        /// The goal.
        goal_id: Uuid,
        /// How far.
        feedback: NavigateFeedback,
    }
    /// [`NavigateFeedback`] before Lyrical.
    "nav2_msgs/action/NavigateToPose_Feedback" EarlierFeedback {
        /// Where it is.
        current_pose: PoseStamped,
        /// Since the goal was accepted.
        navigation_time: Duration,
        /// If it goes on as up to now.
        estimated_time_remaining: Duration,
        /// 0.
        number_of_recoveries: i16,
        /// In a straight line [m].
        distance_remaining: f32,
    }
    /// [`FeedbackMessage`] before Lyrical: its bytes begin so, and its hash is that of distributions which are tested.
    "nav2_msgs/action/NavigateToPose_FeedbackMessage" EarlierFeedbackMessage {
        /// The goal.
        goal_id: Uuid,
        /// How far.
        feedback: EarlierFeedback,
    }
}
