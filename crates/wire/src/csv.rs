//! The original's recorded runs: files of text rows under a header that names the columns, units included.
//!
//! Recognise the header with [`recognise`], then read each line with [`Row::parse_as`](crate::text::Row::parse_as).

use crate::text::RowKind;

/// A column of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name in the header, which ends in the unit: `left_cm`.
    pub name: &'static str,
    /// Its unit; empty for plain numbers.
    pub unit: &'static str,
}

const fn column(name: &'static str, unit: &'static str) -> Column {
    Column { name, unit }
}

const DT: Column = column("dt_ms", "ms");
const SPEED_A: Column = column("speed_a_rpm", "rpm");
const SPEED_B: Column = column("speed_b_rpm", "rpm");
const REFERENCE_A: Column = column("reference_a_rpm", "rpm");
const REFERENCE_B: Column = column("reference_b_rpm", "rpm");
const X: Column = column("x_m", "m");
const Y: Column = column("y_m", "m");
const HEADING: Column = column("heading_deg", "deg");
const LEFT: Column = column("left_cm", "cm");
const RIGHT: Column = column("right_cm", "cm");
const MODE: Column = column("mode", "");
const PWM_A: Column = column("pwm_a", "");
const PWM_B: Column = column("pwm_b", "");

static DISTANCE: [Column; 7] = [
    DT,
    LEFT,
    RIGHT,
    column("reference_cm", "cm"),
    MODE,
    PWM_A,
    PWM_B,
];
static SPEED: [Column; 7] = [
    DT,
    SPEED_A,
    SPEED_B,
    column("reference_rpm", "rpm"),
    MODE,
    PWM_A,
    PWM_B,
];
static WAYPOINTS: [Column; 10] = [
    DT,
    SPEED_A,
    SPEED_B,
    REFERENCE_A,
    REFERENCE_B,
    X,
    Y,
    HEADING,
    PWM_A,
    PWM_B,
];
static MISSION: [Column; 13] = [
    DT,
    REFERENCE_A,
    REFERENCE_B,
    column("heading_reference_deg", "deg"),
    column("goal_x_m", "m"),
    column("goal_y_m", "m"),
    X,
    Y,
    HEADING,
    column("state", ""),
    RIGHT,
    LEFT,
    column("front_cm", "cm"),
];

impl RowKind {
    /// All kinds.
    pub const ALL: [RowKind; 4] = [
        RowKind::Distance,
        RowKind::Speed,
        RowKind::Waypoints,
        RowKind::Mission,
    ];

    /// The columns, in order.
    pub fn columns(self) -> &'static [Column] {
        match self {
            RowKind::Distance => &DISTANCE,
            RowKind::Speed => &SPEED,
            RowKind::Waypoints => &WAYPOINTS,
            RowKind::Mission => &MISSION,
        }
    }
}

/// The kind of rows under a header (the first line of a file); blanks, a byte-order mark and the line's end are
/// ignored. `None` if it is not the original's.
pub fn recognise(header: &str) -> Option<RowKind> {
    let header = header.trim_start_matches('\u{feff}');
    RowKind::ALL.into_iter().find(|kind| {
        header
            .split(',')
            .map(str::trim)
            .eq(kind.columns().iter().map(|column| column.name))
    })
}
