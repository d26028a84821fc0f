//! Who has control: one page at a time, of those that may have it.
//!
//! A controller's page gets control with its first order while no page has it, and keeps it until it releases it, is
//! closed, or another controller takes it on purpose. STOP needs no control. A page is shown a [`ControlView`] of it.

use crate::orders::Order;
use rumbo_wire::Command;
use serde::Serialize;
use std::collections::BTreeMap;

/// Most pages at once.
const PAGES: usize = 100;
/// Further places, reserved for pages that may have control.
const FOR_CONTROLLERS: usize = 28;

/// The number of a page, in order of arrival.
pub type PageId = u64;

/// A page's relation to control, as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Seat {
    /// It may watch and stop.
    Viewer,
    /// No page has control: its first order takes it.
    Free,
    /// It has control.
    Driver,
    /// Another page has control.
    Passenger,
}

/// What a page is shown of control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ControlView {
    /// Its relation to control.
    pub seat: Seat,
    /// The page itself.
    pub page: PageId,
    /// The page that has control.
    pub holder: Option<PageId>,
    /// Pages that are open, viewers too.
    pub pages: usize,
}

/// The one lease of control.
#[derive(Debug, Default)]
pub struct Lease {
    last: PageId,
    holder: Option<PageId>,
    /// The pages that are open, and whether each may have control.
    pages: BTreeMap<PageId, bool>,
}

impl Lease {
    /// Admits a page; `None`: too many are open.
    pub fn join(&mut self, may_control: bool) -> Option<PageId> {
        let places = PAGES + if may_control { FOR_CONTROLLERS } else { 0 };
        if self.pages.len() >= places {
            return None;
        }
        self.last += 1;
        self.pages.insert(self.last, may_control);
        Some(self.last)
    }

    /// Removes a page, and releases its control.
    pub fn leave(&mut self, page: PageId) {
        self.release(page);
        self.pages.remove(&page);
    }

    /// Whether a page may give this order; why not otherwise.
    ///
    /// # Errors
    /// The reason, for a person.
    pub fn admit(&mut self, order: &Order, page: PageId) -> Result<(), &'static str> {
        let may_control = self.pages.get(&page) == Some(&true);
        match order {
            Order::Robot(Command::Stop) => return Ok(()),
            Order::ReleaseControl => {
                self.release(page);
                return Ok(());
            }
            Order::Sketch(..) => return Ok(()),
            Order::TakeControl if may_control => self.holder = Some(page),
            _ if may_control => {
                self.holder.get_or_insert(page);
            }
            _ => return Err("refused: this page may watch, and stop the robot"),
        }
        match self.holder == Some(page) {
            true => Ok(()),
            false => Err("refused: another page has control; take it first"),
        }
    }

    fn release(&mut self, page: PageId) {
        self.holder.take_if(|holder| *holder == page);
    }

    /// What a page is shown.
    #[must_use]
    pub fn view(&self, page: PageId) -> ControlView {
        let seat = match self.holder {
            _ if self.pages.get(&page) != Some(&true) => Seat::Viewer,
            None => Seat::Free,
            Some(holder) if holder == page => Seat::Driver,
            Some(_) => Seat::Passenger,
        };
        ControlView {
            seat,
            page,
            holder: self.holder,
            pages: self.pages.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: Order = Order::Robot(Command::Arm);
    const STOP: Order = Order::Robot(Command::Stop);

    #[test]
    fn one_page_has_control_until_it_leaves_or_another_takes_it() {
        let mut lease = Lease::default();
        let [first, second, viewer] = [true, true, false].map(|may| lease.join(may).unwrap());
        let seats = |lease: &Lease| [first, second, viewer].map(|page| lease.view(page).seat);
        assert_eq!(lease.view(second).seat, Seat::Free);
        let asked = [first, second, viewer].map(|page| lease.admit(&ARM, page).is_ok());
        assert_eq!(asked, [true, false, false]);
        assert_eq!(seats(&lease), [Seat::Driver, Seat::Passenger, Seat::Viewer]);
        assert!(lease.admit(&Order::TakeControl, viewer).is_err());
        // Code may be looked at, not run.
        assert!(lease.admit(&Order::Sketch(1, None), viewer).is_ok());
        assert!(lease.admit(&Order::Debug("".into()), viewer).is_err());
        assert!(lease.admit(&Order::TakeControl, second).is_ok());
        assert_eq!(lease.view(first).seat, Seat::Passenger);
        assert!(lease.admit(&ARM, first).is_err());
        // A page without control releases none by leaving.
        lease.leave(first);
        assert_eq!(lease.view(second).seat, Seat::Driver);
        let watching = lease.view(viewer);
        assert_eq!((watching.holder, watching.pages), (Some(second), 2));
        // A page may release control and stay.
        assert!(lease.admit(&Order::ReleaseControl, viewer).is_ok());
        assert_eq!(lease.view(second).seat, Seat::Driver);
        assert!(lease.admit(&Order::ReleaseControl, second).is_ok());
        assert_eq!(lease.view(second).seat, Seat::Free);
        assert_eq!(lease.view(viewer).holder, None);
        assert!(lease.admit(&ARM, second).is_ok());
        lease.leave(second);
        let third = lease.join(true).unwrap();
        assert_eq!(lease.view(third).seat, Seat::Free);
    }

    #[test]
    fn a_viewer_may_stop_and_nothing_else_and_so_may_a_page_without_control() {
        let mut lease = Lease::default();
        let [driver, other, viewer] = [true, true, false].map(|may| lease.join(may).unwrap());
        // STOP takes no control.
        assert!(lease.admit(&STOP, other).is_ok());
        assert_eq!(lease.view(other).seat, Seat::Free);
        let why = lease.admit(&ARM, viewer).unwrap_err();
        assert!(why.contains("watch"), "{why}");
        assert!(lease.admit(&ARM, driver).is_ok());
        let why = lease.admit(&ARM, other).unwrap_err();
        assert!(why.contains("another page"), "{why}");
        for order in [Order::Speed(2.0), Order::Seek(1.0), Order::TakeControl] {
            assert!(lease.admit(&order, viewer).is_err(), "{order:?}");
        }
        for page in [driver, other, viewer] {
            assert!(lease.admit(&STOP, page).is_ok());
        }
        assert!(lease.admit(&Order::TakeControl, other).is_ok());
        assert!(lease.admit(&ARM, driver).is_err());
    }

    #[test]
    fn many_viewers_leave_places_for_controllers() {
        let mut lease = Lease::default();
        let viewers: Vec<_> = std::iter::from_fn(|| lease.join(false)).collect();
        let driver = lease.join(true).unwrap();
        assert!(lease.admit(&ARM, driver).is_ok());
        let others: Vec<_> = std::iter::from_fn(|| lease.join(true)).collect();
        let there = viewers.len() + 1 + others.len();
        assert_eq!((there, viewers.len()), (PAGES + FOR_CONTROLLERS, PAGES));
        viewers.into_iter().for_each(|page| lease.leave(page));
        assert!(lease.join(false).is_some());
    }
}
