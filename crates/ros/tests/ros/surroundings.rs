//! What surrounds a robot, as displays and planners get it: map, walls, way and goals, scan.

use rumbo_log::{Log, MapPose, Row, Scene, SceneObstacle, SonarMount, State};
use rumbo_ros::convert::{Converter, TopicMessage, messages};
use rumbo_ros::geometry::BodyGeometry;
use rumbo_ros::topics::Topic;
use rumbo_ros::types::decode;
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;

type Header = ((i32, u32), String);
type Point = (f64, f64, f64);
type Pose = (Point, (f64, f64, f64, f64));
type Picture = (Header, String, Vec<u8>);

#[derive(Debug, Deserialize)]
struct Grid {
    header: Header,
    info: ((i32, u32), f32, u32, u32, Pose),
    data: Vec<i8>,
}

impl Grid {
    /// The cell at a place, and how many there are.
    fn cell(&self, x_m: f64, y_m: f64) -> i8 {
        let (_, side_m, width, height, (low, _)) = self.info;
        assert_eq!(self.data.len(), (width * height) as usize);
        let at = |to_m: f64, from_m: f64| ((to_m - from_m) / f64::from(side_m)) as usize;
        self.data[at(y_m, low.1) * width as usize + at(x_m, low.0)]
    }
}

#[derive(Debug, Deserialize)]
struct Marker {
    header: Header,
    ns: String,
    _id: i32,
    kind: i32,
    action: i32,
    pose: Pose,
    scale: Point,
    _color: (f32, f32, f32, f32),
    _lifetime: (i32, u32),
    _locked: bool,
    points: Vec<Point>,
    _colors: Vec<(f32, f32, f32, f32)>,
    _texture: (String, Picture, Vec<(f32, f32)>),
    _mesh: (String, String, (String, Vec<u8>), bool),
}

#[derive(Debug, Deserialize)]
struct Scan {
    header: Header,
    angles_rad: (f32, f32, f32),
    _times_s: (f32, f32),
    reach_m: (f32, f32),
    ranges_m: Vec<f32>,
    _intensities: Vec<f32>,
}

impl Scan {
    /// The distance in a direction.
    fn towards(&self, direction_rad: f64) -> f32 {
        let (first, _, step) = self.angles_rad;
        self.ranges_m[((direction_rad as f32 - first) / step).round() as usize % 360]
    }
}

fn of<T: for<'a> Deserialize<'a>>(sent: &[TopicMessage], topic: Topic) -> Vec<T> {
    let sent = sent.iter().filter(|sent| sent.topic == topic);
    sent.map(|sent| decode(&sent.data).unwrap()).collect()
}

fn markers(sent: &[TopicMessage], topic: Topic) -> Vec<Vec<Marker>> {
    let all: Vec<(Vec<Marker>,)> = of(sent, topic);
    all.into_iter().map(|(markers,)| markers).collect()
}

fn at(x_m: f64, y_m: f64, heading_rad: f64) -> MapPose {
    MapPose {
        x_m,
        y_m,
        heading_rad,
    }
}

/// A wall 2 m ahead, from right to left, and a box of 0.36 m beside the way; no side lies between two cells of a map.
fn scene() -> Scene {
    let obstacle = |closed, corners: &[[f64; 2]]| SceneObstacle {
        corners_m: corners.to_vec(),
        closed,
    };
    let sonar = |id, at, on_servo| SonarMount {
        id,
        at,
        half_angle_rad: 0.2,
        reach_m: 2.5,
        on_servo,
    };
    Scene {
        base_m: 0.1,
        wheel_radius_m: 0.03,
        obstacles: vec![
            obstacle(false, &[[2.02, -0.98], [2.02, 0.98]]),
            obstacle(
                true,
                &[[0.82, 0.62], [1.18, 0.62], [1.18, 0.98], [0.82, 0.98]],
            ),
        ],
        sonars: vec![
            sonar(0, at(0.03, 0.07, FRAC_PI_2), false),
            sonar(1, at(0.03, -0.07, -FRAC_PI_2), false),
            sonar(2, at(0.1, 0.0, 0.0), true),
        ],
        ..Scene::default()
    }
}

