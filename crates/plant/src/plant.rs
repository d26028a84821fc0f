//! The robot in its world: all parts, stepped together.
//!
//! Time goes in steps of at most a millisecond, aligned to the millisecond grid and split where the caller stops.
//! Commands (bridge, servo, trigger) act at the present time; what the robot's pins would see comes back from
//! [`Plant::advance`] as events in the order of time, each at its microsecond.

use libm::{sincos, sqrt};
use std::sync::{Arc, OnceLock};

pub use crate::event::Event;
pub use crate::rig::{Mount, Mounts};

use crate::contact::{self, Footprint, Pose};
use crate::drivetrain::{self, Bridge, Drivetrain, Modulation, Motion, Side};
use crate::encoder::{self, Channel, Encoder};
use crate::event::Queue;
use crate::moving::{Body, BodyMotion, BodyVelocity};
use crate::noise::Noise;
use crate::params::{self, Params};
use crate::servo;
use crate::sonar::{self, InAir, Ping, Sonar, SonarId, View};
use crate::world::{Point, ShapeError, World};

/// Longest physical step, and the grid it keeps to.
pub(crate) const STEP_US: u64 = 1000;
/// No sonar listens for longer after a burst has left.
const IN_AIR_US: u64 = 40_000;

/// The ping may still arrive somewhere then.
const fn is_in_air(one: &InAir, now_us: u64) -> bool {
    one.ping.rise_us + IN_AIR_US > now_us
}

/// The parts of a plant.
#[derive(Clone, Debug, Default)]
pub struct PlantSetup {
    /// Physical numbers, already drawn for the seed if they are to be.
    pub params: Params,
    /// Sonars.
    pub rig: Mounts,
    /// The world.
    pub world: World,
    /// Seed of all noise.
    pub seed: u64,
    /// Which robot of the seed, for batches.
    pub robot: u32,
    /// True if the robot is held up: wheels turn freely and the body stays.
    pub wheels_in_air: bool,
}

/// What does not change during a run.
#[derive(Clone, Debug)]
pub struct Plant {
    pub(crate) drivetrain: Drivetrain,
    pub(crate) encoders: [Encoder; 2],
    pub(crate) footprint: Footprint,
    pub(crate) servo: params::Servo,
    sonar: Sonar,
    mounts: [Option<Mount>; SonarId::ALL.len()],
    pub(crate) world: Arc<World>,
    /// Pings of other robots, and when they were last received: those that may still be in the air then count.
    air: Vec<InAir>,
    air_us: u64,
    pub(crate) wheels_in_air: bool,
}

/// Everything that changes: plain numbers, copied to save a moment and to come back to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub(crate) now_us: u64,
    pub(crate) pose: Pose,
    /// Speed of the body over the last step: forward, yaw.
    pub(crate) speed: [f64; 2],
    pub(crate) drivetrain: drivetrain::State,
    pub(crate) encoders: [encoder::State; 2],
    pub(crate) contact: contact::State,
    pub(crate) servo: servo::State,
    pub(crate) sonars: sonar::States,
}

/// Ground truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundTruth {
    /// Time since the start.
    pub now_us: u64,
    /// Pose of the middle of the wheels' axis.
    pub pose: Pose,
    /// Speed of each wheel (left, right), rad/s, positive forward.
    pub wheel_rad_s: [f64; 2],
    /// Angle of each wheel since some start, rad.
    pub wheel_rad: [f64; 2],
    /// Speed of the body along its x axis.
    pub forward_m_s: f64,
    /// Turn rate of the body, counter-clockwise.
    pub yaw_rad_s: f64,
    /// Noise-free range of each sonar by [`SonarId::index`]; infinite where nothing is within
    /// reach, `None` where there is no such sonar.
    pub range_m: [Option<f64>; SonarId::ALL.len()],
    /// Terminal voltage of the battery.
    pub battery_v: f64,
    /// Current drawn from it.
    pub battery_a: f64,
    /// The servo's angle: 0 ahead, positive to the left.
    pub servo_rad: f64,
    /// Touches so far.
    pub contacts: u32,
    /// Whether the body touches something.
    pub touching: bool,
}

