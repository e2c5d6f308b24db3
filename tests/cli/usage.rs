//! Wrong usage: exit 2, one sentence, and nothing touched.

use super::{assert_empty, folder, run, run_in, sample};

#[test]
fn help_lists_every_verb_and_every_exit_status() {
    let help = run(&["--help"]).exits(0).text();
    for word in [
        "repair",
        "union",
        "intersection",
        "difference",
        "csg",
        "sdf",
        "inspect",
        "convert",
        "hollow",
        "decimate",
        "split",
        "render",
        "devices",
        "schema",
        "130",
    ] {
        assert!(help.contains(word), "`{word}` is missing in:\n{help}");
    }
    assert!(run(&["repair", "--help"]).exits(0).text().contains("Make one closed, oriented solid"));
    assert_eq!(run(&["--version"]).exits(0).text().trim(), concat!("meshwright ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_usage_exits_with_2_and_a_sentence() {
    let folder = folder();
    for (arguments, words) in [
        ("", "Usage"),
        ("mend x.stl", "`mend` is no verb"),
        ("reapir testdata/torus.ply -o OUT/a.stl", "did you mean `repair`?"),
        ("batch reapir testdata --out OUT/none", "did you mean `repair`?"),
        ("inspect testdata/torus.ply --keep-partial", "it is a flag of `repair`"),
        ("repair testdata/torus.ply -o OUT/a.stl --resoluton 64", "--resolution"),
        ("repair testdata/torus.ply -o OUT/a.stl --preset prnit", "print"),
        ("repair testdata/torus.ply -o OUT/a.stl --voxel 0.4mn", "did you mean 0.4mm?"),
        ("repair testdata/torus.ply -o OUT/a.stl --unit milimetre", "did you mean millimeter?"),
        ("repair testdata/torus.ply -o OUT/a.sltt", "did you mean OUT/a.stl?"),
        ("sdf testdata/torus.ply -o OUT/a.vtii", "did you mean OUT/a.vti?"),
        ("split testdata/torus.ply -o OUT/a.objj", "did you mean OUT/a.obj?"),
        ("convert testdata/torus.ply -o OUT/a.glft", "did you mean OUT/a.gltf?"),
        ("field a a=testdata/torus.ply -o OUT/a.nrdd", "did you mean OUT/a.nrrd?"),
        ("repair testdata/torus.ply -o OUT/a.stl --out-format sltt", "did you mean stl?"),
        ("render testdata/torus.ply -o OUT/a.png --view fornt", "did you mean front?"),
        ("csg blok block=testdata/torus.ply -o OUT/a.stl", "did you mean `block`?"),
        ("field ofset(a,1) a=testdata/torus.ply -o OUT/a.stl", "did you mean `offset`?"),
        ("field filter(a,widht=1) a=testdata/torus.ply -o OUT/a.stl", "did you mean `width`?"),
        ("field offset(a,1mn) a=testdata/torus.ply -o OUT/a.stl --unit mm", "did you mean 1mm?"),
        ("repair testdata/torus.ply", "--output"),
        ("repair testdata/torus.ply -o OUT/a.stl --resolution 64 --voxel 1", "cannot be used with"),
        ("repair testdata/torus.ply -o OUT/a.stl --resolution 1", "--resolution"),
        ("repair testdata/torus.ply -o OUT/a.stl --voxel 2h", "it is the voxel that is asked for"),
        ("repair testdata/torus.ply -o OUT/a.stl --voxel 0.4mm", "needs the unit of the model"),
        ("repair testdata/torus.ply -o OUT/a.stl --voxel furlong", "is not a length"),
        ("repair testdata/torus.ply -o OUT/a.stl --unit furlong", "furlong"),
        ("repair testdata/torus.ply -o OUT/a.stl --timeout soon", "is not a duration"),
        ("repair testdata/torus.ply -o OUT/a.stl --max-memory lots", "is not a size"),
        ("repair testdata/torus.ply -o OUT/a.stl --threads 0", "--threads"),
        ("repair testdata/torus.ply -o OUT/a.step", "does not tell its format"),
        ("repair testdata/torus.ply -o -", "no name that tells its format"),
        ("repair testdata/torus.ply -o - --out-format stl --json", "both want standard output"),
        ("repair testdata/torus.ply -o OUT/nowhere/a.stl", "nowhere"),
        ("repair testdata/torus.ply -o OUT", "OUT"),
        ("repair testdata/torus.ply -o OUT/a.stl --report OUT/a.stl", "are the same file"),
        ("repair testdata/torus.ply -o OUT/a.stl --report -", "--report wants a file"),
        ("repair testdata/torus.ply -o OUT/a.stl -q -v", "cannot be used with"),
        ("union testdata/torus.ply -o OUT/a.stl", "two files or more"),
        ("repair testdata/torus.ply -o OUT/a.stl --resolution 4081", "from 2 to 4,080 voxels"),
        ("sdf testdata/torus.ply -o OUT/a.vti --resolution 65536", "from 2 to 4,080 voxels"),
        ("field a a=testdata/torus.ply -o OUT/a.stl --resolution 65536", "from 2 to 4,080 voxels"),
        ("inspect testdata/torus.ply --thickness --resolution 65536", "from 2 to 4,080 voxels"),
        ("repair testdata/torus.ply -o OUT/a.stl --resolution 0.4", "--voxel takes a length"),
        ("repair testdata/torus.ply -o OUT/a.stl --voxel -1", "is not above zero"),
        ("erode testdata/torus.ply -o OUT/a.stl -r -2mm", "`dilate` grows by it"),
        ("erode testdata/torus.ply -o OUT/a.stl -r 1,5", "decimals are written with a point"),
        (
            "repair testdata/torus.ply -o OUT/a.stl --method exact --rebuild",
            "--method exact cannot be used with --rebuild",
        ),
        ("union testdata/torus.ply x.stl -o OUT/a.stl --method exact --no-fit", "cannot be used with --no-fit"),
        ("repair testdata/torus.ply -o OUT/a.stl --method cells", "auto, exact, voxel"),
        ("testdata/torus.ply", "meshwright repair testdata/torus.ply -o testdata/torus_repaired.ply"),
        ("-o OUT/a.stl testdata/torus.ply", "a verb comes first"),
        ("repair testdata/torus.ply testdata/open_cube.off -o OUT/a.stl", "meshwright union"),
        ("repair testdata/torus.ply OUT/a.stl", "-o OUT/a.stl"),
        ("inspect testdata/torus.ply testdata/open_cube.off", "takes one file"),
        ("repair testdata/torus.ply -o OUT/a.jpg --out-format stl", "is named as jpg, and stl would be written"),
        ("convert testdata/torus.ply -o OUT/a.stl --out-format ply", "is named as stl, and ply would be written"),
        ("repair testdata/torus.ply -o OUT/a.stl --map OUT/a.png", "is named as png, and ply would be written"),
        ("compare testdata/torus.ply testdata/torus.ply --map OUT/a.obj", "is named as obj, and ply would be written"),
        ("render testdata/torus.ply -o OUT/a.gif", "is named as gif, and png would be written"),
        ("sdf testdata/torus.ply -o OUT/a.vti --out-format nrrd", "is named as vti, and nrrd would be written"),
        ("field a a=testdata/torus.ply -o OUT/a.vti --out-format stl", "is named as vti, and stl would be written"),
        ("inspect testdata/torus.ply --report OUT/a.stl", "is named as stl, and json would be written"),
        ("repair testdata/torus.ply -o OUT/a.vti", "holds values over a lattice"),
        ("convert testdata/torus.ply -o OUT/a.vti", "meshwright sdf testdata/torus.ply"),
        ("union - - -o OUT/a.stl", "only once"),
        ("inspect testdata/torus.ply --fail-on dust", "dust"),
        ("render testdata/torus.ply -o OUT/a.png --width 0", "--width"),
    ] {
        let words = words.replace("OUT", folder.path().to_str().unwrap());
        run_in(&folder, arguments).exits(2).says(&[&words]);
        assert_empty(&folder);
    }
}

#[test]
fn nothing_is_suggested_where_nothing_is_near() {
    let folder = folder();
    for arguments in [
        "mend x.stl",
        "repair testdata/torus.ply -o OUT/a.stl --colour",
        "repair testdata/torus.ply -o OUT/a.stl --preset wood",
        "repair testdata/torus.ply -o OUT/a.stl --voxel 3parsec",
        "repair testdata/torus.ply -o OUT/a.step",
        "repair testdata/torus.ply -o OUT/a.stl --out-format step",
        "render testdata/torus.ply -o OUT/a.png --view inside",
        "csg wheel a=testdata/torus.ply -o OUT/a.stl",
        "field explode(a) a=testdata/torus.ply -o OUT/a.stl",
    ] {
        let said = run_in(&folder, arguments).exits(2).stderr;
        assert!(!said.contains("did you mean") && !said.contains("similar"), "{arguments}: {said}");
        assert_empty(&folder);
    }
}

#[cfg(not(feature = "gpu"))]
#[test]
fn a_build_without_the_graphics_backend_refuses_it() {
    let folder = folder();
    run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --backend gpu")
        .exits(2)
        .says(&["feature `gpu`", "--backend cpu"]);
    assert_empty(&folder);
    assert!(run(&["devices"]).exits(0).text().contains("feature `gpu`"));
}

#[test]
fn errors_of_ours_are_an_error_line_and_a_hint_line() {
    let folder = folder();
    let said = run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --voxel 0.4mm").exits(2).stderr;
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 2, "{said}");
    assert!(lines[0].starts_with("error: "), "{said}");
    assert!(lines[1].starts_with("hint: ") && lines[1].contains("--unit mm"), "{said}");
}

#[test]
fn an_input_is_overwritten_only_with_force() {
    let folder = folder();
    let copy = folder.path().join("cube.off");
    std::fs::copy(sample("open_cube.off"), &copy).unwrap();
    let before = std::fs::read(&copy).unwrap();
    for arguments in [
        "repair OUT/cube.off -o OUT/cube.off",
        "repair OUT/cube.off -o OUT/./cube.off",
        "convert OUT/cube.off -o OUT/cube.off",
        "union testdata/torus.ply OUT/cube.off -o OUT/cube.off",
        "csg a|b a=testdata/torus.ply b=OUT/cube.off -o OUT/cube.off",
        "render OUT/cube.off -o OUT/cube.off",
    ] {
        run_in(&folder, arguments).exits(2).says(&["is an input and would be overwritten", "--force"]);
        assert_eq!(std::fs::read(&copy).unwrap(), before, "{arguments}");
    }
    run_in(&folder, "convert OUT/cube.off -o OUT/cube.off --force").exits(0);
}

#[test]
fn errors_in_an_expression_point_at_the_column() {
    let folder = folder();
    let csg = |expression: &str| {
        let out = folder.path().join("a.stl");
        let (a, b) = (format!("a={}", sample("torus.ply").display()), format!("b={}", sample("torus.ply").display()));
        run(&["csg", expression, &a, &b, "-o", out.to_str().unwrap()]).exits(2)
    };
    csg("a - (b | )").says(&["column 10", "expected a name, a function or `(`", "\n  a - (b | )\n           ^\n"]);
    csg("a + b").says(&["column 3", "an operator", "\n    ^\n"]);
    csg("a | wheel & b").says(&["column 5", "no file is given for `wheel`", "the names given are a, b"]);
    csg("a").says(&["the expression does not use `b`"]);
    csg("").says(&["column 1"]);
    assert_empty(&folder);
}

#[test]
fn operands_of_csg_need_names() {
    let folder = folder();
    run_in(&folder, "csg a testdata/torus.ply -o OUT/a.stl").exits(2).says(&["is not NAME=FILE"]);
    run_in(&folder, "csg a a=x.stl a=y.stl -o OUT/a.stl").exits(2).says(&["`a` is given twice"]);
    run_in(&folder, "csg a 1a=x.stl -o OUT/a.stl").exits(2).says(&["is not a name"]);
    assert_empty(&folder);
}
