//! The table of functions. To add one is to add its row here: the text is checked, the help is printed and the field is
//! made from what the row says.

use glam::DVec3;

use super::build::{
    aligned, blobs, blur, body, coarse, filter, half_space, middle, morphed_by_radii, moved, pair, ramp,
    scattered_points, smoothing,
};
use super::table::{Axis, Kind, List, Parameter, Presence, Preset, Reading};
use super::tree::{Build, Function, Gives, Join};
use crate::field::blend::{blend_difference, blend_intersection, blend_union};
use crate::field::filter::smooth;
use crate::field::{Placement, Solid, algebra, blob, material};
use crate::ldi::Expression;

/// All functions, in the order of the help.
pub static FUNCTIONS: &[&Function] = &[
    &COMPLEMENT,
    &UNION,
    &INTERSECTION,
    &DIFFERENCE,
    &SYMMETRIC_DIFFERENCE,
    &of("offset", &["a"], "a grown by a length, or shrunk where the length is negative", |call, fields, _| {
        Ok(algebra::offset(fields[0].clone(), call.length_or_zero("by")))
    })
    .with(&[required("by", Kind::SignedLength)]),
    &of("shell", &["a"], "what is within half of the thickness of the surface", |call, fields, _| {
        Ok(algebra::shell(fields[0].clone(), call.length_or_zero("thickness")))
    })
    .with(&[required("thickness", Kind::Length)]),
    &of("blend", &["a", "b"], "the union, rounded where the surfaces meet", |call, fields, _| {
        let [a, b] = pair(fields);
        Ok(blend_union(a, b, call.length_or_zero("radius")))
    })
    .with(RADIUS),
    &of(
        "blend_intersection",
        &["a", "b"],
        "the intersection, rounded where the surfaces meet",
        |call, fields, _| {
            let [a, b] = pair(fields);
            Ok(blend_intersection(a, b, call.length_or_zero("radius")))
        },
    )
    .with(RADIUS),
    &of("blend_difference", &["a", "b"], "a without b, rounded where the surfaces meet", |call, fields, _| {
        let [a, b] = pair(fields);
        Ok(blend_difference(a, b, call.length_or_zero("radius")))
    })
    .with(RADIUS),
    &of_many("average", "the mean shape, by weight if weights are given", |call, fields, _| {
        Ok(algebra::average(fields.to_vec(), &call.list))
    })
    .listed(List::Weights),
    &of("morph", &["a", "b"], "the shape on the way from a (t = 0) to b (t = 1)", |call, fields, _| {
        let [a, b] = pair(fields);
        Ok(algebra::morph(a, b, call.number("t").unwrap_or_default()))
    })
    .with(&[required("t", SHARE)]),
    &of(
        "morph_radii",
        &["a", "b"],
        "the shape on the way from a to b, with each shape weighted by its radius, so that a small one does not vanish early",
        |call, fields, _| morphed_by_radii(pair(fields), call.number("t").unwrap_or_default()),
    )
    .with(&[required("t", SHARE)]),
    &of(
        "ramp",
        &["a", "b"],
        "a at one end of an axis, b at the other end, and in between the shapes on the way from one to the other",
        |call, fields, _| ramp(call, pair(fields)),
    )
    .with(&[
        required("axis", Kind::Axis),
        default("from", Kind::Place, Preset::Quantity(0.0, "%")),
        default("to", Kind::Place, Preset::Quantity(100.0, "%")),
    ]),
    &of("texture", &["a", "b"], "a, with its surface moved in and out by the field b", |call, fields, _| {
        let [a, b] = pair(fields);
        Ok(algebra::morph(a, b, call.number("amount").unwrap_or_default()))
    })
    .with(&[required("amount", SHARE)]),
    &of_many(
        "material",
        "no shape, but a value for each shape, which passes smoothly from one to the other between them",
        |call, fields, _| Ok(material(fields.to_vec(), call.list.clone())),
    )
    .listed(List::Values)
    .measuring(),
    &of(
        "filter",
        &["a"],
        "the surface of a, with a field that is smooth away from it; width is that of the bump kernel, by default 8/9 of cap; sigma takes a Gaussian kernel instead; least is the fewest samples where few are enough; cells is how many cells along cap distances to meshes are interpolated in, and with 0 each is asked for",
        |call, fields, site| filter(call, &fields[0], site.max_memory),
    )
    .with(&[
        default("cap", Kind::Length, Preset::Quantity(5.0, "%")),
        optional("width", Kind::Length),
        Parameter { name: "sigma", kind: Kind::Length, presence: Presence::InsteadOf("width") },
        SAMPLES,
        optional("least", Kind::Count(2, 65_536)),
        default("cells", Kind::Count(0, 1024), Preset::Quantity(24.0, "")),
    ]),
    &of(
        "smooth",
        &["a", "volume"],
        "a, smoothed inside the volume: by radius from depth on, and by less nearer to the volume's surface",
        |call, fields, _| {
            let [a, volume] = pair(fields);
            Ok(smooth(a, volume, &smoothing(call)))
        },
    )
    .with(&[required("depth", Kind::Length), required("radius", Kind::Length), SAMPLES]),
    &of("blur", &["a"], "the field convolved with a Gaussian", |call, fields, site| {
        blur(&fields[0], call.length_or_zero("sigma"), site)
    })
    .with(&[required("sigma", Kind::Length)]),
    &of("coarse", &["a"], "the field sampled with larger voxels", |call, fields, site| {
        coarse(&fields[0], call.length_or_zero("voxel"), site)
    })
    .with(&[required("voxel", Kind::Length)]),
    &of(
        "blob",
        &["a"],
        "the blobby field of a: 0 on the surface, and farther away than radius it stays at minus or plus radius",
        |call, fields, _| Ok(blob::blob(fields[0].clone(), blobs(call))),
    )
    .with(BLOB),
    &of("blob_union", &["a", "b"], "the sum of blobby fields", |call, fields, _| {
        Ok(blob::blob_union(fields.to_vec(), blobs(call)))
    })
    .with(BLOB),
    &of("blob_intersection", &["a", "b"], "the product of blobby fields", |call, fields, _| {
        Ok(blob::blob_intersection(fields.to_vec(), blobs(call)))
    })
    .with(BLOB),
    &of("blob_difference", &["a", "b"], "the blobby field of a, from which that of b takes a bite", |call, fields, _| {
        let [a, b] = pair(fields);
        Ok(blob::blob_difference(a, vec![b], blobs(call)))
    })
    .with(BLOB),
    &of(
        "compare",
        &["a", "b"],
        "no shape, but how much more of a is there than of b, from -1 to 1",
        |call, fields, _| {
            let [a, b] = pair(fields);
            Ok(blob::compare(a, b, blobs(call)))
        },
    )
    .with(BLOB)
    .measuring(),
    &of("move", &["a"], "a moved by x, y and z", |call, fields, _| {
        let by = ["x", "y", "z"].map(|name| call.length_or_zero(name));
        Ok(moved(&fields[0], Placement::moved(DVec3::from_array(by))))
    })
    .with(&[CENTRE[0], CENTRE[1], CENTRE[2]]),
    &of("scale", &["a"], "a made larger or smaller about the middle of its box", |call, fields, _| {
        let factor = call.number("factor").unwrap_or(1.0);
        Ok(moved(&fields[0], Placement::scaled(factor, middle(&fields[0])?)))
    })
    .with(&[required("factor", Kind::Number(1e-6, 1e6))]),
    &of(
        "turn",
        &["a"],
        "a turned about an axis through the middle of its box, counterclockwise seen against the axis",
        |call, fields, _| {
            let angle = call.number("degrees").unwrap_or_default().to_radians();
            Ok(moved(&fields[0], Placement::turned(call.axis_or_z("axis"), angle, middle(&fields[0])?)))
        },
    )
    .with(&[required("axis", Kind::Axis), required("degrees", Kind::Number(-360.0, 360.0))]),
    &of(
        "align",
        &["a", "b"],
        "a moved and scaled, so that its box has the middle and the longest side of the box of b",
        |_, fields, _| aligned(pair(fields)),
    ),
    &of(
        "points",
        &[],
        "the distance to random points in the box around the files and the bodies that stand before it in the text",
        |call, _, site| scattered_points(call, site),
    )
    .with(&[
        required("count", Kind::Count(1, 10_000_000)),
        default("seed", Kind::Count(0, MOST_EXACT), Preset::Quantity(0.0, "")),
    ]),
    &of("sphere", &[], "a ball about a centre", |call, _, site| {
        Ok(body(Solid::Sphere { radius: call.length_or_zero("radius") }, call, site))
    })
    .with(&[required("radius", Kind::Length), CENTRE[0], CENTRE[1], CENTRE[2]]),
    &of("box", &[], "a box about a centre, given by the lengths of its edges", |call, _, site| {
        let size = ["sx", "sy", "sz"].map(|name| call.length_or_zero(name));
        Ok(body(Solid::Box { size: DVec3::from_array(size) }, call, site))
    })
    .with(&[
        required("sx", Kind::Length),
        required("sy", Kind::Length),
        required("sz", Kind::Length),
        CENTRE[0],
        CENTRE[1],
        CENTRE[2],
    ]),
    &of("cylinder", &[], "a cylinder about a centre", |call, _, site| {
        let [radius, height] = ["radius", "height"].map(|name| call.length_or_zero(name));
        Ok(body(Solid::Cylinder { radius, height }, call, site))
    })
    .with(&[
        required("radius", Kind::Length),
        required("height", Kind::Length),
        ALONG_Z,
        CENTRE[0],
        CENTRE[1],
        CENTRE[2],
    ]),
    &of("torus", &[], "a ring about a centre; major is the radius of the ring, minor that of its tube", |call, _, site| {
        let [major, minor] = ["major", "minor"].map(|name| call.length_or_zero(name));
        Ok(body(Solid::Torus { major, minor }, call, site))
    })
    .with(&[required("major", Kind::Length), required("minor", Kind::Length), ALONG_Z, CENTRE[0], CENTRE[1], CENTRE[2]]),
    &of("plane", &[], "everything that is below a coordinate", |call, _, site| Ok(half_space(call, site)))
        .with(&[required("axis", Kind::Axis), required("at", Kind::SignedLength)]),
    &read("exact", Reading::Exact, "the distance to the nearest triangle of a file"),
    &read("robust", Reading::Robust, "the smooth field that repairs are made from"),
    &read("levels", Reading::Levels, "the distance to the nearest triangle, with inside and outside told by the outlines of horizontal slices"),
];

