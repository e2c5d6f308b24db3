//! Reports are what `meshwright schema` says that they are.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::{folder, run, run_in};

/// Checks values against the part of JSON Schema that the program's schema is written in; a word beyond that is an error, so that nothing
/// is passed over.
struct Schema(Value);

impl Schema {
    /// Why `value`, at `place`, is not what `schema` says; otherwise the names of its fields that the schema knows.
    fn check(&self, schema: &Value, value: &Value, place: &str) -> Result<BTreeSet<String>, String> {
        let Value::Object(words) = schema else {
            return if schema == &Value::Bool(true) { Ok(all(value)) } else { Err(format!("{place}: {schema}")) };
        };
        if words.keys().all(|word| ["description", "title", "default"].contains(&word.as_str())) {
            return Ok(all(value));
        }
        let mut known = BTreeSet::new();
        for (word, meant) in words {
            known.append(&mut self.word(words, (word, meant), value, place)?);
        }
        Ok(known)
    }

    /// The same without fields that the schema does not know.
    fn closed(&self, schema: &Value, value: &Value, place: &str) -> Result<(), String> {
        let known = self.check(schema, value, place)?;
        let beyond: Vec<String> = all(value).difference(&known).cloned().collect();
        if beyond.is_empty() { Ok(()) } else { Err(format!("{place}: nothing is said of {beyond:?}")) }
    }

    fn word(
        &self,
        words: &Map<String, Value>,
        (word, meant): (&str, &Value),
        value: &Value,
        place: &str,
    ) -> Result<BTreeSet<String>, String> {
        let wrong = |what: String| Err(format!("{place}: {what}, found {value}"));
        let mut known = BTreeSet::new();
        match word {
            "$ref" => {
                let pointer = meant.as_str().and_then(|text| text.strip_prefix('#')).expect("a place in the schema");
                return self.check(self.0.pointer(pointer).expect("a definition"), value, place);
            }
            "type" => {
                let names = meant.as_array().cloned().unwrap_or_else(|| vec![meant.clone()]);
                if !names.iter().any(|name| is_a(value, name.as_str().expect("a type"))) {
                    return wrong(format!("{meant} is wanted"));
                }
            }
            "const" if value != meant => return wrong(format!("{meant} is wanted")),
            "enum" if !meant.as_array().expect("a list").contains(value) => return wrong(format!("one of {meant}")),
            "minimum" if value.is_number() && value.as_f64() < meant.as_f64() => {
                return wrong(format!("at least {meant}"));
            }
            "maximum" if value.is_number() && value.as_f64() > meant.as_f64() => {
                return wrong(format!("at most {meant}"));
            }
            "minItems" | "maxItems" => {
                let count = value.as_array().map(|items| items.len() as u64);
                let right = if word == "minItems" { count >= meant.as_u64() } else { count <= meant.as_u64() };
                if count.is_some() && !right {
                    return wrong(format!("{word} {meant}"));
                }
            }
            "required" => {
                for name in meant.as_array().expect("a list") {
                    if value.get(name.as_str().expect("a name")).is_none() && value.is_object() {
                        return wrong(format!("{name} is missing"));
                    }
                }
            }
            "properties" => {
                for (name, schema) in meant.as_object().expect("fields") {
                    if let Some(field) = value.get(name) {
                        self.closed(schema, field, &format!("{place}.{name}"))?;
                        known.insert(name.clone());
                    }
                }
            }
            "items" => {
                for (n, item) in value.as_array().into_iter().flatten().enumerate() {
                    self.closed(meant, item, &format!("{place}[{n}]"))?;
                }
            }
            "oneOf" | "anyOf" => {
                let choices = meant.as_array().expect("a list");
                let tried: Vec<_> = choices.iter().map(|choice| self.check(choice, value, place)).collect();
                let mut right: Vec<_> = tried.iter().flatten().collect();
                match (right.len(), word) {
                    (0, _) => return wrong(format!("none of {} fits: {tried:?}", choices.len())),
                    (2.., "oneOf") => return wrong("more than one fits".into()),
                    _ => known.append(&mut right.remove(0).clone()),
                }
            }
            "$schema" | "$defs" | "$comment" | "title" | "description" | "format" | "default" => {}
            "const" | "enum" | "minimum" | "maximum" => {}
            "additionalProperties" if words.contains_key("properties") && meant == &Value::Bool(false) => {}
            _ => return Err(format!("{place}: the schema says {word}, which this test does not understand")),
        }
        Ok(known)
    }
}

