use glam::DVec3;

use super::*;
use crate::io::Colours;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

fn cube(low: DVec3) -> TriMesh {
    let corner = |i: u32| low + DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    let quads = [[0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// A cube without its side towards −y.
fn open_cube() -> TriMesh {
    let mut mesh = cube(DVec3::ZERO);
    mesh.triangles.drain(..2);
    mesh
}

fn plain(view: View) -> RenderOptions {
    let edges = EdgeDrawing::None;
    RenderOptions { width: 200, height: 150, view, edges, background: Background::Transparent, ..Default::default() }
}

fn drawn(mesh: &TriMesh, options: &RenderOptions) -> Image {
    render(mesh, options, &Progress::none()).unwrap()
}

fn count(image: &Image, which: impl Fn([u8; 4]) -> bool) -> usize {
    image.rgba.as_chunks::<4>().0.iter().filter(|&&p| which(p)).count()
}

fn is_rust([r, g, b, a]: [u8; 4]) -> bool {
    a > 0 && r / 2 > b && r / 2 > g
}

#[test]
fn a_cube_from_the_front_covers_its_square() {
    let image = drawn(&cube(DVec3::new(5.0, -3.0, 0.5)), &plain(View::FRONT));
    assert_eq!((image.width, image.height, image.rgba.len()), (200, 150, 200 * 150 * 4));
    let side = 150.0 * 0.92;
    let covered = count(&image, |p| p[3] == 255) as f64;
    assert!((covered / (side * side) - 1.0).abs() < 0.02, "{covered}");
    assert_eq!(image.pixel(0, 0), Some([0; 4]));
    assert_eq!(count(&image, is_rust), 0);
    let white = drawn(&cube(DVec3::ZERO), &RenderOptions { background: Background::White, ..plain(View::FRONT) });
    assert_eq!(white.pixel(0, 0), Some([255; 4]));
}

#[test]
fn front_sides_have_their_colours_back_sides_do_not() {
    let mesh = open_cube();
    let blue = Colours::Faces(vec![[20, 40, 230, 255]; mesh.triangles.len()]);
    let is_blue = |[r, g, b, a]: [u8; 4]| a > 0 && b / 2 > r && b / 2 > g;
    let of = |colours: Option<&Colours>, view| {
        count(
            &render(Painted { mesh: &mesh, colours, is_map: false }, &plain(view), &Progress::none()).unwrap(),
            is_blue,
        )
    };
    assert!(of(Some(&blue), View::BACK) > 15_000 && of(None, View::BACK) == 0);
    assert_eq!(of(Some(&blue), View::FRONT), 0, "only inner sides are seen");
    // From blue to red across one side: both are there, and neither covers half.
    let side = TriMesh { triangles: vec![[0, 1, 2]], positions: vec![DVec3::ZERO, DVec3::X, DVec3::Z] };
    let corners = Colours::Corners(vec![[[0, 0, 255, 255], [255, 0, 0, 255], [255, 0, 0, 255]]]);
    let seen =
        render(Painted { mesh: &side, colours: Some(&corners), is_map: false }, &plain(View::FRONT), &Progress::none())
            .unwrap();
    let (blue, red) = (count(&seen, is_blue), count(&seen, is_rust));
    assert!(blue > 100 && red > 1000, "{blue} blue, {red} red");
}

#[test]
fn back_sides_show_through_a_missing_face() {
    let options = plain(View::FRONT);
    let seen = drawn(&open_cube(), &options);
    assert!(count(&seen, is_rust) > 15_000, "{}", count(&seen, is_rust));
    assert_eq!(count(&drawn(&open_cube(), &plain(View::BACK)), is_rust), 0);
}

#[test]
fn defects_are_coloured_only_when_asked_for() {
    let red = |[r, g, b, _]: [u8; 4]| r > 200 && g < 40 && b < 60;
    let magenta = |[r, g, b, _]: [u8; 4]| r > 200 && g < 40 && b > 180;
    let yellow = |[r, g, b, _]: [u8; 4]| r > 150 && g > 80 && b < 60;
    let (without, with) = (plain(View::ISO), RenderOptions { defects: true, ..plain(View::ISO) });

    assert!(count(&drawn(&open_cube(), &with), red) > 100);
    assert_eq!(count(&drawn(&open_cube(), &without), red), 0);

    let mut crossed = cube(DVec3::ZERO);
    crossed.append(&cube(DVec3::splat(0.5)));
    assert!(count(&drawn(&crossed, &with), yellow) > 1000);
    assert_eq!(count(&drawn(&crossed, &without), yellow), 0);
    let blue = |[r, g, b, _]: [u8; 4]| b > 150 && r < 60 && g < 90;
    assert_eq!(count(&drawn(&crossed, &without), blue), 0);

    let mut joined = cube(DVec3::ZERO);
    joined.append(&cube(DVec3::new(1.0, 0.0, -1.0)));
    assert!(count(&drawn(&joined, &with), magenta) > 20);
    assert_eq!(count(&drawn(&joined, &without), magenta), 0);
}

#[test]
fn lines_along_which_triangles_cross_are_drawn_where_they_are_seen() {
    let blue = |[r, g, b, _]: [u8; 4]| b > 150 && r < 60 && g < 90;
    let with = |view| RenderOptions { defects: true, ..plain(view) };
    // A smaller cube that looks out of the lower one's top: two sides of the square where they cross are seen at its foot.
    let mut crossed = cube(DVec3::ZERO);
    let mut small = cube(DVec3::ZERO);
    small.positions.iter_mut().for_each(|p| *p = *p / 2.0 + DVec3::new(0.25, 0.25, 0.75));
    crossed.append(&small);
    let seen = count(&drawn(&crossed, &with(View::ISO)), blue);
    assert!((50..300).contains(&seen), "{seen}");
    // From below the lower cube hides it, and what crosses nothing has none.
    assert_eq!(count(&drawn(&crossed, &with(View::BOTTOM)), blue), 0);
    assert_eq!(count(&drawn(&cube(DVec3::ZERO), &with(View::ISO)), blue), 0);
}

#[test]
fn edges_are_drawn_where_they_are_seen() {
    let with = |view, edges| drawn(&cube(DVec3::ZERO), &RenderOptions { edges, ..plain(view) });
    let (none, sharp, all) =
        (with(View::ISO, EdgeDrawing::None), with(View::ISO, EdgeDrawing::Sharp), with(View::ISO, EdgeDrawing::All));
    let changed = |a: &Image, b: &Image| {
        let pairs = a.rgba.as_chunks::<4>().0.iter().zip(b.rgba.as_chunks::<4>().0);
        pairs.filter(|(a, b)| a[0].abs_diff(b[0]) > 15 || a[3].abs_diff(b[3]) > 15).count()
    };
    // Nine of the twelve edges are seen, 50 to 80 pixels long, and one diagonal on each of three faces.
    let (outlines, diagonals) = (changed(&none, &sharp), changed(&sharp, &all));
    assert!((600..1500).contains(&outlines), "{outlines}");
    assert!((100..500).contains(&diagonals), "{diagonals}");
    // Straight on, only the outline is sharp, and nothing of the far side shows.
    let (bare, front) = (with(View::FRONT, EdgeDrawing::None), with(View::FRONT, EdgeDrawing::Sharp));
    let inner = |image: &Image| -> Vec<_> { (40..160).map(|x| image.pixel(x, x - 25)).collect() };
    assert_eq!(inner(&front), inner(&bare));
    assert_ne!(front, bare);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut mesh = cube(DVec3::ZERO);
    mesh.append(&cube(DVec3::new(0.6, 0.3, 0.2)));
    mesh.append(&open_cube());
    let options = RenderOptions { defects: true, edges: EdgeDrawing::All, ..plain(View::ISO) };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| drawn(&mesh, &options))
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}

#[test]
fn the_size_of_the_coordinates_does_not_matter() {
    let options = plain(View::ISO);
    let expected = drawn(&cube(DVec3::ZERO), &options);
    for exponent in [-500, -126, 127, 500] {
        let mut mesh = cube(DVec3::ZERO);
        mesh.positions.iter_mut().for_each(|p| *p *= 2f64.powi(exponent));
        assert_eq!(drawn(&mesh, &options), expected, "{exponent}");
    }
}

#[test]
fn hollows_are_darker_and_convex_bodies_as_light_as_ever() {
    let brightness = |mesh: &TriMesh, occlusion, x, y| {
        let image = drawn(mesh, &RenderOptions { occlusion, ..plain(View::TOP) });
        image.pixel(x, y).map(|p| p[..3].iter().map(|&c| u32::from(c)).sum::<u32>()).unwrap()
    };
    // Seen from above into a box without a lid, near a wall.
    let mut open = cube(DVec3::ZERO);
    open.triangles.drain(4..6);
    open.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let (dim, bright) = (brightness(&open, true, 36, 75), brightness(&open, false, 36, 75));
    assert!(dim + 20 < bright, "{dim} {bright}");
    let closed = cube(DVec3::ZERO);
    assert_eq!(brightness(&closed, true, 100, 75), brightness(&closed, false, 100, 75));
}

#[test]
fn closed_surfaces_have_no_pinholes() {
    // A lattice that falls on sample positions in x and y, turned and not.
    let mut mesh = TriMesh::default();
    for k in 0..4 {
        mesh.append(&cube(DVec3::new(f64::from(k), f64::from(k % 2), 0.0)));
    }
    for view in [View::ISO, View::TOP, View::ISO.y_up(), View { from: DVec3::new(1.0, 2.0, 3.0), up: DVec3::X }] {
        let image = drawn(&mesh, &RenderOptions { occlusion: false, ..plain(view) });
        assert_eq!(count(&image, is_rust), 0);
    }
    let image = drawn(&cube(DVec3::ZERO), &plain(View::TOP));
    let row = |y: u32| (0..200).filter(|&x| image.pixel(x, y).is_some_and(|p| p[3] == 255)).count();
    assert!((20..130).all(|y| row(y) == row(75)));
}

#[test]
fn pairs_are_seen_by_one_camera() {
    let mut before = cube(DVec3::ZERO);
    before.append(&cube(DVec3::new(3.0, 0.0, 0.0)));
    let after = cube(DVec3::ZERO);
    let options = RenderOptions { occlusion: false, ..plain(View::FRONT) };
    let [a, b] = render_pair(&before, &after, &options, &Progress::none()).unwrap();
    let left_half = |i: &Image| -> Vec<_> {
        (0..150).flat_map(|y| (0..100).map(move |x| (x, y))).map(|(x, y)| i.pixel(x, y)).collect()
    };
    assert_eq!(left_half(&a), left_half(&b));
    assert!(count(&b, |p| p[3] > 0) * 2 <= count(&a, |p| p[3] > 0) + 20);
    let [a, empty] = render_pair(&before, &TriMesh::default(), &options, &Progress::none()).unwrap();
    assert!(count(&a, |p| p[3] > 0) > 0 && count(&empty, |p| p[3] > 0) == 0);
}

#[test]
fn sheets_hold_the_images_in_rows() {
    let image =
        |width, height, colour: [u8; 4]| Image { width, height, rgba: colour.repeat((width * height) as usize) };
    let two = [image(100, 60, [9; 4]), image(50, 20, [7; 4])];
    let sheet = Image::sheet(&two, 2);
    assert_eq!((sheet.width, sheet.height), (152, 60));
    let at = |x, y| sheet.pixel(x, y).unwrap()[0];
    // Whatever the images have at their edges, the gap is white.
    assert_eq!(
        [at(0, 0), at(99, 59), at(100, 30), at(102, 19), at(102, 20), at(151, 39), at(151, 40)],
        [9, 9, 255, 255, 7, 7, 255]
    );
    assert_eq!(sheet.pixel(152, 0), None);
    let below = Image::sheet(&two, 1);
    assert_eq!((below.width, below.height), (100, 82));
    let at = |x, y| below.pixel(x, y).unwrap()[0];
    assert_eq!([at(0, 59), at(0, 60), at(24, 62), at(25, 62), at(74, 81), at(75, 81)], [9, 255, 255, 7, 7, 255]);
    let four = Image::sheet(&[two[0].clone(), two[0].clone(), two[0].clone()], 2);
    assert_eq!((four.width, four.height), (202, 122));
    let clear = Image::sheet(&[image(10, 10, [0; 4]), image(10, 10, [7; 4])], 2);
    assert_eq!(clear.pixel(10, 5), Some([0; 4]));
    let nothing = Image::sheet(&[], 2);
    assert_eq!((nothing.width, nothing.height), (0, 0));
    assert!(nothing.to_png().is_err());
}

#[test]
fn png_files_decode_to_the_same_pixels() {
    let image = drawn(&cube(DVec3::ZERO), &plain(View::ISO));
    let file = image.to_png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgba).unwrap();
    assert_eq!(Image { width: info.width, height: info.height, rgba }, image);
}

#[test]
fn animations_hold_their_frames() {
    let mesh = cube(DVec3::ZERO);
    let options = RenderOptions { width: 60, height: 50, ..RenderOptions::default() };
    let subject = Subject::new(&mesh, false, &Progress::none()).unwrap();
    let frames = turntable(&subject, 8, &options, None, &Progress::none()).unwrap();
    // A cube looks the same after a quarter of a turn, and not before.
    assert!(frames.len() == 8 && frames[0] != frames[1]);
    let differ = |a: &Image, b: &Image| a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a.abs_diff(**b) > 12).count();
    assert!(differ(&frames[0], &frames[2]) < 200 && differ(&frames[0], &frames[1]) > 1000);
    let file = to_animated_png(&frames, 20).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    assert_eq!(reader.info().animation_control().map(|control| control.num_frames), Some(8));
    for frame in &frames {
        let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut rgba).unwrap();
        assert!(rgba == frame.rgba);
    }
    assert!(to_animated_png(&[], 20).is_err());
    assert!(to_animated_png(&[frames[0].clone(), Image::sheet(&frames, 4)], 20).is_err());
}

