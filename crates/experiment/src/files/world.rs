//! A world file: the walls and boxes that the robot drives among.
//!
//! ```toml
//! title = "A wall across the way"
//! goal_m = [1.2, 0.5]    # of scenarios with goal = "world"
//! north_deg = 90         # where a compass points, counter-clockwise from x
//! [arena]                # what the map shows; walled = true puts a wall along each side
//! from_m = [-0.5, -1.0]
//! to_m = [1.5, 1.0]
//! [[wall]]
//! from_m = [1.2, -1.0]
//! to_m = [1.2, 1.0]
//! [[box]]
//! centre_m = [0.5, 0.6]
//! size_m = [0.4, 0.3]
//! angle_deg = 20
//! [[line]]               # dark lines on the floor: see `line.rs`
//! points_m = [[0, 0], [1, 0]]
//! [[lamp]]               # lamps: see `light.rs`
//! at_m = [0.9, -0.5]
//! [[mover]]              # bodies that move: see `mover.rs`
//! diameter_m = 0.3
//! path_m = [[0.8, -0.9], [0.8, 0.9]]
//! speed_m_s = 0.3
//! [start]                # in place of the scenario's
//! x_m = 0.2
//! heading_deg = 90
//! [random]               # groups of boxes and a goal besides, others for each seed; each key has a default
//! groups = [2, 6]
//! goal_away_m = [2, 4]
//! unreachable = 0.1      # share of the seeds
//! blocked = 0.8          # share of the others with something across the straight line
//! ```

use super::error::FileError;
use super::light::read_light;
use super::line::read_lines;
use super::mover::{MOST_MOVERS, Mover, read_mover};
use super::read::{Allowed, Source, Table};
use super::scenario::{StartPose, read_start};
use super::value::{ANGLE, PLACE, SIDE};
use crate::random_world::{Journey, RandomWorld};
use rumbo_plant::world::{Block, Point, ShapeError, Wall, World};
use rumbo_sim::floor::DarkLine;
use rumbo_sim::light::Light;

/// Each ray of a sonar meets all of them.
const MOST_SHAPES: usize = 1_000;
/// North is up on the map, along y.
const NORTH_DEG: f64 = 90.0;
const GROUPS: Allowed = Allowed::new(0.0, 20.0, "count");
const AWAY: Allowed = Allowed::new(0.5, 15.0, "m");
const SHARE: Allowed = Allowed::new(0.0, 1.0, "");
const THICKNESS: Allowed = Allowed::new(0.0, 1.0, "m");

/// A world, as `worlds/*.toml` describes it. World frame: x and y in metres, angles counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldFile {
    /// Its name in scenarios and commands: the file's name without `.toml`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// The part of the world that a map shows.
    pub arena: Arena,
    /// Straight walls, the arena's own four included where it is walled.
    pub walls: Vec<Wall>,
    /// Boxes, solid.
    pub boxes: Vec<Block>,
    /// Dark lines on the floor.
    pub lines: Vec<DarkLine>,
    /// Its lamps, and the light of the room.
    pub light: Light,
    /// What moves.
    pub movers: Vec<Mover>,
    /// Where the robot starts, in place of the scenario's start.
    pub start: Option<StartPose>,
    /// The goal, for scenarios whose goal is that of the world, in m.
    pub goal_m: Option<Point>,
    /// Where magnetic north is, counter-clockwise from the x axis, in rad.
    pub north_rad: f64,
    /// What every seed adds at random.
    pub random: Option<RandomWorld>,
    /// The goal of the world or of a seed's random one, and the true shortest path to it.
    pub journey: Option<Journey>,
}

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arena {
    /// The corner of smallest x and y, in m.
    pub from_m: [f64; 2],
    /// The corner of largest x and y, in m.
    pub to_m: [f64; 2],
}

