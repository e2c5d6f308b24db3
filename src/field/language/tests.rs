use proptest::prelude::*;
use proptest::sample::{Index, select};

use super::syntax::{MAX_DEPTH, MAX_PARTS};
use super::*;

const NAMES: [&str; 3] = ["a1", "b1", "c1"];

/// The tree of `text` over those of `names` that are in it.
fn tree_of(text: &str, names: &[&str]) -> Node {
    let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    let used: Vec<&str> = names.iter().copied().filter(|name| words.contains(name)).collect();
    parse(text, &used).unwrap_or_else(|e| panic!("{text}: {e} at {:?}", e.position()))
}

fn tree(text: &str) -> Node {
    tree_of(text, &["a", "b", "c", "d"])
}

/// As functions of fields.
fn meaning(text: &str) -> String {
    tree_of(text, &NAMES).to_string()
}

/// The same tree as if all of it stood at the beginning of the text.
fn nowhere(node: &Node) -> Node {
    let span = Span { start: 0, end: 0 };
    let kind = match &node.kind {
        NodeKind::Call(call) => NodeKind::Call(Call {
            fields: call.fields.iter().map(nowhere).collect(),
            arguments: call.arguments.iter().map(|typed| Typed { span, ..typed.clone() }).collect(),
            ..call.clone()
        }),
        name => name.clone(),
    };
    Node { span, kind }
}

fn call(node: &Node) -> &Call {
    let NodeKind::Call(call) = &node.kind else { panic!("{node} is no call") };
    call
}

fn resolved(text: &str) -> Call<Value> {
    let node = tree(text).resolve(model_units).unwrap_or_else(|e| panic!("{text}: {e}"));
    let NodeKind::Call(call) = node.kind else { panic!("{text} is no call") };
    call
}

/// A model in millimetres with a diagonal of 200 and voxels of 0.5.
fn model_units(value: f64, suffix: &str) -> Result<f64, String> {
    match suffix {
        "" | "mm" => Ok(value),
        "h" => Ok(value * 0.5),
        "%" => Ok(value * 2.0),
        "in" => Ok(value * 25.4),
        _ => Err(format!("`{suffix}` is no unit")),
    }
}

fn place(text: &str) -> (Option<usize>, String) {
    let error = match parse(text, &["a", "b"]) {
        Err(error) => error,
        Ok(node) => node.resolve(model_units).map(|node| panic!("{text} is {node:?}")).unwrap_err(),
    };
    (error.position(), error.to_string())
}

#[test]
fn operators_are_short_for_functions_with_the_precedence_of_python_sets() {
    for (text, functions) in [
        ("a1 | b1 & c1", "union(a1, intersection(b1, c1))"),
        ("a1 & b1 - c1", "intersection(a1, difference(b1, c1))"),
        ("a1 - b1 & c1", "intersection(difference(a1, b1), c1)"),
        ("a1 ^ b1 | c1", "union(symmetric_difference(a1, b1), c1)"),
        ("a1 ^ b1 & c1", "symmetric_difference(a1, intersection(b1, c1))"),
        ("a1 - b1 - c1", "difference(a1, b1, c1)"),
        ("a1 - (b1 - c1)", "difference(a1, difference(b1, c1))"),
        ("-a1 - b1", "difference(complement(a1), b1)"),
        ("a1 - -b1", "difference(a1, complement(b1))"),
        ("-(a1 | b1)", "complement(union(a1, b1))"),
        ("- -a1", "a1"),
        ("  (a1|b1)&-c1 ", "intersection(union(a1, b1), complement(c1))"),
    ] {
        assert_eq!(meaning(text), functions, "{text}");
    }
}

