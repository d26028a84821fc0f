//! The debugger as an editor drives it: requests of the Debug Adapter Protocol in, responses and events out, as bytes.
//!
//! The caller passes what the client sends to [`Adapter::receive`], calls [`Adapter::turn`] as long as the program runs,
//! and sends what [`Adapter::take_output`] gives. Or it has whole messages: [`Adapter::ask`], [`Adapter::take_messages`].

mod breakpoints;
mod disassembly;
mod inspect;
mod message;

pub use message::Launch;

use crate::control::{Debugger, Reason, StepKind};
use inspect::Reference;
use message::{Arguments, Frames, Request, framed};
use rumbo_emulator::gdb::DebuggedWorld;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// The stream of the USB port.
const USB: u8 = 0;
/// The only thread.
const THREAD: i64 = 1;

/// Who prepares what a client launches.
pub trait LaunchHost {
    /// The kind of world.
    type World: DebuggedWorld;

    /// The program in its world, standing at its start, and notes for the user.
    ///
    /// # Errors
    /// What is wrong with the program or its setting, and what to do.
    fn launch(&mut self, launch: &Launch) -> Result<(Debugger<Self::World>, Vec<String>), String>;

    /// Takes what the program has sent in a stream; `false`: the client shows what comes from the USB port.
    fn take(&mut self, _stream: u8, _bytes: &[u8]) -> bool {
        false
    }
}

/// An adapter with its client.
pub struct Adapter<H: LaunchHost> {
    host: H,
    frames: Frames,
    debugger: Option<Debugger<H::World>>,
    launch: Launch,
    lines_start_at: i64,
    /// What numbers of variables stand for, since the program stands.
    references: Vec<Reference>,
    /// Why it cannot go on.
    exception: Option<String>,
    next_breakpoint: u64,
    seq: i64,
    output: Vec<Value>,
    /// What follows the response: an event, a stop.
    later: Option<&'static str>,
    stop: Option<Reason>,
    /// It runs to its first line.
    enters: bool,
    is_done: bool,
}

impl<H: LaunchHost> Adapter<H> {
    /// An adapter before the first request.
    pub fn new(host: H) -> Self {
        Adapter {
            host,
            frames: Frames::default(),
            debugger: None,
            launch: Launch::default(),
            lines_start_at: 1,
            references: Vec::new(),
            exception: None,
            next_breakpoint: 1,
            seq: 0,
            output: Vec::new(),
            later: None,
            stop: None,
            enters: false,
            is_done: false,
        }
    }

    /// An adapter of a program that is there already: its client begins with breakpoints, and stops at the first line.
    pub fn holding(host: H, debugger: Debugger<H::World>) -> Self {
        let mut adapter = Self::new(host);
        adapter.debugger = Some(debugger);
        adapter.launch.stop_on_entry = true;
        adapter
    }

    /// The session is over.
    pub fn is_done(&self) -> bool {
        self.is_done
    }

    /// The program runs: [`Adapter::turn`] is to be called.
    pub fn is_running(&self) -> bool {
        self.debugger.as_ref().is_some_and(Debugger::is_running)
    }

    /// Drains what is to be sent to the client.
    pub fn take_output(&mut self) -> Vec<u8> {
        self.take_messages().iter().flat_map(framed).collect()
    }

    /// The same as messages.
    pub fn take_messages(&mut self) -> Vec<Value> {
        std::mem::take(&mut self.output)
    }

    /// Who prepared the program.
    pub fn host(&mut self) -> &mut H {
        &mut self.host
    }

    /// The debugger, while there is a program.
    pub fn held(&self) -> Option<&Debugger<H::World>> {
        self.debugger.as_ref()
    }

    /// The same, to act on it.
    pub fn held_mut(&mut self) -> Option<&mut Debugger<H::World>> {
        self.debugger.as_mut()
    }

