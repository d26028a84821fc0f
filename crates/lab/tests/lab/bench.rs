//! A lab without sockets: a session, its robot, and what a page would be told.

use rumbo_experiment::files::Overrides;
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Entry, Level, Manifest, State};
use rumbo_session::{Event, Extras, Host, Order, SLICE_US, SessionDriver, Target};

#[derive(Default)]
struct Told {
    events: Vec<String>,
    state: Option<Box<State>>,
}

impl Host for Told {
    fn random_id(&mut self) -> u8 {
        7
    }

    fn publish(&mut self, event: Event) {
        let Event::Entry(entry) = event else { return };
        match &*entry {
            Entry::Event(event) => self.events.push(event.text.clone()),
            Entry::State(state) => self.state = Some(state.clone()),
            _ => {}
        }
    }

    fn begin_run(&mut self, _: Manifest) -> Option<(Level, String)> {
        None
    }
}

pub(crate) struct Bench {
    driver: SessionDriver<Told, SimulatedRobot>,
    wall_us: u64,
}

impl Bench {
    /// The robot of seed 1 in a scenario.
    pub(crate) fn of(scenario: &str) -> Self {
        let choice = Choice {
            scenario: scenario.into(),
            world: None,
            rig: None,
            seed: 1,
        };
        Self::new(choice)
    }

    pub(crate) fn new(choice: Choice) -> Self {
        let robot = SimulatedRobot::new(Overrides::default(), choice).unwrap();
        let mut driver =
            SessionDriver::new(Box::new(robot), Told::default(), 1.0, Extras::default());
        driver.begin(0);
        Self { driver, wall_us: 0 }
    }

    pub(crate) fn order(&mut self, order: Order) {
        self.driver.obey([order], self.wall_us).unwrap();
    }

    pub(crate) fn pass(&mut self, seconds: f64) {
        for _ in 0..(seconds * 1e6) as u64 / SLICE_US {
            self.wall_us += SLICE_US;
            self.driver.wall_passed(self.wall_us);
            while self.driver.slice(self.wall_us).unwrap() {}
            self.driver.update(self.wall_us);
        }
    }

    /// The left one's.
    pub(crate) fn wheel_rad_s(&mut self) -> f64 {
        self.driver.target().truth().unwrap().wheel_rad_s.left
    }

    /// What the page was told last.
    pub(crate) fn state(&mut self) -> &State {
        self.driver.host().state.as_deref().unwrap()
    }

    /// An event had these words.
    pub(crate) fn told(&mut self, words: &str) -> bool {
        let events = &self.driver.host().events;
        events.iter().any(|event| event.contains(words))
    }
}