#[test]
fn arguments_are_in_the_order_of_the_table_and_defaults_are_there() {
    for (text, functions) in [
        ("offset(a1, -0.4mm)", "offset(a1, -0.4mm)"),
        ("offset (a1 , by = - 0.4 mm)", "offset(a1, -0.4mm)"),
        ("offset(a1, 1e-3in)", "offset(a1, 0.001in)"),
        ("blend(a1, b1 - c1, .5)", "blend(a1, difference(b1, c1), 0.5)"),
        ("average(a1, b1, c1; 1, 1, 2)", "average(a1, b1, c1; 1, 1, 2)"),
        ("average(a1, b1)", "average(a1, b1; 1, 1)"),
        ("material(a1, b1; -1, 2.5)", "material(a1, b1; -1, 2.5)"),
        ("filter(a1)", "filter(a1, 5%, samples=64, cells=24)"),
        ("filter(a1, sigma=1mm, cap=2h)", "filter(a1, 2h, sigma=1mm, samples=64, cells=24)"),
        (
            "morph(filter(a1), filter(b1), 0.3)",
            "morph(filter(a1, 5%, samples=64, cells=24), filter(b1, 5%, samples=64, cells=24), 0.3)",
        ),
        ("morph(a1, b1, t)", "morph(a1, b1, t)"),
        ("texture(a1, points(500, seed=1), 0.2)", "texture(a1, points(500, 1), 0.2)"),
        ("ramp(a1, b1, x, to=40%)", "ramp(a1, b1, x, 0%, 40%)"),
        ("a1 - cylinder(1, 2, axis=y, z=-3h)", "difference(a1, cylinder(1, 2, y, 0, 0, -3h))"),
        ("levels(a1) | plane(z, -1in)", "union(levels(a1), plane(z, -1in))"),
    ] {
        assert_eq!(meaning(text), functions, "{text}");
    }
}

#[test]
fn everything_knows_where_it_stands() {
    let text = "a - blend((b), c, radius = 2 h)";
    let node = tree(text);
    let shown = |span: Span| &text[span.start..span.end];
    let blend = &call(&node).fields[1];
    assert_eq!(shown(node.span), text);
    assert_eq!(shown(blend.span), "blend((b), c, radius = 2 h)");
    assert_eq!(shown(call(blend).fields[0].span), "(b)");
    assert_eq!(shown(call(blend).arguments[0].span), "2 h");
    let filter = tree("filter(a, 1mm)");
    assert_eq!(call(&filter).arguments[3].span, filter.span, "a default stands where the call does");
}

#[test]
fn lengths_are_resolved_once_the_model_is_known() {
    assert_eq!(resolved("offset(a, -2h)").length("by"), Some(-1.0));
    assert_eq!(resolved("offset(a, 1in)").length("by"), Some(25.4));
    let filter = resolved("filter(a)");
    assert_eq!((filter.length("cap"), filter.length("width")), (Some(10.0), None));
    assert_eq!((filter.count("samples"), filter.argument("radius")), (Some(64), None));
    let ramp = resolved("ramp(a, b, y, -5mm, 40%)");
    assert_eq!(ramp.axis("axis"), Some(Axis::Y));
    assert_eq!((ramp.place("from"), ramp.place("to")), (Some(Place::At(-5.0)), Some(Place::Share(0.4))));
    assert_eq!(resolved("blob(a, 3)").number("gain"), Some(0.5));
}

#[test]
fn the_frame_stands_for_a_number_until_it_has_one() {
    let text = "morph(a, blob(b, 1, gain=t), 0.5)";
    let node = tree(text);
    assert_eq!(node.frame().map(|span| span.start), text.find("t)"));
    assert_eq!(node.resolve(model_units), Err(LanguageError::NoFrame { at: 25 }));
    let at_quarter = node.at_frame(0.25).unwrap();
    assert_eq!(at_quarter.frame(), None);
    assert_eq!(at_quarter.to_string(), "morph(a, blob(b, 1, 0.25), 0.5)");
    assert!(at_quarter.resolve(model_units).is_ok());
    for t in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(node.at_frame(t), Err(LanguageError::OutOfRange { at: 25, .. })), "{t}");
    }
    assert_eq!(parse("t", &["t"]), Err(LanguageError::ReservedName));
    assert_eq!(tree("offset(a, 1)").frame(), None);
}

