#![no_main]

use libfuzzer_sys::fuzz_target;
use meshwright::io::Format;

fuzz_target!(|data: &[u8]| readers::check(data, Format::Off));
