use super::*;

fn square(axis: Axis) -> SlicePlane {
    SlicePlane { axis, at: 0.25, min: DVec2::splat(-1.0), max: DVec2::splat(1.0), y_up: false }
}

fn drawn(field: impl Fn(DVec3) -> f64 + Sync, axis: Axis, size: [u32; 2]) -> Image {
    slice(field, &square(axis), size, &Progress::none()).expect("it can be drawn")
}

fn darkness(image: &Image, x: u32, y: u32) -> f64 {
    let pixel = image.pixel(x, y).expect("a pixel");
    1.0 - f64::from(pixel[..3].iter().map(|&c| u32::from(c)).sum::<u32>()) / 765.0
}

#[test]
fn the_plane_is_the_one_that_was_asked_for() {
    for (axis, right, up) in [(Axis::X, 1, 2), (Axis::Y, 0, 2), (Axis::Z, 0, 1)] {
        let seen = |k: usize| {
            let size = [100, 80];
            let samples = sample_slice(|p| p[k], &square(axis), size, &Progress::none()).expect("values");
            samples.range().expect("values")
        };
        let [low, high] = seen(right);
        assert!((low + 1.2375).abs() < 1e-6 && (high - 1.2375).abs() < 1e-6, "{axis:?}: {low} {high}");
        let [low, high] = seen(up);
        assert!((low + 0.9875).abs() < 1e-6 && (high - 0.9875).abs() < 1e-6, "{axis:?}: {low} {high}");
        assert_eq!(seen(axis.number()), [0.25; 2]);
    }
    // Up is up.
    let image = drawn(|p| p.y, Axis::Z, [60, 60]);
    let [top, bottom] = [3, 56].map(|y| image.pixel(30, y).expect("a pixel"));
    assert!(top[0] > top[2] && bottom[2] > bottom[0], "{top:?} {bottom:?}");
}

#[test]
fn the_line_of_zero_is_bold_smooth_and_in_its_place() {
    for place in [-0.31, -0.302, 0.0, 0.123_4] {
        // A steep field and a shallow one have the same line.
        for steep in [1.0, 20.0] {
            let image = drawn(|p| steep * (p.x - place + 0.1 * p.y), Axis::Z, [200, 200]);
            for y in [40, 100, 171] {
                let dark: Vec<f64> = (0..200).map(|x| (darkness(&image, x, y) - 0.67).max(0.0)).collect();
                let total: f64 = dark.iter().sum();
                let middle = (0..200).map(|x| (x as f64 + 0.5) * dark[x]).sum::<f64>() / total;
                let expected = 100.0 * (1.0 + place - 0.1 * (99.5 - f64::from(y)) / 100.0);
                assert!(total > 0.2 && (middle - expected).abs() < 0.25, "{place} {y}: {middle} not {expected}");
            }
        }
    }
}

#[test]
fn lines_are_at_even_steps_and_flat_places_have_none() {
    let samples = sample_slice(|p| p.x, &square(Axis::Z), [200, 40], &Progress::none()).expect("values");
    let draw = |step: f64| samples.draw(&SliceColours { full: 5.0, step }, &SliceCaption::default());
    // A step as long as this leaves the line of zero alone.
    let plain = draw(100.0);
    let lines = |step: f64| {
        let image = draw(step);
        let dark: Vec<bool> = (0..200).map(|x| darkness(&image, x, 20) > darkness(&plain, x, 20) + 0.02).collect();
        dark.windows(2).filter(|pair| !pair[0] && pair[1]).count()
    };
    // From -5 to 5, which itself may be half a pixel outside.
    let (coarse, fine) = (lines(1.0), lines(0.5));
    assert!((8..=10).contains(&coarse) && (18..=20).contains(&fine), "{coarse} {fine}");
    let flat = sample_slice(|_| 2.0, &square(Axis::Z), [60, 60], &Progress::none()).expect("values");
    let image = flat.draw(&SliceColours { full: 4.0, step: 1.0 }, &SliceCaption::default());
    assert!(image.rgba.chunks(4).all(|pixel| pixel == &image.rgba[..4]));
}

#[test]
fn round_steps() {
    for (farthest, step) in [(1.0, 0.2), (0.8, 0.1), (7.9, 1.0), (8.1, 2.0), (4e-5, 5e-6), (3.0e9, 5e8)] {
        let got = SliceColours::up_to(farthest).step;
        assert!((got / step - 1.0).abs() < 1e-9, "{farthest}: {got}");
    }
    assert_eq!(SliceColours::up_to(f64::NAN).full, 1.0);
}

