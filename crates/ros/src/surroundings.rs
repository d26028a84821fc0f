//! What surrounds a robot, for displays and planners: the world as a map and as walls, the goals and the way driven, and
//! the sonars as one scan.

use crate::geometry::{BASE, BodyGeometry, LEAST_M, MAP, ODOM, pose};
use crate::messages::{
    Color, Header, LaserScan, MapMetaData, Marker, Markers, OccupancyGrid, Point, Time, Vector3,
};
use rumbo_log::{MapPose, SceneObstacle};
use std::f64::consts::{PI, TAU};

/// Side of a map's cell [m]; twice that, and so on, for a world of more than [`MOST_CELLS`].
const CELL_M: f64 = 0.05;
/// Cells along x or y.
const MOST_CELLS: f64 = 1024.0;
/// Free floor around what stands in the world [m].
const MARGIN_M: f64 = 0.5;
/// The same around the robot's start [m].
const FLOOR_M: f64 = 3.0;
/// What is further away is no part of a world [m].
const FAR_M: f64 = 1e5;
/// Cells.
const FREE: i8 = 0;
const OCCUPIED: i8 = 100;

/// Height and thickness of walls in drawings [m].
const WALL_HEIGHT_M: f64 = 0.2;
const WALL_WIDTH_M: f64 = 0.02;
/// What a marker is, and what is to be done with it.
const CUBE: i32 = 1;
const LINE_STRIP: i32 = 4;
const SPHERE_LIST: i32 = 7;
const DELETE: i32 = 2;
const DELETE_ALL: i32 = 3;

/// The way has a place after this distance [m]; twice that, and so on, when it has [`MOST_PLACES`].
const APART_M: f64 = 0.03;
const MOST_PLACES: usize = 1_000;
/// It is shown this often at most [ms].
const SHOWN_MS: i64 = 1_000;

/// Directions of a scan.
const DIRECTIONS: usize = 360;

/// The sides of an obstacle, by their ends.
fn sides(obstacle: &SceneObstacle) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let corners = &obstacle.corners_m;
    let next = corners.iter().skip(1);
    let next = next.chain(corners.first().filter(|_| obstacle.closed));
    corners.iter().copied().zip(next.copied())
}

/// What stands in the world, without what no world has.
fn sound(obstacles: &[SceneObstacle]) -> impl Iterator<Item = &SceneObstacle> {
    let is_near = |corner: &[f64; 2]| corner.iter().all(|at| at.abs() < FAR_M);
    obstacles
        .iter()
        .filter(move |obstacle| obstacle.corners_m.iter().all(is_near))
}

fn header(stamp: &Time, frame: &str) -> Header {
    Header {
        stamp: stamp.clone(),
        frame_id: frame.to_owned(),
    }
}

/// The world as a map of cells: all that stands in it, and the floor around the robot's start.
pub(crate) fn map(stamp: &Time, obstacles: &[SceneObstacle], start: MapPose) -> OccupancyGrid {
    let start = [start.x_m, start.y_m].map(|at| at.clamp(-FAR_M, FAR_M));
    let corners = || sound(obstacles).flat_map(|obstacle| &obstacle.corners_m);
    let fold = |of: fn(f64, f64) -> f64, floor_m: f64, margin_m: f64| {
        [0, 1].map(|axis: usize| {
            let corners = corners().map(|corner| corner[axis] + margin_m);
            corners.fold(start[axis] + floor_m, of)
        })
    };
    let low_m = fold(f64::min, -FLOOR_M, -MARGIN_M);
    let high_m = fold(f64::max, FLOOR_M, MARGIN_M);
    let longest_m = (high_m[0] - low_m[0]).max(high_m[1] - low_m[1]);
    let mut cell_m = CELL_M;
    while longest_m > MOST_CELLS * cell_m {
        cell_m *= 2.0;
    }
    // Whole cells from the frame's origin.
    let low_m = low_m.map(|at| (at / cell_m).floor() * cell_m);
    let [width, height] =
        [0, 1].map(|axis: usize| ((high_m[axis] - low_m[axis]) / cell_m).ceil() as usize);
    let mut data = vec![FREE; width * height];
    let mut occupy = |x_m: f64, y_m: f64| {
        let column = ((x_m - low_m[0]) / cell_m) as usize;
        let row = ((y_m - low_m[1]) / cell_m) as usize;
        if let Some(cell) = data.get_mut(row * width + column) {
            *cell = OCCUPIED;
        }
    };
    for obstacle in sound(obstacles) {
        for ([from_x, from_y], [to_x, to_y]) in sides(obstacle) {
            let (x_m, y_m) = (to_x - from_x, to_y - from_y);
            let steps = (x_m.hypot(y_m) / (0.5 * cell_m)).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let share = f64::from(step) / steps;
                occupy(from_x + share * x_m, from_y + share * y_m);
            }
        }
        if obstacle.closed {
            fill(obstacle, low_m, [width, height], cell_m, &mut occupy);
        }
    }
    let origin = MapPose {
        x_m: low_m[0],
        y_m: low_m[1],
        heading_rad: 0.0,
    };
    OccupancyGrid {
        header: header(stamp, MAP),
        info: MapMetaData {
            map_load_time: stamp.clone(),
            resolution: cell_m as f32,
            width: width as u32,
            height: height as u32,
            origin: pose(origin),
        },
        data,
    }
}

