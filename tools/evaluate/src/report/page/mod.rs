//! Pages that show a comparison of samplers, and fits.

mod definitions;
mod families;
mod fits;
mod html;
mod needs;
mod pictures;
mod point;
mod repeated;
mod run;
mod settings;
mod shapes;
mod thesis;
mod top;

pub use fits::fit_page;
pub use repeated::thesis_page;

use crate::measure::compare::Comparison;
use crate::report::Provenance;

/// One self-contained HTML page, which is well-formed XML as well: text, tables, SVG charts and PNG pictures, without
/// scripts or addresses of other files. Parts of which nothing was measured are left out.
pub fn comparison_page(comparison: &Comparison, provenance: &Provenance) -> String {
    let sections: Vec<Section> = [
        top::verdicts(comparison),
        needs::section(comparison),
        point::section(comparison),
        settings::section(comparison),
        pictures::section(comparison),
        shapes::section(comparison),
        thesis::section(comparison),
        run::section(comparison),
        definitions::section(comparison),
    ]
    .into_iter()
    .flatten()
    .collect();
    whole_page(TITLE, &run::head(comparison, provenance), &sections)
}

/// A page with a head and sections; its own contents come first.
fn whole_page(title: &str, head: &str, sections: &[Section]) -> String {
    let mut contents = String::new();
    let mut body = String::new();
    for Section {
        id,
        title,
        body: text,
    } in sections
    {
        contents += &format!("<li><a href=\"#{id}\">{}</a></li>\n", html::escape(title));
        body += &html::section(id, title, text);
    }
    let title = html::escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
         <meta name=\"color-scheme\" content=\"light dark\" />\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n{head}</header>\n\
         <nav aria-label=\"Contents\">\n<ul>\n{contents}</ul>\n</nav>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

const TITLE: &str = "Sampler comparison: error against time and memory";
const STYLE: &str = include_str!("style.css");

/// A part of the page.
struct Section {
    id: String,
    title: String,
    body: String,
}

impl Section {
    /// A part with something in it; `None` for an empty body.
    fn new(id: &str, title: &str, body: String) -> Option<Self> {
        (!body.is_empty()).then(|| Self {
            id: id.to_owned(),
            title: title.to_owned(),
            body,
        })
    }
}
