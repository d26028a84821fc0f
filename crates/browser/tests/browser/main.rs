//! The lab as the page's worker runs it, with a simulated robot and with one at a serial port.

mod lab;
mod robot;
