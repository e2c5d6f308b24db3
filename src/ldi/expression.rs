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

    /// The same expression with each operand less another one: `negative_of[n]` is the number of the operand that is taken away from
    /// operand `n` wherever that stands. Operands without an entry, or with none, stay. This is how what a file says is to be subtracted from
    /// its mesh ([`Loaded::negative`](crate::io::Loaded::negative)) becomes part of a boolean:
    ///
    /// ```
    /// use meshwright::ldi::Expression;
    ///
    /// // Operand 2 holds what is to be taken away from operand 0.
    /// let expression = Expression::union(2).less(&[Some(2), None]);
    /// assert!(expression.evaluate(&[true, false, false]));
    /// assert!(!expression.evaluate(&[true, false, true]));
    /// assert!(expression.evaluate(&[true, true, true]));
    /// ```
    pub fn less(&self, negative_of: &[Option<usize>]) -> Self {
        let one = |part: &Self| Box::new(part.less(negative_of));
        let all = |parts: &[Self]| parts.iter().map(|part| part.less(negative_of)).collect();
        match self {
            Self::Operand(n) => match negative_of.get(*n).copied().flatten() {
                Some(negative) => Self::Difference(Box::new(Self::Operand(*n)), Box::new(Self::Operand(negative))),
                None => Self::Operand(*n),
            },
            Self::Union(parts) => Self::Union(all(parts)),
            Self::Intersection(parts) => Self::Intersection(all(parts)),
            Self::Difference(a, b) => Self::Difference(one(a), one(b)),
            Self::SymmetricDifference(a, b) => Self::SymmetricDifference(one(a), one(b)),
        }
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

    #[test]
    fn every_use_of_an_operand_is_less_its_negative_parts() {
        let expression = Expression::difference(3);
        let whole = expression.less(&[Some(3), None, Some(4)]);
        for bits in 0..32u32 {
            let inside: Vec<bool> = (0..5).map(|n| bits >> n & 1 == 1).collect();
            let expected = (inside[0] && !inside[3]) && !(inside[1] || (inside[2] && !inside[4]));
            assert_eq!(whole.evaluate(&inside), expected, "{inside:?}");
        }
        assert_eq!(expression.less(&[None; 3]), expression);
    }
}
