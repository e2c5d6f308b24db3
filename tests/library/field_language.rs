//! `docs/field.md` says what the table of functions says.

use meshwright::field::language::markdown;

#[test]
fn the_documented_functions_are_those_there_are() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/field.md");
    let page = std::fs::read_to_string(path).unwrap().replace("\r\n", "\n");
    let table = markdown();
    assert!(page.contains(&table), "docs/field.md should hold this table:\n{table}");
}
