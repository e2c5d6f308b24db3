//! Texts as boolean expressions.

use proptest::prelude::*;
use proptest::sample::select;

use super::syntax::{MAX_DEPTH, MAX_PARTS};
use super::*;

const NAMES: [&str; 4] = ["a", "b", "c", "t"];

fn used(text: &str) -> Vec<&'static str> {
    let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
    NAMES.into_iter().filter(|name| words.contains(name)).collect()
}

/// Truth of `text` for all 16 choices of what is inside a, b, c and t.
fn table(text: &str) -> u16 {
    let used = used(text);
    let expression = parse_boolean(text, &used).unwrap_or_else(|e| panic!("{text}: {e}"));
    (0..16_u16).fold(0, |bits, choice| {
        let bit = |name: &&str| NAMES.iter().position(|other| other == name).is_some_and(|n| choice >> n & 1 == 1);
        let inside: Vec<bool> = used.iter().map(bit).collect();
        bits | u16::from(expression.evaluate(&inside)) << choice
    })
}

#[test]
fn precedence_is_that_of_python_sets() {
    for (text, same) in [
        ("a | b & c", "a | (b & c)"),
        ("a & b - c", "a & (b - c)"),
        ("a - b & c", "(a - b) & c"),
        ("a ^ b | c", "(a ^ b) | c"),
        ("a | b ^ c & t", "a | (b ^ (c & t))"),
        ("a - b - c", "(a - b) - c"),
        ("  a-(b|c)&t ", "(a - (b | c)) & t"),
        ("union(a, b, c) - t", "(a | b | c) - t"),
        ("symmetric_difference(a, b, c)", "a ^ b ^ c"),
        ("difference(a, b, c)", "a - (b | c)"),
    ] {
        assert_eq!(table(text), table(same), "{text}");
    }
    assert_ne!(table("a - b - c"), table("a - (b - c)"));
}

fn refused(text: &str) -> (Option<usize>, String, Option<String>) {
    let error = parse_boolean(text, &NAMES).unwrap_err();
    (error.position(), error.to_string(), error.hint())
}

#[test]
fn what_is_no_boolean_is_named_at_its_place() {
    let no_end = "what is outside has no end: `a - b` is what is inside a and outside b";
    let names = "names joined by `|`, `&`, `-` and `^`; `meshwright field` takes all functions";
    for (text, at, message, hint) in [
        ("a | -b", 4, "`complement(a)` is no boolean operation", Some(no_end)),
        ("a | b - offset(c, 1mm)", 8, "`offset(a, by)` is no boolean operation", Some(names)),
        ("exact(a)", 0, "`exact(name)` is no boolean operation", Some(names)),
        ("2a", 0, "`the expression` must be a field; `2a` is not", None),
        ("a (b)", 0, "there is no function `a`", Some("--help lists all functions")),
        ("a | d", 4, "no file is given for `d`", Some("the names given are a, b, c, t")),
        ("a | t", usize::MAX, "the expression does not use `b`, `c`", Some("use them, or leave their files away")),
    ] {
        let at = Some(at).filter(|at| *at < usize::MAX);
        assert_eq!(refused(text), (at, message.into(), hint.map(str::to_owned)), "{text}");
    }
}

#[test]
fn names_are_letters_digits_and_underlines() {
    assert!(["a", "_", "A1", "t", "union", "_9"].into_iter().all(is_name));
    assert!(!["", "1a", "a b", "a-b", "é", " a", "a "].into_iter().any(is_name));
}

#[test]
fn limits_are_those_of_fields() {
    let deep = "(".repeat(100_000);
    assert!(matches!(parse_boolean(&deep, &[]), Err(LanguageError::TooLong { at: MAX_DEPTH, .. })));
    let longest = vec!["a"; MAX_PARTS + 1].join("-");
    assert!(parse_boolean(&longest, &["a"]).is_ok());
    assert!(matches!(parse_boolean(&(longest + "-a"), &["a"]), Err(LanguageError::TooLong { limit: MAX_PARTS, .. })));
}

/// Texts of names, operators and parentheses.
fn boolean_texts() -> impl Strategy<Value = String> {
    let names = select(NAMES.to_vec()).prop_map(str::to_string);
    names.prop_recursive(6, 64, 2, |text| {
        let operator = select(vec!["|", " & ", "-", " ^", " - "]);
        prop_oneof![
            3 => (text.clone(), operator, text.clone()).prop_map(|(a, operator, b)| format!("{a}{operator}{b}")),
            1 => text.prop_map(|a| format!("( {a})")),
        ]
    })
}

proptest! {
    /// Fully parenthesised text means what it says, spaces or not.
    #[test]
    fn parenthesised_text_is_its_tree(seed in proptest::collection::vec(0_u8..4, 1..12), space in 0_usize..3) {
        let pad = " ".repeat(space);
        let mut text = "a".to_string();
        let mut expected = Expression::Operand(0);
        for (n, choice) in seed.iter().enumerate() {
            let operand = (n + 1) % 4;
            let symbol = ['|', '&', '-', '^'][*choice as usize];
            text = format!("({text}{pad}{symbol}{pad}{})", NAMES[operand]);
            let right = Expression::Operand(operand);
            expected = match symbol {
                '|' => Expression::Union(vec![expected, right]),
                '&' => Expression::Intersection(vec![expected, right]),
                '-' => Expression::Difference(Box::new(expected), Box::new(right)),
                _ => Expression::SymmetricDifference(Box::new(expected), Box::new(right)),
            };
        }
        let used = &NAMES[..NAMES.len().min(seed.len() + 1)];
        prop_assert_eq!(parse_boolean(&text, used).unwrap(), expected);
    }

    /// A boolean is the same solid as its field: inside where the field of the same text is negative.
    #[test]
    fn a_boolean_and_its_field_are_the_same_solid(text in boolean_texts()) {
        let text = text.replace('t', "d");
        let names = ["a", "b", "c", "d"];
        let names: Vec<&str> = names.into_iter().filter(|name| text.contains(name)).collect();
        let boolean = parse_boolean(&text, &names).unwrap();
        let tree = parse(&text, &names).unwrap().resolve(|value, _| Ok(value)).unwrap();
        let slab = |axis: usize, at: f64| -> crate::field::Shared {
            let centre = glam::DVec3::AXES[axis] * at;
            std::sync::Arc::new(crate::field::Body { solid: crate::field::Solid::HalfSpace, centre, axis })
        };
        let bodies = [slab(0, 0.0), slab(1, 0.0), slab(2, 0.0), slab(0, 5.0)];
        let operands = (0..names.len()).map(|n| ((n, Reading::Usual), bodies[n].clone())).collect();
        let progress = crate::progress::Progress::none();
        let lattice = |_: &crate::mesh::Bounds, _| Err("no lattice is needed".to_string());
        let mut site = Site { parts: None, lattice: &lattice, max_memory: None, progress: &progress };
        let field = build(&tree, &operands, &mut site).unwrap();
        for corner in 0..12_u32 {
            let x = [-1.0, 1.0, 6.0][corner as usize % 3];
            let [y, z] = [3, 6].map(|n| if corner / n % 2 == 0 { -1.0 } else { 1.0 });
            let p = glam::DVec3::new(x, y, z);
            let inside: Vec<bool> = bodies[..names.len()].iter().map(|body| body.value(p) < 0.0).collect();
            prop_assert_eq!(field.value(p) < 0.0, boolean.evaluate(&inside), "{} at {}", text, p);
        }
    }
}
