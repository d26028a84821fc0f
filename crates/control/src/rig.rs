//! Where the sonars sit: the rigs of the report, a number in the parameter table.
//!
//! | number | rig | left | right | front |
//! |---|---|---|---|---|
//! | 0 | `front_single` (mode 1) | | | ahead |
//! | 1 | `front_pair` (mode 2) | ahead, left of the middle | ahead, right of it | |
//! | 2 | `side_pair_left` (modes 3, 4) | to the left, in front | to the left, behind | |
//! | 3 | `side_pair_right` | to the right, in front | to the right, behind | |
//! | 4 | `final` (mode 8) | to the left | to the right | ahead, on the servo |

use crate::types::Side;

crate::numbered! {
    /// Which sonars the robot carries, and where.
    #[derive(Default)]
    pub enum Rig {
        /// One sonar looking ahead.
        FrontSingle = 0,
        /// Two looking ahead.
        FrontPair = 1,
        /// Two looking to the left.
        SidePairLeft = 2,
        /// Two looking to the right.
        SidePairRight = 3,
        /// One on the servo in front, one on each side.
        #[default]
        Final = 4,
    }
}

impl Rig {
    /// The names, by number.
    #[cfg(feature = "names")]
    pub const NAMES: [&str; Self::ALL.len()] = {
        let (mut names, mut i) = ([""; Self::ALL.len()], 0);
        while i < names.len() {
            names[i] = Self::ALL[i].name();
            i += 1;
        }
        names
    };

    /// The name used in files.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        match self {
            Rig::FrontSingle => "front_single",
            Rig::FrontPair => "front_pair",
            Rig::SidePairLeft => "side_pair_left",
            Rig::SidePairRight => "side_pair_right",
            Rig::Final => "final",
        }
    }

    /// The rig whose number is nearest, ties to even.
    pub(crate) fn nearest(number: f32) -> Rig {
        if number >= 3.5 {
            Rig::Final
        } else if number <= 0.5 {
            Rig::FrontSingle
        } else if number < 1.5 {
            Rig::FrontPair
        } else if number <= 2.5 {
            Rig::SidePairLeft
        } else {
            Rig::SidePairRight
        }
    }

    /// The side on which a pair of sonars looks, if this rig has one.
    pub const fn paired_side(self) -> Option<Side> {
        match self {
            Rig::SidePairLeft => Some(Side::Left),
            Rig::SidePairRight => Some(Side::Right),
            Rig::FrontSingle | Rig::FrontPair | Rig::Final => None,
        }
    }
}

/// Some of the rigs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rigs(u8);

impl Rigs {
    /// Any rig.
    pub const ANY: Rigs = Rigs::of(&Rig::ALL);

    /// These rigs.
    pub const fn of(rigs: &[Rig]) -> Rigs {
        let (mut bits, mut i) = (0, 0);
        while i < rigs.len() {
            bits |= 1 << rigs[i] as u8;
            i += 1;
        }
        Rigs(bits)
    }

    /// Which they are.
    #[cfg(feature = "names")]
    pub fn iter(self) -> impl Iterator<Item = Rig> {
        Rig::ALL.into_iter().filter(move |rig| self.contains(*rig))
    }

    /// Whether this one is among them.
    pub const fn contains(self, rig: Rig) -> bool {
        self.0 & (1 << rig as u8) != 0
    }
}
