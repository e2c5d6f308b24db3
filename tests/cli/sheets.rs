//! `thicken --base` and `repair --outer`: what is made, what is said, and what is wrong usage.

use meshwright::io;
use serde_json::Value;

use super::{assert_empty, folder, run_in, sample};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_sheet_becomes_a_block() {
    let folder = folder();
    let sheet = io::read(sample("open_sheet.obj")).expect("it reads").mesh;
    let low = sheet.positions.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    let json = run_in(&folder, "thicken testdata/open_sheet.obj -o OUT/block.off --base 5 --json").exits(0).json();
    let block = &json["result"]["pipeline"]["block"];
    assert_eq!((block["axis"].as_str(), number(&block["base"])), (Some("z"), low - 5.0));
    assert_eq!(json["options"]["base"], "5");
    assert_eq!(json["result"]["pipeline"]["triangles"]["kept"], sheet.triangles.len());
    assert_eq!(number(&block["volume"]), number(&json["result"]["output"]["validity"]["volume"]));
    run_in(&folder, "inspect OUT/block.off --fail-on any").exits(0);
    let plane = format!("thicken testdata/open_sheet.obj -o OUT/plane.stl --unit mm --base z={}mm", low - 2.5);
    run_in(&folder, &plane).exits(0).says(&["a block under 1 sheet, with walls under", "down to a base at z ="]);
    let planned = run_in(&folder, "thicken testdata/open_sheet.obj --base 5 --plan").exits(0);
    assert!(planned.text().contains("every closed surface stays as it is"), "{}", planned.text());
    let map = run_in(&folder, "thicken testdata/open_sheet.obj -o OUT/m.off --base 5 --map OUT/map.ply").exits(0);
    map.says(&["kept", "made up"]);
}

#[test]
fn bases_that_cannot_be_are_refused() {
    let folder = folder();
    let refused = |flags: &str, status: i32, words: &[&str]| {
        run_in(&folder, &format!("thicken testdata/open_sheet.obj -o OUT/x.stl {flags}")).exits(status).says(words);
    };
    refused("", 2, &["--min"]);
    refused("--base 5 --min 3", 2, &["--base", "--min"]);
    refused("--base 5 --side front", 2, &["--base", "--side"]);
    refused("--base w=3", 2, &["`w` is no axis", "x=0, y=1.5 or z=-5mm"]);
    refused("--base 0", 2, &["above zero"]);
    refused("--base z=5%", 2, &["no place on an axis"]);
    refused("--base 5mm", 2, &["the file carries none"]);
    refused("--base x=1", 2, &["both sides of its base x = 1", "goes through it at"]);
    run_in(&folder, "thicken testdata/torus.ply -o OUT/x.stl --base 5").exits(4).says(&["no open edge"]);
    assert_empty(&folder);
}

#[test]
fn what_a_ball_does_not_see_goes() {
    let folder = folder();
    let ball = io::read(sample("hollow_ball.stl")).expect("it reads").mesh;
    let json = run_in(&folder, "repair testdata/hollow_ball.stl -o OUT/full.off --outer 5% --json").exits(0).json();
    let outer = &json["result"]["pipeline"]["outer"];
    let (kept, gone) = (outer["outer_triangles"].as_u64(), outer["inner_triangles"].as_u64());
    assert_eq!(kept.zip(gone).map(|(kept, gone)| kept + gone), Some(ball.triangles.len() as u64));
    assert_eq!(outer["inner_patches"], 1);
    assert_eq!(json["result"]["output"]["validity"]["triangles"].as_u64(), kept);
    assert_eq!(number(&json["options"]["outer"]), number(&outer["ball"]));
    let said = run_in(&folder, "repair testdata/hollow_ball.stl -o OUT/again.stl --outer 5%").exits(0);
    said.says(&["a ball of", "it sees from outside", "went, which it does not come to, 1 patch among them as a whole"]);
    // The length may be left away.
    run_in(&folder, "repair testdata/open_cube.off --outer 90% -o OUT/cube.off").exits(0).says(&["the widest hole"]);
    run_in(&folder, "repair testdata/torus.ply --outer -o OUT/t.ply").exits(0).says(&["every triangle was kept"]);
}

#[test]
fn sheets_need_a_thickness() {
    let folder = folder();
    let refused = |line: &str, status: i32, words: &[&str]| {
        run_in(&folder, &format!("{line} -o OUT/x.stl")).exits(status).says(words);
    };
    refused("repair testdata/open_sheet.obj --outer", 3, &["from both sides", "--thickness LEN"]);
    refused("repair testdata/open_cube.off --outer", 3, &["hole that the ball passes", "the widest rim beside"]);
    refused("repair testdata/open_sheet.obj --thickness 1", 2, &["--outer"]);
    refused("repair testdata/torus.ply --outer 1e-6%", 2, &["cannot be rolled", "at least"]);
    refused("repair testdata/torus.ply --outer 0", 2, &["above zero"]);
    refused("repair testdata/torus.ply --outer --holes 1", 2, &["--holes"]);
    refused("repair testdata/torus.ply --outer 0.3% --max-memory 20M", 5, &["take a larger one"]);
    assert_empty(&folder);
    let thick = run_in(&folder, "repair testdata/open_sheet.obj --outer 5% --thickness 1 -o OUT/plate.stl").exits(0);
    thick.says(&["it sees from both sides made 1 thick"]);
    run_in(&folder, "inspect OUT/plate.stl --fail-on any").exits(0);
}
