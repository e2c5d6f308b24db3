//! Writing version 1.0.

use std::io::{self, Write};

use super::super::{DistanceSamples, write_values};

/// Header and magic together end on a multiple of this.
const ALIGNMENT: usize = 64;
/// Magic, version, and length of the header.
const BEFORE_HEADER: usize = 10;

pub(in crate::io::grids) fn write(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let [x, y, z] = samples.dims;
    let mut header = format!("{{'descr': '<f4', 'fortran_order': True, 'shape': ({x}, {y}, {z}), }}");
    let length = (BEFORE_HEADER + header.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_HEADER;
    header.extend(std::iter::repeat_n(' ', length - 1 - header.len()));
    header.push('\n');
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&(length as u16).to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    write_values(samples, out)
}
