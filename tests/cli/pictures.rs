//! What `render` draws of meshes, and how: views, cuts, clear surfaces, turns, kinds of files.

use super::{folder, picture, run_in};

const SIZE: &str = "--width 320 --height 240";

#[test]
fn sheets_have_a_picture_for_each_view_of_each_mesh() {
    let folder = folder();
    for (inputs, views, size) in [
        ("testdata/torus.ply", "iso,front,top,right", (645, 485)),
        ("testdata/torus.ply", "iso,top", (645, 240)),
        ("testdata/torus.ply testdata/open_cube.off", "iso,top,left", (970, 485)),
    ] {
        run_in(&folder, &format!("render {inputs} -o OUT/a.png --views {views} {SIZE}")).exits(0);
        let (width, height, ..) = picture(&folder, "a.png");
        assert_eq!((width, height), size, "{inputs} {views}");
    }
    for views in ["iso,1,0,0", "above"] {
        run_in(&folder, &format!("render testdata/torus.ply -o OUT/a.png --views {views}"))
            .exits(2)
            .says(&["of iso, front"]);
    }
}

#[test]
fn the_gap_between_pictures_is_white_whatever_they_show() {
    let folder = folder();
    run_in(&folder, "sdf testdata/torus.ply -o OUT/t.vdb --resolution 24 --band full").exits(0);
    // So small that the colours of the slice reach its edge.
    run_in(&folder, "render OUT/t.vdb OUT/t.vdb -o OUT/a.png --width 200 --height 150").exits(0);
    let (width, _, _, pixels) = picture(&folder, "a.png");
    assert_eq!(width, 403);
    assert!(pixels.chunks(403).all(|row| row[200..203].iter().all(|&pixel| pixel == [255; 4])));
    assert!(pixels.chunks(403).any(|row| row[199] != [255; 4]));
}

#[test]
fn numbers_of_defects_are_said_and_drawn() {
    let folder = folder();
    let said = run_in(&folder, &format!("render testdata/open_cube.off -o OUT/a.png {SIZE}")).exits(0).stderr;
    let json = run_in(&folder, "inspect testdata/open_cube.off --json").exits(0).json();
    let open = json["inputs"][0]["validity"]["open_edges"].as_u64().expect("a number");
    assert!(said.contains(&format!("#ED0027 {open} open edges; #D4653F inner sides")), "{said}");
    let said = run_in(&folder, &format!("render testdata/torus.ply -o OUT/b.png {SIZE}")).exits(0).stderr;
    assert!(said.contains("closed, and nothing crosses"), "{said}");
    // Words change the picture, and none do where none are wanted.
    run_in(&folder, &format!("render testdata/open_cube.off -o OUT/plain.png --plain {SIZE}")).exits(0);
    run_in(&folder, &format!("render testdata/open_cube.off -o OUT/title.png --title other {SIZE}")).exits(0);
    let rows = |name: &str, rows: std::ops::Range<usize>| {
        picture(&folder, name).3.chunks(320).skip(rows.start).take(rows.len()).flatten().copied().collect::<Vec<_>>()
    };
    let dark = |pixels: &[[u8; 4]]| pixels.iter().filter(|p| p[..3].iter().all(|&c| c < 110)).count();
    assert!(dark(&rows("a.png", 0..18)) > 50 && dark(&rows("plain.png", 0..8)) == 0);
    assert!(rows("a.png", 0..18) != rows("title.png", 0..18) && rows("a.png", 40..240) == rows("title.png", 40..240));
}

#[test]
fn cuts_clear_surfaces_and_zooms_change_what_is_seen() {
    let folder = folder();
    let draw = |flags: &str| {
        run_in(&folder, &format!("render testdata/broken_mug.obj -o OUT/a.png {SIZE} {flags}")).exits(0);
        picture(&folder, "a.png").3
    };
    let whole = draw("");
    for flags in [
        "--clip x=50%",
        "--opacity 40%",
        "--zoom defects",
        "--projection perspective",
        "--edges none",
        "--background white",
    ] {
        assert!(draw(flags) != whole, "{flags}");
    }
    assert_eq!(draw("--background transparent --plain")[0], [0; 4]);
    let said =
        run_in(&folder, &format!("render testdata/torus.ply -o OUT/a.png {SIZE} --zoom defects")).exits(0).stderr;
    assert!(said.contains("no defects to zoom to"), "{said}");
    let refused = [
        ("--clip z=9000", "--clip z=9000 lies outside"),
        ("--opacity 0", "a share from 0.05 to 1"),
        ("--plain --title x", "cannot be used with"),
        ("--view top --views iso", "cannot be used with"),
    ];
    for (flags, words) in refused {
        run_in(&folder, &format!("render testdata/torus.ply -o OUT/b.png {flags}")).exits(2).says(&[words]);
    }
}

