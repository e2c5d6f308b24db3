//! `convert --scale`, `--rotate`, `--lay-flat`, `--to-origin`, `--translate`: the same triangles in another size and place.

use std::str::FromStr;

use clap::Args;
use glam::{DMat3, DQuat, DVec3};
use serde::Serialize;

use super::exit::Failure;
use super::length::{Length, Scale};
use super::words::{self, UnitName};
use crate::io::{Colours, Loaded, Unit};
use crate::mesh::{Bounds, TriMesh, largest_hull_face};

/// Another size and place, in this order: scale, rotate, lay flat, to the origin, translate.
#[derive(Debug, Clone, Default, Args)]
pub struct TransformArgs {
    /// First multiply all coordinates by F, or those along each axis; a negative number mirrors
    #[arg(long, value_name = "F|X,Y,Z", allow_hyphen_values = true)]
    pub scale: Option<Factors>,
    /// Then turn about an axis through the origin, counter-clockwise seen from its tip, in degrees; may be given again
    #[arg(long, value_name = "AXIS=DEG")]
    pub rotate: Vec<Turn>,
    /// Then turn it so that the largest face of its convex hull lies on z = 0
    #[arg(long)]
    pub lay_flat: bool,
    /// Then move it so that its smallest coordinates are 0
    #[arg(long)]
    pub to_origin: bool,
    /// Then move it by these lengths (10mm,0,-2mm)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub translate: Option<Shift>,
}

/// `--scale`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors(DVec3);

impl FromStr for Factors {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        let factors = match numbers.as_deref() {
            Some(&[all]) => DVec3::splat(all),
            Some(&[x, y, z]) => DVec3::new(x, y, z),
            _ => return Err("a number such as 25.4, or three such as 1,1,-1, are needed".into()),
        };
        let usable = factors.to_array().into_iter().all(|f| (1e-30..=1e30).contains(&f.abs()));
        if usable {
            Ok(Self(factors))
        } else {
            Err("a factor must not be 0, and no larger or smaller than can be meant".into())
        }
    }
}

/// One `--rotate`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    axis: char,
    degrees: f64,
}

impl FromStr for Turn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || "an axis and degrees are needed, such as x=90 or z=-45".to_string();
        let (axis, degrees) = text.split_once('=').ok_or_else(wanted)?;
        let axis = match axis.trim() {
            "x" | "X" => 'x',
            "y" | "Y" => 'y',
            "z" | "Z" => 'z',
            _ => return Err(wanted()),
        };
        let degrees = degrees.trim().trim_end_matches('°').trim_end_matches("deg").parse().map_err(|_| wanted())?;
        if f64::is_finite(degrees) { Ok(Self { axis, degrees }) } else { Err(wanted()) }
    }
}

impl Turn {
    /// Quarter turns are exact.
    fn matrix(&self) -> DMat3 {
        let degrees = self.degrees.rem_euclid(360.0);
        let (sin, cos) = match degrees {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            degrees => degrees.to_radians().sin_cos(),
        };
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        match self.axis {
            'x' => DMat3::from_cols(x, DVec3::new(0.0, cos, sin), DVec3::new(0.0, -sin, cos)),
            'y' => DMat3::from_cols(DVec3::new(cos, 0.0, -sin), y, DVec3::new(sin, 0.0, cos)),
            _ => DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), z),
        }
    }
}

/// `--translate`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift([Signed; 3]);

/// A length with a sign; `None` for 0.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Signed(Option<(f64, Length)>);

impl FromStr for Shift {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<Signed> = text.split(',').map(signed).collect::<Result<_, String>>()?;
        let three = parts.try_into().map_err(|_| "three lengths are needed, such as 10mm,0,-2mm".to_string())?;
        Ok(Self(three))
    }
}