/// A robot of this scene that drives ahead, 1 cm in 40 ms.
fn log(scene: Scene, rows: i64) -> Log {
    let rows = (0..rows).map(|number| {
        let mut row = Row::unknown(40 * number);
        for prefix in ["", "true_"] {
            row.set_pose(prefix, at(0.01 * number as f64, 0.0, 0.0));
        }
        row
    });
    let mut log = Log::default();
    log.rows = rows.collect();
    log.scene = Some(scene);
    log
}

#[test]
fn a_map_has_walls_and_boxes_occupied_and_the_floor_free() {
    let sent = messages(&log(scene(), 3), false).unwrap();
    let [grid] = &of::<Grid>(&sent, Topic::Map)[..] else {
        panic!("one map");
    };
    assert_eq!(grid.header.1, "map");
    assert!((grid.info.1 - 0.05).abs() < 1e-6);
    for (x_m, y_m, occupied) in [
        (2.02, 0.97, true),
        (2.02, -0.97, true),
        (1.0, 0.8, true),
        (1.17, 0.97, true),
        (1.0, 0.5, false),
        (1.3, 0.8, false),
        (1.9, 0.0, false),
        (2.1, 0.0, false),
        (2.02, 1.1, false),
    ] {
        assert_eq!(grid.cell(x_m, y_m) == 100, occupied, "{x_m}, {y_m}");
    }
    let occupied = grid.data.iter().filter(|cell| **cell == 100).count();
    assert_eq!(occupied, 40 + 8 * 8);
}

#[test]
fn an_open_world_is_free_floor_and_a_real_robot_has_no_map() {
    let empty = Scene {
        obstacles: Vec::new(),
        ..scene()
    };
    let sent = messages(&log(empty, 3), false).unwrap();
    let [grid] = &of::<Grid>(&sent, Topic::Map)[..] else {
        panic!("one map");
    };
    assert!(grid.data.iter().all(|cell| *cell == 0));
    assert!(grid.data.len() >= 120 * 120, "6 m by 6 m");
    let walls = markers(&sent, Topic::Walls);
    assert!(walls.iter().flatten().all(|marker| marker.action == 3));
    let mut real = log(scene(), 3);
    for (row, t_ms) in real.rows.iter_mut().zip([0, 40, 80]) {
        *row = Row::unknown(t_ms);
        row.set_pose("", at(0.0, 0.0, 0.0));
    }
    let sent = messages(&real, false).unwrap();
    assert!(of::<Grid>(&sent, Topic::Map).is_empty());
    assert!(markers(&sent, Topic::Walls).is_empty());
}

#[test]
fn a_map_of_the_strangest_world_has_a_million_cells_at_most() {
    let mut scene = scene();
    for far in [90_000.0, 1e300, f64::NAN, f64::INFINITY] {
        scene.obstacles.push(SceneObstacle {
            corners_m: vec![[far, -far], [0.0, far]],
            closed: true,
        });
    }
    let sent = messages(&log(scene, 3), false).unwrap();
    let [grid] = &of::<Grid>(&sent, Topic::Map)[..] else {
        panic!("one map");
    };
    assert!(grid.data.len() <= 1 << 20, "{}", grid.data.len());
    assert!(grid.info.1 > 100.0);
}

#[test]
fn walls_and_boxes_stand_as_markers_where_they_are() {
    let sent = messages(&log(scene(), 3), false).unwrap();
    let [walls] = &markers(&sent, Topic::Walls)[..] else {
        panic!("one message");
    };
    // What an earlier world has left goes first.
    assert_eq!(walls[0].action, 3);
    let names: Vec<&str> = walls[1..].iter().map(|marker| &marker.ns[..]).collect();
    assert_eq!(names, ["walls", "boxes", "boxes", "boxes", "boxes"]);
    let wall = &walls[1];
    assert_eq!((wall.kind, wall.action, &wall.header.1[..]), (1, 0, "map"));
    let ((x, y, z), (_, _, sin, cos)) = wall.pose;
    assert_eq!((x, y), (2.02, 0.0));
    assert!((2.0 * sin.atan2(cos) - FRAC_PI_2).abs() < 1e-9, "across");
    assert!((wall.scale.0 - 1.98).abs() < 1e-9 && z == 0.5 * wall.scale.2);
}