#[test]
fn syntax_errors_name_the_place_and_what_was_expected() {
    const FIELD: &str = "expected a name, a function or `(`, found";
    const ARGUMENT: &str = "expected a name, a function, a number or `(`, found";
    const END: &str = "expected an operator (`|` `&` `-` `^`) or the end, found";
    const GROUP: &str = "expected an operator (`|` `&` `-` `^`) or `)`, found";
    const CALL: &str = "expected `,`, an operator (`|` `&` `-` `^`) or `)`, found";
    for (text, at, start, found) in [
        ("", 0, FIELD, "the end"),
        ("a - ", 4, FIELD, "the end"),
        ("a - * b", 4, FIELD, "`*`"),
        ("a b", 2, END, "`b`"),
        ("a | b)", 5, END, "`)`"),
        ("a = b", 2, END, "`=`"),
        ("(a | b", 6, GROUP, "the end"),
        ("(a, b)", 2, GROUP, "`,`"),
        ("offset(a", 8, CALL, "the end"),
        ("offset(a 1mm)", 9, CALL, "`1`"),
        ("blend(offset(a, 1), b; (2", 25, GROUP, "the end"),
        ("offset(a, )", 10, ARGUMENT, "`)`"),
        ("offset(a, by=)", 13, ARGUMENT, "`)`"),
        ("average(a, b; )", 14, "expected a number, found", "`)`"),
        ("offset(a, 2h3)", 12, CALL, "`3`"),
        ("a | é", 4, FIELD, "`é`"),
        ("offset(a, .)", 11, "expected a digit, found", "`)`"),
    ] {
        assert_eq!(place(text), (Some(at), format!("{start} {found}")), "{text}");
    }
}

#[test]
fn errors_of_meaning_name_the_place_and_what_was_wanted() {
    for (text, at, message) in [
        ("a | bb", 4, "no file is given for `bb`"),
        ("a | 3mm", 4, "`union(a, b, ...)` must be a field; `3mm` is not"),
        ("-2", 0, "`the expression` must be a field; `-2` is not"),
        ("a - t", 4, "`difference(a, b, ...)` must be a field, and t is a number; `t` is not"),
        ("ofset(a, 1)", 0, "there is no function `ofset`"),
        ("offset(a, size=1)", 15, "`offset(a, by)` has no parameter `size`"),
        ("offset(a)", 8, "`by` of `offset(a, by)` is missing"),
        ("offset()", 7, "`a` of `offset(a, by)` is missing"),
        ("union(a)", 7, "`b` of `union(a, b, ...)` is missing"),
        ("offset(a, 1, 2)", 13, "too many arguments for `offset(a, by)`"),
        ("offset(a, by=1, 2)", 16, "after an argument with a name, all must have one: `offset(a, by)`"),
        ("offset(a, 1, by=2)", 16, "`by` is given, and `by` too"),
        ("filter(a, 1, 1, 1)", 16, "`sigma` is given, and `width` too"),
        ("blend(a, 2mm, b)", 9, "`b of blend(a, b, radius)` must be a field; `2mm` is not"),
        ("blend(a, b, b)", 12, "`radius` must be a length above zero; `b` is not"),
        ("blend(a, b, -1mm)", 12, "`radius` must be a length above zero; `-1mm` is out of that range"),
        ("shell(a, 0)", 9, "`thickness` must be a length above zero; `0` is out of that range"),
        ("morph(a, b, 1.5)", 12, "`t` must be a number from 0 to 1, or t; `1.5` is out of that range"),
        ("morph(a, b, 1h)", 12, "`t` must be a number from 0 to 1, or t; `1h` is not"),
        ("offset(a, t)", 10, "`by` must be a length of either sign; `t` is not"),
        ("points(0.5)", 7, "`count` must be a whole number from 1 to 10000000; `0.5` is out of that range"),
        ("ramp(a, b, w)", 11, "`axis` must be x, y or z; `w` is not"),
        ("plane(1, 1)", 6, "`axis` must be x, y or z; `1` is not"),
        ("average(a, b; 1)", 14, "`average(a, b, ...; [weights])` takes 2 after the `;`, found 1"),
        ("material(a, b)", 13, "`material(a, b, ...; values)` takes 2 after the `;`, found 0"),
        ("union(a, b; 1, 2)", 12, "`union(a, b, ...)` takes 0 after the `;`, found 2"),
        ("average(a, b; 0, 0)", 14, "`the sum of the weights` must be above zero; `0` is out of that range"),
        ("average(a, b; 1, 2mm)", 17, "`what follows the ;` must be plain numbers; `2mm` is not"),
        ("exact(a | b)", 6, "`name of exact(name)` must be the name of a file; `a | b` is not"),
        ("offset(a, 1e999)", 10, "`1e999` is beyond all numbers"),
    ] {
        assert_eq!(place(text), (Some(at), message.into()), "{text}");
    }
}

