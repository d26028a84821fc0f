#![no_main]
libfuzzer_sys::fuzz_target!(|steps: Vec<claims::robot::Step>| claims::robot::check(steps));