#[test]
fn jpeg_files_begin_and_end_as_they_should() {
    let image = drawn(&cube(DVec3::ZERO), &plain(View::ISO));
    let file = image.to_jpeg().unwrap();
    assert!(file.starts_with(&[0xff, 0xd8, 0xff]) && file.ends_with(&[0xff, 0xd9]));
    assert!(Image { width: 0, height: 0, rgba: Vec::new() }.to_jpeg().is_err());
}

#[test]
fn perspective_shrinks_what_is_far() {
    // Straight on, the far side of a cube lies within the near one; in parallel projection the two are one.
    let mut mesh = cube(DVec3::ZERO);
    mesh.triangles.drain(..2);
    let far = Colours::Faces(vec![[20, 40, 230, 255]; mesh.triangles.len()]);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let painted = Painted { mesh: &mesh, colours: Some(&far), is_map: false };
    let width = |projection| {
        let options = RenderOptions { projection, occlusion: false, ..plain(View::FRONT) };
        let image = render(painted, &options, &Progress::none()).unwrap();
        let lit: Vec<u8> = (0..200).filter_map(|x| image.pixel(x, 75)).filter(|p| p[3] > 0).map(|p| p[2]).collect();
        let middle = lit[lit.len() / 2];
        (lit.len(), lit.iter().filter(|&&b| b == middle).count())
    };
    let (all, back) = width(Projection::Orthographic);
    assert!(back + 4 > all, "{back} of {all}");
    let (all, back) = width(Projection::Perspective);
    // The near side is 3.2 x 1.73 / 2 - 0.5 from the eye, the far one longer by the side.
    let near = 3.2 * 3f64.sqrt() / 2.0 - 0.5;
    let expected = near / (near + 1.0);
    assert!((back as f64 / all as f64 - expected).abs() < 0.03, "{back} of {all}, not {expected}");
}