/// The cells whose middle is in a box: between each two sides that the line through the middles of a row crosses.
fn fill(
    obstacle: &SceneObstacle,
    low_m: [f64; 2],
    [width, height]: [usize; 2],
    cell_m: f64,
    occupy: &mut impl FnMut(f64, f64),
) {
    for row in 0..height {
        let y_m = low_m[1] + (row as f64 + 0.5) * cell_m;
        let crossings = sides(obstacle).filter_map(|([from_x, from_y], [to_x, to_y])| {
            let crosses = (from_y > y_m) != (to_y > y_m);
            crosses.then(|| from_x + (y_m - from_y) / (to_y - from_y) * (to_x - from_x))
        });
        let mut crossings: Vec<f64> = crossings.collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let column = |at: f64| ((at - low_m[0]) / cell_m - 0.5).ceil();
            for column in column(pair[0]) as usize..(column(pair[1]) as usize).min(width) {
                occupy(low_m[0] + (column as f64 + 0.5) * cell_m, y_m);
            }
        }
    }
}

fn marker(stamp: &Time, frame: &str, ns: &str, id: i32, kind: i32) -> Marker {
    Marker {
        header: header(stamp, frame),
        ns: ns.to_owned(),
        id,
        kind,
        pose: pose(MapPose::default()),
        ..Marker::default()
    }
}

/// A colour that nothing shines through.
fn color([r, g, b]: [f32; 3]) -> Color {
    Color { r, g, b, a: 1.0 }
}

/// Walls and boxes as they stand in the world, in place of those before.
pub(crate) fn walls(stamp: &Time, obstacles: &[SceneObstacle]) -> Markers {
    let mut markers = vec![Marker {
        action: DELETE_ALL,
        ..marker(stamp, MAP, "", 0, CUBE)
    }];
    for obstacle in sound(obstacles) {
        let (ns, of) = match obstacle.closed {
            true => ("boxes", color([0.65, 0.5, 0.3])),
            false => ("walls", color([0.6, 0.6, 0.6])),
        };
        for ([from_x, from_y], [to_x, to_y]) in sides(obstacle) {
            let (x_m, y_m) = (to_x - from_x, to_y - from_y);
            let middle = MapPose {
                x_m: from_x + 0.5 * x_m,
                y_m: from_y + 0.5 * y_m,
                heading_rad: y_m.atan2(x_m),
            };
            let mut side = marker(stamp, MAP, ns, markers.len() as i32, CUBE);
            side.pose = pose(middle);
            side.pose.position.z = 0.5 * WALL_HEIGHT_M;
            side.scale = Vector3 {
                x: x_m.hypot(y_m) + WALL_WIDTH_M,
                y: WALL_WIDTH_M,
                z: WALL_HEIGHT_M,
            };
            side.color = of.clone();
            markers.push(side);
        }
    }
    Markers { markers }
}

/// The way driven, and where it leads, in `odom`.
#[derive(Debug)]
pub(crate) struct Way {
    places: Vec<Point>,
    apart_m: f64,
    goals: Vec<Point>,
    is_new: bool,
    shown_ms: Option<i64>,
}

impl Default for Way {
    fn default() -> Self {
        Self {
            places: Vec::new(),
            apart_m: APART_M,
            goals: Vec::new(),
            is_new: false,
            shown_ms: None,
        }
    }
}

