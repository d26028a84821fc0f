//! The states of mode 8 and how they follow one another.

use crate::drawing::machine::{Machine, State, Transition};
use crate::text::{Text, same, word};

/// The states' names, in the order of their numbers.
pub(super) const STATES: [Text; 13] = [
    word("wait-for-goal"),
    word("initial-turn"),
    word("initialise"),
    word("go-to-goal"),
    word("sweep-right"),
    word("sweep-left"),
    word("decide"),
    word("avoidance-turn"),
    word("advance-seek-the-obstacle"),
    word("advance-along-it"),
    word("advance-safe-distance"),
    word("unreachable"),
    word("straight-on"),
];

/// The states of the original program in a lane, which numbers them from 0 again.
pub(super) const ORIGINAL_LANE: [Text; 5] =
    [STATES[12], STATES[4], STATES[5], STATES[6], STATES[7]];

/// A goal around obstacles.
pub(super) const GOAL: Machine = Machine {
    size: (720.0, 410.0),
    states: &[
        State {
            x: 80.0,
            y: 60.0,
            width: 140.0,
            lines: &[STATES[0]],
        },
        State {
            x: 271.0,
            y: 60.0,
            width: 110.0,
            lines: &[STATES[2]],
        },
        State {
            x: 425.0,
            y: 60.0,
            width: 110.0,
            lines: &[STATES[1]],
        },
        State {
            x: 630.0,
            y: 60.0,
            width: 140.0,
            lines: &[STATES[3]],
        },
        State {
            x: 630.0,
            y: 165.0,
            width: 160.0,
            lines: &[STATES[4], STATES[5]],
        },
        State {
            x: 630.0,
            y: 275.0,
            width: 100.0,
            lines: &[STATES[6]],
        },
        State {
            x: 370.0,
            y: 275.0,
            width: 200.0,
            lines: &[STATES[8], STATES[9], STATES[10]],
        },
        State {
            x: 370.0,
            y: 380.0,
            width: 140.0,
            lines: &[STATES[7]],
        },
        State {
            x: 80.0,
            y: 275.0,
            width: 120.0,
            lines: &[STATES[11]],
        },
    ],
    transitions: &[
        Transition {
            way: &[(150.0, 60.0), (216.0, 60.0)],
            at: (155.0, 52.0),
            condition: &[word("goal")],
        },
        Transition {
            way: &[(326.0, 60.0), (370.0, 60.0)],
            at: (0.0, -20.0),
            condition: &[],
        },
        Transition {
            way: &[(480.0, 60.0), (560.0, 60.0)],
            at: (484.0, 50.0),
            condition: &[word("faces-it")],
        },
        Transition {
            way: &[(630.0, 45.0), (630.0, 18.0), (80.0, 18.0), (80.0, 45.0)],
            at: (330.0, 13.0),
            condition: &[word("reached")],
        },
        Transition {
            way: &[(630.0, 75.0), (630.0, 143.0)],
            at: (500.0, 108.0),
            condition: &[word("obstacle-ahead")],
        },
        Transition {
            way: &[(630.0, 188.0), (630.0, 260.0)],
            at: (520.0, 228.0),
            condition: &[word("both-edges-seen")],
        },
        Transition {
            way: &[(580.0, 275.0), (470.0, 275.0)],
            at: (478.0, 266.0),
            condition: &[word("side-chosen")],
        },
        Transition {
            way: &[(330.0, 305.0), (330.0, 365.0)],
            at: (180.0, 339.0),
            condition: &[word("direction-40-off")],
        },
        Transition {
            way: &[(410.0, 365.0), (410.0, 305.0)],
            at: (418.0, 339.0),
            condition: &[word("faces-it")],
        },
        Transition {
            way: &[(425.0, 245.0), (425.0, 75.0)],
            at: (262.0, 150.0),
            condition: &[word("way-to-the-goal-clear"), word("nearer-than-before")],
        },
        Transition {
            way: &[(270.0, 275.0), (140.0, 275.0)],
            at: (150.0, 252.0),
            condition: &[word("whole-outline"), same("")],
        },
        Transition {
            way: &[(80.0, 260.0), (80.0, 75.0)],
            at: (88.0, 170.0),
            condition: &[word("new-goal")],
        },
    ],
};

/// A lane.
pub(super) const LANE: Machine = Machine {
    size: (700.0, 200.0),
    states: &[
        State {
            x: 90.0,
            y: 40.0,
            width: 130.0,
            lines: &[STATES[12]],
        },
        State {
            x: 350.0,
            y: 40.0,
            width: 160.0,
            lines: &[STATES[4]],
        },
        State {
            x: 600.0,
            y: 40.0,
            width: 160.0,
            lines: &[STATES[5]],
        },
        State {
            x: 600.0,
            y: 150.0,
            width: 110.0,
            lines: &[STATES[6]],
        },
        State {
            x: 350.0,
            y: 150.0,
            width: 140.0,
            lines: &[STATES[7]],
        },
    ],
    transitions: &[
        Transition {
            way: &[(155.0, 40.0), (270.0, 40.0)],
            at: (162.0, 30.0),
            condition: &[word("face-at-25-cm")],
        },
        Transition {
            way: &[(430.0, 40.0), (520.0, 40.0)],
            at: (436.0, 16.0),
            condition: &[word("jump-of-30-cm"), word("or-86")],
        },
        Transition {
            way: &[(600.0, 55.0), (600.0, 135.0)],
            at: (490.0, 98.0),
            condition: &[word("jump-or-86")],
        },
        Transition {
            way: &[(545.0, 150.0), (420.0, 150.0)],
            at: (434.0, 140.0),
            condition: &[word("to-the-open-side")],
        },
        Transition {
            way: &[(280.0, 150.0), (90.0, 150.0), (90.0, 55.0)],
            at: (110.0, 140.0),
            condition: &[word("faces-it-at-rest")],
        },
    ],
};