impl Plant {
    /// Puts the parts together.
    #[must_use]
    pub fn new(setup: PlantSetup) -> Self {
        let PlantSetup {
            params,
            rig,
            world,
            seed,
            robot,
            wheels_in_air,
        } = setup;
        let noise = Noise::new(seed, robot);
        Self {
            drivetrain: Drivetrain::new(&params, noise, !wheels_in_air),
            encoders: [0, 1].map(|index| Encoder::new(&params, &noise, index)),
            footprint: Footprint::new(&params.body, &params.wheels),
            servo: params.servo,
            sonar: Sonar::new(&params.sonar, noise),
            mounts: rig.mounts(),
            world: Arc::new(world),
            air: Vec::new(),
            air_us: 0,
            wheels_in_air,
        }
    }

    /// The same whose encoders have the output B too.
    #[must_use]
    pub fn with_second_channels(self) -> Self {
        Self {
            encoders: self.encoders.map(Encoder::with_second),
            ..self
        }
    }

    /// Time 0, at rest at a pose, bridges released, servo straight ahead.
    #[must_use]
    pub fn start(&self, pose: Pose) -> State {
        let drivetrain = self.drivetrain.start();
        let encoder = |i: usize| self.encoders[i].start(drivetrain.wheels[i].angle_rad);
        State {
            now_us: 0,
            pose,
            speed: [0.0; 2],
            drivetrain,
            encoders: [encoder(0), encoder(1)],
            contact: contact::State::default(),
            servo: servo::State::default(),
            sonars: sonar::States::default(),
        }
    }

    /// Whether the body has room at a pose now.
    #[must_use]
    pub fn has_room(&self, state: &State, at: &Pose) -> bool {
        self.footprint.clearance_m(&self.world, state.now_us, at) > 0.0
    }

    /// Shifts what has this number in the world, obstacles first, then bodies with their whole course, unless the robot
    /// is there; whether it was shifted.
    pub fn shift(&mut self, state: &mut State, thing: usize, by_m: Point) -> bool {
        let mut world = World::clone(&self.world);
        let clearance_m = |world| self.footprint.clearance_m(world, state.now_us, &state.pose);
        let was_m = clearance_m(&self.world);
        let is_there = world.shift(thing, by_m);
        // What already leans on the robot may leave it.
        let fits = is_there && clearance_m(&world) >= was_m.min(0.0);
        if fits {
            state.contact.clearance_m = 0.0;
            self.world = Arc::new(world);
        }
        fits
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Puts a body that moves into the world.
    ///
    /// # Errors
    /// There is no room for another one.
    pub fn add_body(&mut self, state: &mut State, body: Body) -> Result<(), ShapeError> {
        state.contact.clearance_m = 0.0;
        Arc::make_mut(&mut self.world).add_body(body)
    }

    /// Puts bodies with the same outlines in place of those of the world, by their numbers: on their way from now on, to
    /// which each has jumped by at most so much \[m\].
    pub fn replace_bodies<'a>(
        &mut self,
        state: &mut State,
        bodies: impl Iterator<Item = (usize, &'a Body, f64)>,
    ) {
        let clearance_m = &mut state.contact.clearance_m;
        let bodies = bodies.map(|(index, body, jump_m)| {
            *clearance_m -= jump_m;
            (index, body)
        });
        Arc::make_mut(&mut self.world).replace_bodies(bodies);
    }

    /// Where the body is, and how fast it moves.
    #[must_use]
    pub fn motion(&self, state: &State) -> BodyMotion {
        let [forward_m_s, yaw_rad_s] = state.speed;
        if state.speed == [0.0; 2] {
            return BodyMotion {
                pose: state.pose,
                velocity: BodyVelocity::default(),
            };
        }
        let (s, c) = sincos(state.pose.heading_rad);
        BodyMotion {
            pose: state.pose,
            velocity: BodyVelocity {
                m_s: [forward_m_s * c, forward_m_s * s],
                yaw_rad_s,
            },
        }
    }

    /// Keeps its world in common with others if it is the same as theirs: the first one's.
    pub fn share_world(&mut self, common: &OnceLock<Arc<World>>) {
        let common = common.get_or_init(|| self.world.clone());
        if self.world == *common {
            self.world = common.clone();
        }
    }

    /// Footprint of the body.
    #[must_use]
    pub const fn footprint(&self) -> &Footprint {
        &self.footprint
    }

    /// Sets one half of the bridge from now on.
    pub fn set_bridge(&self, state: &mut State, side: Side, bridge: Bridge) {
        self.set_bridge_at(state, side, bridge, Modulation::default());
    }

    /// The same with another PWM than the parameters'.
    pub fn set_bridge_at(
        &self,
        state: &mut State,
        side: Side,
        bridge: Bridge,
        modulation: Modulation,
    ) {
        let i = side.index();
        let before = state.drivetrain.wheels[i];
        self.drivetrain
            .set_bridge_at(&mut state.drivetrain, side, bridge, modulation);
        // What holds a wheel that stands at an obstacle holds it that way only.
        if before.speed_rad_s == 0.0
            && before.command.direction != state.drivetrain.wheels[i].command.direction
        {
            state.contact.blocked[i] = 0.0;
        }
    }

    /// Commands the servo's angle: 0 ahead, positive to the left.
    pub fn set_servo(&self, state: &mut State, angle_rad: f64) {
        state.servo.command(&self.servo, angle_rad);
    }

    /// Ends a trigger pulse now. False if the robot has no such sonar or its echo line is not low: nothing happens
    /// then.
    pub fn trigger(&self, state: &mut State, sonar: SonarId) -> bool {
        let Some(view) = self.view(state, sonar) else {
            return false;
        };
        let now_us = state.now_us;
        let pings = self
            .sonar
            .trigger(&mut state.sonars, sonar, now_us, &self.world, &view);
        if pings {
            let in_air = |one: &&InAir| is_in_air(one, self.air_us);
            self.overhear(state, sonar, &view, self.air.iter().filter(in_air));
        }
        pings
    }

    fn overhear<'a>(
        &self,
        state: &mut State,
        sonar: SonarId,
        view: &View,
        pings: impl Iterator<Item = &'a InAir>,
    ) {
        let (now_us, own) = (state.now_us, &mut state.sonars[sonar.index()]);
        self.sonar
            .overhear_pings(own, sonar, now_us, &self.world, view, pings);
    }

