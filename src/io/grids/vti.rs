//! VTK image data in XML, with the numbers appended as they are.

use std::io::{self, Write};

use super::{DistanceSamples, remark, write_values};

pub(super) fn write(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
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
    if let Some(band) = samples.band {
        writeln!(
            out,
            "<FieldData><DataArray type=\"Float64\" Name=\"band\" NumberOfTuples=\"1\" format=\"ascii\">{band}</DataArray></FieldData>"
        )?;
    }
    writeln!(out, "<Piece Extent=\"{extent}\"><PointData Scalars=\"signed_distance\">")?;
    writeln!(out, "<DataArray type=\"Float32\" Name=\"signed_distance\" format=\"appended\" offset=\"0\"/>")?;
    writeln!(out, "</PointData></Piece></ImageData>")?;
    write!(out, "<AppendedData encoding=\"raw\">_")?;
    out.write_all(&(4 * (x * y * z) as u64).to_le_bytes())?;
    write_values(samples, out)?;
    writeln!(out, "</AppendedData></VTKFile>")
}
