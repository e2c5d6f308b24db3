//! `--map`: what each triangle of a result is, in numbers, in colours, in words and in pictures.

use glam::DVec3;
use meshwright::io::{self, Colours};

use super::{folder, picture, run_in};

/// The number of each face, from the header's layout: the last four bytes of each row.
fn kinds(bytes: &[u8], faces: usize) -> Vec<u32> {
    let row = 1 + 12 + 3 + 4;
    let start = bytes.len() - faces * row;
    bytes[start..].chunks(row).map(|row| u32::from_le_bytes([row[16], row[17], row[18], row[19]])).collect()
}

#[test]
fn kept_cut_rebuilt_and_made_up_are_told_apart() {
    let folder = folder();
    for (name, resolution) in [("broken_mug.obj", 96), ("open_cube.off", 48), ("overlapping_boxes.obj", 48)] {
        let line = format!("repair testdata/{name} -o OUT/out.ply --map OUT/map.ply --resolution {resolution} --force");
        let run = run_in(&folder, &format!("{line} --json"));
        let report = run.exits(0).json();
        let input = io::read(format!("testdata/{name}")).expect("our own").mesh;
        let map = io::read(folder.path().join("map.ply")).expect("a map");
        let bytes = std::fs::read(folder.path().join("map.ply")).expect("a map");
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert!(text.contains("property int kind\nend_header"), "{text}");
        let kinds = kinds(&bytes, map.mesh.triangles.len());
        // Kept: exactly those whose corners are the corners of a triangle of the input.
        let sorted = |corners: [DVec3; 3]| {
            let mut corners = corners.map(|p| (p + 0.0).to_array().map(f64::to_bits));
            corners.sort();
            corners
        };
        let own: std::collections::HashSet<_> = (0..input.triangles.len()).map(|t| sorted(input.corners(t))).collect();
        for (t, &kind) in kinds.iter().enumerate() {
            assert_eq!(kind == 0, own.contains(&sorted(map.mesh.corners(t))), "{name}: triangle {t} is of kind {kind}");
        }
        let count = |kind: u32| kinds.iter().filter(|k| **k == kind).count();
        let counts = &report["result"]["pipeline"]["triangles"];
        let [kept, rebuilt, made_up, cut] = [0, 1, 2, 3].map(count);
        let expected = serde_json::json!({ "kept": kept, "cut": cut, "rebuilt": rebuilt, "made_up": made_up });
        assert_eq!(*counts, expected, "{name}");
        assert_eq!(report["result"]["output"]["validity"]["triangles"], kept + cut + rebuilt + made_up);
        // Holes are made up, and only they; where closed surfaces meet, triangles are cut, and nothing else is done.
        let crossing = name == "overlapping_boxes.obj";
        assert_eq!(made_up > 0, !crossing, "{name}: {made_up}");
        assert_eq!((cut > 0, rebuilt > 0), (name != "open_cube.off", name == "broken_mug.obj"), "{name}: {counts}");
        assert!(kept > 0, "{name}: {counts}");
        // Each kind has one colour, which the legend names.
        let Some(Colours::Faces(colours)) = &map.colours else { panic!("{name}: a colour for each face") };
        let words = [(0, "kept"), (3, "cut"), (1, "rebuilt"), (2, "made up")];
        assert_eq!(map.legend.len(), 4);
        for ((kind, word), entry) in words.into_iter().zip(&map.legend) {
            assert!(entry.text.starts_with(word), "{entry:?}");
            let all = colours.iter().zip(&kinds).filter(|(_, k)| **k as usize == kind);
            assert!(all.into_iter().all(|(colour, _)| colour[..3] == entry.colour), "{name}: {entry:?}");
        }
        let said = run_in(&folder, &line).exits(0).stderr;
        let thousands = |n: usize| if n < 1000 { n.to_string() } else { format!("{},{:03}", n / 1000, n % 1000) };
        let counts = [(kept, "kept"), (cut, "cut"), (rebuilt, "rebuilt"), (made_up, "made up")];
        let told = counts.into_iter().filter(|(n, _)| *n > 0).map(|(n, word)| format!("{} {word}", thousands(n)));
        assert!(said.contains(&told.collect::<Vec<_>>().join(", ")), "{said}");
    }
}

#[test]
fn single_precision_and_morphology_have_the_same_kinds() {
    let folder = folder();
    let counts = |line: &str| {
        let report = run_in(&folder, &format!("{line} --json --force")).exits(0).json();
        let counts = &report["result"]["pipeline"]["triangles"];
        ["kept", "cut", "rebuilt", "made_up"].map(|kind| counts[kind].as_u64().expect("a count"))
    };
    // What is valid is kept, in single precision too.
    for name in ["a.stl", "a.ply"] {
        assert_eq!(counts(&format!("repair testdata/bored_block.off -o OUT/{name}")), [1152, 0, 0, 0], "{name}");
    }
    let [kept, _, _, made_up] = counts("dilate testdata/bored_block.off -o OUT/b.ply -r 1 --voxel 0.25");
    assert!(kept == 0 && made_up > 100, "{kept} {made_up}");
    let [kept, _, _, made_up] = counts("canals testdata/bored_block.off -d 2 --remove -o OUT/c.ply --voxel 0.25");
    assert!(kept > 100 && made_up > 0, "{kept} {made_up}");
}

#[test]
fn pictures_of_maps_have_a_legend() {
    let folder = folder();
    run_in(&folder, "canals testdata/bored_block.off -d 2 --map OUT/map.ply --voxel 0.25").exits(0);
    let said = run_in(&folder, "render OUT/map.ply -o OUT/map.png --width 600 --height 400").exits(0).stderr;
    assert!(said.contains("#B0BECD kept: ") && said.contains(" canal 1"), "{said}");
    run_in(&folder, "compare testdata/torus.ply testdata/bored_block.off --map OUT/far.ply").exits(0);
    let said = run_in(&folder, "render OUT/far.ply OUT/map.ply -o OUT/both.png").exits(0).stderr;
    assert!(said.contains("inside the reference") && said.contains("made up"), "{said}");
    // The same mesh without its comments has a picture without the legend.
    let bytes = std::fs::read(folder.path().join("map.ply")).expect("a map");
    let at = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header");
    let header = String::from_utf8_lossy(&bytes[..at]).into_owned();
    let plain: String = header.lines().filter(|l| !l.starts_with("comment")).map(|l| format!("{l}\n")).collect();
    std::fs::write(folder.path().join("plain.ply"), [plain.as_bytes(), &bytes[at..]].concat()).expect("written");
    let said = run_in(&folder, "render OUT/plain.ply -o OUT/plain.png --width 600 --height 400").exits(0).stderr;
    assert!(!said.contains("kept: "), "{said}");
    let [with, without] = ["map.png", "plain.png"].map(|name| picture(&folder, name).3);
    let blue = |image: &[[u8; 4]]| image.iter().filter(|pixel| pixel[..3] == [0, 114, 178]).count();
    assert!(blue(&with) >= 49 && blue(&without) == 0, "{} {}", blue(&with), blue(&without));
}