fn all(value: &Value) -> BTreeSet<String> {
    value.as_object().into_iter().flat_map(|fields| fields.keys().cloned()).collect()
}

fn is_a(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => panic!("there is no type {name}"),
    }
}

fn schema() -> Schema {
    Schema(run(&["schema"]).exits(0).json())
}

#[track_caller]
fn assert_fits(schema: &Schema, report: &Value) {
    schema.closed(&schema.0, report, "report").unwrap_or_else(|error| panic!("{error}\nin {report:#}"));
}

/// Each kind of result that there is, and a run that gives it.
#[test]
fn every_verb_reports_what_the_schema_says() {
    let (folder, schema) = (folder(), schema());
    let mut seen = BTreeSet::new();
    for (line, kind) in [
        ("repair testdata/broken_mug.obj -o OUT/mug.stl --resolution 24 --keep-partial", "solid"),
        ("repair testdata/torus.ply -o OUT/torus.stl --resolution 24 --report OUT/run.json", "solid"),
        ("report OUT/run.json -o OUT/run.html", "page"),
        ("repair testdata/overlapping_boxes.obj --each -o OUT/each.3mf", "objects"),
        ("repair testdata/torus.ply --plan --resolution 24", "plan"),
        ("repair testdata/overlapping_boxes.obj -o OUT/boxes.stl", "solid"),
        ("repair testdata/overlapping_boxes.obj --plan", "plan"),
        ("inspect testdata/overlapping_boxes.obj", "inspection"),
        ("union testdata/torus.ply testdata/open_cube.off -o OUT/u.stl --resolution 24 --keep-partial", "solid"),
        ("intersection testdata/torus.ply testdata/torus.ply -o OUT/i.stl --resolution 24", "solid"),
        ("difference testdata/noisy_cube.off testdata/torus.ply -o OUT/d.stl --resolution 24 --keep-partial", "solid"),
        (
            "csg a-(b|c) a=testdata/noisy_cube.off b=testdata/torus.ply c=testdata/torus.ply -o OUT/c.stl --resolution 24 --keep-partial",
            "solid",
        ),
        ("dilate testdata/torus.ply -o OUT/di.stl --radius 1h --resolution 24 --keep-partial", "solid"),
        ("erode testdata/noisy_cube.off -o OUT/er.stl --radius 1h --resolution 24 --keep-partial", "solid"),
        ("open testdata/noisy_cube.off -o OUT/op.stl --radius 1h --resolution 24 --keep-partial", "solid"),
        ("close testdata/torus.ply -o OUT/cl.stl --radius 1h --resolution 24 --keep-partial", "solid"),
        ("canals testdata/bored_block.off --max-diameter 3h --resolution 24", "solid"),
        ("thicken testdata/thin_plate.stl -o OUT/th.stl --min 5h --resolution 24 --keep-partial", "solid"),
        ("thicken testdata/open_sheet.obj -o OUT/bl.stl --base 5", "solid"),
        ("thicken testdata/open_sheet.obj --base 5 --plan", "plan"),
        ("repair testdata/hollow_ball.stl -o OUT/ou.stl --outer 5%", "solid"),
        ("repair testdata/hollow_ball.stl --outer --plan", "plan"),
        ("hollow testdata/noisy_cube.off -o OUT/ho.stl --wall 3h --resolution 32 --keep-partial", "solid"),
        ("sdf testdata/torus.ply -o OUT/torus.nrrd --resolution 24", "distance"),
        ("sdf testdata/open_cube.off -o OUT/open.vti --resolution 24", "distance"),
        ("sdf testdata/torus.ply --plan --resolution 24", "distance-plan"),
        ("field offset(a,1h) a=testdata/torus.ply -o OUT/f.ply --resolution 24", "field"),
        (
            "field morph(a,b,t) a=testdata/torus.ply b=testdata/noisy_cube.off -o OUT/g.nrrd --frames 2 --resolution 24",
            "field",
        ),
        ("inspect testdata/torus.ply --thickness --resolution 24", "inspection"),
        ("inspect testdata/broken_mug.obj --resolution 24", "inspection"),
        ("inspect testdata/open_cube.off --holes", "inspection"),
        ("inspect testdata/open_cube.off", "inspection"),
        ("inspect OUT/torus.nrrd", "lattice"),
        ("compare testdata/torus.ply testdata/open_cube.off --samples 500 --map OUT/m.ply", "comparison"),
        ("decimate testdata/torus.ply -o OUT/q.stl --ratio 50%", "decimation"),
        ("split testdata/hollow_ball.stl -o OUT/piece.stl", "bodies"),
        ("convert testdata/torus.ply -o OUT/c.obj --scale 2", "conversion"),
        ("convert OUT/torus.nrrd -o OUT/again.vti", "conversion"),
        ("render testdata/torus.ply -o OUT/p.png --width 32 --height 32", "picture"),
        ("render OUT/torus.nrrd -o OUT/s.png --width 32 --height 32", "picture"),
        ("devices", "devices"),
    ] {
        let done = run_in(&folder, &format!("{line} --json -q"));
        assert!(done.status == 0 || done.status == 3, "{line}: {}\n{}", done.status, done.stderr);
        let report = done.json();
        assert_eq!(report["result"]["kind"], kind, "{line}");
        assert_eq!(report["schema"], 2);
        assert_fits(&schema, &report);
        seen.insert(kind.to_string());
    }
    let kinds = schema.0.pointer("/$defs/RunResult/oneOf").and_then(Value::as_array).expect("the kinds of results");
    let kinds: BTreeSet<String> =
        kinds.iter().map(|kind| kind["properties"]["kind"]["const"].as_str().expect("a tag").to_string()).collect();
    assert_eq!(seen, kinds, "a kind of result is in no run");
}

