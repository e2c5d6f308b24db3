//! `--report FILE.html`: the page as text. What it looks like in a browser is for `tools/page.py`.

use std::fmt::Write;

use tempfile::TempDir;

use super::{folder, run_in};

/// Elements that have no end.
const VOID: [&str; 2] = ["meta", "img"];

/// The page of a run, by its arguments.
#[track_caller]
fn page(folder: &TempDir, arguments: &str, status: i32) -> String {
    run_in(folder, &format!("{arguments} --report OUT/page.html -q")).exits(status);
    std::fs::read_to_string(folder.path().join("page.html")).expect("a page")
}

/// What stands within the element with this id, up to the end of its kind.
#[track_caller]
fn within<'a>(page: &'a str, start: &str, end: &str) -> &'a str {
    let from = page.find(start).unwrap_or_else(|| panic!("no {start}")) + start.len();
    let rest = &page[from..];
    &rest[..rest.find(end).unwrap_or_else(|| panic!("no {end}"))]
}

fn report(page: &str) -> serde_json::Value {
    serde_json::from_str(within(page, "id=\"report\">", "</script>")).expect("the report is JSON")
}

fn cells(row: &str) -> Vec<String> {
    row.split("<td>").skip(1).map(|cell| cell[..cell.find("</td>").expect("an end")].to_string()).collect()
}

/// The cells of the rows of a section.
fn rows(page: &str, section: &str) -> Vec<Vec<String>> {
    let body = within(page, &format!("<section id=\"{section}\">"), "</section>");
    body.lines().filter(|line| line.starts_with("<tr")).map(cells).collect()
}

/// Asserts that every element ends where it should, and that attributes are whole.
#[track_caller]
fn assert_well_formed(page: &str) {
    let mut open: Vec<String> = Vec::new();
    let mut rest = page.strip_prefix("<!DOCTYPE html>").expect("a page of HTML");
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let end = rest.find('>').expect("a tag ends");
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes in <{tag}>");
        let name: String = tag.chars().take_while(|c| !c.is_whitespace()).collect();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "</{name}> after {open:?}");
        } else if !tag.ends_with('/') && !VOID.contains(&name.as_str()) {
            if ["script", "style"].contains(&name.as_str()) {
                let end = rest.find(&format!("</{name}>")).expect("a script ends");
                rest = &rest[end + name.len() + 3..];
            } else {
                open.push(name);
            }
        }
    }
    assert_eq!(open, Vec::<String>::new());
}

#[track_caller]
fn assert_contained(page: &str) {
    for word in
        ["http:", "https:", "//cdn", "url(", "@import", "<link", "<iframe", "fetch(", "XMLHttpRequest", "import("]
    {
        assert!(!page.contains(word), "{word} is in the page");
    }
    for address in page.split("src=\"").skip(1) {
        assert!(address.starts_with("data:image/png;base64,"), "{}", &address[..40.min(address.len())]);
    }
    assert!(page.contains("default-src 'none'"));
}

fn thousands(number: &serde_json::Value) -> String {
    let digits = number.as_u64().expect("a whole number").to_string();
    let parts: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|part| std::str::from_utf8(part).ok()).collect();
    parts.join(",")
}

#[test]
fn pages_hold_all_that_they_need() {
    let folder = folder();
    for (line, status, panes) in [
        ("repair testdata/broken_mug.obj -o OUT/mug.ply --resolution 64", 0, 2),
        ("difference testdata/hollow_ball.stl testdata/inside_out_cube.stl -o OUT/less.stl --resolution 48", 0, 2),
        ("compare testdata/torus.ply testdata/noisy_cube.off", 0, 2),
        ("decimate testdata/torus.ply -o OUT/fewer.ply --ratio 0.5", 0, 2),
        ("canals testdata/bored_block.off --max-diameter 3% --resolution 48", 0, 1),
        ("inspect testdata/broken_mug.obj --holes", 0, 1),
        ("convert testdata/torus.ply -o OUT/torus.stl", 0, 0),
        ("repair testdata/torus.ply -o OUT/plan.stl --plan", 0, 0),
    ] {
        let page = page(&folder, line, status);
        assert_well_formed(&page);
        assert_contained(&page);
        assert_eq!(page.matches("<img ").count(), panes, "{line}");
        assert_eq!(page.contains("id=\"meshes\""), panes > 0, "{line}");
        assert_eq!(report(&page)["exit"], status, "{line}");
    }
}

