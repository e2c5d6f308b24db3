//! Writing, with the numbers appended as they are.

use std::io::{self, Write};

use super::super::{DistanceSamples, remark, write_values};

pub(in crate::io::grids) fn write(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let [x, y, z] = samples.dims;
    let last = [x, y, z].map(|count| count.saturating_sub(1));
    let extent = format!("0 {} 0 {} 0 {}", last[0], last[1], last[2]);
    let (o, h) = (samples.origin, samples.spacing);
    writeln!(out, "<?xml version=\"1.0\"?>\n<!-- {} -->", remark(samples))?;
    writeln!(out, "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">")?;
    writeln!(
        out,
        "<ImageData WholeExtent=\"{extent}\" Origin=\"{} {} {}\" Spacing=\"{h} {h} {h}\" Direction=\"1 0 0 0 1 0 0 0 1\">",
        o.x, o.y, o.z
    )?;
    write!(out, "<FieldData>")?;
    if let Some(band) = samples.band {
        write!(
            out,
            "<DataArray type=\"Float64\" Name=\"band\" NumberOfTuples=\"1\" format=\"ascii\">{band}</DataArray>"
        )?;
    }
    if let Some(unit) = samples.unit {
        write_text("unit", unit.symbol(), out)?;
    }
    write_text("sign", "negative inside", out)?;
    writeln!(out, "</FieldData>")?;
    writeln!(out, "<Piece Extent=\"{extent}\"><PointData Scalars=\"signed_distance\">")?;
    writeln!(out, "<DataArray type=\"Float32\" Name=\"signed_distance\" format=\"appended\" offset=\"0\"/>")?;
    writeln!(out, "</PointData></Piece></ImageData>")?;
    write!(out, "<AppendedData encoding=\"raw\">_")?;
    out.write_all(&(4 * (x * y * z) as u64).to_le_bytes())?;
    write_values(samples, out)?;
    writeln!(out, "</AppendedData></VTKFile>")
}

/// A text among the field data: the codes of its characters and a zero.
fn write_text(name: &str, text: &str, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "<DataArray type=\"String\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">")?;
    for code in text.bytes() {
        write!(out, "{code} ")?;
    }
    write!(out, "0</DataArray>")
}