#[test]
fn cuts_show_the_inside_of_closed_meshes_hatched() {
    let sand = |[r, g, b, a]: [u8; 4]| a > 0 && r > g && g > b && r - b > 25 && u32::from(g) * 4 > u32::from(r) * 3;
    let clip = |at| Some(Clip { axis: Axis::Z, at });
    let options = RenderOptions { clip: clip(0.5), occlusion: false, ..plain(View::TOP) };
    let cut = drawn(&cube(DVec3::ZERO), &options);
    let all = count(&cut, |p| p[3] == 255) as f64;
    assert!(count(&cut, sand) as f64 > 0.97 * all && all > 15_000.0, "{} of {all}", count(&cut, sand));
    assert_eq!(count(&cut, is_rust), 0);
    // Hollow, the hollow is not hatched: it has a quarter of the area.
    let mut hollow = cube(DVec3::ZERO);
    let mut inner = cube(DVec3::ZERO);
    inner.positions.iter_mut().for_each(|p| *p = *p / 2.0 + 0.25);
    inner.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    hollow.append(&inner);
    let share = count(&drawn(&hollow, &options), sand) as f64 / all;
    assert!((share - 0.75).abs() < 0.02, "{share}");
    // An open mesh has no inside: what is seen are its inner sides.
    let open = drawn(&open_cube(), &options);
    assert!(count(&open, sand) == 0 && count(&open, is_rust) > 10_000);
    // A plane beyond the mesh takes nothing, or all.
    let whole = RenderOptions { clip: None, ..options.clone() };
    assert_eq!(
        drawn(&cube(DVec3::ZERO), &RenderOptions { clip: clip(2.0), ..options.clone() }),
        drawn(&cube(DVec3::ZERO), &whole)
    );
    assert_eq!(
        count(&drawn(&cube(DVec3::ZERO), &RenderOptions { clip: clip(-1.0), ..options.clone() }), |p| p[3] > 0),
        0
    );
    // In perspective the same plane cuts the same mesh.
    let far = RenderOptions { projection: Projection::Perspective, ..options };
    assert!(count(&drawn(&cube(DVec3::ZERO), &far), sand) > 5_000);
}