#[test]
fn numbers_on_the_page_are_those_of_the_report() {
    let folder = folder();
    let page = page(&folder, "repair testdata/open_cube.off -o OUT/cube.stl", 0);
    let report = report(&page);
    let numbers = rows(&page, "numbers");
    let [before, after] = [&report["inputs"][0]["validity"], &report["result"]["output"]["validity"]];
    for (name, field) in [("Triangles", "triangles"), ("Open edges", "open_edges"), ("Surfaces", "bodies")] {
        let row = numbers.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {numbers:?}"));
        assert_eq!(row[1..], [thousands(&before[field]), thousands(&after[field])], "{name}");
    }
    let holes = report["result"]["pipeline"]["holes"].as_array().expect("holes");
    let listed: Vec<_> = rows(&page, "defects").into_iter().filter(|row| row[0].starts_with("Hole")).collect();
    assert!(!holes.is_empty() && listed.len() == holes.len(), "{listed:?}");
    for (row, hole) in listed.iter().zip(holes) {
        assert_eq!(row[0], format!("Hole {}", hole["number"]));
        assert!(row[1].starts_with(&format!("{} edges", thousands(&hole["edges"]))), "{row:?}");
        assert!(row[4].contains(&format!("{} triangle", thousands(&hole["triangles"]))), "{row:?}");
    }
    // Holes are told once: their rims are no defects besides.
    assert!(!rows(&page, "defects").iter().any(|row| row[0] == "Open edges"), "{page}");
    assert_eq!(rows(&page, "bodies").len() as u64, after["bodies"].as_u64().expect("a number"));
    let hash = report["inputs"][0]["sha256"].as_str().expect("a hash");
    assert!(rows(&page, "again").iter().any(|row| row[2] == hash));
}

#[test]
fn the_page_is_the_same_for_any_number_of_threads() {
    let folder = folder();
    let line = "repair testdata/broken_mug.obj -o OUT/mug.ply --resolution 64 --threads";
    // But for the time that it took, and the number of threads in the command and the options.
    let lasting = |threads: u32| {
        let page = page(&folder, &format!("{line} {threads}"), 0);
        let start = page.find("<section id=\"time\">").expect("a section");
        let end = page.find("</main>").expect("an end");
        let report = page.find("<script type=\"application/json\" id=\"report\">").expect("the report");
        let meshes = page.find("<script type=\"application/json\" id=\"meshes\">").expect("the meshes");
        [&page[..start], &page[end..report], &page[meshes..]].concat()
    };
    assert!(lasting(1) == lasting(2), "the page depends on the number of threads");
}

#[test]
fn names_cannot_become_parts_of_the_page() {
    let folder = folder();
    let evil = "</script><script>alert(1)</script><img_src=x_onerror=alert(2)>";
    let cube = std::fs::read_to_string("testdata/overlapping_boxes.obj").expect("our own");
    let lines: Vec<String> = cube
        .lines()
        .map(|line| match line.strip_prefix("o ") {
            Some(name) => format!("o {evil}{name}"),
            None => line.to_string(),
        })
        .collect();
    let name = "a<b>&'x'.obj";
    std::fs::write(folder.path().join(name), format!("o {evil}\n{}\n", lines.join("\n"))).expect("a file");
    let page = page(&folder, &format!("repair OUT/{name} -o OUT/out.stl"), 0);
    assert_well_formed(&page);
    assert!(!page.contains("<script>alert") && !page.contains("<img_src") && !page.contains("a<b>"), "a name is a tag");
    assert!(page.contains("a&lt;b&gt;&amp;&#39;x&#39;.obj"));
    let report = report(&page);
    assert!(
        report["inputs"][0]["parts"].to_string().contains("</script><script>alert(1)"),
        "{}",
        report["inputs"][0]["parts"]
    );
}

#[test]
fn pages_of_runs_that_fail_say_why() {
    let folder = folder();
    let page = page(&folder, "repair testdata/no_such_file.stl -o OUT/out.stl", 4);
    assert_well_formed(&page);
    let verdict = within(&page, "<p class=\"verdict bad\">", "</p>");
    assert!(verdict.contains("no_such_file.stl"), "{verdict}");
    let report = report(&page);
    assert_eq!(report["exit"], 4);
    run_in(&folder, "repair testdata/torus.ply -o OUT/out.stl --report OUT/page.png").exits(2).says(&["png"]);
}

