//! Negative parts of a file, which slicers take away from the rest: an operand of their own where solids are combined.

use super::input::Input;
use crate::io::Loaded;
use crate::ldi::Expression;

/// Makes an operand of the negative parts of each input, after all others, and takes it away from its own in the
/// expression.
pub fn as_operands(inputs: &mut Vec<Input>, expression: &Expression) -> Expression {
    let given = inputs.len();
    let mut negative_of = vec![None; given];
    for n in 0..given {
        let Some(negative) = inputs[n].loaded.negative.take() else { continue };
        negative_of[n] = Some(inputs.len());
        let (own, format, unit) = (&inputs[n], inputs[n].loaded.format, inputs[n].loaded.unit);
        let label = format!("{} (negative parts)", own.label);
        let entry = super::entries::InputEntry {
            path: label.clone(),
            name: None,
            parts: std::mem::take(&mut inputs[n].entry.negative_parts),
            warnings: Vec::new(),
            ..inputs[n].entry.clone()
        };
        let (mesh, parts) = (negative.mesh, negative.parts);
        let loaded = Loaded {
            mesh,
            colours: None,
            texture: None,
            legend: Vec::new(),
            scale: None,
            format,
            unit,
            parts,
            negative: None,
            warnings: Vec::new(),
        };
        inputs.push(Input { label, loaded, entry });
    }
    expression.less(&negative_of)
}
