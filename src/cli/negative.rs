//! Negative parts of a file, which slicers take away from the rest: an operand of their own where solids are combined.

use super::input::Input;
use super::report::PartEntry;
use super::words;
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
        let entry = super::report::InputEntry {
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
            format,
            unit,
            parts,
            negative: None,
            warnings: Vec::new(),
        };
        inputs.push(Input { label, loaded, entry });
    }
    without(expression, &negative_of)
}

/// The expression with each operand less its negative parts.
fn without(expression: &Expression, negative_of: &[Option<usize>]) -> Expression {
    let one = |part: &Expression| Box::new(without(part, negative_of));
    let all = |parts: &[Expression]| parts.iter().map(|part| without(part, negative_of)).collect();
    match expression {
        Expression::Operand(n) => match negative_of.get(*n).copied().flatten() {
            Some(negative) => {
                Expression::Difference(Box::new(Expression::Operand(*n)), Box::new(Expression::Operand(negative)))
            }
            None => Expression::Operand(*n),
        },
        Expression::Union(parts) => Expression::Union(all(parts)),
        Expression::Intersection(parts) => Expression::Intersection(all(parts)),
        Expression::Difference(a, b) => Expression::Difference(one(a), one(b)),
        Expression::SymmetricDifference(a, b) => Expression::SymmetricDifference(one(a), one(b)),
    }
}

/// For what has nothing to subtract from: forgets the negative parts, and says which.
pub fn leave_out(input: &mut Input, notes: &mut Vec<String>) {
    if input.loaded.negative.take().is_some() {
        notes.push(format!(
            "{}: {} left out; repair and the booleans subtract them",
            input.label,
            named(&input.entry.negative_parts)
        ));
    }
}

/// "2 negative parts (`a`, `b`)".
fn named(parts: &[PartEntry]) -> String {
    let names: Vec<String> =
        parts.iter().filter(|part| !part.name.is_empty()).map(|part| format!("`{}`", part.name)).collect();
    let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
    format!("{}{names}", words::plural(parts.len(), "negative part"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_use_of_an_operand_is_less_its_negative_parts() {
        let expression = Expression::difference(3);
        let whole = without(&expression, &[Some(3), None, Some(4)]);
        for bits in 0..32u32 {
            let inside: Vec<bool> = (0..5).map(|n| bits >> n & 1 == 1).collect();
            let expected = (inside[0] && !inside[3]) && !(inside[1] || (inside[2] && !inside[4]));
            assert_eq!(whole.evaluate(&inside), expected, "{inside:?}");
        }
        assert_eq!(without(&expression, &[None; 3]), expression);
    }
}
