//! Robots among what moves: arrangements drawn by seeds, how many robots arrive, and what is touched how fast.
//!
//! An arrangement is the text of a scenario and of its world, so that `rumbo run` can repeat it.

use crate::files::{FileError, Kind, Library, Overrides};
use crate::random_world::Dice;
use crate::run::{self, RunResult};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovingDraw {
    /// A goal 4 m ahead, across the way of the two people of the world `crossing`; the robot sets off at a drawn time.
    Crossing,
    /// A goal 4 m ahead, with two people of drawn places, sizes and speeds.
    People,
    /// So many robots in a room of 3 x 3 m: three go each to the next one's place, others to the one across.
    Room(usize),
}

impl MovingDraw {
    /// Those of the campaign.
    pub const ALL: [Self; 5] = [
        Self::Crossing,
        Self::People,
        Self::Room(3),
        Self::Room(4),
        Self::Room(6),
    ];

    /// The scenario of a seed, and its world if that is not a built-in one.
    #[must_use]
    pub fn draw(self, seed: u64) -> (String, Option<String>) {
        let dice = &mut Dice::new(seed);
        match self {
            Self::Crossing => (goal_ahead("crossing", dice.within(0.0, ROUND_S)), None),
            Self::People => (goal_ahead("drawn", 0.0), Some(people(dice))),
            Self::Room(robots) => (room(robots, dice), Some(ROOM.to_owned())),
        }
    }
}

impl std::fmt::Display for MovingDraw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Crossing => f.write_str("crossing"),
            Self::People => f.write_str("people"),
            Self::Room(robots) => write!(f, "room{robots}"),
        }
    }
}

const ROOM: &str = "\
title = \"A room\"
[arena]
from_m = [-1.5, -1.5]
to_m = [1.5, 1.5]
walled = true
";

/// The slower one of `crossing` is back where it was, and goes the same way, after this time [s].
const ROUND_S: f64 = 26.0;
/// Time in which the robots are to arrive [s].
const TIME_S: f64 = 120.0;

/// The head of a scenario in a world, with its limit; the robots set off after a wait.
fn head(world: &str, wait_s: f64) -> String {
    let duration_s = TIME_S + wait_s;
    format!(
        "title = \"What moves in mode 8\"\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"{world}\"\nmode = \"mission\"\n\
         duration_s = {duration_s:.2}\ncalibrated = true\n[limits]\n\"contact_speed_m_s\" = {{ max = 0.1 }}\n"
    )
}

/// Sends a goal, and ON.
fn commands(table: &str, [x_m, y_m]: [f64; 2], wait_s: f64) -> String {
    let [goal_s, on_s] = [0.4, 0.5].map(|at_s| at_s + wait_s);
    format!(
        "[[{table}]]\nat_s = {goal_s:.2}\ngoal_m = [{x_m:.3}, {y_m:.3}]\n[[{table}]]\nat_s = {on_s:.2}\narm = true\n"
    )
}

fn goal_ahead(world: &str, wait_s: f64) -> String {
    head(world, wait_s) + &commands("command", [4.0, 0.0], wait_s)
}

/// Two who cross the way to a goal 4 m ahead, back and forth.
fn people(dice: &mut Dice) -> String {
    let mut world =
        "title = \"Two people\"\n[arena]\nfrom_m = [-0.5, -1.5]\nto_m = [4.5, 1.5]\n".to_owned();
    for middle_m in [1.3, 2.7] {
        let [from_m, to_m] = [(); 2].map(|()| middle_m + dice.within(-0.3, 0.3));
        let side = if dice.chance(0.5) { 1.2 } else { -1.2 };
        let body = if dice.chance(0.5) {
            format!("diameter_m = {:.3}", dice.within(0.2, 0.4))
        } else {
            let [long_m, wide_m] = [dice.within(0.2, 0.5), dice.within(0.15, 0.3)];
            format!("size_m = [{long_m:.3}, {wide_m:.3}]")
        };
        let [speed_m_s, pause_s, start_s] = [
            dice.within(0.2, 0.5),
            dice.within(0.5, 2.0),
            dice.within(0.0, 4.0),
        ];
        world += &format!(
            "[[mover]]\n{body}\npath_m = [[{from_m:.3}, {side}], [{to_m:.3}, {}]]\nspeed_m_s = {speed_m_s:.3}\n\
             pause_s = {pause_s:.3}\nstart_s = {start_s:.3}\nrepeat = \"back_and_forth\"\n",
            -side
        );
    }
    world
}

