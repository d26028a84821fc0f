//! Who has control: one page at a time, of those that may have it.
//!
//! A controller's page gets control with its first order while nobody has it, and keeps it until it lets go, is closed, or another controller
//! takes it on purpose. STOP needs no control. What a page is told of it is [`View`].

use serde::Serialize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Pages at once.
const PAGES: usize = 100;
/// Places besides for pages that may have control: viewers leave them free.
const FOR_CONTROLLERS: usize = 28;

/// The number of a page, in the order in which they came.
pub(crate) type PageId = u64;

/// Where a page sits, as it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Seat {
    /// It may watch and stop.
    Viewer,
    /// Nobody has control: its first order takes it.
    Free,
    /// It has control.
    Driver,
    /// Another page has control.
    Passenger,
}

/// What a page is told of control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct View {
    pub(crate) seat: Seat,
    /// The page itself.
    pub(crate) page: PageId,
    /// The page that has control.
    pub(crate) holder: Option<PageId>,
    /// Pages that are open, viewers too.
    pub(crate) pages: usize,
}

#[derive(Debug, Default)]
struct Holder {
    next: PageId,
    held_by: Option<PageId>,
    pages: usize,
}

/// The one lease of control.
#[derive(Clone, Debug)]
pub(crate) struct Lease {
    holder: Arc<Mutex<Holder>>,
    changed: watch::Sender<()>,
}

impl Lease {
    /// A lease that nobody has.
    pub(crate) fn new() -> Self {
        Self {
            holder: Arc::default(),
            changed: watch::Sender::new(()),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Holder> {
        self.holder.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes its holder when control has changed hands.
    pub(crate) fn subscribe(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    /// A page has come; `None`: there is no place for it.
    pub(crate) fn sit_down(&self, may_control: bool) -> Option<Place> {
        let mut holder = self.lock();
        let places = PAGES + if may_control { FOR_CONTROLLERS } else { 0 };
        if holder.pages >= places {
            return None;
        }
        holder.next += 1;
        holder.pages += 1;
        self.changed.send_replace(());
        Some(Place {
            page: holder.next,
            may_control,
            lease: self.clone(),
        })
    }
}

/// A page's place; with it goes control, if it had it.
#[derive(Debug)]
pub(crate) struct Place {
    page: PageId,
    may_control: bool,
    lease: Lease,
}

impl Place {
    /// Control, if nobody else has it; whether the page has it now.
    pub(crate) fn ask(&self) -> bool {
        let mut holder = self.lease.lock();
        if self.may_control && holder.held_by.is_none() {
            holder.held_by = Some(self.page);
            self.lease.changed.send_replace(());
        }
        holder.held_by == Some(self.page)
    }

    /// Control, whoever has it; whether the page may have it.
    pub(crate) fn take(&self) -> bool {
        if self.may_control {
            self.lease.lock().held_by = Some(self.page);
            self.lease.changed.send_replace(());
        }
        self.may_control
    }

    /// Lets go of control, if the page has it.
    pub(crate) fn release(&self) {
        let mut holder = self.lease.lock();
        if holder.held_by == Some(self.page) {
            holder.held_by = None;
            self.lease.changed.send_replace(());
        }
    }

    /// Where the page sits.
    pub(crate) fn seat(&self) -> Seat {
        self.view().seat
    }

    /// What the page is told.
    pub(crate) fn view(&self) -> View {
        let holder = self.lease.lock();
        let seat = match holder.held_by {
            _ if !self.may_control => Seat::Viewer,
            None => Seat::Free,
            Some(page) if page == self.page => Seat::Driver,
            Some(_) => Seat::Passenger,
        };
        View {
            seat,
            page: self.page,
            holder: holder.held_by,
            pages: holder.pages,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.release();
        self.lease.lock().pages -= 1;
        self.lease.changed.send_replace(());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_page_has_control_until_it_goes_or_another_takes_it() {
        let lease = Lease::new();
        let (first, second, viewer) = (
            lease.sit_down(true).unwrap(),
            lease.sit_down(true).unwrap(),
            lease.sit_down(false).unwrap(),
        );
        assert_eq!(second.seat(), Seat::Free);
        assert!(first.ask() && !second.ask() && !viewer.ask());
        assert_eq!(
            [first.seat(), second.seat(), viewer.seat()],
            [Seat::Driver, Seat::Passenger, Seat::Viewer]
        );
        assert!(!viewer.take() && second.take());
        assert_eq!(first.seat(), Seat::Passenger);
        assert!(!first.ask());
        // Who has no control takes none away by going.
        drop(first);
        assert!(second.ask());
        let watching = viewer.view();
        assert_eq!(
            (watching.holder, watching.pages),
            (Some(second.view().page), 2)
        );
        // Who has it may let go, and stay.
        viewer.release();
        assert_eq!(second.seat(), Seat::Driver);
        second.release();
        assert_eq!((second.seat(), viewer.view().holder), (Seat::Free, None));
        assert!(second.ask());
        drop(second);
        assert_eq!(lease.sit_down(true).unwrap().seat(), Seat::Free);
    }

    #[test]
    fn many_viewers_leave_places_for_who_may_drive() {
        let lease = Lease::new();
        let viewers: Vec<_> = std::iter::from_fn(|| lease.sit_down(false)).collect();
        let driver = lease.sit_down(true).unwrap();
        assert!(driver.ask());
        let others: Vec<_> = std::iter::from_fn(|| lease.sit_down(true)).collect();
        let there = viewers.len() + 1 + others.len();
        assert_eq!((there, viewers.len()), (PAGES + FOR_CONTROLLERS, PAGES));
        drop(viewers);
        assert!(lease.sit_down(false).is_some());
    }
}
