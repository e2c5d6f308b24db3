//! A solid angle near one place, as a polynomial of second degree.

use glam::{DMat3, DVec3};

/// The sum of the solid angles of things that are far from a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expansion {
    pub(super) centre: DVec3,
    value: f64,
    gradient: DVec3,
    hessian: DMat3,
}

impl Expansion {
    pub(super) fn about(centre: DVec3) -> Self {
        Self { centre, value: 0.0, gradient: DVec3::ZERO, hessian: DMat3::ZERO }
    }

    /// Adds a dipole's D·r/r³, r = `at` - p.
    pub(super) fn add_dipole(&mut self, at: DVec3, dipole: DVec3) {
        let r = at - self.centre;
        let (squared, along) = (r.length_squared(), dipole.dot(r));
        let cubed = 1.0 / (squared * squared.sqrt());
        let fifth = cubed / squared;
        self.value += along * cubed;
        self.gradient += r * (3.0 * along * fifth) - dipole * cubed;
        let (diagonal, outer) = (-3.0 * along * fifth, 15.0 * along * fifth / squared);
        for (axis, column) in DVec3::AXES.into_iter().enumerate() {
            let mixed = (dipole * r[axis] + r * dipole[axis]) * (-3.0 * fifth);
            *self.hessian.col_mut(axis) += mixed + column * diagonal + r * (outer * r[axis]);
        }
    }

    /// Adds something of which `value` and `gradient` at the centre suffice.
    pub(super) fn add(&mut self, (value, gradient): (f64, DVec3)) {
        self.value += value;
        self.gradient += gradient;
    }

    /// Adds something by its value, gradient and second derivatives at the centre.
    pub(super) fn add_bent(&mut self, (value, gradient, hessian): (f64, DVec3, DMat3)) {
        self.add((value, gradient));
        self.hessian += hessian;
    }

    /// The gradient at `p`.
    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        self.gradient + self.hessian * (p - self.centre)
    }

    /// The solid angle at `p`.
    pub(super) fn at(&self, p: DVec3) -> f64 {
        let x = p - self.centre;
        self.value + self.gradient.dot(x) + 0.5 * x.dot(self.hessian * x)
    }
}
