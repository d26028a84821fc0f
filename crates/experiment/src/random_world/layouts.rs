//! Groups of boxes that touch each other, around (0, 0), and their placement.

use super::dice::Dice;
use rumbo_plant::world::{Block, Point};
use std::f64::consts::FRAC_PI_3;

/// Smallest and largest side of a box [m].
const SIDE_M: (f64, f64) = (0.2, 0.6);
/// Thickness of the walls of an L, a U or a ring [m].
const THICKNESS_M: (f64, f64) = (0.1, 0.25);
/// Depth of a touch [shares of a box's half side]: boxes drawn together on purpose leave no slit.
const OVERLAP: f64 = 0.1;

/// A group of any kind.
pub(super) fn group(dice: &mut Dice) -> Vec<Block> {
    match dice.whole(0.0, 9.0) {
        0..=3 => single(dice),
        4..=5 => touching(dice),
        6..=7 => l_shape(dice),
        _ => u_shape(dice),
    }
}

fn upright(center_m: Point, size_m: [f64; 2]) -> Block {
    Block {
        center_m,
        size_m,
        heading_rad: 0.0,
    }
}

fn sides(dice: &mut Dice) -> [f64; 2] {
    [(); 2].map(|()| dice.within(SIDE_M.0, SIDE_M.1))
}

fn single(dice: &mut Dice) -> Vec<Block> {
    vec![upright([0.0; 2], sides(dice))]
}

/// Two to four boxes at random angles, each against a face of the previous one.
fn touching(dice: &mut Dice) -> Vec<Block> {
    let mut boxes = single(dice);
    for _ in 0..dice.whole(1.0, 3.0) {
        let before = boxes[boxes.len() - 1];
        let size_m = sides(dice);
        // The largest circle inside the new box reaches into the face of the old one.
        let away_m = 0.5 * (1.0 - OVERLAP) * size_m[0].min(size_m[1]);
        let axis = dice.whole(0.0, 1.0);
        let sign = if dice.chance(0.5) { 1.0 } else { -1.0 };
        let mut at = [0.0; 2];
        at[axis] = sign * (0.5 * before.size_m[axis] + away_m);
        at[1 - axis] = dice.within(-0.4, 0.4) * before.size_m[1 - axis];
        let [x, y] = turned(at, before.heading_rad);
        boxes.push(Block {
            center_m: [before.center_m[0] + x, before.center_m[1] + y],
            size_m,
            heading_rad: dice.angle_rad(),
        });
    }
    boxes
}

/// Two arms at a right angle; their corner is at the origin.
fn l_shape(dice: &mut Dice) -> Vec<Block> {
    let thickness_m = dice.within(THICKNESS_M.0, THICKNESS_M.1);
    let [one_m, other_m] = [(); 2].map(|()| dice.within(0.4, 1.2));
    vec![
        upright([0.5 * (one_m - thickness_m), 0.0], [one_m, thickness_m]),
        upright([0.0, 0.5 * (other_m - thickness_m)], [thickness_m, other_m]),
    ]
}

/// Open towards -x: a robot that goes along +x drives into it.
fn u_shape(dice: &mut Dice) -> Vec<Block> {
    let thickness_m = dice.within(THICKNESS_M.0, THICKNESS_M.1);
    let (inner_m, depth_m) = (dice.within(0.45, 0.9), dice.within(0.25, 0.7));
    let arm_m = depth_m + thickness_m;
    let arm = |side: f64| {
        upright(
            [
                0.5 * (thickness_m - arm_m),
                side * 0.5 * (inner_m + thickness_m),
            ],
            [arm_m, thickness_m],
        )
    };
    let base = upright([0.0, 0.0], [thickness_m, inner_m + 2.0 * thickness_m]);
    vec![base, arm(1.0), arm(-1.0)]
}

/// A box whose middle is deep inside, and sometimes others against it.
pub(super) fn solid(dice: &mut Dice) -> Vec<Block> {
    let size_m = [(); 2].map(|()| dice.within(0.4, 0.8));
    let mut boxes = vec![upright([0.0; 2], size_m)];
    if dice.chance(0.5) {
        let more = sides(dice);
        let away_m = 0.5 * (size_m[0] + (1.0 - OVERLAP) * more[0].min(more[1]));
        boxes.push(Block {
            center_m: [away_m, 0.0],
            size_m: more,
            heading_rad: dice.angle_rad(),
        });
    }
    boxes
}

/// Four walls without a gap.
pub(super) fn ring(dice: &mut Dice) -> Vec<Block> {
    let thickness_m = dice.within(THICKNESS_M.0, THICKNESS_M.1);
    let [x, y] = [(); 2].map(|()| dice.within(0.5, 0.9));
    let (across_m, beside_m) = (0.5 * (y + thickness_m), 0.5 * (x + thickness_m));
    let long = [x + 2.0 * thickness_m, thickness_m];
    let short = [thickness_m, y + thickness_m];
    vec![
        upright([0.0, across_m], long),
        upright([0.0, -across_m], long),
        upright([beside_m, 0.0], short),
        upright([-beside_m, 0.0], short),
    ]
}

/// A group about a point, which is within 5 cm of the middle of both.
pub(super) fn around(
    dice: &mut Dice,
    point_m: Point,
    layout: fn(&mut Dice) -> Vec<Block>,
) -> Vec<Block> {
    let boxes = layout(dice);
    let at = [0, 1].map(|axis| point_m[axis] + dice.within(-0.035, 0.035));
    placed(&boxes, at, dice.angle_rad())
}

/// A group across the line from a start to a goal; of the U's, half are open towards the start.
pub(super) fn across(
    dice: &mut Dice,
    start_m: Point,
    goal_m: Point,
) -> (Vec<Block>, Option<usize>) {
    let on_line = between(start_m, goal_m, dice.within(0.25, 0.75));
    let at = on_line.map(|place| place + dice.within(-0.1, 0.1));
    let (boxes, heading_rad) = if dice.chance(0.15) {
        let bearing_rad = libm::atan2(goal_m[1] - start_m[1], goal_m[0] - start_m[0]);
        let askew_rad = dice.within(-FRAC_PI_3, FRAC_PI_3);
        (u_shape(dice), bearing_rad + askew_rad)
    } else {
        (group(dice), dice.angle_rad())
    };
    (placed(&boxes, at, heading_rad), None)
}

/// The point that divides the line from one to the other; 0 is the first.
pub(super) fn between(from: Point, to: Point, part: f64) -> Point {
    [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]))
}

/// A group turned, then moved.
pub(super) fn placed(boxes: &[Block], at: Point, heading_rad: f64) -> Vec<Block> {
    boxes
        .iter()
        .map(|one| {
            let [x, y] = turned(one.center_m, heading_rad);
            Block {
                center_m: [at[0] + x, at[1] + y],
                heading_rad: one.heading_rad + heading_rad,
                ..*one
            }
        })
        .collect()
}

/// A vector turned counter-clockwise.
pub(super) fn turned(vector: Point, angle_rad: f64) -> Point {
    let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
    [
        cos * vector[0] - sin * vector[1],
        sin * vector[0] + cos * vector[1],
    ]
}