    /// Lets the sonars receive pings of other robots, which have left within the last millisecond.
    pub fn receive_pings(&mut self, state: &mut State, pings: &[Ping]) {
        let air_us = state.now_us;
        self.air_us = air_us;
        if pings.is_empty() {
            return;
        }
        self.air.retain(|one| is_in_air(one, air_us));
        let received = self.air.len();
        self.air.extend(pings.iter().map(InAir::new));
        for sonar in SonarId::ALL {
            if state.sonars[sonar.index()].listens()
                && let Some(view) = self.view(state, sonar)
            {
                self.overhear(state, sonar, &view, self.air[received..].iter());
            }
        }
    }

    /// A sonar as it is now.
    #[must_use]
    pub const fn sonar<'a>(&self, state: &'a State, sonar: SonarId) -> &'a sonar::State {
        &state.sonars[sonar.index()]
    }

    /// Passes time up to `until_us` (nothing happens if that is past), reporting events in the order of time.
    pub fn advance(&self, state: &mut State, until_us: u64, events: &mut impl FnMut(Event)) {
        let mut queue = Queue::default();
        if state.now_us < until_us && self.stands(state) {
            self.stand(state, until_us);
            Self::pass_echoes(state, &mut queue, events);
            queue.flush(events);
        }
        while state.now_us < until_us {
            let grid_us = (state.now_us / STEP_US + 1) * STEP_US;
            self.step(state, grid_us.min(until_us), &mut queue, events);
            queue.flush(events);
        }
    }

    pub(crate) fn step(
        &self,
        state: &mut State,
        until_us: u64,
        queue: &mut Queue,
        events: &mut impl FnMut(Event),
    ) {
        let step_us = (until_us - state.now_us) as f64;
        let dt_s = step_us * 1e-6;

        let before_rad = state.drivetrain.wheels.map(|wheel| wheel.angle_rad);
        let resistance_n_m = self.footprint.resistance_n_m(&state.contact);
        let motion = self
            .drivetrain
            .step(&mut state.drivetrain, dt_s, resistance_n_m);
        for wheel in [Side::Left, Side::Right] {
            let i = wheel.index();
            let turn_rad = [before_rad[i], state.drivetrain.wheels[i].angle_rad];
            self.pass_edges(state, wheel, turn_rad, step_us, queue, events);
        }
        state.servo.step(&self.servo, dt_s);
        state.now_us = until_us;
        self.move_body(state, &motion, dt_s, queue, events);
        Self::pass_echoes(state, queue, events);
    }

    /// Reports the edges of a wheel that turns from one angle to another in the step of this length from now on.
    pub(crate) fn pass_edges(
        &self,
        state: &mut State,
        wheel: Side,
        [from_rad, to_rad]: [f64; 2],
        step_us: f64,
        queue: &mut Queue,
        events: &mut impl FnMut(Event),
    ) {
        let (i, from_us) = (wheel.index(), state.now_us);
        self.encoders[i].turn(&mut state.encoders[i], from_rad, to_rad, |edge| {
            // Within (from, until], rounded up: an edge at the very start belongs to the next microsecond.
            let exact_us = edge.fraction * step_us;
            let whole_us = exact_us as u32;
            let into_us = whole_us + u32::from(f64::from(whole_us) < exact_us);
            let event = Event::Edge {
                wheel,
                channel: edge.channel,
                at_us: from_us + u64::from(into_us.max(1)),
                level: edge.level,
            };
            queue.put(event, events);
        });
    }

    /// Reports the edges of the echo lines up to now. Inline: most steps have none.
    #[inline]
    pub(crate) fn pass_echoes(
        state: &mut State,
        queue: &mut Queue,
        events: &mut impl FnMut(Event),
    ) {
        let until_us = state.now_us;
        for sonar in SonarId::ALL {
            Sonar::advance(&mut state.sonars[sonar.index()], until_us, |edge| {
                let at_us = edge.at_us;
                let event = if edge.level {
                    Event::EchoRise { sonar, at_us }
                } else {
                    Event::EchoFall { sonar, at_us }
                };
                queue.put(event, events);
            });
        }
    }

    /// Moves the body along the arc of its wheels, as far as the world lets it.
    fn move_body(
        &self,
        state: &mut State,
        motion: &Motion,
        dt_s: f64,
        queue: &mut Queue,
        events: &mut impl FnMut(Event),
    ) {
        let at_rest = motion.forward_m == 0.0 && motion.yaw_rad == 0.0;
        if at_rest && (self.wheels_in_air || state.contact.stays_clear(&self.world, dt_s)) {
            state.speed = [0.0; 2];
            return;
        }
        let before = state.pose;
        let middle_rad = before.heading_rad + 0.5 * motion.yaw_rad;
        let (across, ahead) = sincos(middle_rad);
        let mut pose = Pose {
            x_m: before.x_m + motion.forward_m * ahead,
            y_m: before.y_m + motion.forward_m * across,
            heading_rad: before.heading_rad + motion.yaw_rad,
        };
        let step = contact::ContactStep {
            world: &self.world,
            until_us: state.now_us,
            dt_s,
        };
        let impact = self
            .footprint
            .settle(&step, &mut state.contact, &before, &mut pose);
        let moved_m = (pose.x_m - before.x_m) * ahead + (pose.y_m - before.y_m) * across;
        state.speed = [
            moved_m / dt_s,
            (pose.heading_rad - before.heading_rad) / dt_s,
        ];
        pose.heading_rad = wrapped(pose.heading_rad);
        state.pose = pose;
        if let Some(impact) = impact {
            let at_us = state.now_us;
            let event = Event::Contact {
                at_us,
                obstacle: impact.obstacle,
                speed_m_s: impact.speed_m_s,
            };
            queue.put(event, events);
        }
    }

    fn view(&self, state: &State, sonar: SonarId) -> Option<View> {
        self.view_from(&state.pose, state.speed, state.servo.angle_rad, sonar)
    }

    /// A sonar's view from a pose at a speed, by the servo's angle.
    fn view_from(
        &self,
        pose: &Pose,
        [forward_m_s, yaw_rad_s]: [f64; 2],
        servo_rad: f64,
        sonar: SonarId,
    ) -> Option<View> {
        self.mounts[sonar.index()].map(|mount| {
            let (s, c) = sincos(pose.heading_rad);
            let along = forward_m_s - yaw_rad_s * mount.y_m;
            let across = yaw_rad_s * mount.x_m;
            let servo_rad = if mount.on_servo { servo_rad } else { 0.0 };
            View {
                at: [
                    pose.x_m + c * mount.x_m - s * mount.y_m,
                    pose.y_m + s * mount.x_m + c * mount.y_m,
                ],
                axis_rad: pose.heading_rad + mount.angle_rad + servo_rad,
                speed_m_s: sqrt(along * along + across * across),
            }
        })
    }

    /// The present time, pose and speeds. Costs one exact cone query per sonar.
    #[must_use]
    pub fn truth(&self, state: &State) -> GroundTruth {
        let range_m = SonarId::ALL
            .map(|sonar| self.range_m(sonar, state.now_us, &state.pose, state.servo.angle_rad));
        let [left, right] = &state.drivetrain.wheels;
        GroundTruth {
            now_us: state.now_us,
            pose: state.pose,
            wheel_rad_s: [left.speed_rad_s, right.speed_rad_s],
            wheel_rad: [left.angle_rad, right.angle_rad],
            forward_m_s: state.speed[0],
            yaw_rad_s: state.speed[1],
            range_m,
            battery_v: self.battery_v(state),
            battery_a: state.drivetrain.battery.current_a,
            servo_rad: state.servo.angle_rad,
            contacts: state.contact.contacts,
            touching: state.contact.touching(),
        }
    }

    /// Noise-free range of a sonar from a pose at an instant, by the servo's angle; infinite where nothing is within reach,
    /// `None` where there is no such sonar.
    #[must_use]
    pub fn range_m(&self, sonar: SonarId, now_us: u64, pose: &Pose, servo_rad: f64) -> Option<f64> {
        let view = self.view_from(pose, [0.0; 2], servo_rad, sonar)?;
        Some(self.sonar.true_range_m(&self.world, now_us, &view))
    }

    /// Whether their worlds are one and the same thing in memory.
    #[must_use]
    pub fn has_world_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.world, &other.world)
    }

    /// Terminal voltage of the battery.
    #[must_use]
    pub fn battery_v(&self, state: &State) -> f64 {
        self.drivetrain.battery_v(&state.drivetrain)
    }

    /// Speeds of both wheels, left and right, forward positive.
    #[must_use]
    pub const fn wheel_rad_s(&self, state: &State) -> [f64; 2] {
        let [left, right] = &state.drivetrain.wheels;
        [left.speed_rad_s, right.speed_rad_s]
    }

    /// Levels of both Hall sensors, left and right.
    #[must_use]
    pub fn encoder_levels(&self, state: &State) -> [bool; 4] {
        let level =
            |index: usize, channel| self.encoders[index].level(&state.encoders[index], channel);
        [
            level(0, Channel::A),
            level(1, Channel::A),
            level(0, Channel::B),
            level(1, Channel::B),
        ]
    }

    /// Lifts the robot of these parameters so that its wheels turn freely, or puts it down.
    pub fn lift(&mut self, params: &Params, wheels_in_air: bool) {
        self.drivetrain = self.drivetrain.moved(params, !wheels_in_air);
        self.wheels_in_air = wheels_in_air;
    }

    /// True if the robot was set up with its wheels off the floor.
    #[must_use]
    pub const fn wheels_in_air(&self) -> bool {
        self.wheels_in_air
    }
}

