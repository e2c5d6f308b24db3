//! The same lattice in all the forms that other programs give it.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use glam::DVec3;
use meshwright::io::{GridFile, Unit, read_grid_bytes};

use super::grids::values_of;

const DIMS: [usize; 3] = [2, 3, 4];

/// The value at x, y, z; a whole number, so that every type holds it.
fn value(n: usize) -> i8 {
    (n % 2 + n / 2 % 3 * 10 + n / 6 * 30) as i8 - 60
}

fn expected() -> Vec<f32> {
    (0..24).map(|n| value(n).into()).collect()
}

/// The numbers as bytes of a type: its width, whether it is of floats, and its order.
fn bytes_as(width: usize, float: bool, big: bool) -> Vec<u8> {
    let one = |n: i8| -> Vec<u8> {
        let mut word = match (width, float) {
            (4, true) => f32::from(n).to_le_bytes().to_vec(),
            (8, true) => f64::from(n).to_le_bytes().to_vec(),
            _ => i64::from(n).to_le_bytes()[..width].to_vec(),
        };
        if big {
            word.reverse();
        }
        word
    };
    (0..24).flat_map(|n| one(value(n))).collect()
}

#[track_caller]
fn read(bytes: &[u8]) -> GridFile {
    let file = read_grid_bytes(bytes, None, None).unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(bytes)));
    assert_eq!((file.dims, values_of(&file)), (DIMS, expected()));
    file
}

/// A VTK file with the given attributes and data array, and what follows the image.
fn vti(file: &str, array: &str, text: &[u8], after: &[u8]) -> Vec<u8> {
    let mut out = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" {file}>\n<ImageData WholeExtent=\"0 1 0 2 0 3\" \
         Origin=\"1 2 3\" Spacing=\"0.5 0.5 0.5\">\n<Piece Extent=\"0 1 0 2 0 3\">\n<PointData>\n\
         <DataArray Name=\"d\" {array}>"
    )
    .into_bytes();
    out.extend(text);
    out.extend(b"</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n");
    out.extend(after);
    out.extend(b"</VTKFile>\n");
    out
}