/// The function that is called `name`.
pub fn by_name(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().copied().find(|function| function.name == name)
}

/// What `-a` is short for.
pub(super) static COMPLEMENT: Function = of("complement", &["a"], "what is outside of a; short: -a", |_, fields, _| {
    Ok(algebra::complement(fields[0].clone()))
});
/// What `a | b` is short for.
pub(super) static UNION: Function =
    of_many("union", "what is inside any; short: a | b", |_, fields, _| Ok(algebra::union(fields.to_vec())))
        .joining(|a, b| Expression::Union(vec![a, b]));
/// What `a & b` is short for.
pub(super) static INTERSECTION: Function =
    of_many("intersection", "what is inside all; short: a & b", |_, fields, _| {
        Ok(algebra::intersection(fields.to_vec()))
    })
    .joining(|a, b| Expression::Intersection(vec![a, b]));
/// What `a - b` is short for.
pub(super) static DIFFERENCE: Function =
    of_many("difference", "what is inside the first and no other; short: a - b", |_, fields, _| {
        Ok(algebra::difference(fields[0].clone(), fields[1..].to_vec()))
    })
    .joining(|a, b| Expression::Difference(Box::new(a), Box::new(b)));
/// What `a ^ b` is short for.
pub(super) static SYMMETRIC_DIFFERENCE: Function =
    of_many("symmetric_difference", "what is inside an odd number; short: a ^ b", |_, fields, _| {
        Ok(algebra::symmetric_difference(fields.to_vec()))
    })
    .joining(|a, b| Expression::SymmetricDifference(Box::new(a), Box::new(b)));

