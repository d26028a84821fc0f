//! What crossed the link, burst after burst: all bytes together, for a burst each 10 ms would be as many allocations.

use std::fmt;

/// Raw bytes that crossed the link together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkBurst<'a> {
    /// When they were sent to the robot, or had arrived from it [us].
    pub t_us: u64,
    /// To the robot, or from it.
    pub to_robot: bool,
    /// What.
    pub bytes: &'a [u8],
}

/// Bursts in order.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct LinkTape {
    bytes: Vec<u8>,
    /// Each one's time [us], whether it went to the robot, and where its bytes end.
    bursts: Vec<(u64, bool, usize)>,
}

impl LinkTape {
    /// Adds a burst at the end.
    pub fn push(&mut self, burst: LinkBurst<'_>) {
        self.bytes.extend_from_slice(burst.bytes);
        let end = self.bytes.len();
        self.bursts.push((burst.t_us, burst.to_robot, end));
    }

    /// Adds those of another one.
    pub fn append(&mut self, later: Self) {
        if self.is_empty() {
            *self = later;
        } else {
            later.iter().for_each(|burst| self.push(burst));
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = LinkBurst<'_>> {
        let mut from = 0;
        self.bursts.iter().map(move |&(t_us, to_robot, end)| {
            let begin = std::mem::replace(&mut from, end);
            LinkBurst {
                t_us,
                to_robot,
                bytes: self.bytes.get(begin..end).unwrap_or_default(),
            }
        })
    }

    /// Nothing crossed it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.bursts.is_empty()
    }
}

/// The list of the bursts.
impl fmt::Debug for LinkTape {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_list().entries(self.iter()).finish()
    }
}