#[test]
fn the_way_driven_and_the_goal_are_markers_in_odom() {
    let mut log = log(scene(), 251);
    // The robot counts from where it was after 5 s; its goal is a metre ahead of that.
    for row in &mut log.rows {
        let later = row.t_ms >= 5_000;
        row.set_pose("origin_", at(if later { 1.25 } else { 0.0 }, 0.0, 0.0));
        if later {
            let x_m = 0.01 * (row.t_ms - 5_000) as f64 / 40.0;
            row.set_pose("", at(x_m, 0.0, 0.0));
        }
    }
    let mut state = State {
        t_s: 6.0,
        ..State::default()
    };
    state.robot.task.goal = Some([1.0, 0.5]);
    let mut without = state.clone();
    (without.t_s, without.robot.task.goal) = (9.0, None);
    log.states = vec![state, without];
    let all = markers(&messages(&log, false).unwrap(), Topic::Way);
    // Ten seconds: once a second.
    assert_eq!(all.len(), 11);
    for (second, both) in all.iter().enumerate() {
        let [way, goals] = &both[..] else {
            panic!("{both:?}");
        };
        assert_eq!((&way.header.1[..], way.kind, goals.kind), ("odom", 4, 7));
        let reached_m = way.points.last().unwrap().0;
        assert!((reached_m - 0.25 * second as f64).abs() < 0.04, "{second}");
        let steps = way.points.windows(2).map(|pair| pair[1].0 - pair[0].0);
        assert!(steps.clone().all(|step_m| step_m > 0.029 && step_m < 0.05));
        let has_goal = (6..9).contains(&second);
        assert_eq!(goals.action, if has_goal { 0 } else { 2 }, "{second}");
        if has_goal {
            let (x, y, _) = goals.points[0];
            assert!((x - 2.25).abs() < 0.02 && (y - 0.5).abs() < 1e-6, "{x}");
        }
    }
}

#[test]
fn a_long_way_has_a_thousand_places_at_most_and_begins_where_it_began() {
    let all = markers(&messages(&log(scene(), 10_000), false).unwrap(), Topic::Way);
    let last = &all.last().unwrap()[0].points;
    assert!(last.len() < 1_000 && last.len() > 400, "{}", last.len());
    assert_eq!(last[0].0, 0.0);
    assert!(last.last().unwrap().0 > 99.0);
}

#[test]
fn a_scan_has_each_sonar_in_its_directions_and_no_number_elsewhere() {
    let mut log = log(scene(), 1);
    let row = &mut log.rows[0];
    row.set("range_left_m", 0.5);
    row.set("range_front_m", f64::INFINITY);
    row.set("servo_rad", -0.5);
    assert!(of::<Scan>(&messages(&log, false).unwrap(), Topic::Scan).is_empty());
    let scans: Vec<Scan> = of(&messages(&log, true).unwrap(), Topic::Scan);
    let scan = &scans[0];
    assert_eq!(scan.header.1, "base_link");
    assert_eq!(scan.ranges_m.len(), 360);
    // From the middle of the axis: the sonar sits 7 cm to the left.
    assert!((scan.towards(FRAC_PI_2 - 0.05) - 0.57).abs() < 0.01);
    assert_eq!(
        scan.towards(-0.5),
        f32::INFINITY,
        "clear, where the servo looks"
    );
    assert!(scan.towards(0.0).is_nan() && scan.towards(-FRAC_PI_2).is_nan());
    assert!(scan.reach_m.0 < 0.03 && scan.reach_m.1 > 2.5);
}

#[test]
fn an_unknown_frame_is_refused_with_those_that_work() {
    let log = log(scene(), 2);
    let mut converter = Converter::new("rumbo", String::new(), 0);
    let refused = |converter: &Converter| converter.in_odom("camera", MapPose::default());
    let real = "there is no frame `camera`; use odom or base_link";
    assert_eq!(refused(&converter).unwrap_err(), real);
    converter.know(BodyGeometry::new(log.scene(), |_| None).unwrap());
    converter.row(&log.rows[0]).unwrap();
    let simulated = "there is no frame `camera`; use odom, base_link or map";
    assert_eq!(refused(&converter).unwrap_err(), simulated);
}
