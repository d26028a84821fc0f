//! The state machines of the modes as tables, for whoever draws them: what leads from which state to which. The modes themselves do not
//! use it; a test in `rumbo-scenario` runs every experiment and finds each change of state here.

use super::ModeId;

/// A way from one state of a mode to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// Number of the state that is left, as in telemetry.
    pub from: u8,
    /// Number of the state that follows.
    pub to: u8,
    /// When, in a few words.
    pub when: &'static str,
}

const fn way(from: u8, to: u8, when: &'static str) -> Transition {
    Transition { from, to, when }
}

const MANUAL: &[Transition] = &[
    way(0, 1, "a movement by duty"),
    way(0, 2, "a movement by speed"),
    way(1, 0, "stop"),
    way(1, 2, "a movement by speed"),
    way(2, 0, "stop"),
    way(2, 1, "a movement by duty"),
];

const FRONT_DISTANCE: &[Transition] = &[
    way(0, 1, "within 5 cm"),
    way(1, 0, "beyond 6 cm"),
    way(1, 2, "within the tolerance"),
    way(2, 0, "beyond 6 cm"),
    way(2, 1, "beyond twice the tolerance for 0.15 s"),
];

const FRONT_ALIGN: &[Transition] = &[
    way(0, 1, "the bearing is known"),
    way(1, 2, "within 5 cm"),
    way(2, 1, "beyond 6 cm"),
    way(2, 3, "within the tolerance, askew"),
    way(2, 4, "within the tolerance"),
    way(3, 2, "square"),
    way(4, 1, "beyond 6 cm"),
    way(4, 2, "beyond twice the tolerance for 0.15 s"),
    way(4, 3, "askew for 0.3 s"),
];

const WALL: &[Transition] = &[
    way(0, 1, "the distance is known, far from it"),
    way(0, 2, "the distance is known"),
    way(1, 2, "near the distance"),
    way(1, 3, "something ahead, or a sonar in doubt"),
    way(2, 1, "far from the distance"),
    way(2, 3, "something ahead, or a sonar in doubt"),
    way(3, 1, "clear again, far from the distance"),
    way(3, 2, "clear again"),
];

const WHEEL_SPEED: &[Transition] = &[
    way(0, 1, "a reference that is not zero"),
    way(1, 0, "both references are zero"),
];

const STRAIGHT_LINE: &[Transition] = &[
    way(0, 1, "both wheels stand and the reference is not zero"),
    way(1, 2, "the reference is zero or has the other sign"),
    way(2, 0, "slow enough"),
    way(2, 1, "the reference has the old sign again"),
];

const WAYPOINTS: &[Transition] = &[
    way(0, 1, "both wheels stand and there is a waypoint"),
    way(0, 2, "it faces the waypoint already"),
    way(0, 3, "pure pursuit"),
    way(0, 4, "at the waypoint already, which has a heading"),
    way(0, 5, "at the last waypoint already"),
    way(1, 2, "it faces the waypoint"),
    way(1, 3, "it faces the lookahead"),
    way(2, 0, "it stands at the waypoint"),
    way(2, 4, "it stands at the waypoint, which has a heading"),
    way(2, 5, "it stands at the last waypoint"),
    way(3, 0, "it stands at the waypoint"),
    way(3, 1, "it stands and the lookahead is far to a side"),
    way(3, 4, "it stands at the waypoint, which has a heading"),
    way(3, 5, "it stands at the last waypoint"),
    way(4, 0, "it faces the waypoint's heading"),
    way(4, 5, "it faces the last waypoint's heading"),
    way(5, 0, "a waypoint is appended"),
];

const MISSION: &[Transition] = &[
    way(0, 2, "a goal arrives"),
    way(2, 1, "the goal is not ahead"),
    way(2, 3, "it faces the goal"),
    way(1, 3, "it faces the goal"),
    way(3, 0, "it stands at the goal"),
    way(3, 4, "an obstacle ahead"),
    way(3, 8, "the obstacle that it has just left"),
    way(4, 5, "looked to the right"),
    way(5, 6, "looked to the left"),
    way(6, 8, "the shorter way round"),
    way(6, 3, "the way to the goal is clear"),
    way(6, 1, "the goal is not ahead"),
    way(7, 8, "it faces past the end"),
    way(7, 3, "the way to the goal is clear"),
    way(7, 1, "the goal is not ahead"),
    way(8, 9, "the sonar beside sees the obstacle"),
    way(8, 7, "the way past is far from ahead"),
    way(8, 3, "the way to the goal is clear"),
    way(8, 1, "the goal is not ahead"),
    way(9, 10, "the sonar beside loses the obstacle"),
    way(9, 7, "the way past is far from ahead"),
    way(9, 3, "the way to the goal is clear"),
    way(9, 1, "the goal is not ahead"),
    way(10, 8, "12.5 cm on"),
    way(10, 9, "the sonar beside sees the obstacle"),
    way(10, 7, "the way past is far from ahead"),
    way(10, 3, "the way to the goal is clear"),
    way(10, 1, "the goal is not ahead"),
    way(7, 11, "there is no way"),
    way(8, 11, "there is no way"),
    way(9, 11, "there is no way"),
    way(10, 11, "there is no way"),
    way(11, 2, "a goal arrives"),
    way(2, 12, "lane: begin"),
    way(12, 4, "lane: stands before a face"),
    way(6, 7, "lane: a quarter turn, or half a turn"),
    way(7, 12, "lane: it faces the heading"),
];

impl ModeId {
    /// The ways from state to state while the robot is armed; a command may lead back to the beginning at any time.
    pub const fn transitions(self) -> &'static [Transition] {
        match self {
            ModeId::Manual => MANUAL,
            ModeId::FrontDistance => FRONT_DISTANCE,
            ModeId::FrontAlign => FRONT_ALIGN,
            ModeId::WallHold | ModeId::WallFollow => WALL,
            ModeId::WheelSpeed => WHEEL_SPEED,
            ModeId::StraightLine => STRAIGHT_LINE,
            ModeId::Waypoints => WAYPOINTS,
            ModeId::Mission => MISSION,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_joins_two_states_that_the_mode_has_and_is_told_once() {
        for mode in ModeId::ALL {
            let states = mode.state_names().len();
            let ways = mode.transitions();
            for (index, way) in ways.iter().enumerate() {
                assert!(
                    usize::from(way.from.max(way.to)) < states,
                    "{mode:?} {way:?}"
                );
                assert_ne!(way.from, way.to, "{mode:?} {way:?}");
                let twice = ways[..index]
                    .iter()
                    .any(|other| (other.from, other.to) == (way.from, way.to));
                assert!(!twice, "{mode:?} {way:?}");
            }
        }
    }

    #[test]
    fn every_state_can_be_reached() {
        for mode in ModeId::ALL {
            let reached = |state: usize| {
                state == 0
                    || mode
                        .transitions()
                        .iter()
                        .any(|way| usize::from(way.to) == state)
            };
            for (state, name) in mode.state_names().iter().enumerate() {
                assert!(reached(state), "{mode:?} {name}");
            }
        }
    }
}
