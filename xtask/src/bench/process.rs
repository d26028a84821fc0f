//! CPU time and memory of a process, from Linux's `/proc`.

use std::time::{Duration, Instant};

/// Ticks per second of the times in `/proc/PID/stat`; fixed by the kernel's interface.
const TICKS_PER_S: f64 = 100.0;

/// Share of one core that a process uses while `time` passes [%].
pub(crate) fn cpu_percent(pid: u32, time: Duration) -> Result<f64, String> {
    let (start, before) = (Instant::now(), cpu_s(pid)?);
    std::thread::sleep(time);
    Ok(100.0 * (cpu_s(pid)? - before) / start.elapsed().as_secs_f64())
}

/// Memory in use [MB].
pub(crate) fn resident_mb(pid: u32) -> Result<f64, String> {
    let status = read(pid, "status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib: Option<f64> = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
    kib.map(|kib| kib * 1024.0 / 1e6)
        .ok_or_else(|| "no VmRSS in /proc/PID/status".to_owned())
}

fn cpu_s(pid: u32) -> Result<f64, String> {
    parse_cpu_s(&read(pid, "stat")?).ok_or_else(|| "cannot read /proc/PID/stat".to_owned())
}

/// User and system time; the name before them may hold spaces and parentheses.
fn parse_cpu_s(stat: &str) -> Option<f64> {
    let fields: Vec<&str> = stat[stat.rfind(')')? + 1..].split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / TICKS_PER_S)
}

fn read(pid: u32, file: &str) -> Result<String, String> {
    let path = format!("/proc/{pid}/{file}");
    std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error} (Linux only)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cpu_time_is_user_and_system_whatever_the_name() {
        let stat = "7 (a) b) S 1 1 1 0 -1 4194560 10 0 0 0 150 50 0 0 20 0 1 0 9 1 1";
        assert_eq!(parse_cpu_s(stat), Some(2.0));
    }
}
