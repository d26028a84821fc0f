//! The steps of writing a program, and where they stand.

use crate::error::{BOOT_SECTION, FlashError, IntoBootSection, Phase};
use crate::message::{Inbox, encode};
use std::collections::VecDeque;

/// Of an ATmega2560 (2549Q, section 29.3).
const SIGNATURE: [u8; 3] = [0x1E, 0x98, 0x01];
/// Words of a page of its flash, and bytes (table 29-7).
const PAGE_WORDS: usize = 128;
const PAGE: usize = 2 * PAGE_WORDS;
/// `rjmp .`: the program stands still.
const HALT: [u8; 2] = [0xFF, 0xCF];

/// The lines are released and pulled for this long: the capacitor between DTR and RESET discharges in between [us].
const PULSE_US: u64 = 50_000;
/// Time between two attempts to sign on [us].
const SIGN_ON_US: u64 = 250_000;
/// Attempts to sign on after each reset: the boot loader waits for a second.
const SIGN_ONS: u32 = 4;
/// Resets before the board counts as one that does not answer.
const RESETS: u32 = 5;
/// Longest wait for any other answer; the longest that a boot loader takes is that for a page, 40 ms [us].
const PATIENCE_US: u64 = 1_000_000;

/// Commands of STK500v2.
const SIGN_ON: u8 = 0x01;
const LOAD_ADDRESS: u8 = 0x06;
const ENTER: u8 = 0x10;
const LEAVE: u8 = 0x11;
const PROGRAM_FLASH: u8 = 0x13;
const READ_FLASH: u8 = 0x14;
const READ_SIGNATURE: u8 = 0x1B;
/// Answer to what was done.
const OK: u8 = 0x00;

/// What is to be done with the port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortAction {
    /// Pull the lines DTR and RTS (assert them), or release them.
    Lines(bool),
    /// Send these bytes.
    Send(Vec<u8>),
    /// Nothing until bytes arrive, or some milliseconds have passed.
    Wait,
    /// Nothing any more: the program is on the board, and starts.
    Done,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Pulls the lines, and signs on.
    Begin,
    Signature(u8),
    Enter,
    /// Pages from here on.
    Address(usize),
    Write(usize),
    /// Page 0, so that nothing starts.
    WriteHalt,
    Read(usize),
    ReadHalt,
    /// The same as proof of a reset: no address was loaded since.
    ReadAfterReset,
    Leave,
}

/// Where the current step stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// It has not begun.
    New,
    /// The lines were released then [us].
    Released(u64),
    /// They were pulled then [us].
    Pulled(u64),
    /// A message was sent then [us].
    Sent(u64),
}

/// Writes one program to one board.
#[derive(Debug)]
pub struct Programmer {
    /// Whole pages, from address 0.
    program: Vec<u8>,
    steps: VecDeque<(Phase, Step)>,
    all: usize,
    progress: Progress,
    resets: u32,
    sign_ons: u32,
    /// The board answered after the last reset, but was not reset by it.
    stuck: bool,
    number: u8,
    inbox: Inbox,
    signature: [u8; 3],
    /// A page of the board was changed.
    begun: bool,
}

impl Programmer {
    /// Writes this program for an ATmega2560, which begins at address 0.
    ///
    /// # Errors
    /// It is too large: it reaches into the section of the boot loader.
    pub fn new(program: &[u8]) -> Result<Self, IntoBootSection> {
        if program.len() > BOOT_SECTION {
            return Err(IntoBootSection);
        }
        let mut program = program.to_vec();
        program.resize(program.len().max(1).next_multiple_of(PAGE), 0xFF);
        let steps = steps(program.len() / PAGE);
        Ok(Self {
            program,
            all: steps.len(),
            steps,
            progress: Progress::New,
            resets: 0,
            sign_ons: 0,
            stuck: false,
            number: 0,
            inbox: Inbox::default(),
            signature: [0; 3],
            begun: false,
        })
    }