fn place(at: MapPose, z: f64) -> Point {
    Point {
        x: at.x_m,
        y: at.y_m,
        z,
    }
}

impl Way {
    /// The robot is here now.
    pub(crate) fn step(&mut self, at: MapPose) {
        let is_near = |last: &Point| (at.x_m - last.x).hypot(at.y_m - last.y) < self.apart_m;
        if self.places.last().is_some_and(is_near) {
            return;
        }
        self.places.push(place(at, 0.005));
        self.is_new = true;
        if self.places.len() >= MOST_PLACES {
            let mut keep = false;
            self.places.retain(|_| {
                keep = !keep;
                keep
            });
            self.apart_m *= 2.0;
        }
    }

    /// The robot is to get there.
    pub(crate) fn aim(&mut self, goals: impl Iterator<Item = MapPose>) {
        let goals: Vec<Point> = goals.map(|at| place(at, 0.05)).collect();
        self.is_new |= goals != self.goals;
        self.goals = goals;
    }

    /// What there is to show anew.
    pub(crate) fn markers(&mut self, t_ms: i64, stamp: &Time) -> Option<Markers> {
        let is_due = self
            .shown_ms
            .is_none_or(|then_ms| t_ms - then_ms >= SHOWN_MS);
        if !(self.is_new && is_due) {
            return None;
        }
        (self.is_new, self.shown_ms) = (false, Some(t_ms));
        let scaled = |to: f64| Vector3 {
            x: to,
            y: to,
            z: to,
        };
        let way = Marker {
            scale: scaled(0.01),
            color: color([0.1, 0.6, 0.9]),
            points: self.places.clone(),
            ..marker(stamp, ODOM, "way", 0, LINE_STRIP)
        };
        let goals = Marker {
            action: if self.goals.is_empty() { DELETE } else { 0 },
            scale: scaled(0.1),
            color: color([0.1, 0.7, 0.2]),
            points: self.goals.clone(),
            ..marker(stamp, ODOM, "goals", 0, SPHERE_LIST)
        };
        Some(Markers {
            markers: vec![way, goals],
        })
    }
}

/// The sonars as one scan around `base_link`: each reading in all directions of its beam, since it tells none of them;
/// no number where no sonar looks. `ranges_m` by `SonarId` number.
pub(crate) fn scan(
    stamp: &Time,
    geometry: &BodyGeometry,
    servo_rad: f64,
    ranges_m: [Option<f64>; 3],
) -> LaserScan {
    let step_rad = TAU / DIRECTIONS as f64;
    let mut scan = LaserScan {
        header: header(stamp, BASE),
        angle_min: -PI as f32,
        angle_max: (PI - step_rad) as f32,
        angle_increment: step_rad as f32,
        range_min: LEAST_M,
        ranges: vec![f32::NAN; DIRECTIONS],
        ..LaserScan::default()
    };
    for mount in &geometry.sonars {
        let Some(Some(range_m)) = ranges_m.get(usize::from(mount.id)) else {
            continue;
        };
        let turned_rad = if mount.on_servo { servo_rad } else { 0.0 };
        // A clear beam is clear as far as it reaches.
        let to_m = range_m.min(mount.reach_m);
        let half = (mount.half_angle_rad / step_rad).ceil();
        for beam in -(half as i32)..=half as i32 {
            let off_rad = mount.half_angle_rad * f64::from(beam) / half.max(1.0);
            let (sin, cos) = (mount.at.heading_rad + turned_rad + off_rad).sin_cos();
            let (x_m, y_m) = (mount.at.x_m + to_m * cos, mount.at.y_m + to_m * sin);
            let direction = ((y_m.atan2(x_m) + PI) / step_rad).round() as usize % DIRECTIONS;
            let seen_m = match range_m.is_finite() {
                true => x_m.hypot(y_m) as f32,
                false => f32::INFINITY,
            };
            if let Some(known_m) = scan.ranges.get_mut(direction) {
                // The nearest of two that see the same way; `min` takes a number where the other is none.
                *known_m = known_m.min(seen_m);
            }
        }
        let outward_m = mount.at.x_m.hypot(mount.at.y_m) + mount.reach_m;
        scan.range_max = scan.range_max.max(outward_m as f32);
    }
    scan
}
