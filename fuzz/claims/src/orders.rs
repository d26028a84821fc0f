//! Anything from a page is an order or gives an error of one line; what the station then sends, over a link without
//! faults, the robot accepts.

use rumbo_control::{Inputs, Micros};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_session::client::{KnownTable, RobotClient};
use rumbo_session::{BadOrder, Order};
use rumbo_wire::{Command, ResetCause};

/// Orders of one run.
const ORDERS: usize = 64;
/// Ticks for each order, and before the first.
const TICKS: u32 = 5;
const TICK_US: u32 = 10_000;

struct Bench {
    client: RobotClient,
    robot: Robot,
    now_us: u32,
}

impl Bench {
    fn tick(&mut self) {
        self.now_us += TICK_US;
        let (now_us, mut bytes, mut received) = (self.now_us.into(), Vec::new(), Vec::new());
        self.client.poll(now_us, &mut bytes, &mut received);
        bytes.iter().for_each(|byte| self.robot.receive(*byte));
        self.robot.tick(&Inputs {
            now: Micros(self.now_us),
            ..Inputs::default()
        });
        self.robot.report();
        bytes.clear();
        bytes.extend(std::iter::from_fn(|| self.robot.transmit()));
        self.client.receive(&bytes, now_us, &mut received);
    }
}

/// The commands for the robot in a page's text.
fn commands(text: &str) -> Result<Vec<Command>, BadOrder> {
    Ok(match text.parse()? {
        Order::Robot(command) | Order::Hold(command) => vec![command],
        Order::Route(commands) => commands,
        _ => Vec::new(),
    })
}

/// Panics if the claim does not hold.
pub fn check(text: &str) {
    let mut bench = Bench {
        client: RobotClient::new(1, true, KnownTable::OURS),
        robot: Robot::new(RobotConfig {
            image: 0,
            reset: ResetCause::PowerOn,
            start: 0,
        }),
        now_us: 0,
    };
    (0..TICKS).for_each(|_| bench.tick());
    for line in text.lines().take(ORDERS) {
        match commands(line) {
            Ok(commands) => {
                for command in commands {
                    // It may be full.
                    let _ = bench.client.submit(command, bench.now_us.into());
                }
            }
            Err(why) => {
                let why = why.to_string();
                assert!(!why.is_empty() && !why.contains('\n'), "{why}");
            }
        }
        (0..TICKS).for_each(|_| bench.tick());
    }
    assert!(bench.client.connected(), "the robot went silent");
    let link = bench.client.link(bench.now_us.into());
    assert_eq!(link.crc_errors, 0);
}
