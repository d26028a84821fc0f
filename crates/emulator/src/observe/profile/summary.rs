//! What a profile says when the program has run.

use super::{FunctionUse, InterruptUse, Profile, ROOT, UNKNOWN};
use std::collections::BTreeSet;

impl Profile {
    /// All cycles observed.
    pub fn cycles(&self) -> u64 {
        self.end - self.start.unwrap_or(self.end)
    }

    /// Cycles in which the CPU slept, waking up included.
    pub fn cycles_asleep(&self) -> u64 {
        let roots = self.nodes[ROOT].children.iter();
        let asleep = roots.filter(|node| self.nodes[**node].function == self.asleep);
        asleep.map(|node| self.nodes[*node].cycles).sum()
    }

    /// Cycles by chain of calls, a line each, as tools that draw flame graphs read them: `main;tick;__mulsf3 1234`.
    pub fn folded(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        for (index, node) in self
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.cycles > 0)
        {
            let chain = self.chain(index);
            let names: Vec<&str> = if chain.is_empty() {
                vec![self.name(UNKNOWN)]
            } else {
                chain
                    .into_iter()
                    .map(|function| self.name(function))
                    .collect()
            };
            lines.push(format!("{} {}\n", names.join(";"), node.cycles));
        }
        lines.sort();
        lines.concat()
    }

    /// The name of a vector in the datasheet.
    pub fn vector_name(&self, vector: u8) -> &'static str {
        self.model.vector_name(vector)
    }

    /// The functions that ran, of which so many cost the most with all that they call. One that ran already when the profile
    /// began has no call, such as `main`.
    pub fn costliest(&self, most: usize) -> Vec<FunctionUse> {
        let entries = self.nodes.iter().filter(|node| node.interrupt);
        let entries: BTreeSet<&str> = entries.map(|node| self.name(node.function)).collect();
        let asleep = self.name(self.asleep);
        let ran = self.functions().into_iter();
        ran.filter(|function| function.name != asleep && !entries.contains(&*function.name))
            .take(most)
            .collect()
    }

    /// The interrupts that were served, by vector.
    pub fn interrupts(&self) -> Vec<InterruptUse> {
        let mut interrupts = self.interrupts.clone();
        interrupts.sort_by_key(|interrupt| interrupt.vector);
        interrupts
    }

    /// The functions that ran, the most expensive with all that it calls first.
    pub fn functions(&self) -> Vec<FunctionUse> {
        let mut uses: Vec<FunctionUse> = self
            .names
            .iter()
            .zip(&self.calls)
            .map(|(name, calls)| FunctionUse {
                name: name.clone(),
                calls: *calls,
                own: 0,
                total: 0,
            })
            .collect();
        for (index, node) in self
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.cycles > 0)
        {
            uses[usize::from(node.function)].own += node.cycles;
            let mut chain = self.chain(index);
            // A function that calls itself counts once.
            chain.sort_unstable();
            chain.dedup();
            for function in chain {
                uses[usize::from(function)].total += node.cycles;
            }
        }
        uses.retain(|function| function.total > 0);
        uses.sort_by(|a, b| b.total.cmp(&a.total).then_with(|| a.name.cmp(&b.name)));
        uses
    }
}