#[test]
fn clear_surfaces_let_what_is_behind_them_through() {
    let mut mesh = cube(DVec3::ZERO);
    let mut inner = cube(DVec3::ZERO);
    inner.positions.iter_mut().for_each(|p| *p = *p / 2.0 + 0.25);
    mesh.append(&inner);
    let options = |opacity| RenderOptions { opacity, ..plain(View::FRONT) };
    let at = |opacity, x| drawn(&mesh, &options(opacity)).pixel(x, 75).unwrap();
    // Opaque, the inner cube is hidden; clear, there is more to see through in the middle.
    assert_eq!(at(1.0, 60), at(1.0, 100));
    let (edge, middle) = (at(0.3, 60), at(0.3, 100));
    let expected = |surfaces: i32| 255.0 * (1.0 - 0.7f64.powi(surfaces));
    assert!((f64::from(edge[3]) - expected(2)).abs() < 2.0, "{edge:?}");
    assert!((f64::from(middle[3]) - expected(4)).abs() < 2.0, "{middle:?}");
    assert_eq!(count(&drawn(&mesh, &options(0.3)), is_rust), 0);
}

#[test]
fn white_parts_stand_out_from_the_background() {
    let mesh = cube(DVec3::ZERO);
    let white = Colours::Faces(vec![[255; 4]; mesh.triangles.len()]);
    let painted = Painted { mesh: &mesh, colours: Some(&white), is_map: false };
    let options = RenderOptions { background: Background::Gradient, edges: EdgeDrawing::Sharp, ..plain(View::ISO) };
    let image = render(painted, &options, &Progress::none()).unwrap();
    let clear =
        render(painted, &RenderOptions { background: Background::Transparent, ..options }, &Progress::none()).unwrap();
    let pixels = image.rgba.as_chunks::<4>().0.iter().zip(clear.rgba.as_chunks::<4>().0);
    let (mut behind, mut lit) = (Vec::new(), Vec::new());
    for (pixel, clear) in pixels {
        match clear[3] {
            0 => behind.push(pixel[0]),
            255 => lit.push(pixel[0]),
            _ => {}
        }
    }
    assert!(behind.iter().all(|&b| (200..240).contains(&b)));
    // Nothing is burnt out, and the brightest side is lighter than what is behind.
    assert!(lit.iter().all(|&b| b < 253) && lit.iter().filter(|&&b| b > 240).count() > 1000);
    // The outline: dark all around.
    assert!(lit.iter().filter(|&&b| b < 110).count() > 200);
}

