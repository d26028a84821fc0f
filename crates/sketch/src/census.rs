//! The processes of a run, and the memory that they hold together: what no limit of a single process bounds.

use crate::limits::Limits;
use std::fs;

/// What a process and its descendants take beyond a limit, if they do. Where the system lists no children there is
/// nothing to count.
pub(crate) fn excess(root: u32, limits: &Limits) -> Option<String> {
    let (mut tasks, mut memory_kb) = (0, 0);
    let mut next = vec![root.to_string()];
    // A process that has ended meanwhile has neither threads nor memory.
    while let Some(process) = next.pop() {
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
        let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let resident = resident.and_then(|rest| rest.split_whitespace().next()?.parse().ok());
        memory_kb += resident.unwrap_or(0u64);
        let threads = fs::read_dir(format!("/proc/{process}/task"));
        for thread in threads.into_iter().flatten().flatten() {
            tasks += 1;
            if tasks > limits.processes {
                return Some(format!("more than {} processes", limits.processes));
            }
            let children = fs::read_to_string(thread.path().join("children")).unwrap_or_default();
            next.extend(children.split_whitespace().map(str::to_owned));
        }
    }
    let most = limits.memory_mb;
    (memory_kb > most << 10).then(|| format!("more than {most} MB of memory"))
}
