//! May the wheels turn?
//!
//! # Theory of operation
//!
//! The robot starts disarmed after any reset. Only a command arms it, and only if the other end of the link is alive,
//! the mode's sensors give good readings, and no fault is latched. While armed, any fault releases the wheels and
//! latches with its cause until a command clears it; a link silent for longer than its time-out is such a fault.
//! Only a command arms again: neither the return of the link nor the clearing does.
//!
//! | from | what happens | to | effect |
//! |---|---|---|---|
//! | disarmed | arm, all is well | armed | the mode starts; event *armed* |
//! | disarmed | arm, something is not | disarmed | refused, with the reason |
//! | armed | arm | armed | none |
//! | armed | stop, disarm | disarmed | wheels released; event *disarmed* |
//! | armed | fault | faulted | wheels released; events *fault*, *disarmed* |
//! | faulted | arm | faulted | refused: *faulted* |
//! | faulted | clear | disarmed | event *cleared* |
//! | faulted | another fault, stop, disarm | faulted | none: the first cause stays |
//! | disarmed | fault, stop, disarm, clear | disarmed | none |

use rumbo_control::{Fault, Micros};
use rumbo_wire::{EventKind, Refusal};

/// The supervisor's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum State {
    /// The wheels are released.
    #[default]
    Disarmed,
    /// The mode drives.
    Armed,
    /// The wheels are released, and stay so until the fault is cleared.
    Faulted(Fault),
}

/// The state machine and the liveness of the link.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Supervisor {
    state: State,
    /// The tick of the last sign of life; `None` when that is too long ago, so that a wrap of the clock never makes an
    /// old one recent.
    alive_at: Option<Micros>,
}

impl Supervisor {
    /// The wheels may turn.
    pub(crate) fn is_armed(&self) -> bool {
        self.state == State::Armed
    }

    /// The latched fault.
    pub(crate) fn fault(&self) -> Option<Fault> {
        match self.state {
            State::Faulted(fault) => Some(fault),
            State::Disarmed | State::Armed => None,
        }
    }

    /// Records a sign of life.
    pub(crate) fn sign_of_life(&mut self, now: Micros) {
        self.alive_at = Some(now);
    }

    /// Declares the link dead after `timeout_us` without a sign of life. To be called at every tick.
    pub(crate) fn watch_link(&mut self, now: Micros, timeout_us: u32) -> Option<EventKind> {
        if self.alive_at.is_some_and(|at| now.since(at) >= timeout_us) {
            self.alive_at = None;
        }
        if self.alive_at.is_none() {
            self.fail(Fault::LinkLost)
        } else {
            None
        }
    }

    /// Arms; `ready` is the mode's check of its sensors.
    ///
    /// # Errors
    /// The reason for the refusal.
    pub(crate) fn arm(&mut self, ready: Result<(), Refusal>) -> Result<Option<EventKind>, Refusal> {
        match self.state {
            State::Armed => Ok(None),
            State::Faulted(_) => Err(Refusal::Faulted),
            State::Disarmed => {
                if self.alive_at.is_none() {
                    return Err(Refusal::NoLink);
                }
                ready?;
                self.state = State::Armed;
                Ok(Some(EventKind::Armed))
            }
        }
    }

    /// Stops and disarms.
    pub(crate) fn disarm(&mut self) -> Option<EventKind> {
        if !self.is_armed() {
            return None;
        }
        self.state = State::Disarmed;
        Some(EventKind::Disarmed)
    }

    /// Latches a fault if armed; *disarmed* follows the returned event.
    pub(crate) fn fail(&mut self, fault: Fault) -> Option<EventKind> {
        if !self.is_armed() {
            return None;
        }
        self.state = State::Faulted(fault);
        Some(EventKind::Faulted(fault))
    }

    /// Clears the latched fault.
    pub(crate) fn clear(&mut self) -> Option<EventKind> {
        let fault = self.fault()?;
        self.state = State::Disarmed;
        Some(EventKind::Cleared(fault))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMEOUT_US: u32 = 400_000;

    fn with_link() -> Supervisor {
        let mut supervisor = Supervisor::default();
        supervisor.sign_of_life(Micros(0));
        supervisor
    }

    #[test]
    fn starts_disarmed_and_arms_only_with_a_live_link_and_good_sensors() {
        let mut supervisor = Supervisor::default();
        assert_eq!(supervisor.state, State::Disarmed);
        assert_eq!(supervisor.arm(Ok(())), Err(Refusal::NoLink));
        let mut supervisor = with_link();
        assert_eq!(
            supervisor.arm(Err(Refusal::SonarNotReady)),
            Err(Refusal::SonarNotReady)
        );
        assert_eq!(supervisor.state, State::Disarmed);
        assert_eq!(supervisor.arm(Ok(())), Ok(Some(EventKind::Armed)));
        assert_eq!(supervisor.arm(Ok(())), Ok(None));
    }

    #[test]
    fn the_first_fault_latches_until_it_is_cleared_and_clearing_does_not_arm() {
        let mut supervisor = with_link();
        assert_eq!(
            supervisor.fail(Fault::WallLost),
            None,
            "nothing to stop while disarmed"
        );
        supervisor.arm(Ok(())).unwrap();
        assert_eq!(
            supervisor.fail(Fault::WallLost),
            Some(EventKind::Faulted(Fault::WallLost))
        );
        assert_eq!(supervisor.fail(Fault::LinkLost), None);
        assert_eq!(supervisor.arm(Ok(())), Err(Refusal::Faulted));
        assert_eq!(supervisor.disarm(), None);
        assert_eq!(
            supervisor.clear(),
            Some(EventKind::Cleared(Fault::WallLost))
        );
        assert_eq!(
            (supervisor.state, supervisor.clear()),
            (State::Disarmed, None)
        );
    }

    #[test]
    fn a_dead_link_stays_dead_when_the_clock_wraps() {
        let mut supervisor = with_link();
        supervisor.arm(Ok(())).unwrap();
        assert_eq!(supervisor.watch_link(Micros(399_999), TIMEOUT_US), None);
        let lost = Some(EventKind::Faulted(Fault::LinkLost));
        assert_eq!(supervisor.watch_link(Micros(400_000), TIMEOUT_US), lost);
        supervisor.clear();
        supervisor.watch_link(Micros(10), TIMEOUT_US);
        assert_eq!(supervisor.arm(Ok(())), Err(Refusal::NoLink));
    }

    #[test]
    fn a_live_link_survives_the_wrap_of_the_clock() {
        let mut supervisor = Supervisor::default();
        supervisor.sign_of_life(Micros(u32::MAX - 100_000));
        supervisor.arm(Ok(())).unwrap();
        assert_eq!(supervisor.watch_link(Micros(200_000), TIMEOUT_US), None);
        assert!(supervisor.watch_link(Micros(300_000), TIMEOUT_US).is_some());
    }
}
