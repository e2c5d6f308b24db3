//! A page about a run: one HTML file that asks nothing of any other, with tables and charts for every reader and a view in 3D for those whose
//! browser runs scripts. Data in, text out: what is to be said comes from the caller.
//!
//! The way of the data: a [`Pane`] is a mesh with its layers, simplified where it is too large for a browser (`fewer`), its numbers packed into
//! text (`pack`); [`Section`]s become HTML; [`Page::html`] puts both into the template with its style and script, which are files of this folder.

mod bodies;
mod chart;
mod clusters;
mod escape;
mod fewer;
mod layers;
mod pack;
mod section;
mod thickness;
mod view;

use serde_json::json;

pub use bodies::{BodyMeasures, bodies_of};
pub use chart::Histogram;
pub use clusters::{Cluster, DefectKind, clusters};
pub use layers::{Classes, Lines, Marks, Values, box_edges};
pub use section::{Part, Place, Row, Section, Table};
pub use thickness::wall_thickness;
pub use view::{MOST_TRIANGLES, Pane};

use crate::digits::count;
use escape::html;

/// How a run ended, in one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mood {
    /// All is well.
    Good,
    /// There is a result, and something to know of it.
    Careful,
    /// There is no result, or what was looked at has defects.
    Bad,
}

/// What stands on a page.
#[derive(Debug, Clone)]
pub struct Page {
    /// The heading.
    pub title: String,
    /// What the page is of, below the heading.
    pub subtitle: String,
    /// How it ended.
    pub mood: Mood,
    /// The same in a sentence.
    pub verdict: String,
    /// What stands before the view.
    pub first: Vec<Section>,
    /// The meshes of the view: none, one or two.
    pub panes: Vec<Pane>,
    /// The heading of the view.
    pub view_title: String,
    /// The name of the layer that is shown at first.
    pub shown_first: String,
    /// What stands after the view.
    pub sections: Vec<Section>,
    /// The report of the run, carried along for programs.
    pub report: serde_json::Value,
    /// The name of the program and its version.
    pub made_by: String,
    /// Whether the page says `bye` to where it came from when its tab is shut.
    pub served: bool,
}

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Nothing may be asked of any other file or machine.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// Of a page that is served: the farewell goes to where it came from, and to nowhere else.
const FAREWELL: (&str, &str) =
    ("; connect-src 'self'", "<script>\naddEventListener('pagehide', () => navigator.sendBeacon('bye'));\n</script>\n");

impl Page {
    /// The page. The same data give the same text.
    pub fn html(&self) -> String {
        let mood = match self.mood {
            Mood::Good => ("good", "✓"),
            Mood::Careful => ("careful", "!"),
            Mood::Bad => ("bad", "✗"),
        };
        let (more, farewell) = if self.served { FAREWELL } else { ("", "") };
        let first: String = self.first.iter().map(Section::html).collect();
        let sections: String = self.sections.iter().map(Section::html).collect();
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}{more}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
             <meta name=\"generator\" content=\"{made_by}\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <header><h1>{title}</h1><p class=\"subtitle\">{subtitle}</p>\
             <p class=\"verdict {class}\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span><span>{verdict}</span></p></header>\n\
             <main>\n{first}{view}{sections}</main>\n<footer><p>Made by {made_by}. The page holds all of its data; nothing is fetched or sent.</p></footer>\n\
             <script type=\"application/json\" id=\"report\">{report}</script>\n{script}{farewell}</body>\n</html>\n",
            made_by = html(&self.made_by),
            title = html(&self.title),
            subtitle = html(&self.subtitle),
            class = mood.0,
            sign = mood.1,
            verdict = html(&self.verdict),
            view = self.view(),
            report = escape::json(&self.report),
            script = self.script(),
        )
    }

    /// The pictures, and the place of the view.
    fn view(&self) -> String {
        if self.panes.is_empty() {
            return String::new();
        }
        let picture = |pane: &Pane| {
            let title = html(&pane.title);
            let image = pane.picture.as_ref().map_or(String::new(), |png| {
                format!(
                    "<img alt=\"{title}: {}\" src=\"{}\">",
                    html(&pane.caption),
                    pack::data_address("image/png", png)
                )
            });
            format!("<figure>{image}<figcaption><b>{title}</b> {}</figcaption></figure>", html(&pane.caption))
        };
        let pictures: String = self.panes.iter().map(picture).collect();
        format!(
            "<section id=\"view\"><h2>{}</h2>\n<div id=\"stage\" hidden></div>\n<div id=\"pictures\">{pictures}</div>\n\
             <p class=\"note\" id=\"still\">With scripts and WebGL these are meshes that can be turned.</p>{}</section>\n",
            html(&self.view_title),
            self.notes()
        )
    }

    /// What is to be said of meshes that are not shown whole.
    fn notes(&self) -> String {
        let large = self.panes.iter().filter(|pane| pane.mesh.triangles.len() > MOST_TRIANGLES);
        large
            .map(|pane| {
                let of = count(pane.mesh.triangles.len());
                format!(
                    "<p class=\"note simplified\">{}: simplified for the view, from {of} triangles to at most {}, by joining vertices that are near each other. \
                     Tables, charts and pictures are of all triangles.</p>",
                    html(&pane.title),
                    count(MOST_TRIANGLES)
                )
            })
            .collect()
    }

    fn script(&self) -> String {
        if self.panes.is_empty() {
            return String::new();
        }
        let panes: Vec<serde_json::Value> = self.panes.iter().map(|pane| pane.data(pane.shown().as_ref())).collect();
        let data = json!({ "panes": panes, "first": self.shown_first });
        format!(
            "<script type=\"application/json\" id=\"meshes\">{}</script>\n<script>\n{SCRIPT}</script>\n",
            escape::json(&data)
        )
    }
}