#[test]
fn captions_stand_around_the_mesh() {
    let mesh = open_cube();
    let subject = Subject::new(&mesh, true, &Progress::none()).unwrap();
    assert_eq!((subject.defects().open_edges, subject.defects().shows_inside), (4, true));
    let options = RenderOptions {
        width: 480,
        height: 360,
        defects: true,
        background: Background::White,
        ..RenderOptions::default()
    };
    let caption = Caption {
        title: "A box without a side".into(),
        legend: defect_legend(&subject.defects()),
        scale: Some(crate::io::ColourScale {
            title: "mm".into(),
            low: -1.0,
            high: 1.0,
            stops: vec![[0, 0, 255], [0, 255, 0]],
            histogram: vec![1, 2],
        }),
        unit: "mm".into(),
    };
    let draw = |captions: &[Caption]| {
        render_views(std::slice::from_ref(&subject), &[View::ISO], &options, captions, &Progress::none())
            .unwrap()
            .remove(0)
    };
    let (with, bare) = (draw(&[caption]), draw(&[]));
    let inked = |image: &Image, xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
        ys.flat_map(|y| xs.clone().map(move |x| (x, y)))
            .filter(|&(x, y)| image.pixel(x, y).is_some_and(|p| p[..3] != [255; 3]))
            .count()
    };
    // Above, below, to the right.
    for (xs, ys, least) in [(0..240, 0..20, 150), (0..200, 315..360, 200), (380..480, 20..315, 2000)] {
        let found = inked(&with, xs.clone(), ys.clone());
        assert!(found > least, "{xs:?} {ys:?}: {found}");
    }
    assert_eq!(inked(&bare, 0..240, 0..10), 0);
    // Too small a picture has none.
    let small = RenderOptions { width: 100, height: 90, ..options };
    let of = |captions: &[Caption]| {
        render_views(std::slice::from_ref(&subject), &[View::ISO], &small, captions, &Progress::none()).unwrap()
    };
    assert_eq!(of(&[Caption { title: "x".into(), ..Caption::default() }]), of(&[]));
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let mesh = cube(DVec3::ZERO);
    let error = |mesh: &TriMesh, options: &RenderOptions| render(mesh, options, &Progress::none()).unwrap_err();
    assert_eq!(error(&TriMesh::default(), &plain(View::ISO)), RenderError::Empty);
    for (width, height, supersampling) in [(0, 5, 1), (5, 20_000, 1), (5, 5, 0), (5, 5, 9), (16_384, 16_384, 1)] {
        let options = RenderOptions { width, height, supersampling, ..plain(View::ISO) };
        assert_eq!(error(&mesh, &options), RenderError::Size { width, height, supersampling });
    }
    let late = Progress::none().with_deadline(std::time::Instant::now());
    let stopped = render(&mesh, &plain(View::ISO), &late);
    assert_eq!(stopped, Err(RenderError::Stopped(Stopped::Deadline)));
}

