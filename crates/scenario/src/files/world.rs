//! A world file: the walls and boxes that the robot drives among.

/// A world, as `worlds/*.toml` describes it. World frame: x and y in metres, angles counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldFile {
    /// The name by which scenarios and commands call it: the file's name without `.toml`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// The part of the world that a map shows.
    pub arena: Arena,
    /// Straight walls without thickness, the arena's own four included where it is walled.
    pub walls: Vec<WallSegment>,
    /// Boxes, solid.
    pub boxes: Vec<BoxShape>,
}

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arena {
    /// The corner of smallest x and y [m].
    pub from_m: [f64; 2],
    /// The corner of largest x and y [m].
    pub to_m: [f64; 2],
}

/// A straight wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSegment {
    /// One end, x and y [m].
    pub from_m: [f64; 2],
    /// The other end, x and y [m].
    pub to_m: [f64; 2],
}

/// A rectangular box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxShape {
    /// Its middle, x and y [m].
    pub centre_m: [f64; 2],
    /// Its sides, along x and y before it is turned [m].
    pub size_m: [f64; 2],
    /// How far it is turned, counter-clockwise [rad].
    pub angle_rad: f64,
}