fn signed(text: &str) -> Result<Signed, String> {
    let text = text.trim();
    let (sign, rest) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let number = rest.trim_end_matches(|c: char| c.is_alphabetic() || matches!(c, '%' | '"'));
    if number.trim().parse::<f64>() == Ok(0.0) {
        return Ok(Signed(None));
    }
    let length: Length = rest.parse().map_err(|error: super::length::QuantityError| error.to_string())?;
    if rest.starts_with('-') || matches!(length, Length::Voxels(_)) {
        return Err(format!("`{text}` is no length to move by, such as 10mm, 5% (of the diagonal) or -2.5"));
    }
    Ok(Signed(Some((sign, length))))
}

/// What was done, in the order in which it was.
#[derive(Debug, Clone, Default, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Transformed {
    /// The factors along the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
    /// Whether left and right have changed; the triangles were turned over with it.
    pub mirrored: bool,
    /// Axes and degrees.
    pub rotate: Vec<(char, f64)>,
    /// Area of the face that it was laid on, square model units, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub laid_on: Option<f64>,
    /// By how much it was moved after all that, model units; with `--to-origin`, too.
    pub moved: [f64; 3],
    /// Its bounding box then.
    pub bounds: [[f64; 3]; 2],
}

impl Transformed {
    /// `scaled by 2; turned about z by 90°; moved by 1 0 0`.
    pub fn words(&self, unit: Option<Unit>) -> String {
        let unit = unit.map(|unit| unit.to_string());
        let unit: UnitName<'_> = unit.as_deref();
        let mut parts = Vec::new();
        match self.scale {
            Some([x, y, z]) if x == y && y == z => parts.push(format!("scaled by {x}")),
            Some([x, y, z]) => parts.push(format!("scaled by {x} {y} {z}")),
            None => {}
        }
        if self.mirrored {
            parts.push("mirrored, its triangles turned over so that they still face outwards".into());
        }
        parts.extend(self.rotate.iter().map(|(axis, degrees)| format!("turned about {axis} by {degrees}°")));
        if let Some(area) = self.laid_on {
            parts.push(format!("laid flat on a face of {}", words::area(area, unit)));
        }
        if self.moved != [0.0; 3] {
            parts.push(format!("moved by {}", words::with_unit(&self.moved.map(words::number).join(" "), unit)));
        }
        parts.join("; ")
    }
}

/// Does what is asked for, if anything is.
pub fn apply(args: &TransformArgs, loaded: &mut Loaded, unit: Option<Unit>) -> Result<Option<Transformed>, Failure> {
    let nothing = args.scale.is_none() && args.rotate.is_empty() && args.translate.is_none();
    if nothing && !args.lay_flat && !args.to_origin {
        return Ok(None);
    }
    let diagonal = loaded.mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal);
    let scale = Scale { unit, diagonal, voxel: None };
    let shift = args.translate.map(|shift| shift.resolve(&scale)).transpose()?;
    let mut done = Transformed::default();
    if let Some(Factors(factors)) = args.scale {
        loaded.mesh.positions.iter_mut().for_each(|p| *p *= factors);
        done.scale = Some(factors.to_array());
        done.mirrored = factors.to_array().iter().filter(|f| **f < 0.0).count() % 2 == 1;
        if done.mirrored {
            turn_over(loaded);
        }
    }
    for turn in &args.rotate {
        let matrix = turn.matrix();
        loaded.mesh.positions.iter_mut().for_each(|p| *p = matrix * *p);
        done.rotate.push((turn.axis, turn.degrees));
    }
    if args.lay_flat {
        done.laid_on = Some(lay_flat(&mut loaded.mesh)?);
    }
    let origin = loaded.mesh.bounds().filter(|_| args.to_origin).map(|bounds| bounds.min);
    for by in [origin.map(|p| -p), shift].into_iter().flatten() {
        loaded.mesh.positions.iter_mut().for_each(|p| *p += by);
        done.moved = (DVec3::from_array(done.moved) + by).to_array();
    }
    let bounds = loaded.mesh.bounds().filter(|bounds| bounds.min.is_finite() && bounds.max.is_finite());
    let Some(bounds) = bounds else { return Err(Failure::usage("the coordinates would be larger than any number")) };
    done.bounds = [bounds.min.to_array(), bounds.max.to_array()];
    Ok(Some(done))
}