#[test]
fn odd_meshes_and_views_are_drawn_without_panic() {
    let point = TriMesh { positions: vec![DVec3::ONE; 3], triangles: vec![[0, 1, 2], [0, 0, 0]] };
    let line = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], triangles: vec![[0, 1, 2]] };
    let same = TriMesh { positions: cube(DVec3::ZERO).positions, triangles: vec![[0, 1, 7]; 5000] };
    let mut wide = cube(DVec3::ZERO);
    wide.positions[3] = DVec3::new(1e308, -1e308, 1e308);
    let views = [View::ISO, View { from: DVec3::ZERO, up: DVec3::ZERO }, View { from: DVec3::X, up: DVec3::X }];
    for mesh in [point, line, same, wide] {
        for view in views {
            let options = RenderOptions { defects: true, edges: EdgeDrawing::All, ..plain(view) };
            assert_eq!(drawn(&mesh, &options).rgba.len(), 120_000);
        }
    }
}

#[test]
fn views_are_known_by_name() {
    assert!(View::NAMES.iter().all(|name| View::named(name).is_some()));
    assert_eq!(View::named("front"), Some(View::FRONT));
    assert_eq!(View::named("inside"), None);
    assert_eq!(View::FRONT.y_up(), View { from: DVec3::Z, up: DVec3::Y });
}
