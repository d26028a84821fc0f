//! A rig seen from above: footprint, wheels, and each sonar with its beam, as the robot file places them.

use super::sketch::{Anchor, Sketch};
use crate::text::{Language, Text, word};
use rumbo_experiment::files::Setup;
use rumbo_plant::plant::Mount;

/// Pixels per metre.
const SCALE: f64 = 900.0;
const WIDTH: f64 = 620.0;
/// How far the beams are drawn [m].
const BEAM_M: f64 = 0.11;

const LEFT: Text = word("left-sonar-name");
const RIGHT: Text = word("right-sonar-name");
const FIRST: Text = word("first");
const SECOND: Text = word("second");
const FRONT: Text = word("front");
const ON_SERVO: Text = word("front-on-the-servo");

/// The drawing.
pub(crate) fn svg(language: Language, setup: &Setup) -> String {
    let mut sketch = Sketch::new();
    // x ahead is to the right of the page, y to the left of the robot is up.
    let rig = &setup.rig;
    let mounts = [rig.left, rig.right, rig.front].into_iter().flatten();
    let beside = mounts.filter(|mount| mount.angle_rad != 0.0).count() > 0;
    // Room for a beam, where there is one to that side.
    let mounts = || [rig.left, rig.right].into_iter().flatten();
    let room = |side: f64| {
        let some = mounts().any(|mount| side * mount.angle_rad > 0.1);
        if some { 205.0 } else { 112.0 }
    };
    let (above, below) = (room(1.0), room(-1.0));
    let height = above + below;
    let place = |x_m: f64, y_m: f64| (230.0 + SCALE * x_m, above - SCALE * y_m);
    chassis(&mut sketch, setup, place);
    let pair =
        rig.front.is_none() && rig.left.map(|m| m.angle_rad) == rig.right.map(|m| m.angle_rad);
    let names = if pair && beside {
        [FIRST, SECOND]
    } else {
        [LEFT, RIGHT]
    };
    let half_rad = setup.robot.plant.sonar.beam_half_angle_rad;
    for (mount, name) in [(rig.left, names[0]), (rig.right, names[1])] {
        if let Some(mount) = mount {
            sonar(
                &mut sketch,
                place(mount.x_m, mount.y_m),
                &mount,
                half_rad,
                name.of(language),
            );
        }
    }
    if let Some(mount) = rig.front {
        let at = place(mount.x_m, mount.y_m);
        if mount.on_servo {
            sketch.circle(at, 13.0, "b");
        }
        let name = if mount.on_servo { ON_SERVO } else { FRONT };
        sonar(&mut sketch, at, &mount, half_rad, name.of(language));
    }
    dimensions(&mut sketch, language, setup, place);
    sketch.finish(WIDTH, height)
}

/// Body, wheels with their axle, and the axes of its frame.
fn chassis(sketch: &mut Sketch, setup: &Setup, place: impl Fn(f64, f64) -> (f64, f64)) {
    let body = &setup.robot.plant.body;
    let rear = place(
        body.centre_ahead_m - 0.5 * body.length_m,
        0.5 * body.width_m,
    );
    sketch.rectangle(rear, (SCALE * body.length_m, SCALE * body.width_m), "b");
    let radius_m = setup.robot.plant.wheels.left.radius_m;
    for side in [0.5, -0.5] {
        let (x, y) = place(-radius_m, side * body.base_m);
        sketch.rectangle((x, y - 6.0), (2.0 * SCALE * radius_m, 12.0), "o");
    }
    let axle = [0.5, -0.5].map(|side| place(0.0, side * body.base_m));
    sketch.line(&axle, "l");
    let origin = place(0.0, 0.0);
    let ahead = place(0.06, 0.0);
    sketch.arrow(&[origin, ahead]);
    sketch.text((ahead.0 + 3.0, origin.1 + 4.0), "x", Anchor::Start);
    sketch.arrow(&[origin, place(0.0, 0.035)]);
    sketch.text((origin.0 - 5.0, place(0.0, 0.027).1), "y", Anchor::End);
}

fn sonar(sketch: &mut Sketch, at: (f64, f64), mount: &Mount, half_rad: f64, name: &str) {
    let reach = SCALE * BEAM_M;
    let end = |angle: f64| (at.0 + reach * angle.cos(), at.1 - reach * angle.sin());
    let (from, to) = (mount.angle_rad - half_rad, mount.angle_rad + half_rad);
    sketch.polygon(&[at, end(from), end(mount.angle_rad), end(to)], "z");
    let (cos, sin) = (mount.angle_rad.cos(), mount.angle_rad.sin());
    // The sensor is 45 mm wide across its beam.
    let across = (-sin * 20.0, -cos * 20.0);
    let back = (-cos * 7.0, sin * 7.0);
    sketch.polygon(
        &[
            (at.0 + across.0, at.1 + across.1),
            (at.0 - across.0, at.1 - across.1),
            (at.0 - across.0 + back.0, at.1 - across.1 + back.1),
            (at.0 + across.0 + back.0, at.1 + across.1 + back.1),
        ],
        "o",
    );
    if cos.abs() > 0.5 {
        sketch.text((at.0 + reach + 6.0, at.1 + 4.0), name, Anchor::Start);
    } else {
        sketch.text(
            (at.0, at.1 - (reach + 14.0) * sin + 4.0),
            name,
            Anchor::Middle,
        );
    }
}

/// What the geometry's numbers are.
fn dimensions(
    sketch: &mut Sketch,
    language: Language,
    setup: &Setup,
    place: impl Fn(f64, f64) -> (f64, f64),
) {
    let body = &setup.robot.plant.body;
    let cm = |metres: f64| format!("{} cm", language.short(100.0 * metres, 1));
    let x = place(-0.115, 0.0).0;
    sketch.measure(
        (x, place(0.0, 0.5 * body.base_m).1),
        (x, place(0.0, -0.5 * body.base_m).1),
        &cm(body.base_m),
        (-30.0, 4.0),
    );
    let (left, right) = (setup.rig.left, setup.rig.right);
    let (Some(left), Some(right)) = (left, right) else {
        return;
    };
    if setup.rig.front.is_none() && left.y_m != right.y_m {
        let x = place(left.x_m, 0.0).0 - 26.0;
        sketch.measure(
            (x, place(0.0, left.y_m).1),
            (x, place(0.0, right.y_m).1),
            &cm(left.y_m - right.y_m),
            (-24.0, -20.0),
        );
    } else if setup.rig.front.is_none() {
        // On the side without sonars, outside the body.
        let y = place(0.0, -left.y_m.signum() * (left.y_m.abs() + 0.02)).1;
        sketch.measure(
            (place(right.x_m, 0.0).0, y),
            (place(left.x_m, 0.0).0, y),
            &cm(left.x_m - right.x_m),
            (0.0, 16.0),
        );
    }
}
