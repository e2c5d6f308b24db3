//! Writing version 5, raw.

use std::io::{self, Write};

use super::super::{DistanceSamples, remark, write_values};

pub(in crate::io::grids) fn write(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let [x, y, z] = samples.dims;
    let (o, h) = (samples.origin, samples.spacing);
    writeln!(out, "NRRD0005\n# {}", remark(samples))?;
    writeln!(out, "content: {}", remark(samples))?;
    writeln!(out, "type: float\ndimension: 3\nsizes: {x} {y} {z}\nendian: little\nencoding: raw")?;
    writeln!(out, "kinds: domain domain domain\ncenters: node node node\nspace dimension: 3")?;
    if let Some(unit) = samples.unit {
        writeln!(out, "space units: \"{unit}\" \"{unit}\" \"{unit}\"")?;
    }
    writeln!(out, "space directions: ({h},0,0) (0,{h},0) (0,0,{h})\nspace origin: ({},{},{})", o.x, o.y, o.z)?;
    writeln!(out, "sign:=negative inside")?;
    if let Some(band) = samples.band {
        writeln!(out, "band:={band}")?;
    }
    writeln!(out)?;
    write_values(samples, out)
}
