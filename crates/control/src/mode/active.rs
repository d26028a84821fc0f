//! The list of the modes, and the one that runs: its setpoint, its state, and what it needs of the robot.

use super::description::Description;
use super::reference::{Reference, ReferenceKind};
use super::{
    Action, Mode, SetpointError, front_align, front_distance, manual, mission, policy,
    straight_line, twist, wall_follow, wall_hold, waypoints, wheel_speed,
};
use crate::estimate::Estimate;
#[cfg(feature = "names")]
use crate::params::ParamId;
use crate::params::Params;
use crate::policy::{NetworkShape, Observation};
use crate::rig::Rig;
use crate::types::{Fault, Look};

/// Declares [`ModeId`] and [`ActiveMode`] by a list of modes and their modules.
macro_rules! modes {
    ($( #[doc = $about:literal] $( #[$default:ident] )? $mode:ident: $module:ident; )+) => {
        /// The modes: those of the report by the number they have there, and others.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u8)]
        pub enum ModeId { $( #[doc = $about] $( #[$default] )? $mode = $module::DESCRIPTION.number, )+ }

        impl ModeId {
            /// All modes, in the order of their numbers.
            pub const ALL: [ModeId; [$( $module::DESCRIPTION.number ),+].len()] = [ $( ModeId::$mode ),+ ];

            /// What the mode is.
            #[cfg(feature = "names")]
            pub const fn description(self) -> &'static Description {
                match self { $( ModeId::$mode => &$module::DESCRIPTION, )+ }
            }

            /// What the reference is, if there is one.
            pub const fn reference_kind(self) -> Option<ReferenceKind> {
                match self { $( ModeId::$mode => const { kind(&$module::DESCRIPTION) }, )+ }
            }

            /// The same if a command sets it.
            pub const fn takes_reference(self) -> Option<ReferenceKind> {
                match self { $( ModeId::$mode => const { commanded(&$module::DESCRIPTION) }, )+ }
            }
        }

        /// The mode that runs, with its setpoint and its state.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(
            clippy::large_enum_variant,
            reason = "one mode is active at a time, in place; there is no heap to box the large one in"
        )]
        pub enum ActiveMode { $(
            #[doc = $about]
            $mode(<$module::$mode<'static> as Mode<'static>>::Setpoint, <$module::$mode<'static> as Mode<'static>>::State),
        )+ }

        impl ActiveMode {
            /// A mode at its start, with its default setpoint.
            pub fn new(id: ModeId) -> Self {
                match id { $( ModeId::$mode => Self::$mode($module::$mode::first(), Default::default()), )+ }
            }

            /// Which mode it is.
            pub fn id(&self) -> ModeId {
                match self { $( Self::$mode(..) => ModeId::$mode, )+ }
            }

            /// Forgets its state and keeps its setpoint: the wheels have just been armed.
            pub fn start(&mut self) {
                match self { $( Self::$mode(_, state) => $module::$mode::start(state), )+ }
            }

            /// Where it needs to look, armed or not.
            pub fn look(&self) -> Look {
                match self { $( Self::$mode(..) => $module::$mode::LOOK, )+ }
            }

            /// Whether the mode can do its work with the sonars of this rig.
            pub fn fits(&self, rig: Rig) -> bool {
                let rigs = match self { $( Self::$mode(..) => const { $module::DESCRIPTION.rigs }, )+ };
                rigs.contains(rig)
            }

            /// Whether the sensors it needs give good readings.
            pub fn is_ready(&self, params: &Params, estimate: &Estimate) -> bool {
                match self { $( Self::$mode(setpoint, _) => $module::$mode::new(params, setpoint).is_ready(estimate), )+ }
            }

            /// The reference in force.
            pub fn reference(&self) -> Reference {
                match self { $( Self::$mode(setpoint, state) => $module::$mode::reference(setpoint, state), )+ }
            }

            /// Sets the reference: a distance [m], or the speed of both wheels [rad/s].
            ///
            /// # Errors
            /// Why it is refused; the last one stays.
            pub fn set_reference(&mut self, value: f32) -> Result<(), SetpointError> {
                match self { $( Self::$mode(setpoint, _) => $module::$mode::set_reference(setpoint, value), )+ }
            }

            /// One tick.
            ///
            /// # Errors
            /// Why the mode must stop.
            pub fn step(&mut self, params: &Params, estimate: &Estimate) -> Result<Action, Fault> {
                match self { $( Self::$mode(setpoint, state) => $module::$mode::new(params, setpoint).step(state, estimate), )+ }
            }

            /// What its own loops are made of by this estimate, after its tick; `None` where it has none.
            #[cfg(not(target_arch = "avr"))]
            pub fn terms(&self, params: &Params, estimate: &Estimate) -> Option<super::ModeTerms> {
                match self { $( Self::$mode(setpoint, state) => $module::$mode::new(params, setpoint).terms(state, estimate), )+ }
            }
        }
    };
}

