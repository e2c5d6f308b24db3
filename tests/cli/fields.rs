//! `field` as users meet it.

use meshwright::io::{Colours, read_grid};
use tempfile::TempDir;

use super::{assert_empty, folder, names_in, run_in};

fn volume(folder: &TempDir, line: &str) -> f64 {
    let report = run_in(folder, &format!("{line} --json")).exits(0).json();
    report["result"]["frames"][0]["output"]["validity"]["volume"].as_f64().expect("a volume")
}

#[test]
fn bodies_of_an_expression_are_exact_where_they_are_flat() {
    let folder = folder();
    for (expression, expected) in [
        ("box(2,2,2)|box(2,2,2,x=1)", 12.0),
        ("box(2,2,2)-box(1,1,4)", 6.0),
        ("box(2,2,2)&plane(z,0.5)", 6.0),
        ("box(2,2,2)^box(2,2,2,x=1)", 8.0),
        ("offset(box(2,2,2),-0.25)", 3.375),
        ("move(turn(box(2,2,2),z,90),x=5)", 8.0),
    ] {
        let found = volume(&folder, &format!("field {expression} --voxel 0.1 -o OUT/o.ply"));
        assert!((found - expected).abs() < 2e-4 * expected, "{expression}: {found} instead of {expected}");
    }
}

#[test]
fn meshes_keep_their_sharp_edges_and_colours_through_booleans() {
    let folder = folder();
    let line = "field a-sphere(2,x=5,y=5,z=10) a=testdata/inside_out_cube.stl --resolution 40 -o OUT/o.off";
    run_in(&folder, line).exits(0).says(&["a: repaired first"]);
    let mesh = meshwright::io::read(folder.path().join("o.off")).unwrap().mesh;
    for corner in 0..8 {
        let at = glam::DVec3::from([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 10.0 } else { 0.0 }));
        assert!(mesh.positions.iter().any(|p| p.distance(at) < 1e-5), "corner {at}");
    }
    let red = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 4\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1 255 0 0\n3 0 1 3 255 0 0\n\
        3 1 2 3 255 0 0\n3 2 0 3 255 0 0\n";
    std::fs::write(folder.path().join("red.ply"), red).unwrap();
    run_in(&folder, "field a&plane(z,0.5) a=OUT/red.ply --resolution 24 -o OUT/half.ply").exits(0);
    let half = meshwright::io::read(folder.path().join("half.ply")).unwrap();
    let Some(Colours::Faces(colours)) = half.colours else { panic!("{:?}", half.colours) };
    let red = |t: usize| colours[t] == [255, 0, 0, 255];
    let on_top = |t: usize| half.mesh.corners(t).iter().all(|p| (p.z - 0.5).abs() < 1e-6);
    assert!((0..colours.len()).all(|t| red(t) != on_top(t)), "only the cut has no colour of its own");
}

#[test]
fn lattices_come_and_go_in_every_format() {
    let folder = folder();
    for format in ["vti", "nrrd", "vdb"] {
        let file = format!("OUT/f.{format}");
        run_in(&folder, &format!("field sphere(1) --voxel 0.1 --band 0.5 -o {file} --unit mm")).exits(0);
        let found = volume(&folder, &format!("field offset(a,0.2mm) a={file} --voxel 0.1 --unit mm -o OUT/o.ply"));
        let expected = 4.0 / 3.0 * std::f64::consts::PI * 1.2f64.powi(3);
        assert!((found / expected - 1.0).abs() < 0.02, "{format}: {found} instead of {expected}");
    }
    run_in(&folder, "field blob(sphere(1),0.5) --voxel 0.1 --band full -o OUT/full.npy").exits(0);
    let full = read_grid(folder.path().join("full.npy")).unwrap();
    let middle = full.at(glam::IVec3::from(full.dims.map(|n| n as i32 / 2))).unwrap();
    assert!((middle + 0.5).abs() < 1e-6, "the blob is 1 inside: {middle}");
}

#[test]
fn a_sequence_has_a_file_for_each_frame_and_ends_where_its_parts_are() {
    let folder = folder();
    let line = "field morph(sphere(1),box(1,1,1),t) --frames 3 --voxel 0.1 -o OUT/m.ply";
    run_in(&folder, line).exits(0).says(&["frame 2 of 3"]);
    assert_eq!(names_in(folder.path()), ["m_0.ply", "m_1.ply", "m_2.ply"]);
    let sizes = [0, 1, 2].map(|k| {
        let mesh = meshwright::io::read(folder.path().join(format!("m_{k}.ply"))).unwrap().mesh;
        mesh.bounds().unwrap().size().x
    });
    assert!((sizes[0] - 2.0).abs() < 0.01 && (sizes[2] - 1.0).abs() < 1e-5, "{sizes:?}");
    assert!(sizes[1] > sizes[2] && sizes[1] < sizes[0], "{sizes:?}");
}