#[test]
fn a_page_is_made_of_a_report_later() {
    let folder = folder();
    run_in(&folder, "repair testdata/open_cube.off -o OUT/cube.stl --report OUT/run.json -q").exits(0);
    run_in(&folder, "report OUT/run.json").exits(0).says(&["run.html"]);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a page");
    let later = read("run.html");
    assert_well_formed(&later);
    assert_contained(&later);
    assert_eq!(later.matches("<img ").count(), 2);
    let at_once = page(&folder, "repair testdata/open_cube.off -o OUT/cube.stl", 0);
    for section in ["numbers", "defects", "done", "bodies"] {
        assert_eq!(rows(&later, section), rows(&at_once, section), "{section}");
    }
    for (line, section) in [
        ("compare testdata/torus.ply testdata/noisy_cube.off", "measured"),
        ("decimate testdata/torus.ply -o OUT/fewer.ply --ratio 0.5", "measured"),
        ("inspect testdata/broken_mug.obj --holes", "defects"),
    ] {
        run_in(&folder, &format!("{line} --report OUT/other.json -q")).exits(0);
        run_in(&folder, "report OUT/other.json -o OUT/other.html -q").exits(0);
        assert_eq!(rows(&read("other.html"), section), rows(&page(&folder, line, 0), section), "{line}");
        assert!(read("other.html").contains("id=\"meshes\""), "{line}");
    }
    // A file that is another one is not shown.
    std::fs::copy("testdata/torus.ply", folder.path().join("cube.stl")).expect("a copy");
    let run = run_in(&folder, "report OUT/run.json -o OUT/changed.html --json").exits(0).json();
    assert!(
        run["result"]["missing"][0].as_str().is_some_and(|text| text.ends_with("has changed since the run")),
        "{run}"
    );
    let changed = read("changed.html");
    assert!(changed.contains("has changed since the run") && !changed.contains("<img "), "{changed}");
    std::fs::remove_file(folder.path().join("cube.stl")).expect("it was there");
    run_in(&folder, "report OUT/run.json -o OUT/gone.html").exits(0).says(&["is not there any more"]);
    std::fs::write(folder.path().join("other.json"), "{\"tool\": \"another\"}").expect("a file");
    run_in(&folder, "report OUT/other.json").exits(4).says(&["is no report of meshwright"]);
}

/// A closed surface of many triangles, as OBJ.
fn ball(rings: usize, sides: usize) -> String {
    let mut text = String::new();
    let point = |ring: usize, side: usize| {
        let (v, u) =
            (std::f64::consts::PI * ring as f64 / rings as f64, std::f64::consts::TAU * side as f64 / sides as f64);
        let r = 1.0 + 0.01 * (17.0 * u).sin() * (13.0 * v).sin();
        [r * v.sin() * u.cos(), r * v.sin() * u.sin(), r * v.cos()]
    };
    let mut put = |[x, y, z]: [f64; 3]| writeln!(text, "v {x} {y} {z}").expect("a string takes all");
    put([0.0, 0.0, 1.0]);
    (1..rings).for_each(|ring| (0..sides).for_each(|side| put(point(ring, side))));
    put([0.0, 0.0, -1.0]);
    let number = |ring: usize, side: usize| 2 + (ring - 1) * sides + side % sides;
    let last = 2 + (rings - 1) * sides;
    for side in 0..sides {
        writeln!(text, "f 1 {} {}", number(1, side), number(1, side + 1)).expect("a string takes all");
        writeln!(text, "f {last} {} {}", number(rings - 1, side + 1), number(rings - 1, side))
            .expect("a string takes all");
        for ring in 1..rings - 1 {
            let [a, b, c, d] =
                [number(ring, side), number(ring + 1, side), number(ring + 1, side + 1), number(ring, side + 1)];
            writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("a string takes all");
        }
    }
    text
}

#[test]
fn large_meshes_make_pages_that_can_be_sent() {
    let folder = folder();
    std::fs::write(folder.path().join("ball.obj"), ball(224, 225)).expect("a file");
    let page = page(&folder, "repair OUT/ball.obj -o OUT/out.ply", 0);
    let triangles = report(&page)["inputs"][0]["validity"]["triangles"].as_u64().expect("a number");
    assert!(triangles > 100_000, "{triangles}");
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
}