modes! {
    /// Basic movements, open loop or by speed (memoria 1).
    #[default]
    Manual: manual;
    /// Stop at a distance from a wall (memoria 2.1).
    FrontDistance: front_distance;
    /// Stop square to a wall at a distance from it (memoria 2.2).
    FrontAlign: front_align;
    /// Follow a wall at the distance at which the robot starts (memoria 3.1).
    WallHold: wall_hold;
    /// Follow a wall at a commanded distance (memoria 3.2).
    WallFollow: wall_follow;
    /// Each wheel at a commanded speed (memoria 4.1).
    WheelSpeed: wheel_speed;
    /// Straight on, by the difference of distance travelled (memoria 4.2).
    StraightLine: straight_line;
    /// A route of poses by odometry (memoria 4.3).
    Waypoints: waypoints;
    /// A goal around obstacles, or a lane of boxes (memoria 5).
    Mission: mission;
    /// A goal by a learned network.
    Policy: policy;
    /// A forward speed and a yaw rate from outside.
    Twist: twist;
}

impl ModeId {
    /// Its name in files, commands and the dashboard.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        self.description().name
    }

    /// The mode with this number.
    pub fn from_number(number: u8) -> Option<ModeId> {
        Self::ALL.into_iter().find(|mode| *mode as u8 == number)
    }
}

impl ActiveMode {
    /// Works on a decision of mode 9 after its tick, with the network whose bytes `read` gives; `observe` is what the robot
    /// knows, with the goal there.
    pub fn decide(
        &mut self,
        shape: &NetworkShape,
        read: impl Fn(u16) -> u8,
        observe: impl FnOnce(&(f32, f32)) -> Observation,
    ) {
        if let Self::Policy(policy::Goal(Some(goal_m)), state) = self {
            state.decide(goal_m, shape, read, observe);
        }
    }
}

#[cfg(feature = "names")]
impl ParamId {
    /// The modes that use it; none for parameters of the robot in any mode.
    pub fn modes(self) -> impl Iterator<Item = ModeId> {
        ModeId::ALL.into_iter().filter(move |mode| {
            let mut groups = mode.description().parameters.iter();
            groups.any(|group| group.parameters.contains(&self))
        })
    }
}

impl Default for ActiveMode {
    fn default() -> Self {
        Self::new(ModeId::default())
    }
}

const fn kind(description: &Description) -> Option<ReferenceKind> {
    match description.reference {
        Some(reference) => Some(reference.kind),
        None => None,
    }
}

