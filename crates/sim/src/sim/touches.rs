//! What the body has met.

use rumbo_plant::plant::Event;

/// The beginning of a touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactStart {
    /// End of the step in which it began [us].
    pub at_us: u64,
    /// Index of the obstacle in the world, followed by those of its bodies.
    pub obstacle: usize,
    /// Closing speed of the points that met [m/s].
    pub speed_m_s: f64,
}

/// Touches in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches(pub(super) Vec<ContactStart>);

impl Touches {
    /// Notes an event, if it is a touch.
    pub(super) fn note(&mut self, event: &Event) {
        if let Event::Contact {
            at_us,
            obstacle,
            speed_m_s,
        } = *event
        {
            self.0.push(ContactStart {
                at_us,
                obstacle,
                speed_m_s,
            });
        }
    }

    /// Fastest [m/s]; 0 without any.
    pub(super) fn worst_m_s(&self) -> f64 {
        self.0
            .iter()
            .map(|touch| touch.speed_m_s)
            .fold(0.0, f64::max)
    }
}
