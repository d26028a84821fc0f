//! The page's debugger: the adapter for editors with the lab's simulation in its hands.

use rumbo_debug::control::Debugger;
use rumbo_debug::dap::{Adapter, Launch, LaunchHost};
use rumbo_debug::symbols::{SymbolError, Symbols};
use rumbo_lab::{Attach, Holder, Live};
use serde_json::Value;
use std::path::PathBuf;

/// What gives a simulation of this program to a debugger; a page knows the program's files by these names.
///
/// # Errors
/// The image has no debugging information.
pub(crate) fn attach(elf: &[u8], files: &[String]) -> Result<Attach, SymbolError> {
    let find = |name: &str| {
        let name = name.trim_start_matches("./");
        let known = files.iter().find(|file| *file == name);
        known.map(PathBuf::from)
    };
    let symbols = Symbols::read(elf, &find)?;
    Ok(Box::new(|live| {
        let debugger = Debugger::new(symbols, live);
        Box::new(InHand(Adapter::holding(Output::default(), debugger)))
    }))
}

/// Keeps what the program has sent, for the lab.
#[derive(Default)]
struct Output(Vec<(u8, Vec<u8>)>);

impl LaunchHost for Output {
    type World = Live;

    fn launch(&mut self, _: &Launch) -> Result<(Debugger<Live>, Vec<String>), String> {
        Err("the page launches programs by itself".into())
    }

    fn take(&mut self, stream: u8, bytes: &[u8]) -> bool {
        self.0.push((stream, bytes.to_owned()));
        true
    }
}

struct InHand(Adapter<Output>);

impl Holder for InHand {
    fn live(&self) -> Option<&Live> {
        self.0.held().map(Debugger::world)
    }

    fn change(&mut self, act: &mut dyn FnMut(&mut Live)) {
        if let Some(debugger) = self.0.held_mut() {
            debugger.change(act);
        }
    }

    fn is_running(&self) -> bool {
        self.0.is_running()
    }

    fn turn(&mut self) {
        self.0.turn();
    }

    fn ask(&mut self, request: &Value) -> Result<(), String> {
        self.0.ask(request)
    }

    fn take_messages(&mut self) -> Vec<Value> {
        self.0.take_messages()
    }