impl State {
    /// Where the body is.
    #[must_use]
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Time since the start.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// The servo's angle: 0 ahead, positive to the left.
    #[must_use]
    pub const fn servo_rad(&self) -> f64 {
        self.servo.angle_rad
    }

    /// Speed of the body along its x axis, and its turn rate, counter-clockwise.
    #[must_use]
    pub const fn speed(&self) -> [f64; 2] {
        self.speed
    }

    /// Whether the body touches something.
    #[must_use]
    pub const fn touching(&self) -> bool {
        self.contact.touching()
    }

    /// Holds a wheel, as a hand or a thread around its axle would, with so much dry friction [N m]; 0 lets go.
    pub fn hold(&mut self, wheel: Side, friction_n_m: f64) {
        self.contact.held_n_m[wheel.index()] = friction_n_m;
    }

    /// Moves the robot, as a hand would: speeds and everything else stay.
    pub fn place(&mut self, pose: Pose) {
        self.pose = pose;
        self.contact.clearance_m = 0.0;
    }
}

/// Heading in (-pi, pi] of one at most a turn outside.
fn wrapped(heading_rad: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    if heading_rad > PI {
        heading_rad - TAU
    } else if heading_rad <= -PI {
        heading_rad + TAU
    } else {
        heading_rad
    }
}
