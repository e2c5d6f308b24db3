//! Examples of every verb, as its help shows them.

/// A command line, and what it is for.
type Example = (&'static str, &'static str);

/// The help of a verb after its flags: `rest`, and examples.
pub fn after(verb: &str, rest: &str) -> String {
    let lines: String = of(verb).iter().map(|(line, what)| format!("\n  {line}\n      {what}")).collect();
    format!("{}\n\nExamples:{lines}", rest.trim_end())
}

/// The examples of a verb.
pub fn of(verb: &str) -> &'static [Example] {
    EXAMPLES.iter().find(|(name, _)| *name == verb).map_or(&[], |(_, examples)| examples)
}

/// All of them, by verb.
const EXAMPLES: [(&str, &[Example]); 26] = [
    (
        "repair",
        &[
            ("meshwright repair part.stl -o part_repaired.stl", "one closed solid; what is right stays as it is"),
            (
                "meshwright repair scan.obj -o scan_repaired.obj --preset scan --report scan.html",
                "settings for measured surfaces, and a page that shows what was changed",
            ),
            (
                "meshwright repair part.stl -o part_repaired.3mf --unit mm --voxel 0.2mm",
                "voxels of 0.2 mm where surface is made anew",
            ),
            (
                "meshwright repair plate.3mf -o plate_repaired.3mf --each",
                "every object of the file by itself; names, places and colours stay",
            ),
            (
                "meshwright repair part.stl -o skin.stl --outer 1%",
                "the surface as it is seen from outside, and no other",
            ),
        ],
    ),
    (
        "union",
        &[
            ("meshwright union body.stl rib.obj -o both.3mf", "two meshes as one solid"),
            ("meshwright union a.ply b.ply c.ply -o all.ply --plan", "what it would cost, and nothing is done"),
        ],
    ),
    (
        "intersection",
        &[
            ("meshwright intersection statue.stl box.stl -o inside.stl", "what of the statue lies in the box"),
            (
                "meshwright intersection a.ply b.ply -o common.ply --map map.ply",
                "and the same coloured by what was kept and cut",
            ),
        ],
    ),
    (
        "difference",
        &[
            ("meshwright difference block.stl bore.ply -o drilled.stl", "the block without the bore"),
            (
                "meshwright difference statue.stl bore.ply rib.obj -o cut.3mf --method exact",
                "without both, exactly, or not at all where an input has holes",
            ),
        ],
    ),
    (
        "csg",
        &[
            (
                "meshwright csg 'a - (b | c)' a=block.stl b=bore.ply c=rib.obj -o part.3mf",
                "the block without the bore and the rib",
            ),
            ("meshwright csg 'base & lid' base=a.stl lid=b.stl -o both.ply", "names may be words"),
        ],
    ),
    (
        "dilate",
        &[
            ("meshwright dilate part.stl -r 0.4mm --unit mm -o grown.stl", "0.4 mm larger on all sides, edges rounded"),
            ("meshwright dilate part.3mf -r 1% --sharp -o grown.3mf", "by 1 % of the diagonal, edges sharp"),
        ],
    ),
    (
        "erode",
        &[
            ("meshwright erode part.stl -r 0.4mm --unit mm -o shrunk.stl", "0.4 mm smaller on all sides"),
            ("meshwright erode part.obj -r 2h --resolution 64 -o shrunk.obj", "by two voxels of a coarse lattice"),
        ],
    ),
    (
        "open",
        &[
            ("meshwright open part.stl -r 1mm --unit mm -o opened.stl", "without whiskers, and walls under 2 mm"),
            ("meshwright open scan.ply -r 2% -o opened.ply", "the same by the size of the scan"),
        ],
    ),
    (
        "close",
        &[
            ("meshwright close part.stl -r 1mm --unit mm -o closed.stl", "cracks and gaps under 2 mm filled"),
            ("meshwright close scan.ply -r 2% -o closed.ply", "the same by the size of the scan"),
        ],
    ),
    (
        "canals",
        &[
            ("meshwright canals part.stl -d 3mm --unit mm", "a list of canals that a ball of 3 mm does not pass"),
            ("meshwright canals part.stl -d 3mm --unit mm --remove all -o filled.stl", "all of them filled"),
        ],
    ),
    (
        "thicken",
        &[
            ("meshwright thicken part.stl --min 2mm --unit mm -o thick.stl", "no wall under 2 mm"),
            ("meshwright thicken sheet.obj --min 4% --side front -o wall.obj", "a wall of an open sheet"),
            ("meshwright thicken terrain.obj --base 10% -o block.stl", "a block to print of a height map"),
        ],
    ),
    (
        "sdf",
        &[
            ("meshwright sdf part.stl -o part.vti", "distances within four voxels of the surface"),
            ("meshwright sdf part.stl --voxel 0.5 --band full -o part.nrrd", "everywhere, at a spacing of 0.5"),
            (
                "meshwright sdf scan.obj --sign winding --resolution 128 -o scan.npy",
                "of a surface with holes, for NumPy",
            ),
        ],
    ),
    (
        "field",
        &[
            ("meshwright field 'offset(a, -0.4mm)' a=part.stl --unit mm -o inner.stl", "0.4 mm smaller"),
            (
                "meshwright field 'blend(a, b, 2mm)' a=body.stl b=rib.obj --unit mm -o mug.3mf",
                "both as one, with a rounded joint",
            ),
            (
                "meshwright field 'morph(a, b, t)' a=a.obj b=b.obj --frames 9 -o morph.ply",
                "nine meshes on the way from one shape to another",
            ),
            ("meshwright field 'average(a, b, c; 1, 1, 2)' a=a.ply b=b.ply c=c.ply -o mean.vdb", "a weighted mean"),
        ],
    ),
    (
        "hollow",
        &[
            ("meshwright hollow part.stl -w 2mm --unit mm -o shell.stl", "a cavity, and a wall of 2 mm"),
            (
                "meshwright hollow statue.stl -w 3% --drain 8@0,0,-50 -o shell.stl",
                "and a hole of diameter 8 from the bottom into the cavity",
            ),
        ],
    ),
    (
        "decimate",
        &[
            ("meshwright decimate dense.ply --ratio 10% -o light.ply", "a tenth of the triangles"),
            (
                "meshwright decimate dense.ply --max-deviation 0.1% -o light.ply",
                "as few as keep the shape within 0.1 %",
            ),
        ],
    ),
    (
        "split",
        &[
            ("meshwright split plate.3mf -o parts", "part_001.3mf and so on, in the folder parts"),
            ("meshwright split bolts.stl -o bolt.ply", "bolt_001.ply and so on"),
        ],
    ),
    (
        "inspect",
        &[
            ("meshwright inspect part.stl", "what is wrong with it, and what to do next"),
            ("meshwright inspect scan.obj --holes", "every hole, and what would close it"),
            ("meshwright inspect part.stl --thickness --voxel 0.5", "walls and gaps, measured along rays 0.5 apart"),
            ("meshwright inspect part.stl --fail-on any --json", "for scripts: exit status 3 where something is wrong"),
        ],
    ),
    (
        "compare",
        &[
            ("meshwright compare part.stl part_repaired.stl", "how far the second is from the first"),
            (
                "meshwright compare part.stl scan.ply --map distances.ply",
                "and the scan coloured by its distance from the part",
            ),
            (
                "meshwright compare a.stl b.stl --fail-on-max 0.1mm --unit mm",
                "exit status 3 where they are farther apart than 0.1 mm",
            ),
        ],
    ),
    (
        "convert",
        &[
            ("meshwright convert part.obj -o part.stl", "another format"),
            ("meshwright convert part.stl --unit in -o part.3mf", "the numbers are inches, and 3MF says so"),
            ("meshwright convert part.stl --rotate x=90 --to-origin -o turned.stl", "turned, and moved to the origin"),
            ("meshwright convert part.vti -o part.vdb", "a grid in another format"),
        ],
    ),
    (
        "render",
        &[
            ("meshwright render part.stl -o part.png", "a picture, with defects in colour"),
            (
                "meshwright render part.stl part_repaired.stl -o both.png --view front",
                "before and after, from the front",
            ),
            ("meshwright render part.vti --slice z=50% -o slice.png", "a slice of a grid"),
        ],
    ),
    (
        "view",
        &[
            ("meshwright view part.stl part_repaired.stl", "both in a browser, turned together"),
            ("meshwright view part.stl part.vti -o page.html", "a file to look at later"),
        ],
    ),
    (
        "report",
        &[
            ("meshwright report run.json", "run.html beside it"),
            ("meshwright report run.json -o page.html", "another name"),
        ],
    ),
    ("devices", &[("meshwright devices", "a table"), ("meshwright devices --json", "the same for programs")]),
    (
        "licenses",
        &[("meshwright licenses", "all licences"), ("meshwright licenses > licenses.txt", "the same in a file")],
    ),
    (
        "batch",
        &[
            ("meshwright batch repair scans --out repaired", "all meshes in and below the folder scans"),
            (
                "meshwright batch repair 'scans/*.stl' --out repaired --preset scan --timeout 10m",
                "some of them, with options of `repair`, and ten minutes for each",
            ),
            ("meshwright batch repair scans --out repaired --resume", "what an earlier batch has not done"),
            ("meshwright batch inspect scans --out reports --jobs 2", "a report of each, two at a time"),
            ("meshwright batch --manifest jobs.jsonl --out results", "jobs from a file"),
        ],
    ),
    (
        "schema",
        &[("meshwright schema", "the schema"), ("meshwright schema > report.schema.json", "the same in a file")],
    ),
];

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use super::super::args::{command, parse};
    use super::*;

    /// The words of a line as a shell reads them, up to where its output goes.
    fn words(line: &str) -> Vec<OsString> {
        let line = line.split(" > ").next().unwrap_or_default();
        let pieces = line.split('\'').enumerate();
        let words = pieces.flat_map(|(n, piece)| match n % 2 {
            0 => piece.split_whitespace().map(OsString::from).collect(),
            _ => vec![OsString::from(piece)],
        });
        words.collect()
    }

    #[test]
    fn every_verb_has_examples_of_its_own_that_are_understood() {
        let program = command();
        let verbs: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
        assert!(EXAMPLES.iter().all(|(verb, _)| verbs.contains(verb)), "of a verb that is none");
        for verb in program.get_subcommands() {
            let name = verb.get_name();
            assert!((2..=5).contains(&of(name).len()), "{name}");
            let help = verb.clone().render_long_help().to_string();
            let shown = help.split_once("\nExamples:\n").map(|(_, after)| after).expect(name);
            for (line, what) in of(name) {
                assert!(shown.contains(&format!("  {line}\n      {what}")), "{line}");
                let words = words(line);
                assert_eq!(words[..2], ["meshwright", name], "{line}");
                let parsed = parse(words);
                assert!(parsed.is_ok(), "{line}: {:?}", parsed.err());
            }
            let last = of(name).last().map(|(_, what)| *what).expect(name);
            assert!(help.trim_end().ends_with(last), "{name}: the examples are not the end");
        }
    }
}