/// A number of 4 or 8 bytes.
fn word(n: usize, width: usize, big: bool) -> Vec<u8> {
    let mut bytes = n.to_le_bytes()[..width].to_vec();
    if big {
        bytes.reverse();
    }
    bytes
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Header and blocks of `block` bytes before compression.
fn packed(bytes: &[u8], block: usize, width: usize, big: bool) -> [Vec<u8>; 2] {
    let blocks: Vec<Vec<u8>> = bytes.chunks(block).map(deflated).collect();
    let mut header = [blocks.len(), block, bytes.len() % block].map(|n| word(n, width, big)).concat();
    header.extend(blocks.iter().flat_map(|block| word(block.len(), width, big)));
    [header, blocks.concat()]
}

#[test]
fn vtk_in_every_storage() {
    for (header, width) in [("UInt32", 4), ("UInt64", 8)] {
        for (order, big) in [("LittleEndian", false), ("BigEndian", true)] {
            for (kind, size, float) in
                [("Float32", 4, true), ("Float64", 8, true), ("Int16", 2, false), ("Int8", 1, false)]
            {
                let bytes = bytes_as(size, float, big);
                let file = format!("version=\"1.0\" byte_order=\"{order}\" header_type=\"{header}\"");
                let zlib = format!("{file} compressor=\"vtkZLibDataCompressor\"");
                let array = |format: &str| format!("type=\"{kind}\" format=\"{format}\"");
                let plain = [word(bytes.len(), width, big), bytes.clone()].concat();
                read(&vti(&file, &array("binary"), STANDARD.encode(&plain).as_bytes(), b""));
                let appended = |encoding: &str, data: &[u8]| {
                    // Another array lies before this one.
                    let start = format!("<AppendedData encoding=\"{encoding}\">\n  _");
                    [start.as_bytes(), b"AAAA", data, b"</AppendedData>"].concat()
                };
                let at = array("appended\" offset=\"4");
                read(&vti(&file, &at, b"", &appended("raw", &plain)));
                read(&vti(&file, &at, b"", &appended("base64", STANDARD.encode(&plain).as_bytes())));
                for block in [bytes.len(), 10, 7 * size] {
                    let [head, blocks] = packed(&bytes, block, width, big);
                    let encoded = STANDARD.encode(&head) + &STANDARD.encode(&blocks);
                    read(&vti(&zlib, &array("binary"), format!("\n  {encoded}\n").as_bytes(), b""));
                    read(&vti(&zlib, &at, b"", &appended("base64", encoded.as_bytes())));
                    read(&vti(&zlib, &at, b"", &appended("raw", &[head, blocks].concat())));
                }
            }
        }
    }
}

#[test]
fn vtk_text_places_and_cells() {
    let numbers: Vec<String> = expected().iter().map(f32::to_string).collect();
    let text = numbers.join("\n  ");
    let plain = vti("version=\"0.1\"", "type=\"Float32\" format=\"ascii\"", text.as_bytes(), b"");
    let file = read(&plain);
    assert_eq!((file.origin, file.spacing, file.band, file.unit), (DVec3::new(1.0, 2.0, 3.0), 0.5, None, None));
    let changed = |from: &str, to: &str| String::from_utf8(plain.clone()).unwrap().replace(from, to).into_bytes();
    assert_eq!(read(&changed("0 1 0 2 0 3", "4 5 -2 0 1 4")).origin, DVec3::new(3.0, 1.0, 3.5));
    let cells = String::from_utf8(changed("0 1 0 2 0 3", "0 2 0 3 0 4")).unwrap().replace("PointData", "CellData");
    assert_eq!(read(cells.as_bytes()).origin, DVec3::new(1.25, 2.25, 3.25));
    // The array that the file names counts, not the first.
    let other = "<PointData Scalars=\"d\"><DataArray type=\"Float32\" Name=\"e\" format=\"ascii\">1</DataArray>";
    let file = read(&changed("<PointData>", other));
    assert!(file.warnings.iter().any(|words| words.contains("1 more")), "{:?}", file.warnings);
    let fields = "<FieldData><DataArray type=\"Float64\" Name=\"band\" format=\"ascii\">2.5</DataArray>\
                  <DataArray type=\"String\" Name=\"unit\" format=\"ascii\">109 109 0</DataArray></FieldData><Piece";
    let file = read(&changed("<Piece", fields));
    assert_eq!((file.band, file.unit), (Some(2.5), Some(Unit::Millimetre)));
    let turned = String::from_utf8(changed(
        "<Piece",
        "<FieldData><DataArray type=\"String\" Name=\"sign\" \
        format=\"ascii\">112 111 115 105 116 105 118 101 32 105 110 115 105 100 101 0</DataArray></FieldData><Piece",
    ));
    let file = read_grid_bytes(turned.unwrap().as_bytes(), None, None).expect("it is sound");
    assert_eq!(values_of(&file), expected().iter().map(|value| -value).collect::<Vec<_>>());
}

fn nrrd(fields: &str, data: &[u8]) -> Vec<u8> {
    let mut out = format!("NRRD0004\n# a remark\ndimension: 3\nsizes: 2 3 4\n{}\n\n", fields.trim_end()).into_bytes();
    out.extend(data);
    out
}

#[test]
fn nrrd_in_every_encoding() {
    for (kind, size, float) in
        [("float", 4, true), ("double", 8, true), ("signed char", 1, false), ("short", 2, false), ("int64_t", 8, false)]
    {
        for (order, big) in [("little", false), ("big", true)] {
            let bytes = bytes_as(size, float, big);
            let fields = |encoding: &str| format!("type: {kind}\nendian: {order}\nencoding: {encoding}");
            read(&nrrd(&fields("raw"), &bytes));
            read(&nrrd(&(fields("raw") + "\nbyte skip: -1"), &[b"rubbish".as_slice(), &bytes].concat()));
            read(&nrrd(&(fields("raw") + "\nline skip: 1\nbyteskip: 2"), &[b"a line\nxx".as_slice(), &bytes].concat()));
            let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&bytes).unwrap();
            read(&nrrd(&fields("gzip"), &encoder.finish().unwrap()));
        }
    }
    let numbers: Vec<String> = expected().iter().map(f32::to_string).collect();
    let text = nrrd("type: double\nencoding: ascii\nspacings: 0.5 0.5 0.5", numbers.join(" ").as_bytes());
    assert!(read(&text).warnings.is_empty());
    let windows = String::from_utf8(text).unwrap().replace('\n', "\r\n");
    assert_eq!(read(windows.as_bytes()).spacing, 0.5);
}

