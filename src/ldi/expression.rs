//! Boolean expressions over operands (Bærentzen §5.1, made general).

/// A boolean expression over operands, numbered from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Expression {
    /// The solid of one operand.
    Operand(usize),
    /// All points inside at least one of these; an empty list is nothing.
    Union(Vec<Expression>),
    /// All points inside each of these; an empty list is nothing.
    Intersection(Vec<Expression>),
    /// All points inside the first and not inside the second.
    Difference(Box<Expression>, Box<Expression>),
    /// All points inside exactly one of the two.
    SymmetricDifference(Box<Expression>, Box<Expression>),
}

impl Expression {
    /// The union of operands 0 to `count` - 1.
    pub fn union(count: usize) -> Self {
        Self::Union((0..count).map(Self::Operand).collect())
    }

    /// The intersection of operands 0 to `count` - 1.
    pub fn intersection(count: usize) -> Self {
        Self::Intersection((0..count).map(Self::Operand).collect())
    }

    /// Operand 0 without the union of operands 1 to `count` - 1.
    pub fn difference(count: usize) -> Self {
        let removed = Self::Union((1..count).map(Self::Operand).collect());
        Self::Difference(Box::new(Self::Operand(0)), Box::new(removed))
    }

    /// Whether a point is inside the result, given for each operand whether it is inside that.
    /// Operands beyond `inside` count as outside.
    pub fn evaluate(&self, inside: &[bool]) -> bool {
        match self {
            Self::Operand(n) => inside.get(*n).copied().unwrap_or(false),
            Self::Union(parts) => parts.iter().any(|part| part.evaluate(inside)),
            Self::Intersection(parts) => !parts.is_empty() && parts.iter().all(|part| part.evaluate(inside)),
            Self::Difference(a, b) => a.evaluate(inside) && !b.evaluate(inside),
            Self::SymmetricDifference(a, b) => a.evaluate(inside) != b.evaluate(inside),
        }
    }

    /// One more than the largest operand number; 0 for an expression without operands.
    pub fn operand_count(&self) -> usize {
        match self {
            Self::Operand(n) => n + 1,
            Self::Union(parts) | Self::Intersection(parts) => parts.iter().map(Self::operand_count).max().unwrap_or(0),
            Self::Difference(a, b) | Self::SymmetricDifference(a, b) => a.operand_count().max(b.operand_count()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difference_removes_every_later_operand() {
        let e = Expression::difference(3);
        assert!(e.evaluate(&[true, false, false]));
        assert!(!e.evaluate(&[true, false, true]));
        assert!(!e.evaluate(&[false, true, false]));
        assert_eq!(e.operand_count(), 3);
    }

    #[test]
    fn empty_lists_are_nothing() {
        assert!(!Expression::union(0).evaluate(&[]));
        assert!(!Expression::intersection(0).evaluate(&[true]));
    }
}