/// From here on, whole numbers are not exact in `f64`.
const MOST_EXACT: u64 = 1 << 53;
const SHARE: Kind = Kind::Number(0.0, 1.0);
/// At 0 and 1 Perlin's gain is a step.
const GAIN: Kind = Kind::Number(0.05, 0.95);
const RADIUS: &[Parameter] = &[required("radius", Kind::Length)];
const BLOB: &[Parameter] = &[required("radius", Kind::Length), default("gain", GAIN, Preset::Quantity(0.5, ""))];
const SAMPLES: Parameter = default("samples", Kind::Count(1, 65_536), Preset::Quantity(64.0, ""));
const ALONG_Z: Parameter = default("axis", Kind::Axis, Preset::Axis(Axis::Z));
const CENTRE: [Parameter; 3] = [coordinate("x"), coordinate("y"), coordinate("z")];

const fn of(name: &'static str, fields: &'static [&'static str], help: &'static str, build: Build) -> Function {
    row(name, fields, help, Gives::Made(build))
}

const fn of_many(name: &'static str, help: &'static str, build: Build) -> Function {
    Function { more_fields: true, ..row(name, &["a", "b"], help, Gives::Made(build)) }
}

const fn read(name: &'static str, reading: Reading, help: &'static str) -> Function {
    row(name, &["name"], help, Gives::Read(reading))
}

const fn row(name: &'static str, fields: &'static [&'static str], help: &'static str, gives: Gives) -> Function {
    let (more_fields, parameters, list, boolean, measure) = (false, &[] as &[Parameter], List::None, None, false);
    Function { name, fields, more_fields, parameters, list, help, gives, boolean, measure }
}

impl Function {
    const fn with(self, parameters: &'static [Parameter]) -> Self {
        Self { parameters, ..self }
    }

    const fn listed(self, list: List) -> Self {
        Self { list, ..self }
    }

    const fn joining(self, join: Join) -> Self {
        Self { boolean: Some(join), ..self }
    }

    const fn measuring(self) -> Self {
        Self { measure: true, ..self }
    }
}

const fn required(name: &'static str, kind: Kind) -> Parameter {
    Parameter { name, kind, presence: Presence::Required }
}

const fn default(name: &'static str, kind: Kind, preset: Preset) -> Parameter {
    Parameter { name, kind, presence: Presence::Default(preset) }
}

const fn optional(name: &'static str, kind: Kind) -> Parameter {
    Parameter { name, kind, presence: Presence::Optional }
}

const fn coordinate(name: &'static str) -> Parameter {
    default(name, Kind::SignedLength, Preset::Quantity(0.0, ""))
}