    /// Takes bytes of the client.
    ///
    /// # Errors
    /// They are not of the protocol: nothing more can be understood.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.frames.take(bytes);
        while let Some(request) = self.frames.next()? {
            self.respond(&request);
        }
        Ok(())
    }

    /// Takes a request.
    ///
    /// # Errors
    /// It is none.
    pub fn ask(&mut self, request: &Value) -> Result<(), String> {
        let request = Request::deserialize(request);
        self.respond(&request.map_err(|error| format!("a message that is no request: {error}"))?);
        Ok(())
    }

    fn respond(&mut self, request: &Request) {
        let answer = self.answer(request);
        let mut response = json!({
            "type": "response", "request_seq": request.seq, "command": request.command, "success": answer.is_ok(),
        });
        match answer {
            Ok(Value::Null) => {}
            Ok(body) => response["body"] = body,
            Err(error) => {
                response["message"] = json!(error);
                response["body"] = json!({"error": {"id": 1, "format": "{text}", "variables": {"text": error}, "showUser": true}});
            }
        }
        self.send(response);
        self.tell();
        if let Some(name) = self.later.take() {
            self.event(name, json!({}));
        }
        if let Some(reason) = self.stop.take() {
            self.stopped(&reason);
        }
    }

    /// Lets the program run for an interval of its time, if it runs.
    pub fn turn(&mut self) {
        let Some(debugger) = &mut self.debugger else {
            return;
        };
        let reason = debugger.turn();
        self.tell();
        if let Some(reason) = reason {
            self.stopped(&reason);
        }
    }

    fn send(&mut self, mut message: Value) {
        self.seq += 1;
        message["seq"] = json!(self.seq);
        self.output.push(message);
    }

    fn event(&mut self, name: &str, body: Value) {
        self.send(json!({"type": "event", "event": name, "body": body}));
    }

    fn show(&mut self, category: &str, text: &str) {
        self.event("output", json!({"category": category, "output": text}));
    }

    /// Shows what the program and breakpoints have written.
    fn tell(&mut self) {
        let Some(debugger) = &mut self.debugger else {
            return;
        };
        let (output, log) = (debugger.take_output(), debugger.take_log());
        for (stream, bytes) in output {
            if !self.host.take(stream, &bytes) && stream == USB {
                let text = String::from_utf8_lossy(&bytes).replace("\r\n", "\n");
                self.show("stdout", &text);
            }
        }
        for line in log {
            self.show("console", &format!("{line}\n"));
        }
    }

    fn stopped(&mut self, reason: &Reason) {
        self.references.clear();
        self.exception = None;
        let (word, text) = match reason {
            Reason::Step if std::mem::take(&mut self.enters) => ("entry", String::new()),
            Reason::Breakpoint(_) => ("breakpoint", String::new()),
            Reason::Data(_) => ("data breakpoint", String::new()),
            Reason::Step => ("step", String::new()),
            Reason::Pause => ("pause", String::new()),
            Reason::Start => ("entry", "At the beginning: there is nothing before".into()),
            Reason::Over => {
                let text = "The scenario's time is over; step back, restart, or end it";
                ("pause", text.into())
            }
            Reason::Ended(verdict) => {
                self.exception = Some(verdict.clone());
                ("exception", format!("The program cannot go on: {verdict}"))
            }
        };
        let mut body = json!({"reason": word, "threadId": THREAD, "allThreadsStopped": true});
        if !text.is_empty() {
            body["description"] = json!(text);
            body["text"] = json!(text);
            self.show("console", &format!("{text}\n"));
        }
        match reason {
            Reason::Breakpoint(ids) => body["hitBreakpointIds"] = json!(ids),
            Reason::Data(id) => body["hitBreakpointIds"] = json!([id]),
            _ => {}
        }
        self.event("stopped", body);
    }

    fn answer(&mut self, request: &Request) -> Result<Value, String> {
        let arguments = &request.arguments;
        match &*request.command {
            "initialize" => {
                let from_one = arguments["linesStartAt1"].as_bool().unwrap_or(true);
                self.lines_start_at = i64::from(from_one);
                Ok(capabilities())
            }
            "launch" | "attach" => self.launch(read(arguments)?),
            "configurationDone" => self.start(),
            "setExceptionBreakpoints" => Ok(json!({"breakpoints": []})),
            "threads" => Ok(json!({"threads": [{"id": THREAD, "name": "main"}]})),
            "disconnect" | "terminate" => {
                self.debugger = None;
                self.later = Some("terminated");
                self.is_done = request.command == "disconnect";
                Ok(Value::Null)
            }
            "restart" => {
                self.debugger()?.restart();
                self.start()
            }
            "pause" => {
                self.debugger()?.pause();
                self.stop = Some(Reason::Pause);
                Ok(Value::Null)
            }
            "exceptionInfo" => Ok(json!({
                "exceptionId": "ended", "description": self.exception, "breakMode": "always",
            })),
            "setBreakpoints" => self.set_breakpoints(&read(arguments)?),
            "setFunctionBreakpoints" => self.set_function_breakpoints(&read(arguments)?),
            "setInstructionBreakpoints" => self.set_instruction_breakpoints(&read(arguments)?),
            "breakpointLocations" => self.breakpoint_locations(&read(arguments)?),
            "dataBreakpointInfo" => self.data_breakpoint_info(&read(arguments)?),
            "setDataBreakpoints" => self.set_data_breakpoints(&read(arguments)?),
            command => match command {
                "stackTrace" | "scopes" | "variables" | "setVariable" | "setExpression"
                | "evaluate" | "disassemble" | "continue" | "next" | "stepIn" | "stepOut"
                | "stepBack" | "reverseContinue" => self.standing(command, arguments),
                _ => Err(format!("the request {command} is not supported")),
            },
        }
    }

    /// Requests that are for a program that stands.
    fn standing(&mut self, command: &str, arguments: &Value) -> Result<Value, String> {
        let asked: Arguments = read(arguments)?;
        if self.debugger()?.is_running() {
            // What is typed goes to a running program too.
            return match asked.typed() {
                Some(typed) if command == "evaluate" => self.type_in(typed),
                _ => Err("the program runs; pause it first".into()),
            };
        }
        let step = |step| match &*asked.granularity {
            "instruction" => StepKind::Instruction,
            _ => step,
        };
        match command {
            "stackTrace" => self.stack_trace(&asked),
            "scopes" => self.scopes(asked.frame_id),
            "variables" => self.variables(&asked),
            "setVariable" => self.set_variable(&asked),
            "setExpression" => self.set_expression(&asked),
            "evaluate" => self.evaluate(&asked),
            "disassemble" => self.disassemble(&read(arguments)?),
            "next" => self.step(step(StepKind::Over)),
            "stepIn" => self.step(step(StepKind::In)),
            "stepOut" => self.step(StepKind::Out),
            "stepBack" => {
                self.stop = Some(self.debugger()?.step_back(step(StepKind::Over)));
                Ok(Value::Null)
            }
            "reverseContinue" => {
                self.stop = Some(self.debugger()?.go_back());
                Ok(Value::Null)
            }
            _ => {
                self.references.clear();
                self.debugger()?.go();
                Ok(json!({"allThreadsContinued": true}))
            }
        }
    }

    fn debugger(&mut self) -> Result<&mut Debugger<H::World>, String> {
        self.debugger
            .as_mut()
            .ok_or_else(|| "nothing is being debugged; launch a program first".into())
    }

    fn launch(&mut self, launch: Launch) -> Result<Value, String> {
        let (debugger, notes) = self.host.launch(&launch)?;
        let debugger = self.debugger.insert(debugger);
        debugger.set_just_own_code(launch.just_my_code != Some(false));
        self.launch = launch;
        for note in notes {
            self.show("console", &format!("{note}\n"));
        }
        self.later = Some("initialized");
        Ok(Value::Null)
    }

    /// Lets the program run, or to its first line.
    fn start(&mut self) -> Result<Value, String> {
        self.enters = self.launch.stop_on_entry;
        match self.enters {
            true => self.debugger()?.go_to_entry(),
            false => self.debugger()?.go(),
        }
        Ok(Value::Null)
    }

    fn step(&mut self, step: StepKind) -> Result<Value, String> {
        self.references.clear();
        self.stop = self.debugger()?.step(step)?;
        Ok(Value::Null)
    }
}

fn read<T: DeserializeOwned>(arguments: &Value) -> Result<T, String> {
    let arguments = match arguments {
        Value::Null => json!({}),
        other => other.clone(),
    };
    serde_json::from_value(arguments).map_err(|error| format!("its arguments: {error}"))
}

fn capabilities() -> Value {
    let able = [
        "supportsConfigurationDoneRequest",
        "supportsFunctionBreakpoints",
        "supportsConditionalBreakpoints",
        "supportsHitConditionalBreakpoints",
        "supportsLogPoints",
        "supportsEvaluateForHovers",
        "supportsStepBack",
        "supportsSetVariable",
        "supportsSetExpression",
        "supportsRestartRequest",
        "supportsTerminateRequest",
        "supportsExceptionInfoRequest",
        "supportsDataBreakpoints",
        "supportsDisassembleRequest",
        "supportsSteppingGranularity",
        "supportsInstructionBreakpoints",
        "supportsBreakpointLocationsRequest",
    ];
    able.into_iter()
        .map(|name| (name.to_owned(), json!(true)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}