#[test]
fn vertices_are_painted_by_a_second_expression() {
    let folder = folder();
    let line = "field box(4,1,1) --paint material(box(1,2,2,x=-3),box(1,2,2,x=3);0,1) --paint-range 0,1 --voxel 0.2 -o OUT/p.ply";
    run_in(&folder, line).exits(0).says(&["colours stand for values from 0 (violet) to 1 (yellow)"]);
    let read = meshwright::io::read(folder.path().join("p.ply")).unwrap();
    let Some(Colours::Vertices(colours)) = read.colours else { panic!("{:?}", read.colours) };
    for (p, colour) in read.mesh.positions.iter().zip(colours).filter(|(p, _)| p.x.abs() > 1.0) {
        assert_eq!(p.x < 0.0, colour[1] < 128, "violet on the left, yellow on the right: {p} {colour:?}");
    }
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let folder = folder();
    for (line, status, words) in [
        ("field ofset(a,1) a=testdata/torus.ply -o OUT/o.ply", 2, &["column 1", "ofset", "offset"][..]),
        ("field offset(b,1) a=testdata/torus.ply -o OUT/o.ply", 2, &["column 8", "`b`"]),
        ("field sphere(1) a=testdata/torus.ply -o OUT/o.ply", 2, &["does not use `a`"]),
        ("field sphere(1mm) -o OUT/o.ply", 2, &["column 8", "1mm"]),
        ("field offset(sphere(1),2h) -o OUT/o.ply", 2, &["2h", "--voxel"]),
        ("field morph(sphere(1),box(1,1,1),t) -o OUT/o.ply", 2, &["column 28", "--frames"]),
        ("field sphere(1) --frames 3 -o OUT/o.ply", 2, &["no `t`"]),
        ("field sphere(1) --paint sphere(2) -o OUT/o.vti", 2, &["--paint colours the vertices"]),
        ("field filter(sphere(1),0.1,0.2) --voxel 0.1 -o OUT/o.ply", 2, &["at most 0.08888", "at least 0.225"]),
        ("field -sphere(1) --voxel 0.1 -o OUT/o.ply", 4, &["has no end"]),
        ("field sphere(1)&sphere(1,x=5) --voxel 0.1 -o OUT/o.ply", 4, &["nothing is inside"]),
        ("field points(5) --voxel 0.1 -o OUT/o.ply", 4, &["points are scattered"]),
        ("field sphere(1) --voxel 0.001 --max-memory 1M -o OUT/o.ply", 5, &["--max-memory allows"]),
        ("field a a=testdata/missing.ply -o OUT/o.ply", 4, &["cannot read"]),
        ("field sphere(1) --voxel 0.1 -o OUT/o.xyz", 2, &["does not tell its format", ".vdb"]),
    ] {
        run_in(&folder, line).exits(status).says(words);
        assert_empty(&folder);
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = folder();
    let expression = "blend(filter(a,samples=16,least=8),blur(sphere(3,x=10),1),2)|texture(b,points(50),0.2)";
    for threads in [1, 3] {
        let line = format!(
            "field {expression} a=testdata/torus.ply b=testdata/broken_mug.obj --resolution 32 --threads {threads}"
        );
        run_in(&folder, &format!("{line} -o OUT/{threads}.ply")).exits(0);
        run_in(&folder, &format!("{line} -o OUT/{threads}.vdb")).exits(0);
    }
    for kind in ["ply", "vdb"] {
        let [one, three] =
            [1, 3].map(|threads| std::fs::read(folder.path().join(format!("{threads}.{kind}"))).unwrap());
        assert!(one == three, "{kind}");
    }
}

#[test]
fn the_ways_to_a_distance_agree_on_a_sound_mesh() {
    let folder = folder();
    let all = ["exact(a)", "robust(a)", "levels(a)", "a"];
    let volumes =
        all.map(|way| volume(&folder, &format!("field {way} a=testdata/torus.ply --resolution 64 -o OUT/o.ply")));
    for (way, found) in all.iter().zip(volumes) {
        assert!((found / volumes[3] - 1.0).abs() < 0.01, "{way}: {found} instead of {}", volumes[3]);
    }
}