#[test]
fn errors_that_need_the_model_keep_their_place() {
    assert_eq!(place("a | b | offset(a, 2furlong)"), (Some(18), "`furlong` is no unit".into()));
    let tiny = tree("shell(a, 1)").resolve(|_, _| Ok(0.0)).unwrap_err();
    assert_eq!(tiny.to_string(), "`thickness` must be a length above zero; `1 = 0` is out of that range");
    assert_eq!(tiny.position(), Some(9));
    assert!(tree("offset(a, 1)").resolve(|_, _| Ok(f64::INFINITY)).is_err());
    let default = tree("a | filter(b)").resolve(|_, _| Err("no diagonal".into())).unwrap_err();
    assert_eq!(default, LanguageError::Quantity { at: 4, reason: "no diagonal".into() });
}

#[test]
fn hints_know_what_was_meant() {
    let hint = |text: &str| parse(text, &["a", "b"]).unwrap_err().hint();
    assert_eq!(hint("ofset(a, 1) | b").as_deref(), Some("did you mean `offset`?"));
    assert_eq!(hint("blend_union(a, b)").as_deref(), Some("--help lists all functions"));
    assert_eq!(hint("c | a").as_deref(), Some("the names given are a, b"));
    assert_eq!(hint("a | points").as_deref(), Some("`points` is a function: points(count, seed=0)"));
    let unused = parse("a", &["a", "b"]).unwrap_err();
    assert_eq!((unused.to_string().as_str(), unused.position()), ("the expression does not use `b`", None));
}

#[test]
fn monstrous_texts_are_refused_before_they_recurse() {
    for deep in ["(".repeat(100_000), "offset(".repeat(100_000)] {
        assert!(matches!(parse(&deep, &[]), Err(LanguageError::TooLong { limit: MAX_DEPTH, .. })));
    }
    for long in [vec!["a"; 100_000].join("-"), "-".repeat(100_000), format!("union({})", "a,".repeat(100_000))] {
        assert!(matches!(parse(&long, &["a"]), Err(LanguageError::TooLong { limit: MAX_PARTS, .. })));
    }
    let longest = vec!["a"; MAX_PARTS + 1].join("-");
    assert_eq!(call(&parse(&longest, &["a"]).unwrap()).fields.len(), MAX_PARTS + 1);
    let minuses = format!("{}a", "-".repeat(MAX_PARTS));
    assert_eq!(parse(&minuses, &["a"]).unwrap().to_string(), "a");
    let deepest = format!("{}a{}", "-blend(a, ".repeat(MAX_DEPTH), ", 1)".repeat(MAX_DEPTH));
    assert!(parse(&deepest, &["a"]).is_ok());
}

#[test]
fn the_table_can_be_read_one_way_only() {
    for signature in FUNCTIONS.iter().copied() {
        assert_eq!(by_name(signature.name), Some(signature));
        assert!(
            !signature.more_fields || signature.parameters.is_empty(),
            "where would the fields of {signature} end?"
        );
        for parameter in signature.parameters {
            let same = signature.parameters.iter().filter(|p| p.name == parameter.name);
            assert_eq!(same.count(), 1, "{signature}");
            if let Presence::InsteadOf(other) = parameter.presence {
                assert!(signature.parameters.iter().any(|p| p.name == other && p.presence == Presence::Optional));
            }
        }
        let last_required = signature.parameters.iter().rposition(|p| p.presence == Presence::Required);
        let first_optional = signature.parameters.iter().position(|p| p.presence != Presence::Required);
        assert!(last_required < first_optional || first_optional.is_none(), "{signature}");
        assert!(help().contains(&signature.to_string()));
    }
}

/// A text for an argument of this kind.
fn argument(kind: Kind) -> BoxedStrategy<String> {
    let suffix = select(vec!["", "mm", "h", "%", " in", "\""]);
    let number = prop_oneof![(0.001..1e4).prop_map(|x: f64| x.to_string()), Just("1e-3".into()), Just("7.".into())];
    match kind {
        Kind::Length => (number, suffix).prop_map(|(n, s)| n + s).boxed(),
        Kind::SignedLength | Kind::Place => {
            (select(vec!["", "-", "- "]), number, suffix).prop_map(|(m, n, s)| m.to_string() + &n + s).boxed()
        }
        Kind::Number(from, to) => {
            prop_oneof![(from..to).prop_map(|x: f64| x.to_string()), Just("t".to_string())].boxed()
        }
        Kind::Count(from, to) => (from..to.min(1000)).prop_map(|n| n.to_string()).boxed(),
        Kind::Axis => select(Axis::ALL.to_vec()).prop_map(|axis| axis.name().to_string()).boxed(),
    }
}