    fn take_output(&mut self) -> Vec<(u8, Vec<u8>)> {
        std::mem::take(&mut self.0.host().0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sketch::image_to_debug;
    use rumbo_experiment::files::Overrides;
    use rumbo_lab::{Made, OwnProgram, SimulatedRobot, Workshop};
    use rumbo_log::{Choice, HeldState};
    use rumbo_session::{SLICE_US, Target, TargetError};
    use rumbo_sim::boards::Board;
    use serde_json::json;

    const SKETCH: &str = "int count = 0;
void setup() { Serial.begin(115200); pinMode(4, OUTPUT); digitalWrite(4, HIGH); analogWrite(5, 200); }
void loop() {
  count = count + 1;
  delay(200);
  Serial.println(count);
}
";

    struct Once(Option<Made>);

    impl Workshop for Once {
        fn next(&mut self) -> Option<Made> {
            self.0.take()
        }
    }

    /// A robot whose program stands at its start; none without a compiler.
    fn debugged() -> Option<SimulatedRobot> {
        let folder = tempfile::tempdir().unwrap();
        let sketch = folder.path().join("counter");
        std::fs::create_dir(&sketch).unwrap();
        std::fs::write(sketch.join("counter.ino"), SKETCH).unwrap();
        let image = image_to_debug(sketch.to_str().unwrap(), <&Board>::default(), false);
        let (image, _) = match image {
            Ok(made) => made,
            Err(_) if std::env::var_os("CI").is_none() => return None,
            Err(error) => panic!("{error}"),
        };
        let attach = attach(&std::fs::read(&image).unwrap(), &["counter.ino".into()]).unwrap();
        let choice = Choice {
            scenario: "mode1".into(),
            world: Some("open".into()),
            rig: None,
            seed: 1,
        };
        let mut robot = SimulatedRobot::new(Overrides::default(), choice).unwrap();
        let made = Once(Some(Made::Debugged(image, attach)));
        robot.own_program(OwnProgram::new("counter", Some(Box::new(made))));
        while robot.news().is_some() {}
        Some(robot)
    }

    fn held(robot: &SimulatedRobot) -> HeldState {
        robot.program().unwrap().held.unwrap()
    }

    /// Asks; gives what came back.
    fn ask(robot: &mut SimulatedRobot, command: &str, arguments: Value) -> Value {
        let request =
            json!({"seq": 7, "type": "request", "command": command, "arguments": arguments});
        robot.ask_debugger(&request).unwrap();
        let mut messages = robot.take_debug().into_iter();
        messages
            .find(|message| message["request_seq"] == 7)
            .unwrap()
    }

    /// Lets time pass until the program stands, and some more.
    fn go(robot: &mut SimulatedRobot, command: &str) -> u64 {
        ask(robot, command, json!({"threadId": 1}));
        for _ in 0..1_000 {
            robot.advance(SLICE_US).unwrap();
        }
        assert!(held(robot).stands, "{command}");
        let stack = ask(robot, "stackTrace", json!({"threadId": 1}));
        stack["body"]["stackFrames"][0]["line"].as_u64().unwrap()
    }

    fn said(robot: &mut SimulatedRobot) -> String {
        let said = robot.consoles().into_iter();
        let bytes = said
            .filter(|(usart, _)| *usart == 0)
            .flat_map(|(_, bytes)| bytes);
        String::from_utf8(bytes.collect()).unwrap()
    }

    #[test]
    fn the_session_s_time_stands_with_the_program_and_never_goes_back_with_it() {
        let Some(mut robot) = debugged() else {
            return;
        };
        let lines = json!({"source": {"path": "counter.ino"}, "breakpoints": [{"line": 6}]});
        let set = ask(&mut robot, "setBreakpoints", lines);
        assert_eq!(set["body"]["breakpoints"][0]["verified"], true);
        assert_eq!(go(&mut robot, "configurationDone"), 2);
        assert_eq!(go(&mut robot, "continue"), 6);
        let (reached_us, truth) = (robot.now_us(), robot.truth());
        assert!((200_000..210_000).contains(&reached_us), "{reached_us}");
        assert!(truth.unwrap().wheel_rad_s.right.abs() > 1.0);
        // Back over the wait, and on: the robot is as it was, and nothing is said twice.
        assert_eq!(go(&mut robot, "stepBack"), 5);
        assert!(held(&robot).back_us > 199_000);
        assert_eq!((robot.now_us(), robot.truth()), (reached_us, truth));
        assert_eq!(go(&mut robot, "next"), 6);
        assert_eq!((held(&robot).back_us, robot.truth()), (0, truth));
        go(&mut robot, "continue");
        go(&mut robot, "continue");
        go(&mut robot, "stepBack");
        go(&mut robot, "continue");
        assert_eq!(said(&mut robot), "1\r\n2\r\n");
        // STOP, while it stands.
        robot.supply_motors(false);
        for _ in 0..15 {
            go(&mut robot, "continue");
        }
        assert!(robot.truth().unwrap().wheel_rad_s.right.abs() < 0.1);
    }

    #[test]
    fn a_page_cannot_have_other_programs_launched_or_the_past_searched_and_ends_it_at_will() {
        let Some(mut robot) = debugged() else {
            return;
        };
        for command in [
            "launch",
            "attach",
            "restart",
            "reverseContinue",
            "disassemble",
            "",
        ] {
            let request = json!({"seq": 1, "command": command, "arguments": {"program": "/etc"}});
            assert_eq!(robot.ask_debugger(&request), Err(TargetError::NotDebugged));
        }
        assert!(robot.ask_debugger(&json!({"command": "threads"})).is_err());
        let end = json!({"seq": 1, "command": "disconnect"});
        robot.ask_debugger(&end).unwrap();
        assert!(robot.program().unwrap().held.is_none());
        robot.advance(SLICE_US).unwrap();
        assert_eq!(robot.now_us(), SLICE_US);
        assert_eq!(robot.ask_debugger(&end), Err(TargetError::NotDebugged));
    }
}