#[test]
fn where_there_is_no_value_is_grey() {
    let image = drawn(|p| if p.x < 0.0 { f64::NAN } else { p.x - 0.5 }, Axis::Z, [100, 100]);
    let [r, g, b] = NOTHING.to_srgb();
    let grey = |x: u32| (0..100).all(|y| image.pixel(x, y) == Some([r, g, b, 255]));
    assert!((0..50).all(grey) && (50..100).all(|x| !grey(x)));
    let empty = sample_slice(|_| f64::NAN, &square(Axis::X), [300, 100], &Progress::none()).expect("a picture");
    assert_eq!((empty.range(), empty.farthest()), (None, 0.0));
}

#[test]
fn beyond_a_band_only_the_side_is_told() {
    let image = drawn(|p| p.x.clamp(-0.5, 0.5), Axis::Z, [100, 100]);
    let side = |inside: bool| {
        let [r, g, b] = BEYOND[usize::from(!inside)].to_srgb();
        (0..100).filter(|&x| (0..100).all(|y| image.pixel(x, y) == Some([r, g, b, 255]))).collect::<Vec<u32>>()
    };
    let (inside, outside) = (side(true), side(false));
    assert!((23..=26).contains(&inside.len()) && inside.iter().all(|&x| x < 26), "{inside:?}");
    assert!((23..=26).contains(&outside.len()) && outside.iter().all(|&x| x > 73), "{outside:?}");
}

#[test]
fn where_y_points_up_the_picture_turns_with_it() {
    for (axis, right, up) in
        [(Axis::X, -DVec3::Z, DVec3::Y), (Axis::Y, DVec3::X, -DVec3::Z), (Axis::Z, DVec3::X, DVec3::Y)]
    {
        let plane = SlicePlane { y_up: true, ..square(axis) };
        let middle = plane.position(DVec2::splat(0.5));
        assert_eq!(plane.position(DVec2::new(1.0, 0.5)) - middle, right, "{axis:?}");
        assert_eq!(plane.position(DVec2::new(0.5, 1.0)) - middle, up, "{axis:?}");
    }
}

#[test]
fn the_bar_and_the_axes_have_their_values() {
    let image = drawn(|p| p.x, Axis::Z, [600, 400]);
    let layout = Layout::of([600, 400].into());
    assert_eq!((Layout::of([200, 400].into()).plot, Layout::of([200, 400].into()).corner), ([200, 400], [0, 0]));
    assert_eq!(Layout::of(SliceSize { pixels: [600, 400], plain: true }).plot, [600, 400]);
    let [right, bottom] = [0, 1].map(|k| layout.corner[k] + layout.plot[k]);
    assert!(right < 560 && bottom < 390);
    let strip = |y: u32| image.pixel(right + 14, y).expect("a pixel");
    let [top, low] = [strip(layout.corner[1] + 8), strip(bottom - 8)];
    assert!(top[0] > top[2] && low[2] > low[0], "{top:?} {low:?}");
    let dark = |xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
        xs.flat_map(|x| ys.clone().map(move |y| (x, y)))
            .filter(|&(x, y)| image.pixel(x, y).is_some_and(|p| p[0] < 90))
            .count()
    };
    for (xs, ys) in [(right + 24..600, 0..bottom), (0..layout.corner[0], 0..bottom), (0..right, bottom..400)] {
        let found = dark(xs.clone(), ys.clone());
        assert!((40..4000).contains(&found), "{xs:?} {ys:?}: {found}");
    }
}

#[test]
fn threads_change_nothing_and_sizes_are_checked() {
    let field = |p: DVec3| p.length() - 0.7;
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| drawn(field, Axis::Y, [300, 170]))
    };
    assert_eq!(run(1), run(3));
    let error = slice(field, &square(Axis::X), [0, 5], &Progress::none()).unwrap_err();
    assert_eq!(error, RenderError::Size { width: 0, height: 5, supersampling: 1 });
    let late = Progress::none().with_deadline(std::time::Instant::now());
    let stopped = slice(field, &square(Axis::X), [50, 50], &late).unwrap_err();
    assert!(matches!(stopped, RenderError::Stopped(_)));
}
