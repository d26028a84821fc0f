//! A hand that lifts what stands in the world and puts it down elsewhere, while the robot drives.
//!
//! It does what lines say. `robot=X Y HEADING` is a pose in the world \[m\], \[rad\]. `thing=N DX DY` is how far from where
//! the world has it \[m\] the box or wall of this number stands from then on; the numbers of what moves by itself follow,
//! and its whole path is shifted, so that it goes on by time alone.

use rumbo_plant::contact::Pose;
use rumbo_sim::Sim;
use std::f64::consts::PI;

/// Farthest that it reaches \[m\].
const REACH_M: f64 = 100.0;

/// Does what a line says; false of one that is wrong, or asks for a place where there is no room: it does nothing.
pub fn act(sim: &mut Sim, line: &[u8]) -> bool {
    let line = std::str::from_utf8(line).unwrap_or_default();
    let (what, numbers) = line.trim().split_once('=').unwrap_or_default();
    let numbers = numbers.split(' ').map(str::parse);
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().unwrap_or_default();
    let within = |m: f64| m.abs() <= REACH_M;
    match (what, &numbers[..]) {
        ("robot", &[x_m, y_m, heading_rad])
            if within(x_m) && within(y_m) && heading_rad.is_finite() =>
        {
            sim.put(Pose {
                x_m,
                y_m,
                heading_rad: heading_rad.clamp(-PI, PI),
            })
        }
        ("thing", &[number, x_m, y_m])
            if within(x_m) && within(y_m) && (0.0..=f64::from(u16::MAX)).contains(&number) =>
        {
            sim.shift(number as usize, [x_m, y_m])
        }
        _ => false,
    }
}