#[test]
fn nrrd_says_where_in_many_ways() {
    let file = |fields: &str| read(&nrrd(&format!("type: int8\nencoding: raw\n{fields}"), &bytes_as(1, false, false)));
    let plain =
        file("space: left-posterior-superior\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (1,-2,0.5)");
    assert_eq!((plain.origin, plain.spacing), (DVec3::new(1.0, -2.0, 0.5), 2.0));
    let mins = "spacings: 0.5 0.5 0.5\naxis mins: 1 2 3";
    assert_eq!(file(mins).origin, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(file(&format!("{mins}\ncenters: cell cell cell")).origin, DVec3::new(1.25, 2.25, 3.25));
    assert!(file("").warnings.iter().any(|words| words.contains("no spacing")));
    let unit = |line: &str| file(&format!("spacings: 1 1 1\n{line}"));
    assert_eq!(unit("space units: \"cm\" \"cm\" \"cm\"").unit, Some(Unit::Centimetre));
    assert_eq!(unit("units: \"mm\" \"mm\" \"mm\"\nband:=2.5").band, Some(2.5));
    let odd = unit("space units: \"mm\" \"mm\" \"cm\"");
    assert!(odd.unit.is_none() && odd.warnings.len() == 1, "{:?}", odd.warnings);
}

fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut out = vec![0x93, b'N', b'U', b'M', b'P', b'Y', version, 0];
    let length = header.len() as u32;
    out.extend(if version == 1 { length.to_le_bytes()[..2].to_vec() } else { length.to_le_bytes().to_vec() });
    [out, header.as_bytes().to_vec(), data.to_vec()].concat()
}

#[test]
fn numpy_in_both_orders_and_every_type() {
    for (code, size, float) in [("f4", 4, true), ("f8", 8, true), ("i1", 1, false), ("i2", 2, false), ("i8", 8, false)]
    {
        for (order, big) in [("<", false), (">", true)] {
            let bytes = bytes_as(size, float, big);
            // From x fastest to z fastest.
            let rows = (0..2).flat_map(|x| (0..3).flat_map(move |y| (0..4).map(move |z| x + 2 * y + 6 * z)));
            let turned: Vec<u8> = rows.flat_map(|n| bytes[n * size..(n + 1) * size].to_vec()).collect();
            for version in [1, 2, 3] {
                let header = |fortran: &str| {
                    format!("{{'descr': '{order}{code}', 'fortran_order': {fortran}, 'shape': (2, 3, 4), }}   \n")
                };
                read(&npy(version, &header("True"), &bytes));
                read(&npy(version, &header("False"), &turned));
            }
        }
    }
    let file =
        read(&npy(1, "{\"shape\": (2,3,4), \"fortran_order\": True, \"descr\": \"|i1\"}", &bytes_as(1, false, false)));
    assert_eq!((file.origin, file.spacing, file.unit), (DVec3::ZERO, 1.0, None));
}