#[test]
fn runs_that_fail_report_what_the_schema_says() {
    let (folder, schema) = (folder(), schema());
    for (line, status) in [
        ("repair testdata/open_sheet.obj -o OUT/a.stl --voxel 0.4mm", 2),
        ("inspect OUT/nothing.stl", 4),
        ("repair testdata/open_cube.off -o OUT/a.stl --method exact", 3),
        ("repair testdata/open_sheet.obj -o OUT/a.stl --outer", 3),
        ("thicken testdata/torus.ply -o OUT/a.stl --base 5", 4),
        ("compare testdata/torus.ply testdata/open_cube.off --samples 500 --fail-on-max 0.01", 3),
        ("repair testdata/torus.ply --plan --max-memory 1M --resolution 512 --rebuild", 5),
    ] {
        let report = run_in(&folder, &format!("{line} --json -q")).exits(status).json();
        assert_fits(&schema, &report);
        assert!(report["error"]["message"].is_string(), "{line}");
    }
}

/// The test would see what it is there for.
#[test]
fn reports_that_are_wrong_do_not_fit() {
    let (folder, schema) = (folder(), schema());
    let report = run_in(&folder, "inspect testdata/torus.ply --json -q").exits(0).json();
    assert_fits(&schema, &report);
    let changes: [(&str, Value); 7] = [
        ("/schema", "two".into()),
        ("/result/kind", "wish".into()),
        ("/result/mass/volume", Value::Null),
        ("/inputs/0/validity/area", "much".into()),
        ("/inputs/0/validity/triangles", (-1).into()),
        ("/stages/0/stage", "thinking".into()),
        ("/inputs/0/parts", serde_json::json!([{ "name": "a", "triangles": 1, "colour": "red" }])),
    ];
    for (place, value) in changes {
        let mut changed = report.clone();
        let Some(at) = changed.pointer_mut(place) else { panic!("{place} is not in {report:#}") };
        *at = value;
        assert!(schema.closed(&schema.0, &changed, "report").is_err(), "{place}");
    }
    let mut lacking = report.clone();
    lacking.as_object_mut().expect("fields").remove("warnings");
    assert!(schema.closed(&schema.0, &lacking, "report").is_err());
}
