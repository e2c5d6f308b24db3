//! The functions of the language: what each takes, and what it gives.

/// A function of the language; what it does is said by its [`Signature`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the table has a line on each")]
pub enum Function {
    Complement,
    Union,
    Intersection,
    Difference,
    SymmetricDifference,
    Offset,
    Shell,
    Blend,
    BlendIntersection,
    BlendDifference,
    Average,
    Morph,
    MorphRadii,
    Ramp,
    Texture,
    Material,
    Filter,
    Smooth,
    Blur,
    Coarse,
    Blob,
    BlobUnion,
    BlobIntersection,
    BlobDifference,
    Compare,
    Move,
    Scale,
    Turn,
    Align,
    Points,
    Sphere,
    Box,
    Cylinder,
    Torus,
    Plane,
    Exact,
    Robust,
    Levels,
}

/// What a function takes and gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signature {
    /// Whose it is.
    pub function: Function,
    /// What it is called by.
    pub name: &'static str,
    /// What its fields are called where it is explained; as many are needed.
    pub fields: &'static [&'static str],
    /// Whether any number of fields may follow; then there are no parameters.
    pub more_fields: bool,
    /// Whether its field must be the plain name of an operand.
    pub plain_name: bool,
    /// What comes after the fields, in order.
    pub parameters: &'static [Parameter],
    /// What comes after a `;`.
    pub list: List,
    /// One line on what it gives.
    pub help: &'static str,
}

/// One parameter of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// What it is called by, as in `radius=2mm`.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Whether it can be left away.
    pub presence: Presence,
}

/// What a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A length above zero.
    Length,
    /// A length of either sign.
    SignedLength,
    /// A coordinate along an axis: a length, or with `%` a share of the extent along that axis.
    Place,
    /// A number without a unit in this range, ends included; or the frame, `t`.
    Number(f64, f64),
    /// A whole number in this range, ends included.
    Count(u64, u64),
    /// `x`, `y` or `z`.
    Axis,
}

/// Whether a parameter can be left away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Presence {
    /// It cannot.
    Required,
    /// Then it is this.
    Default(Preset),
    /// Then it is absent, which means something of its own.
    Optional,
    /// The same, and it cannot be given together with the parameter of this name.
    InsteadOf(&'static str),
}

/// A default, as if it had been typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preset {
    /// A number and its suffix.
    Quantity(f64, &'static str),
    /// An axis.
    Axis(Axis),
}

/// An axis of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "they say what they are")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    pub fn number(self) -> usize {
        self as usize
    }

    /// As it is typed.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.number()]
    }
}

/// What a function takes after a `;`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// Nothing.
    None,
    /// A weight for each field, with a sum above zero; left away, all weigh the same.
    Weights,
    /// A value for each field.
    Values,
}

impl Function {
    /// What it takes and gives.
    pub fn signature(self) -> &'static Signature {
        &FUNCTIONS[self as usize]
    }

    /// The function that is called `name`.
    pub fn by_name(name: &str) -> Option<Self> {
        FUNCTIONS.iter().find(|signature| signature.name == name).map(|signature| signature.function)
    }
}

