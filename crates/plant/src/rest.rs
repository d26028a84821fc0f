//! A robot that stands with its motors off: charge, memories of friction and the servo go on, and nothing else does. Bit for
//! bit the whole step, whose other terms are zeros then; robots stand for half of most runs.

use crate::drivetrain::{self, Drivetrain};
use crate::plant::{Plant, STEP_US, State};

impl Plant {
    /// Whether it stands, and goes on to: its motors are off, and nothing that moves can push it.
    pub(crate) fn stands(&self, state: &State) -> bool {
        let is_alone = self.wheels_in_air || self.world.bodies().is_empty();
        is_alone && state.drivetrain.stands()
    }

    /// Passes time in the steps of [`Plant::advance`].
    pub(crate) fn stand(&self, state: &mut State, until_us: u64) {
        state.speed = [0.0; 2];
        while state.now_us < until_us {
            let grid_us = (state.now_us / STEP_US + 1) * STEP_US;
            let end_us = grid_us.min(until_us);
            let dt_s = (end_us - state.now_us) as f64 * 1e-6;
            self.drivetrain.stand(&mut state.drivetrain, dt_s);
            state.servo.step(&self.servo, dt_s);
            state.now_us = end_us;
        }
    }
}

impl drivetrain::State {
    fn stands(&self) -> bool {
        let mut wheels = self.wheels.iter();
        wheels.all(|wheel| wheel.speed_rad_s == 0.0 && wheel.command.direction == 0.0)
    }
}

impl Drivetrain {
    fn stand(&self, state: &mut drivetrain::State, dt_s: f64) {
        self.battery.draw(&mut state.battery, 0.0, dt_s);
        for (i, wheel) in state.wheels.iter_mut().enumerate() {
            wheel.current_a = 0.0;
            self.roll(i, wheel, 0.0, 0.0, dt_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Pose;
    use crate::drivetrain::{Bridge, Side};
    use crate::event::Queue;
    use crate::params::Params;
    use crate::plant::{Mount, Mounts, PlantSetup};
    use crate::sonar::SonarId;
    use crate::world::{Wall, World};

    /// Each step as a whole.
    fn advance_whole(plant: &Plant, state: &mut State, until_us: u64, seen: &mut Vec<String>) {
        let mut queue = Queue::default();
        while state.now_us < until_us {
            let grid_us = (state.now_us / STEP_US + 1) * STEP_US;
            let mut note = |event| seen.push(format!("{event:?}"));
            plant.step(state, grid_us.min(until_us), &mut queue, &mut note);
            queue.flush(&mut note);
        }
    }

    #[test]
    fn standing_is_bit_for_bit_the_whole_step() {
        let mount = |angle_rad, on_servo| {
            Some(Mount {
                x_m: 0.1,
                y_m: 0.0,
                angle_rad,
                on_servo,
            })
        };
        let wall = Wall {
            from_m: [1.0, 3.0],
            to_m: [1.0, -3.0],
            thickness_m: 0.02,
        };
        for (wheels_in_air, off) in [(false, Bridge::Released), (true, Bridge::Brake(0.7))] {
            let plant = Plant::new(PlantSetup {
                params: Params::default(),
                rig: Mounts {
                    left: mount(1.57, false),
                    right: mount(-1.57, false),
                    front: mount(0.0, true),
                    ..Mounts::default()
                },
                world: World::new(&[wall], &[]).unwrap(),
                wheels_in_air,
                ..PlantSetup::default()
            });
            let start = plant.start(Pose::default());
            let (mut one, mut other) = (start, start);
            let (mut seen, mut seen_whole) = (Vec::new(), Vec::new());
            let mut stood = 0;
            for part in 0..400_u64 {
                let bridge = if (100..150).contains(&part) {
                    Bridge::Forward(0.6)
                } else {
                    off
                };
                for state in [&mut one, &mut other] {
                    plant.set_bridge(state, Side::Left, bridge);
                    plant.set_bridge(state, Side::Right, bridge);
                    plant.set_servo(state, if part % 90 < 45 { 0.9 } else { -0.4 });
                    plant.trigger(state, SonarId::ALL[(part % 3) as usize]);
                }
                stood += u32::from(plant.stands(&one));
                // Off the grid too.
                let until_us = one.now_us + 7_000 + part % 11 * 413;
                plant.advance(&mut one, until_us, &mut |event| {
                    seen.push(format!("{event:?}"))
                });
                advance_whole(&plant, &mut other, until_us, &mut seen_whole);
                assert_eq!(format!("{one:?}"), format!("{other:?}"), "part {part}");
            }
            assert_eq!(seen, seen_whole);
            assert!((150..350).contains(&stood), "{stood}");
        }
    }
}