const fn commanded(description: &Description) -> Option<ReferenceKind> {
    match description.reference {
        Some(reference) if reference.commanded => Some(reference.kind),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::{Range, SonarId};

    #[test]
    fn modes_are_found_by_their_number() {
        assert!(ModeId::ALL.is_sorted_by_key(|mode| *mode as u8));
        for mode in ModeId::ALL {
            assert_eq!(ModeId::from_number(mode as u8), Some(mode));
            assert_eq!(ActiveMode::new(mode).id(), mode);
        }
        assert_eq!(ModeId::from_number(11), None);
    }

    #[test]
    fn the_front_mode_is_ready_only_when_its_sonar_sees_a_wall() {
        let mode = ActiveMode::new(ModeId::FrontDistance);
        let (params, mut estimate) = (Params::default(), Estimate::default());
        assert!(!mode.is_ready(&params, &estimate));
        estimate.ranges[SonarId::Front as usize].range = Range::Clear;
        assert!(!mode.is_ready(&params, &estimate));
        let front = &mut estimate.ranges[SonarId::Front as usize];
        front.range = Range::Valid(0.8);
        assert!(!mode.is_ready(&params, &estimate), "an old reading");
        estimate.ranges[SonarId::Front as usize].age_ticks = 10;
        assert!(mode.is_ready(&params, &estimate));
        assert!(ActiveMode::new(ModeId::Manual).is_ready(&params, &Estimate::default()));
    }

    #[test]
    fn a_mode_fits_the_rigs_that_carry_its_sonars() {
        let fits = |id| Rig::ALL.map(|rig| ActiveMode::new(id).fits(rig));
        assert_eq!(
            fits(ModeId::FrontDistance),
            [true, false, false, false, true]
        );
        assert_eq!(fits(ModeId::FrontAlign), [false, true, false, false, true]);
        assert_eq!(fits(ModeId::WallFollow), [false, false, true, true, true]);
        assert_eq!(fits(ModeId::Waypoints), [true; 5]);
    }
}

/// Guarantees of the descriptions for the code that derives from them.
#[cfg(all(test, feature = "names"))]
mod descriptions {
    use super::*;

    #[test]
    fn a_way_leads_to_another_state_and_is_described_once() {
        for mode in ModeId::ALL {
            let states = mode.description().states;
            assert!(states.len() <= 16, "telemetry has four bits: {mode:?}");
            for (from, state) in states.iter().enumerate() {
                for (index, way) in state.ways.iter().enumerate() {
                    assert_ne!(usize::from(way.to), from, "{mode:?} {way:?}");
                    let twice = state.ways[..index].iter().any(|other| other.to == way.to);
                    assert!(!twice, "{mode:?} {way:?}");
                }
            }
        }
    }

    #[test]
    fn every_state_can_be_reached() {
        // Mode 4 has the first state of mode 3, which measures, and never is in it.
        for mode in ModeId::ALL {
            let states = mode.description().states;
            for (number, state) in states.iter().enumerate().skip(1) {
                let mut ways = states.iter().flat_map(|state| state.ways);
                assert!(
                    ways.any(|way| usize::from(way.to) == number),
                    "{mode:?} {state:?}"
                );
            }
        }
    }

    #[test]
    fn a_reference_begins_within_its_range_and_a_parameter_is_in_one_group() {
        for mode in ModeId::ALL {
            let about = mode.description();
            if let Some(reference) = about.reference {
                let [first, _] = ActiveMode::new(mode).reference().numbers();
                assert_eq!(reference.check(reference.offered), Ok(()), "{mode:?}");
                assert_eq!(
                    reference.check(first).is_ok(),
                    reference.commanded,
                    "{mode:?}"
                );
                assert_eq!(
                    ActiveMode::new(mode)
                        .set_reference(reference.offered)
                        .is_ok(),
                    reference.commanded && reference.kind != ReferenceKind::Goal,
                );
            }
            let mut ids = about.parameters.iter().flat_map(|group| group.parameters);
            while let Some(id) = ids.next() {
                assert!(!ids.clone().any(|other| other == id), "{mode:?} {id:?}");
            }
            let rigs = Rig::ALL.map(|rig| about.rigs.contains(rig));
            assert!(rigs.contains(&true), "{mode:?}");
        }
    }
}