#[test]
fn regions_of_a_report_are_drawn() {
    let folder = folder();
    run_in(
        &folder,
        "repair testdata/thin_parts.obj -o OUT/out.stl --method voxel --resolution 24 --report OUT/run.json",
    )
    .exits(0);
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("run.json")).expect("a report")).expect("JSON");
    let thin = report["result"]["pipeline"]["thin"]["regions"].as_array().map_or(0, Vec::len);
    assert!(thin > 0, "{report}");
    let draw = |flags: &str| {
        let said =
            run_in(&folder, &format!("render testdata/thin_parts.obj -o OUT/a.png {SIZE} {flags}")).exits(0).stderr;
        let (.., pixels) = picture(&folder, "a.png");
        (said, pixels.iter().filter(|p| p[0] > 120 && p[1] < 40 && (90..150).contains(&p[2])).count())
    };
    let (said, with) = draw("--regions OUT/run.json");
    assert!(said.contains(&format!("thin walls and gaps: {thin}")), "{said}");
    let (_, without) = draw("");
    assert!(with > without + 50, "{with} {without}");
    run_in(&folder, "inspect testdata/torus.ply --report OUT/none.json").exits(0);
    run_in(&folder, &format!("render testdata/torus.ply -o OUT/a.png {SIZE} --regions OUT/none.json"))
        .exits(0)
        .says(&["no thin or doubtful regions"]);
    run_in(&folder, "render testdata/torus.ply -o OUT/a.png --regions testdata/torus.ply")
        .exits(4)
        .says(&["is no report"]);
}

#[test]
fn turns_and_photographs_are_files_of_their_kind() {
    let folder = folder();
    run_in(&folder, &format!("render testdata/torus.ply -o OUT/t.png --turntable 6 {SIZE}"))
        .exits(0)
        .says(&["6 of them"]);
    let (width, height, frames, _) = picture(&folder, "t.png");
    assert_eq!((width, height, frames), (320, 240, 6));
    let json = run_in(&folder, &format!("render testdata/torus.ply -o OUT/a.JPG {SIZE} --json")).exits(0).json();
    assert_eq!(json["result"]["output"]["format"], "jpeg");
    let bytes = std::fs::read(folder.path().join("a.JPG")).expect("a picture");
    assert!(bytes.starts_with(&[0xff, 0xd8, 0xff]));
    run_in(&folder, "render testdata/torus.ply -o OUT/b.jpg --turntable 6").exits(2).says(&["holds no animation"]);
    for other in ["testdata/open_cube.off", "--views iso,top", "--slice z"] {
        run_in(&folder, &format!("render testdata/torus.ply {other} -o OUT/b.png --turntable 6"))
            .exits(2)
            .says(&["--turntable"]);
    }
}

#[test]
fn maps_of_distances_have_a_bar_and_a_range() {
    let folder = folder();
    run_in(&folder, "compare testdata/torus.ply testdata/bored_block.off --map OUT/far.ply --unit mm").exits(0);
    run_in(
        &folder,
        "compare testdata/torus.ply testdata/bored_block.off --map OUT/own.ply --unit mm --map-range 0.5mm",
    )
    .exits(0);
    let header = |name: &str| {
        let bytes = std::fs::read(folder.path().join(name)).expect("a map");
        let end = bytes.windows(10).position(|w| w == b"end_header").expect("a header");
        String::from_utf8_lossy(&bytes[..end]).into_owned()
    };
    assert!(header("own.ply").contains("colour scale -0.5 0.5 distance, mm"), "{}", header("own.ply"));
    assert!(!header("far.ply").contains("colour scale -0.5 0.5"));
    let histogram = header("own.ply")
        .lines()
        .find_map(|line| line.strip_prefix("comment colour histogram ").map(String::from))
        .expect("a histogram");
    let counted: u64 = histogram.split(' ').map(|n| n.parse::<u64>().expect("a number")).sum();
    let vertices = header("own.ply").lines().find_map(|line| line.strip_prefix("element vertex ")?.parse().ok());
    assert_eq!(Some(counted), vertices);
    for name in ["far", "own"] {
        run_in(&folder, &format!("render OUT/{name}.ply -o OUT/{name}.png {SIZE} --no-defects")).exits(0);
    }
    let (far, own) = (picture(&folder, "far.png").3, picture(&folder, "own.png").3);
    assert!(far != own);
    // The bar on the right: red above, blue below.
    let strip = |rows: std::ops::Range<usize>, red: bool| {
        let rows = own.chunks(320).skip(rows.start).take(rows.len());
        rows.flat_map(|row| &row[240..])
            .filter(|p| if red { p[0] > p[2].saturating_add(60) } else { p[2] > p[0].saturating_add(60) })
            .count()
    };
    assert!(strip(20..70, true) > 150 && strip(20..70, false) == 0);
    assert!(strip(140..190, false) > 150 && strip(140..190, true) == 0);
    for range in ["0", "-1", "2h"] {
        run_in(&folder, &format!("compare testdata/torus.ply testdata/torus.ply --map OUT/x.ply --map-range={range}"))
            .exits(2);
    }
    run_in(&folder, "compare testdata/torus.ply testdata/torus.ply --map-range 1").exits(2).says(&["--map"]);
}