/// Robots around the middle of a room, each nearly facing its goal.
fn room(robots: usize, dice: &mut Dice) -> String {
    let corners = robots == 4;
    let turn_rad = if corners {
        TAU / 8.0
    } else {
        dice.within(0.0, TAU)
    };
    let places_m: Vec<[f64; 2]> = (0..robots)
        .map(|robot| {
            let angle_rad = turn_rad + TAU * robot as f64 / robots as f64;
            let radius_m = if corners { 1.41 } else { 1.1 };
            [angle_rad.cos(), angle_rad.sin()].map(|of| radius_m * of + dice.within(-0.1, 0.1))
        })
        .collect();
    let on = if robots == 3 { 1 } else { robots / 2 };
    let mut text = head("drawn", 0.0);
    for (robot, [x_m, y_m]) in places_m.iter().enumerate() {
        let [to_x_m, to_y_m] = places_m[(robot + on) % robots];
        let (dx_m, dy_m) = (to_x_m - x_m, to_y_m - y_m);
        let heading_rad = dy_m.atan2(dx_m) + dice.within(-0.3, 0.3);
        let (sin, cos) = heading_rad.sin_cos();
        let goal_m = [dx_m * cos + dy_m * sin, dy_m * cos - dx_m * sin];
        text += &format!(
            "[[fleet]]\nname = \"r{robot}\"\nstart = {{ x_m = {x_m:.3}, y_m = {y_m:.3}, heading_deg = {:.2} }}\n",
            heading_rad.to_degrees()
        );
        text += &commands("fleet.command", goal_m, 0.0);
    }
    text
}

/// What became of a seed's robots.
#[derive(Clone, Debug)]
pub struct MovingOutcome {
    /// How many robots there were.
    pub robots: usize,
    /// How many of them arrived in time.
    pub arrived: usize,
    /// Fastest touch of the run [m/s]; 0 without one.
    pub fastest_m_s: f64,
}

/// Runs a place with these seeds, on all cores; in order of seeds.
///
/// # Errors
/// An arrangement that does not fit together.
pub fn drive(
    place: MovingDraw,
    seeds: std::ops::Range<u64>,
) -> Result<Vec<MovingOutcome>, FileError> {
    seeds
        .into_par_iter()
        .map(|seed| {
            let (scenario, world) = place.draw(seed);
            let mut library = Library::new().holding(Kind::Scenario, "moving", &scenario);
            if let Some(world) = world {
                library = library.holding(Kind::World, "drawn", &world);
            }
            let result = run::run(&library.setup("moving", &Overrides::default())?, seed)?;
            Ok(MovingOutcome::of(&result))
        })
        .collect()
}

impl MovingOutcome {
    fn of(result: &RunResult) -> Self {
        let fastest_m_s = result.metrics.get("contact_speed_m_s").copied();
        let alone = result.robots.is_empty();
        let arrived = if alone { "reached" } else { "arrived" };
        let arrived = result.metrics.get(arrived).copied().unwrap_or_default();
        Self {
            robots: result.robots.len().max(1),
            arrived: arrived as usize,
            fastest_m_s: fastest_m_s.filter(|speed| speed.is_finite()).unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_can_be_drawn_and_seeds_differ() {
        for place in MovingDraw::ALL {
            let drawn = [1, 2].map(|seed| place.draw(seed));
            assert_ne!(drawn[0], drawn[1], "{place}");
            for (scenario, world) in drawn {
                let library = Library::new()
                    .holding(Kind::Scenario, "moving", &scenario)
                    .holding(Kind::World, "drawn", &world.unwrap_or_default());
                let setup = library.setup("moving", &Overrides::default()).unwrap();
                let robots = if let MovingDraw::Room(robots) = place {
                    robots
                } else {
                    1
                };
                assert_eq!(setup.robots().len(), robots);
            }
        }
    }
}