impl Shift {
    /// In model units.
    pub fn resolve(&self, scale: &Scale) -> Result<DVec3, Failure> {
        let mut by = [0.0; 3];
        for (by, Signed(part)) in by.iter_mut().zip(self.0) {
            if let Some((sign, length)) = part {
                *by = sign * length.resolve(scale)?;
            }
        }
        Ok(DVec3::from_array(by))
    }
}

/// Turns all triangles over, with the colours of their corners.
fn turn_over(loaded: &mut Loaded) {
    loaded.mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    if let Some(Colours::Corners(corners)) = &mut loaded.colours {
        corners.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
}

/// Turns a mesh about the middle of its box so that the largest face of its hull faces down, and puts that on z = 0. Returns the face's
/// area.
fn lay_flat(mesh: &mut TriMesh) -> Result<f64, Failure> {
    let face = largest_hull_face(mesh).zip(mesh.bounds());
    let Some(((normal, area), bounds)) = face else {
        return Err(Failure::input("a mesh without any height cannot be laid flat on a face: it is flat"));
    };
    let matrix = downwards(normal);
    let middle = bounds.min.midpoint(bounds.max);
    if matrix != DMat3::IDENTITY {
        mesh.positions.iter_mut().for_each(|p| *p = matrix * (*p - middle) + middle);
    }
    let low = mesh.bounds().map_or(0.0, |bounds| bounds.min.z);
    mesh.positions.iter_mut().for_each(|p| p.z -= low);
    Ok(area)
}

/// A normal as near as this to an axis is along it.
const ALONG: f64 = 1e-12;

/// The turn that makes a direction point down; along axes, exactly.
fn downwards(normal: DVec3) -> DMat3 {
    let near = |axis: DVec3| normal.dot(axis) > 1.0 - ALONG;
    let quarter = |axis: char, degrees: f64| Turn { axis, degrees }.matrix();
    match normal {
        _ if near(DVec3::NEG_Z) => DMat3::IDENTITY,
        _ if near(DVec3::Z) => quarter('x', 180.0),
        _ if near(DVec3::X) => quarter('y', 90.0),
        _ if near(DVec3::NEG_X) => quarter('y', -90.0),
        _ if near(DVec3::Y) => quarter('x', -90.0),
        _ if near(DVec3::NEG_Y) => quarter('x', 90.0),
        _ => DMat3::from_quat(DQuat::from_rotation_arc(normal, DVec3::NEG_Z)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_goes_down_exactly() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
            let matrix = downwards(axis);
            assert_eq!(matrix * axis, DVec3::NEG_Z, "{axis}");
            assert_eq!(matrix.determinant(), 1.0);
        }
        let tilted = DVec3::new(0.36, 0.48, 0.8);
        assert!((downwards(tilted) * tilted).distance(DVec3::NEG_Z) < 1e-15);
    }

    #[test]
    fn turns_are_counter_clockwise_seen_from_the_tip_of_the_axis() {
        for (turn, from, to) in
            [("x=90", DVec3::Y, DVec3::Z), ("y=90", DVec3::Z, DVec3::X), ("z=-270", DVec3::X, DVec3::Y)]
        {
            assert_eq!(turn.parse::<Turn>().expect("a turn").matrix() * from, to, "{turn}");
        }
        let small = "z=30".parse::<Turn>().expect("a turn").matrix() * DVec3::X;
        assert!(small.distance(DVec3::new(0.75f64.sqrt(), 0.5, 0.0)) < 1e-15);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "0", "1,2", "a", "1,0,1", "inf", "nan"] {
            assert!(text.parse::<Factors>().is_err(), "{text}");
        }
        for text in ["", "w=90", "x", "x=", "x=nan", "90"] {
            assert!(text.parse::<Turn>().is_err(), "{text}");
        }
        for text in ["", "1,2", "1,2,3,4", "--1,0,0", "2h,0,0", "x,0,0"] {
            assert!(text.parse::<Shift>().is_err(), "{text}");
        }
        assert!("-1.5mm, +2,0mm".parse::<Shift>().is_ok());
    }
}