/// All functions, in the order of [`Function`].
pub const FUNCTIONS: [Signature; Function::Levels as usize + 1] = [
    of_fields(Function::Complement, "complement", &["a"], "what is outside of a; short: -a"),
    of_many(Function::Union, "union", "what is inside any; short: a | b"),
    of_many(Function::Intersection, "intersection", "what is inside all; short: a & b"),
    of_many(Function::Difference, "difference", "what is inside the first and no other; short: a - b"),
    of_many(Function::SymmetricDifference, "symmetric_difference", "what is inside an odd number; short: a ^ b"),
    with(
        of_fields(Function::Offset, "offset", &["a"], "a grown by a length, or shrunk where it is negative"),
        &[required("by", Kind::SignedLength)],
    ),
    with(
        of_fields(Function::Shell, "shell", &["a"], "what is within half of the thickness of the surface"),
        &[required("thickness", Kind::Length)],
    ),
    with(of_fields(Function::Blend, "blend", &["a", "b"], "the union, rounded where the surfaces meet"), RADIUS),
    with(
        of_fields(
            Function::BlendIntersection,
            "blend_intersection",
            &["a", "b"],
            "the intersection, rounded where the surfaces meet",
        ),
        RADIUS,
    ),
    with(
        of_fields(
            Function::BlendDifference,
            "blend_difference",
            &["a", "b"],
            "a without b, rounded where the surfaces meet",
        ),
        RADIUS,
    ),
    listed(of_many(Function::Average, "average", "the mean shape, by weight if weights are given"), List::Weights),
    with(
        of_fields(Function::Morph, "morph", &["a", "b"], "the shape on the way from a (t = 0) to b (t = 1)"),
        &[required("t", SHARE)],
    ),
    with(
        of_fields(
            Function::MorphRadii,
            "morph_radii",
            &["a", "b"],
            "the same, each weighted by its radius, so that a small shape does not vanish early",
        ),
        &[required("t", SHARE)],
    ),
    with(
        of_fields(
            Function::Ramp,
            "ramp",
            &["a", "b"],
            "a at one end of an axis, b at the other, shapes between them between",
        ),
        &[
            required("axis", Kind::Axis),
            default("from", Kind::Place, Preset::Quantity(0.0, "%")),
            default("to", Kind::Place, Preset::Quantity(100.0, "%")),
        ],
    ),
    with(
        of_fields(Function::Texture, "texture", &["a", "b"], "a, with its surface moved by the field b"),
        &[required("amount", SHARE)],
    ),
    listed(
        of_many(
            Function::Material,
            "material",
            "no shape: a value on each shape, passing smoothly from one to the other between them",
        ),
        List::Values,
    ),
    with(
        of_fields(
            Function::Filter,
            "filter",
            &["a"],
            "the same surface, the field smooth away from it; width: of the bump kernel, 8/9 of cap; sigma: a Gaussian kernel instead; least: fewest samples where few are enough",
        ),
        &[
            default("cap", Kind::Length, Preset::Quantity(5.0, "%")),
            optional("width", Kind::Length),
            Parameter { name: "sigma", kind: Kind::Length, presence: Presence::InsteadOf("width") },
            SAMPLES,
            optional("least", Kind::Count(2, 65_536)),
        ],
    ),
    with(
        of_fields(
            Function::Smooth,
            "smooth",
            &["a", "volume"],
            "a, smoothed by up to radius from depth inside the volume on",
        ),
        &[required("depth", Kind::Length), required("radius", Kind::Length), SAMPLES],
    ),
    with(
        of_fields(Function::Blur, "blur", &["a"], "the field convolved with a Gaussian"),
        &[required("sigma", Kind::Length)],
    ),
    with(
        of_fields(Function::Coarse, "coarse", &["a"], "the field sampled with larger voxels"),
        &[required("voxel", Kind::Length)],
    ),
    with(
        of_fields(
            Function::Blob,
            "blob",
            &["a"],
            "the blobby field: 0 on the surface, minus and plus radius from radius on",
        ),
        BLOB,
    ),
    with(of_fields(Function::BlobUnion, "blob_union", &["a", "b"], "the sum of blobby fields"), BLOB),
    with(of_fields(Function::BlobIntersection, "blob_intersection", &["a", "b"], "the product of blobby fields"), BLOB),
    with(
        of_fields(
            Function::BlobDifference,
            "blob_difference",
            &["a", "b"],
            "the blobby field of a, bitten by that of b",
        ),
        BLOB,
    ),
    with(
        of_fields(Function::Compare, "compare", &["a", "b"], "no shape: how much more a is there than b, from -1 to 1"),
        BLOB,
    ),
    with(of_fields(Function::Move, "move", &["a"], "a elsewhere"), &[CENTRE[0], CENTRE[1], CENTRE[2]]),
    with(
        of_fields(Function::Scale, "scale", &["a"], "a made larger about the middle of its box, or smaller"),
        &[required("factor", Kind::Number(1e-6, 1e6))],
    ),
    with(
        of_fields(
            Function::Turn,
            "turn",
            &["a"],
            "a turned about an axis through the middle of its box, counterclockwise seen against the axis",
        ),
        &[required("axis", Kind::Axis), required("degrees", Kind::Number(-360.0, 360.0))],
    ),
    of_fields(
        Function::Align,
        "align",
        &["a", "b"],
        "a moved and scaled: the middle and the longest side of its box become those of b's",
    ),
    with(
        of_fields(
            Function::Points,
            "points",
            &[],
            "the distance to random points in the box of the operands and of the bodies before",
        ),
        &[
            required("count", Kind::Count(1, 10_000_000)),
            default("seed", Kind::Count(0, MOST_EXACT), Preset::Quantity(0.0, "")),
        ],
    ),
    with(
        of_fields(Function::Sphere, "sphere", &[], "a ball about a centre"),
        &[required("radius", Kind::Length), CENTRE[0], CENTRE[1], CENTRE[2]],
    ),
    with(
        of_fields(Function::Box, "box", &[], "a box by its edges, about a centre"),
        &[
            required("sx", Kind::Length),
            required("sy", Kind::Length),
            required("sz", Kind::Length),
            CENTRE[0],
            CENTRE[1],
            CENTRE[2],
        ],
    ),
    with(
        of_fields(Function::Cylinder, "cylinder", &[], "a cylinder about a centre"),
        &[required("radius", Kind::Length), required("height", Kind::Length), ALONG_Z, CENTRE[0], CENTRE[1], CENTRE[2]],
    ),
    with(
        of_fields(Function::Torus, "torus", &[], "a ring about a centre: radius of the ring, radius of its tube"),
        &[required("major", Kind::Length), required("minor", Kind::Length), ALONG_Z, CENTRE[0], CENTRE[1], CENTRE[2]],
    ),
    with(
        of_fields(Function::Plane, "plane", &[], "all that is below a coordinate"),
        &[required("axis", Kind::Axis), required("at", Kind::SignedLength)],
    ),
    of_name(Function::Exact, "exact", "the distance to the nearest triangle of a file"),
    of_name(Function::Robust, "robust", "the field that repairs are made from"),
    of_name(Function::Levels, "levels", "the distance to the nearest triangle, its sides by outlines level by level"),
];

// Every function is where its number says: `signature` cannot miss.
const _: () = {
    let mut n = 0;
    while n < FUNCTIONS.len() {
        assert!(FUNCTIONS[n].function as usize == n);
        n += 1;
    }
};

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

const fn of_fields(
    function: Function,
    name: &'static str,
    fields: &'static [&'static str],
    help: &'static str,
) -> Signature {
    let (more_fields, plain_name, parameters, list): (_, _, &[Parameter], _) = (false, false, &[], List::None);
    Signature { function, name, fields, more_fields, plain_name, parameters, list, help }
}

const fn of_many(function: Function, name: &'static str, help: &'static str) -> Signature {
    Signature { more_fields: true, ..of_fields(function, name, &["a", "b"], help) }
}

const fn of_name(function: Function, name: &'static str, help: &'static str) -> Signature {
    Signature { plain_name: true, ..of_fields(function, name, &["name"], help) }
}

const fn with(signature: Signature, parameters: &'static [Parameter]) -> Signature {
    Signature { parameters, ..signature }
}

const fn listed(signature: Signature, list: List) -> Signature {
    Signature { list, ..signature }
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