    /// Length of the program, in whole pages [bytes].
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.program.len()
    }

    /// What is going on, and which part of everything is done, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> (Phase, f64) {
        let phase = self.steps.front().map_or(Phase::Finishing, |step| step.0);
        let done = self.all - self.steps.len();
        (phase, done as f64 / self.all as f64)
    }

    /// What an error or a port that is lost now leaves behind, to be put behind its message.
    #[must_use]
    pub fn aftermath(&self) -> &'static str {
        match self.begun && !self.steps.is_empty() {
            true => {
                ". The board has no complete program now, and does nothing until one is written"
            }
            false => "",
        }
    }

    /// Takes bytes that have arrived.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.inbox.extend(bytes);
    }

    /// What to do now, at this time of any clock that never goes back \[us\]; to be called again at once, except after
    /// [`PortAction::Wait`] and [`PortAction::Done`].
    ///
    /// # Errors
    /// Why it has ended.
    pub fn poll(&mut self, now_us: u64) -> Result<PortAction, FlashError> {
        while let Some((phase, step)) = self.steps.front().copied() {
            match self.progress {
                Progress::New if step == Step::Begin => {
                    self.progress = Progress::Released(now_us);
                    return Ok(PortAction::Lines(false));
                }
                Progress::Released(since_us) if now_us >= since_us + PULSE_US => {
                    self.progress = Progress::Pulled(now_us);
                    return Ok(PortAction::Lines(true));
                }
                Progress::Pulled(since_us) if now_us >= since_us + PULSE_US => {
                    // What the program sent before the reset.
                    self.inbox.clear();
                    self.sign_ons = 1;
                    return Ok(self.send(step, now_us));
                }
                Progress::Released(_) | Progress::Pulled(_) => return Ok(PortAction::Wait),
                Progress::New => return Ok(self.send(step, now_us)),
                Progress::Sent(sent_us) => match self.inbox.next(self.number) {
                    Some(answer) => self.take(phase, step, &answer)?,
                    None => return self.wait(phase, step, sent_us, now_us),
                },
            }
        }
        Ok(PortAction::Done)
    }

    fn send(&mut self, step: Step, now_us: u64) -> PortAction {
        self.progress = Progress::Sent(now_us);
        // After a reset some boot loaders take no other number than 1.
        self.number = match step {
            Step::Begin => 1,
            _ => self.number.wrapping_add(1),
        };
        self.begun |= matches!(step, Step::Write(_) | Step::WriteHalt);
        PortAction::Send(encode(self.number, &self.body(step)))
    }

    fn body(&self, step: Step) -> Vec<u8> {
        let [high, low] = (PAGE as u16).to_be_bytes();
        match step {
            Step::Begin => vec![SIGN_ON],
            // The four bytes of the programming instruction, of which only the third varies.
            Step::Signature(index) => vec![READ_SIGNATURE, 4, 0x30, 0, index, 0],
            // Times and the instruction are those of avrdude for this chip; a boot loader ignores them.
            Step::Enter => vec![ENTER, 200, 100, 25, 32, 0, 0x53, 3, 0xAC, 0x53, 0, 0],
            Step::Address(page) => {
                let word = (page * PAGE_WORDS) as u32;
                [&[LOAD_ADDRESS][..], &word.to_be_bytes()].concat()
            }
            Step::Write(_) | Step::WriteHalt => {
                // Mode: by pages, then write; the instructions for a programmer without a boot loader.
                let head = [PROGRAM_FLASH, high, low, 0xC1, 10, 0x40, 0x4C, 0x20, 0, 0];
                [&head[..], &self.page(step)].concat()
            }
            Step::Read(_) | Step::ReadHalt | Step::ReadAfterReset => {
                vec![READ_FLASH, high, low, 0x20]
            }
            Step::Leave => vec![LEAVE, 1, 1],
        }
    }

    /// What a page holds after this step.
    fn page(&self, step: Step) -> Vec<u8> {
        match step {
            Step::Write(page) | Step::Read(page) => {
                self.program[page * PAGE..(page + 1) * PAGE].to_vec()
            }
            _ => HALT.repeat(PAGE_WORDS),
        }
    }

    fn wait(
        &mut self,
        phase: Phase,
        step: Step,
        sent_us: u64,
        now_us: u64,
    ) -> Result<PortAction, FlashError> {
        if step != Step::Begin {
            return match now_us < sent_us + PATIENCE_US {
                true => Ok(PortAction::Wait),
                false => Err(FlashError::Silent(phase)),
            };
        }
        if now_us < sent_us + SIGN_ON_US {
            return Ok(PortAction::Wait);
        }
        if self.sign_ons < SIGN_ONS {
            self.sign_ons += 1;
            return Ok(self.send(step, now_us));
        }
        self.reset_again()?;
        self.poll(now_us)
    }

    fn reset_again(&mut self) -> Result<(), FlashError> {
        self.resets += 1;
        self.progress = Progress::New;
        match self.resets < RESETS {
            true => Ok(()),
            false if self.stuck => Err(FlashError::NoReset),
            false => Err(FlashError::NoAnswer),
        }
    }

    /// Takes the answer to a step.
    fn take(&mut self, phase: Phase, step: Step, answer: &[u8]) -> Result<(), FlashError> {
        let command = self.body(step)[0];
        let data = match answer {
            [answered, OK, data @ ..] if *answered == command => data,
            [_, status, ..] => {
                let status = *status;
                return Err(FlashError::Refused {
                    phase,
                    command,
                    status,
                });
            }
            _ => return Err(FlashError::Silent(phase)),
        };
        match step {
            Step::Enter => self.resets = 0,
            Step::Signature(index) => {
                let index = usize::from(index);
                self.signature[index] = data.first().copied().unwrap_or_default();
                let (found, expected) = (self.signature, SIGNATURE);
                if index + 1 == found.len() && found != expected {
                    return Err(FlashError::Signature { found, expected });
                }
            }
            Step::ReadAfterReset if !data.starts_with(&self.page(step)) => {
                self.stuck = true;
                self.steps.push_front((phase, Step::Begin));
                self.all += 1;
                return self.reset_again();
            }
            Step::Read(page) => self.compare(page, step, data)?,
            Step::ReadHalt => self.compare(0, step, data)?,
            _ => {}
        }
        self.steps.pop_front();
        self.progress = Progress::New;
        Ok(())
    }

    fn compare(&self, page: usize, step: Step, data: &[u8]) -> Result<(), FlashError> {
        let written = self.page(step);
        let read = data.iter().chain(std::iter::repeat(&0));
        let mut pairs = written.iter().zip(read).enumerate();
        match pairs.find(|(_, (written, read))| written != read) {
            None => Ok(()),
            Some((at, (written, read))) => Err(FlashError::Mismatch {
                address: page * PAGE + at,
                written: *written,
                read: *read,
            }),
        }
    }
}

/// All steps for a program of so many pages.
fn steps(pages: usize) -> VecDeque<(Phase, Step)> {
    let of = |phase| move |step| (phase, step);
    let connect = [
        Step::Begin,
        Step::Signature(0),
        Step::Signature(1),
        Step::Signature(2),
        Step::Enter,
    ];
    let write = [Step::Address(0), Step::WriteHalt].into_iter();
    let write = write.chain((1..pages).map(Step::Write));
    let verify = [Step::Address(0), Step::ReadHalt].into_iter();
    let verify = verify.chain((1..pages).map(Step::Read));
    let finish = [
        Step::Begin,
        Step::ReadAfterReset,
        Step::Enter,
        Step::Address(0),
        Step::Write(0),
        Step::Address(0),
        Step::Read(0),
        Step::Leave,
    ];
    let connect = connect.into_iter().map(of(Phase::Connecting));
    connect
        .chain(write.map(of(Phase::Writing)))
        .chain(verify.map(of(Phase::Verifying)))
        .chain(finish.into_iter().map(of(Phase::Finishing)))
        .collect()
}