impl WorldFile {
    /// Reads a world.
    ///
    /// # Errors
    /// All problems of the text, by line of `file`.
    pub fn parse(name: &str, file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let title = root
            .required_text("title", "one line that says what the world is")
            .value;
        let (arena, mut walls) = read_arena(&root.table("arena"));
        walls.extend(root.tables("wall", MOST_SHAPES).into_iter().map(read_wall));
        let boxes: Vec<Block> = root
            .tables("box", MOST_SHAPES)
            .into_iter()
            .map(read_box)
            .collect();
        let movers = root
            .tables("mover", MOST_MOVERS)
            .iter()
            .filter_map(|table| {
                let mover = read_mover(table)?;
                begins_free(table, &mover, &walls, &boxes);
                Some(mover)
            })
            .collect();
        let lines = read_lines(&root);
        let light = read_light(&root);
        let random = root
            .has("random")
            .then(|| read_random(&root.table("random")));
        let start = root.has("start").then(|| read_start(&root.table("start")));
        let goal_m = root.pair("goal_m", PLACE);
        let north_deg = root.number("north_deg", ANGLE).unwrap_or(NORTH_DEG);
        if random.is_some() && goal_m.is_some() {
            root.complain_here("goal_m: [random] draws a goal; leave one of them out");
        }
        root.finish();
        source.verdict()?;
        Ok(Self {
            name: name.into(),
            title,
            text: text.into(),
            arena,
            walls,
            boxes,
            lines,
            light,
            movers,
            start,
            goal_m,
            north_rad: north_deg.to_radians(),
            random,
            journey: None,
        })
    }

    /// The obstacles and what moves in the plant's form.
    ///
    /// # Errors
    /// A shape without size; a parsed file has none.
    pub fn world(&self) -> Result<World, ShapeError> {
        let mut world = World::new(&self.walls, &self.boxes)?;
        for mover in &self.movers {
            world.add_body(mover.body()?)?;
        }
        Ok(world)
    }
}

/// Reports a mover that starts in a wall or a box; the hinge of a door may be in one.
fn begins_free(table: &Table<'_, '_>, mover: &Mover, walls: &[Wall], boxes: &[Block]) {
    let (Ok(body), Ok(world)) = (mover.body(), World::new(walls, boxes)) else {
        return;
    };
    let outline = body.outline(&body.at(0).pose);
    if !mover.is_door && world.obstacles().iter().any(|each| each.overlaps(&outline)) {
        table.complain_here("starts inside a wall or box; move the first point of its path_m");
    }
}

fn read_arena(table: &Table<'_, '_>) -> (Arena, Vec<Wall>) {
    let [x0, y0] = table.pair("from_m", PLACE).unwrap_or([-2.0, -2.0]);
    let [x1, y1] = table.pair("to_m", PLACE).unwrap_or([2.0, 2.0]);
    if x0 >= x1 || y0 >= y1 {
        table.complain_here(
            "from_m must be the corner of smaller x and y, to_m that of larger x and y",
        );
    }
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
    let walled = table.flag("walled").is_some_and(|flag| flag.value);
    let sides = corners.windows(2).filter(|_| walled);
    let walls = sides
        .map(|ends| Wall {
            from_m: ends[0],
            to_m: ends[1],
            thickness_m: 0.0,
        })
        .collect();
    table.finish();
    (
        Arena {
            from_m: [x0, y0],
            to_m: [x1, y1],
        },
        walls,
    )
}

fn read_random(table: &Table<'_, '_>) -> RandomWorld {
    let usual = RandomWorld::default();
    let span = |key: &str, allowed: Allowed, usual: [f64; 2]| {
        let [low, high] = table.pair(key, allowed).unwrap_or(usual);
        if low > high {
            table.complain_here(&format!("{key}: the smaller value comes first"));
        }
        [low, high]
    };
    let random = RandomWorld {
        groups: span("groups", GROUPS, usual.groups),
        goal_away_m: span("goal_away_m", AWAY, usual.goal_away_m),
        unreachable: table
            .number("unreachable", SHARE)
            .unwrap_or(usual.unreachable),
        blocked: table.number("blocked", SHARE).unwrap_or(usual.blocked),
    };
    table.finish();
    random
}

fn read_wall(table: Table<'_, '_>) -> Wall {
    let from_m = table.required_pair("from_m", PLACE);
    let to_m = table.required_pair("to_m", PLACE);
    let thickness_m = table.number("thickness_m", THICKNESS).unwrap_or(0.0);
    if table.has("from_m") && table.has("to_m") && from_m == to_m {
        table.complain_here("from_m and to_m are the same point: a wall needs two different ends");
    }
    table.finish();
    Wall {
        from_m,
        to_m,
        thickness_m,
    }
}

fn read_box(table: Table<'_, '_>) -> Block {
    let center_m = table.required_pair("centre_m", PLACE);
    let size_m = table.required_pair("size_m", SIDE);
    let angle_deg = table.number("angle_deg", ANGLE).unwrap_or(0.0);
    table.finish();
    Block {
        center_m,
        size_m,
        heading_rad: angle_deg.to_radians(),
    }
}
