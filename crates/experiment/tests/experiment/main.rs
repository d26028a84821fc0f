//! Experiments: their files, single runs, batches, and the requirements of each mode.

mod batch;
mod closed_loop;
mod earlier_files;
mod emulated;
mod files;
mod golden;
mod moving;