/// A text for the call of `signature` with fields taken from `fields`.
fn call_text(signature: &'static Function, fields: BoxedStrategy<String>) -> BoxedStrategy<String> {
    let fields =
        if signature.takes_a_name() { select(NAMES.to_vec()).prop_map(str::to_string).boxed() } else { fields };
    let count = signature.fields.len();
    let counts = if signature.more_fields { count..=count + 2 } else { count..=count };
    let parameters: Vec<BoxedStrategy<(&Parameter, String, Index)>> = signature
        .parameters
        .iter()
        .map(|parameter| (Just(parameter), argument(parameter.kind), any::<Index>()).boxed())
        .collect();
    (prop::collection::vec(fields, counts), parameters, any::<bool>())
        .prop_map(move |(mut texts, parameters, list)| {
            let count = texts.len();
            let mut named = false;
            for (parameter, text, index) in parameters {
                let required = parameter.presence == Presence::Required;
                let rival = matches!(parameter.presence, Presence::InsteadOf(_));
                match index.index(3) {
                    0 if !required => named = true,
                    _ if rival && !named => named = true,
                    1 if !rival && !named => texts.push(text),
                    _ if rival => {}
                    _ => {
                        named = true;
                        texts.push(format!("{} = {text}", parameter.name));
                    }
                }
            }
            let list = match signature.list {
                List::Weights if !list => String::new(),
                List::None => String::new(),
                _ => format!("; {}", (1..=count).map(|n| format!("{n}.5")).collect::<Vec<_>>().join(",")),
            };
            format!("{}({}{list})", signature.name, texts.join(" ,"))
        })
        .boxed()
}

/// Texts that are right.
fn right_texts() -> impl Strategy<Value = String> {
    let names = select(NAMES.to_vec()).prop_map(str::to_string);
    names.prop_recursive(4, 24, 4, |field| {
        let join = (select(vec![" | ", "&", " - ", "^ ", "-"]), field.clone(), field.clone());
        prop_oneof![
            join.prop_map(|(operator, a, b)| format!("{a}{operator}{b}")),
            field.clone().prop_map(|a| format!("-({a} )")),
            select(FUNCTIONS.to_vec()).prop_flat_map(move |s| call_text(s, field.clone().boxed())),
        ]
    })
}

proptest! {
    #[test]
    fn printed_and_parsed_again_it_is_the_same(text in right_texts()) {
        let node = tree_of(&text, &NAMES);
        let printed = node.to_string();
        prop_assert_eq!(nowhere(&tree_of(&printed, &NAMES)), nowhere(&node), "{}", printed);
        let at_half = node.at_frame(0.5).unwrap();
        prop_assert!(at_half.resolve(|value, _| Ok(value)).is_ok());
        prop_assert_eq!(node.frame().is_some(), node != at_half);
    }

    #[test]
    fn any_text_is_answered(text in "[a-c0-9(),;=.|&^ -]{0,40}|(offset|blend|average|morph|[abt(),;=. -]|1e-?9?|%|mm){0,20}|\\PC{0,20}") {
        let inside = |error: &LanguageError| error.position().is_none_or(|at| text.is_char_boundary(at));
        match parse(&text, &["a", "b"]) {
            Err(error) => prop_assert!(inside(&error), "{:?}", error),
            Ok(node) => if let Err(error) = node.resolve(model_units) {
                prop_assert!(inside(&error), "{:?}", error);
            },
        }
    }

    /// One piece of a right text gone or doubled: an answer, and a place inside the text.
    #[test]
    fn broken_texts_are_answered(text in right_texts(), at in any::<Index>(), double in any::<bool>()) {
        let mut broken: Vec<char> = text.chars().collect();
        let at = at.index(broken.len());
        if double { broken.insert(at, broken[at]) } else { broken.remove(at); }
        let broken: String = broken.into_iter().collect();
        if let Err(error) = parse(&broken, &NAMES) {
            prop_assert!(error.position().is_none_or(|at| broken.is_char_boundary(at)), "{}: {:?}", broken, error);
        }
    }
}
